// SPDX-License-Identifier: BSL-1.0
#include "framehex/executor.hpp"
#include "support/idle_caller.hpp"

#include <catch2/catch.hpp>

#include <set>
#include <stdexcept>
#include <vector>

using namespace framehex;

TEST_CASE("each block is run once, with a worker of its own at a time", "[executor]") {
  for (const std::size_t n_threads : std::vector<std::size_t>{1, 2, 3, 7}) {
    const ThreadExecutor executor(n_threads);
    REQUIRE(executor.workers() == n_threads);
    for (const std::size_t n_blocks : std::vector<std::size_t>{0, 1, 2, 5, 1000}) {
      std::vector<std::atomic<int>> runs(n_blocks), inside(n_threads);
      std::atomic<bool> shared{false};
      executor(n_blocks, [&](std::size_t block, std::size_t worker) {
        if (inside[worker]++ != 0) shared = true;
        ++runs[block];
        --inside[worker];
      });
      CHECK_FALSE(shared);
      for (const auto& n : runs) CHECK(n == 1);
    }
  }
}

TEST_CASE("threads are kept", "[executor]") {
  const ThreadExecutor executor(3);
  const ThreadExecutor copy = executor;
  std::set<std::thread::id> ids;
  std::mutex mutex;
  for (int call = 0; call < 500; ++call)
    (call % 2 == 0 ? executor : copy)(8, [&](std::size_t, std::size_t) {
      const std::lock_guard lock(mutex);
      ids.insert(std::this_thread::get_id());
    });
  CHECK(ids.size() <= 3);
}

TEST_CASE("calls within blocks and from several threads end", "[executor]") {
  const ThreadExecutor executor(3);
  std::atomic<int> n{0};
  executor(20, [&](std::size_t, std::size_t) { executor(10, [&](std::size_t, std::size_t) { ++n; }); });
  CHECK(n == 200);
  {
    std::vector<std::jthread> hosts;
    for (int host = 0; host < 4; ++host)
      hosts.emplace_back([&] {
        for (int call = 0; call < 50; ++call) executor(10, [&](std::size_t, std::size_t) { ++n; });
      });
  }
  CHECK(n == 200 + 4 * 50 * 10);
}

TEST_CASE("what a block throws arrives, and the pool goes on", "[executor]") {
  const ThreadExecutor executor(3);
  for (int call = 0; call < 20; ++call) {
    CHECK_THROWS_AS(executor(100,
                             [&](std::size_t block, std::size_t) {
                               if (block == 50) throw std::runtime_error("block 50");
                             }),
                    std::runtime_error);
    std::atomic<int> n{0};
    executor(100, [&](std::size_t, std::size_t) { ++n; });
    CHECK(n == 100);
  }
}

TEST_CASE("an executor that is told to stop leaves the rest out", "[executor]") {
  bool stop = false;
  std::size_t n_run = 0;
  const SerialExecutor serial;
  const StoppableExecutor executor(serial, [&] { return stop; });
  executor(100'000'000, [&](std::size_t block, std::size_t) {
    ++n_run;
    stop = block >= 1000;
  });
  CHECK(n_run > 1000);
  CHECK(n_run < 100'000'000);
}

TEST_CASE("a block that takes long after many short ones delays the question by no more than itself", "[executor]") {
  using namespace std::chrono_literals;
  const ThreadExecutor threads(2);
  std::atomic<int> n_long{0}, n_run{0};
  int longest = 0;
  const StoppableExecutor executor(threads, [&] {
    longest = std::max(longest, n_long.exchange(0));
    return false;
  });
  executor(5000, [&](std::size_t block, std::size_t) {
    ++n_run;
    if (block < 4980) return;
    std::this_thread::sleep_for(60ms);
    ++n_long;
  });
  CHECK(n_run == 5000);
  CHECK(longest <= 2);  // one of each thread, though the batch had room for hundreds
}

TEST_CASE("whether to stop is asked on the calling thread, whoever works", "[executor][regression]") {
  const auto caller = std::this_thread::get_id();
  const test::IdleCaller idle;
  int n_elsewhere = 0, n_since = 0, longest = 0;
  std::vector<int> n_runs(40, 0);
  const StoppableExecutor executor(idle, [&] {
    longest = std::max(longest, std::exchange(n_since, 0));
    n_elsewhere += std::this_thread::get_id() != caller;
    return false;
  });
  executor(n_runs.size(), [&](std::size_t block, std::size_t) {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    ++n_runs[block];
    ++n_since;
  });
  CHECK(n_elsewhere == 0);
  CHECK(longest <= 3);  // begun within 50 ms, as each takes 20 or more
  CHECK(std::ranges::count(n_runs, 1) == 40);
}
