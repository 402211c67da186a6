// SPDX-License-Identifier: BSL-1.0
#pragma once

#include <algorithm>
#include <atomic>
#include <concepts>
#include <cstddef>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace framehex {

/// Runs independent blocks of work.
///
/// `executor(n_blocks, body)` calls `body(block, worker)` once for each block in [0, n_blocks) in any order, with
/// `worker` < `executor.workers()` never shared by two calls at the same time (so it may index scratch memory), and
/// returns when all have ended. A host wraps its own thread pool in ten lines. Algorithms cut their work into blocks
/// that do not depend on the number of workers, so that results do not either.
///
/// The calling thread should run blocks as well, as `ThreadExecutor`'s does: an observer is called on that thread and
/// from within its blocks, so that a pool that leaves it idle is silent, and cannot be cancelled, while it works.
template <class E>
concept Executor = requires(const E& executor, std::size_t n, void (*body)(std::size_t, std::size_t)) {
  executor(n, body);
  { executor.workers() } -> std::convertible_to<std::size_t>;
};

/// The default: the calling thread.
struct SerialExecutor {
  std::size_t workers() const { return 1; }

  template <class Body>
  void operator()(std::size_t n_blocks, Body&& body) const {
    for (std::size_t block = 0; block < n_blocks; ++block) body(block, std::size_t{0});
  }
};

/// The standard's threads, started anew at each call: for stages of milliseconds and more.
class ThreadExecutor {
public:
  /// @param n_threads  0: as many as the machine has.
  explicit ThreadExecutor(std::size_t n_threads = 0) : workers_(n_threads) {
    if (workers_ == 0) workers_ = std::thread::hardware_concurrency();
    if (workers_ == 0) workers_ = 1;
  }

  std::size_t workers() const { return workers_; }

  /// @throws the first exception (in time) that `body` threw; blocks not yet begun are then skipped.
  template <class Body>
  void operator()(std::size_t n_blocks, Body&& body) const {
    if (workers_ == 1 || n_blocks < 2) return SerialExecutor{}(n_blocks, body);
    std::atomic<std::size_t> next{0};
    std::exception_ptr failure;
    std::mutex failure_mutex;
    const auto work = [&](std::size_t worker) {
      try {
        for (std::size_t block = next++; block < n_blocks; block = next++) body(block, worker);
      } catch (...) {
        next = n_blocks;
        const std::lock_guard lock(failure_mutex);
        if (!failure) failure = std::current_exception();
      }
    };
    std::vector<std::jthread> threads;
    for (std::size_t worker = 1; worker < workers_ && worker < n_blocks; ++worker) threads.emplace_back(work, worker);
    work(0);
    threads.clear();
    if (failure) std::rethrow_exception(failure);
  }

private:
  std::size_t workers_;
};

/// Calls `body(first, last)` on blocks of [0, n) whose size does not depend on the executor, so that results do not either.
template <Executor E, class Body>
void for_blocks(const E& executor, std::size_t n, std::size_t block_size, Body&& body) {
  executor((n + block_size - 1) / block_size, [&](std::size_t block, std::size_t) {
    const std::size_t first = block * block_size;
    body(first, std::min(n, first + block_size));
  });
}

}  // namespace framehex
