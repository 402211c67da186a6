// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/executor.hpp"

#include <thread>

namespace framehex::test {

/// A pool whose caller only waits.
struct IdleCaller {
  std::size_t workers() const { return 1; }

  template <class Body>
  void operator()(std::size_t n_blocks, Body&& body) const {
    std::jthread([&] { SerialExecutor{}(n_blocks, body); });
  }
};

}  // namespace framehex::test
