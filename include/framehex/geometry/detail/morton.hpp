// SPDX-License-Identifier: BSL-1.0
#pragma once

#include <cstdint>

namespace framehex::detail {

/// The 21 lowest bits with two zeros between each and the next: one axis of a place along the Morton curve.
inline std::uint64_t spread_to_thirds(std::uint64_t x) {
  x = (x | x << 32) & 0x1f00000000ffff;
  x = (x | x << 16) & 0x1f0000ff0000ff;
  x = (x | x << 8) & 0x100f00f00f00f00f;
  x = (x | x << 4) & 0x10c30c30c30c30c3;
  return (x | x << 2) & 0x1249249249249249;
}

}  // namespace framehex::detail
