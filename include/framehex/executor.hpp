// SPDX-License-Identifier: BSL-1.0
#pragma once

#include <algorithm>
#include <atomic>
#include <chrono>
#include <concepts>
#include <condition_variable>
#include <cstddef>
#include <exception>
#include <memory>
#include <mutex>
#include <thread>
#include <type_traits>
#include <utility>
#include <vector>

namespace framehex {

/// Runs independent blocks of work.
///
/// `executor(n_blocks, body)` calls `body(block, worker)` once for each block in [0, n_blocks) in any order, with
/// `worker` < `executor.workers()` never shared by two calls at the same time (so it may index scratch memory), and
/// returns when all have ended. A host wraps its own thread pool in ten lines. Algorithms cut their work into blocks
/// that do not depend on the number of workers, so that results do not either.
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

namespace detail {

/// Threads that wait for work until they are destroyed.
class ThreadPool {
public:
  explicit ThreadPool(std::size_t n_workers) {
    for (std::size_t worker = 1; worker < n_workers; ++worker) threads_.emplace_back([this, worker] { serve(worker); });
  }
  ThreadPool(const ThreadPool&) = delete;
  ThreadPool& operator=(const ThreadPool&) = delete;
  ~ThreadPool() {
    {
      const std::lock_guard lock(mutex_);
      ending_ = true;
    }
    wake_.notify_all();
  }

  /// Runs `work(worker)` once on each thread and on the calling one, which is worker 0.
  /// @return false when the pool is at work already: nothing was run.
  template <class Work>
  bool run(Work& work) {
    const std::unique_lock busy(busy_, std::try_to_lock);
    if (!busy) return false;
    {
      const std::lock_guard lock(mutex_);
      work_ = [](void* job, std::size_t worker) { (*static_cast<Work*>(job))(worker); };
      job_ = &work;
      n_running_ = threads_.size();
      ++n_jobs_;
    }
    wake_.notify_all();
    work(0);
    std::unique_lock lock(mutex_);
    done_.wait(lock, [this] { return n_running_ == 0; });
    return true;
  }

private:
  void serve(std::size_t worker) {
    std::unique_lock lock(mutex_);
    for (std::size_t n_seen = 0;;) {
      wake_.wait(lock, [&] { return ending_ || n_jobs_ != n_seen; });
      if (ending_) return;
      n_seen = n_jobs_;
      lock.unlock();
      work_(job_, worker);
      lock.lock();
      if (--n_running_ == 0) done_.notify_one();
    }
  }

  std::mutex busy_, mutex_;
  std::condition_variable wake_, done_;
  void (*work_)(void*, std::size_t) = nullptr;
  void* job_ = nullptr;
  std::size_t n_jobs_ = 0, n_running_ = 0;
  bool ending_ = false;
  std::vector<std::jthread> threads_;  ///< last, so that they end before what they use
};

}  // namespace detail

/// The standard's threads, started once and kept; copies share them.
///
/// A call from within a block, or while another thread's call is running, is worked off by the calling thread alone.
class ThreadExecutor {
public:
  /// @param n_threads  0: as many as the machine has.
  explicit ThreadExecutor(std::size_t n_threads = 0) : workers_(n_threads) {
    if (workers_ == 0) workers_ = std::max<std::size_t>(std::thread::hardware_concurrency(), 1);
    if (workers_ > 1) pool_ = std::make_shared<detail::ThreadPool>(workers_);
  }

  std::size_t workers() const { return workers_; }

  /// @throws the first exception (in time) that `body` threw; blocks not yet begun are then skipped.
  template <class Body>
  void operator()(std::size_t n_blocks, Body&& body) const {
    if (!pool_ || n_blocks < 2) return SerialExecutor{}(n_blocks, body);
    std::atomic<std::size_t> next{0};
    std::exception_ptr failure;
    std::mutex failure_mutex;
    auto work = [&](std::size_t worker) {
      try {
        for (std::size_t block = next++; block < n_blocks; block = next++) body(block, worker);
      } catch (...) {
        next = n_blocks;
        const std::lock_guard lock(failure_mutex);
        if (!failure) failure = std::current_exception();
      }
    };
    if (!pool_->run(work)) return SerialExecutor{}(n_blocks, body);
    if (failure) std::rethrow_exception(failure);
  }

private:
  std::size_t workers_;
  std::shared_ptr<detail::ThreadPool> pool_;
};

/// Any executor, by reference: what takes it is compiled once for all of them.
///
/// The executor must outlive it. A block costs one indirect call more.
class ExecutorRef {
public:
  template <Executor E>
  requires(!std::same_as<E, ExecutorRef>)
      ExecutorRef(const E& executor)  // NOLINT: whoever takes any executor is meant to be called with that
      : executor_(&executor),
        workers_([](const void* e) -> std::size_t { return static_cast<const E*>(e)->workers(); }),
        run_([](const void* e, std::size_t n_blocks, void* body, Block block) {
          (*static_cast<const E*>(e))(n_blocks, [=](std::size_t i, std::size_t worker) { block(body, i, worker); });
        }) {}

