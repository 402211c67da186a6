// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/executor.hpp"

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

namespace framehex {

/// An Executor on the threads of oneTBB, for hosts that use it already. Copies share an arena.
///
/// The calling thread takes part, unless more threads than one call at the same time. A block that calls the executor
/// again is not interrupted by other blocks of its own call, so that `worker` may index scratch memory.
class TbbExecutor {
public:
  /// @param n_threads  0: as many as TBB uses by default.
  explicit TbbExecutor(int n_threads = 0)
      : arena_(std::make_shared<tbb::task_arena>(n_threads > 0 ? n_threads : int{tbb::task_arena::automatic})) {
    arena_->initialize();
  }

  std::size_t workers() const { return static_cast<std::size_t>(arena_->max_concurrency()); }

  /// @throws one of the exceptions that `body` threw; blocks not yet begun are then skipped.
  template <class Body>
  void operator()(std::size_t n_blocks, Body&& body) const {
    const auto run = [&](std::size_t block) {
      body(block, static_cast<std::size_t>(tbb::this_task_arena::current_thread_index()));
    };
    const auto run_all = [&] { tbb::parallel_for(std::size_t{0}, n_blocks, run, tbb::simple_partitioner{}); };
    arena_->execute([&] { tbb::this_task_arena::isolate(run_all); });
  }

private:
  std::shared_ptr<tbb::task_arena> arena_;
};
static_assert(Executor<TbbExecutor>);

}  // namespace framehex
