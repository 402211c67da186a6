// SPDX-License-Identifier: BSL-1.0
#pragma once

#include <cstdint>

namespace framehex::detail {

/// Scrambles 64 bits. Source: the finalizer of SplitMix64 (Steele, Lea, Flood, OOPSLA 2014).
inline std::uint64_t scramble(std::uint64_t x) {
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9U;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebU;
  return x ^ (x >> 31);
}

}  // namespace framehex::detail
