// SPDX-License-Identifier: BSL-1.0
#include "interruption.hpp"

#include "framehex/adapters/tetgen_process.hpp"
#include "framehex/io/output_file.hpp"

#include <signal.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <thread>

namespace program {

namespace {

constexpr int exit_interrupted = 130;

void set_stop_signals(sigset_t& set) {
  sigemptyset(&set);
  sigaddset(&set, SIGINT);
  sigaddset(&set, SIGTERM);
}

}  // namespace

// A thread of its own waits for the signals, which are blocked everywhere else: it may do what a handler may not.
struct Interruption::Watch {
  std::vector<std::string> outputs;
  std::atomic<bool> requested = false;
  std::jthread thread;

  void run(const std::stop_token& stop) {
    sigset_t set;
    set_stop_signals(set);
    const timespec pause{0, 50'000'000};
    while (!stop.stop_requested())
      if (sigtimedwait(&set, nullptr, &pause) > 0) {
        requested = true;
        break;
      }
    for (int i = 0; i < 7 && !stop.stop_requested(); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(100));
    if (!requested || stop.stop_requested()) return;
    end_progress();
    std::fputs("framehex: interrupted\n", stderr);
    std::error_code ignored;
    for (const std::string& name : outputs) {
      const std::string partial = framehex::OutputFile::temporary_name(name);
      if (!partial.empty()) std::filesystem::remove(partial, ignored);
    }
    const std::string prefix = framehex::detail::TemporaryFolder::prefix();
    for (const auto& entry :
         std::filesystem::directory_iterator(std::filesystem::temp_directory_path(ignored), ignored))
      if (entry.path().filename().string().starts_with(prefix)) std::filesystem::remove_all(entry.path(), ignored);
    std::_Exit(exit_interrupted);
  }
};

Interruption::Interruption(std::vector<std::string> outputs) : watch_(new Watch) {
  watch_->outputs = std::move(outputs);
  sigset_t set;
  set_stop_signals(set);
  pthread_sigmask(SIG_BLOCK, &set, nullptr);
  watch_->thread = std::jthread([watch = watch_](const std::stop_token& stop) { watch->run(stop); });
}

Interruption::~Interruption() {
  delete watch_;
}

bool Interruption::requested() const {
  return watch_->requested;
}

namespace {

void draw(const framehex::Progress& progress) {
  constexpr int width = 30;
  char bar[width + 1];
  const int filled = static_cast<int>(progress.fraction * width);
  for (int i = 0; i < width; ++i) bar[i] = i < filled ? '#' : '.';
  bar[width] = '\0';
  std::fprintf(stderr, "\r\033[K%-20.*s [%s] %3d %%", static_cast<int>(progress.stage.size()), progress.stage.data(),
               bar, static_cast<int>(100 * progress.fraction));
  std::fflush(stderr);
}

}  // namespace

framehex::Observer make_observer(const Interruption& interruption, bool visible) {
  const bool draws = visible && ::isatty(STDERR_FILENO) != 0;
  using Clock = std::chrono::steady_clock;
  return [&interruption, draws, last = Clock::time_point{}](const framehex::Progress& progress) mutable {
    if (draws && Clock::now() - last > std::chrono::milliseconds(100)) {
      draw(progress);
      last = Clock::now();
    }
    return !interruption.requested();
  };
}

void end_progress() {
  if (::isatty(STDERR_FILENO) != 0) std::fputs("\r\033[K", stderr);
}

}  // namespace program
