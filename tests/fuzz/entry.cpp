// SPDX-License-Identifier: BSL-1.0
// What libFuzzer calls; FRAMEHEX_FUZZ_TARGET is one of the functions of targets.hpp.
#include "targets.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  framehex::test::FRAMEHEX_FUZZ_TARGET({data, size});
  return 0;
}