  std::size_t workers() const { return workers_(executor_); }

  template <class Body>
  void operator()(std::size_t n_blocks, Body&& body) const {
    using B = std::remove_reference_t<Body>;
    auto* const address = const_cast<std::remove_const_t<B>*>(std::addressof(body));
    run_(executor_, n_blocks, address,
         [](void* b, std::size_t block, std::size_t worker) { (*static_cast<B*>(b))(block, worker); });
  }

private:
  using Block = void (*)(void* body, std::size_t block, std::size_t worker);

  const void* executor_;
  std::size_t (*workers_)(const void*);
  void (*run_)(const void*, std::size_t n_blocks, void* body, Block);
};

/// An executor that asks on the calling thread, about twenty times a second, whether to go on; blocks not yet begun when
/// the answer is no are left out.
///
/// The question is asked between batches, so that it is asked whatever threads the executor runs blocks on. A batch is
/// at most twice as large as the one before, and takes no further block when its time is up: a block that takes long
/// delays the question by no more than itself.
template <Executor E, class Stop>
class StoppableExecutor {
public:
  /// @param stop  `bool stop()`: true ends the work.
  StoppableExecutor(const E& executor, Stop stop) : executor_(executor), stop_(std::move(stop)) {}

  std::size_t workers() const { return executor_.workers(); }

  template <class Body>
  void operator()(std::size_t n_blocks, Body&& body) const {
    std::size_t first = 0;
    for (std::size_t size = workers(); first < n_blocks; size = std::min(2 * size, n_blocks)) {
      first = run_batch(first, first + std::min(size, n_blocks - first), body);
      if (stop_()) return;
    }
  }

private:
  /// @return the first block of [first, last) that was not run; at least one was.
  template <class Body>
  std::size_t run_batch(std::size_t first, std::size_t last, Body& body) const {
    using Clock = std::chrono::steady_clock;
    const Clock::time_point end = Clock::now() + std::chrono::milliseconds(50);
    std::atomic<std::size_t> next{first};
    executor_(std::min(workers(), last - first), [&](std::size_t, std::size_t worker) {
      while (next == first || Clock::now() < end) {
        const std::size_t block = next++;
        if (block >= last) return;
        body(block, worker);
      }
    });
    return std::min<std::size_t>(next, last);
  }

  const E& executor_;
  Stop stop_;
};

/// Calls `body(first, last)` on blocks of [0, n) whose size does not depend on the executor, so that results do not either.
template <Executor E, class Body>
void for_blocks(const E& executor, std::size_t n, std::size_t block_size, Body&& body) {
  executor((n + block_size - 1) / block_size, [&](std::size_t block, std::size_t) {
    const std::size_t first = block * block_size;
    body(first, std::min(n, first + block_size));
  });
}

/// Sum of `term(i)` over [0, n), added up block by block in order, so that it does not depend on the executor.
///
/// @param partial  scratch for the blocks' sums, kept by the caller so that loops do not allocate.
template <Executor E, class Term>
double sum_by_blocks(const E& executor, std::size_t n, std::size_t block_size, std::vector<double>& partial,
                     const Term& term) {
  partial.assign((n + block_size - 1) / block_size, 0.0);
  for_blocks(executor, n, block_size, [&](std::size_t first, std::size_t last) {
    double total = 0;
    for (std::size_t i = first; i < last; ++i) total += term(i);
    partial[first / block_size] = total;
  });
  double total = 0;
  for (const double p : partial) total += p;
  return total;
}

}  // namespace framehex
