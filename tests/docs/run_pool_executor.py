#!/usr/bin/env python3
# SPDX-License-Identifier: BSL-1.0
"""Runs the PoolExecutor of docs/how-to.md over a pool of threads: run_pool_executor.py SOURCE_DIR CXX [FLAGS...]

Whichever thread's block throws, what it throws must arrive, and no task may be running any longer when it does.
"""
import pathlib
import re
import subprocess
import sys
import tempfile

POOL = r"""
#include "framehex/executor.hpp"

#include <cstdio>
#include <functional>
#include <stdexcept>

/// Each task has a thread of its own.
class ThreadPool {
public:
  std::size_t n_threads() const { return 3; }
  void start(std::function<void()> task) {
    threads_.emplace_back([this, task] {
      try {
        task();
      } catch (...) {
        const std::lock_guard lock(mutex_);
        thrown_ = std::current_exception();
      }
    });
  }
  void wait() {
    threads_.clear();
    if (thrown_) std::rethrow_exception(std::exchange(thrown_, nullptr));
  }

private:
  std::mutex mutex_;
  std::exception_ptr thrown_;
  std::vector<std::jthread> threads_;
};
"""

MAIN = r"""
int main() {
  ThreadPool pool;
  const PoolExecutor executor{&pool};
  std::atomic<int> n_runs{0};
  executor(100, [&](std::size_t, std::size_t) { ++n_runs; });
  if (n_runs != 100) return std::puts("not every block was run once"), 1;
  for (const bool on_calling_thread : {true, false}) {
    std::atomic<int> n_running{0};
    std::atomic<bool> thrown{false};
    bool arrived = false;
    try {
      executor(60, [&](std::size_t, std::size_t worker) {
        ++n_running;
        std::this_thread::sleep_for(std::chrono::milliseconds(worker == 0 ? 20 : 40));
        --n_running;
        if ((worker == 0) == on_calling_thread && !thrown.exchange(true)) throw std::runtime_error("a block");
      });
    } catch (const std::runtime_error&) {
      arrived = true;
    }
    if (n_running != 0) std::puts("tasks go on after the call"), std::fflush(stdout), std::_Exit(1);
    if (!arrived) return std::puts("what a block threw is lost"), 1;
  }
}
"""


def main():
    root, compiler, *flags = sys.argv[1:]
    page = (pathlib.Path(root) / "docs" / "how-to.md").read_text()
    snippet = re.search(r"^```cpp\n(struct PoolExecutor.*?)^```$", page, re.M | re.S)[1]
    with tempfile.TemporaryDirectory() as name:
        source, program = pathlib.Path(name) / "pool.cpp", pathlib.Path(name) / "pool"
        source.write_text(POOL + snippet + MAIN)
        subprocess.run([compiler, "-std=c++20", "-pthread", f"-I{root}/include", *flags, source, "-o", program], check=True)
        return subprocess.run([program], timeout=120).returncode


if __name__ == "__main__":
    sys.exit(main())
