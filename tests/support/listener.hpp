// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/observer.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <ctime>
#include <map>
#include <string>
#include <string_view>
#include <utility>

namespace framehex::test {

/// The calls of an observer, and the CPU time of the process between them.
class Listener {
public:
  Observer observer() {
    last_ = cpu_seconds();
    return [this](const Progress& progress) {
      hear(progress.stage);
      return true;
    };
  }

  void hear(std::string_view stage) {
    const double now = cpu_seconds();
    Silence& silence = longest_[{before_, std::string(stage)}];
    silence.seconds = std::max(silence.seconds, now - last_);
    ++silence.n_calls;
    before_ = stage;
    last_ = cpu_seconds();
  }

  /// Checks that no silence was longer than `Observer` promises, from when the observer was made to now.
  void check_silences() {
    constexpr double limit = 0.2;  // s
    hear("(end)");
    for (const auto& [stages, silence] : longest_) {
      INFO(stages.first << " to " << stages.second << ": " << silence.n_calls << " calls");
      CHECK(silence.seconds < limit);
    }
  }

private:
  struct Silence {
    double seconds = 0;
    int n_calls = 0;
  };

  static double cpu_seconds() {
    timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
  }

  std::map<std::pair<std::string, std::string>, Silence> longest_;
  std::string before_ = "(start)";
  double last_ = 0;
};

}  // namespace framehex::test
