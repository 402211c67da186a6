// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/config.hpp"

#include <span>

namespace framehex {

/// The smallest box with sides along the axes that holds all points, in their unit; empty for none.
///
/// @par Complexity  O(n).
inline Eigen::AlignedBox3d bounding_box(std::span<const Vector3> points) {
  Eigen::AlignedBox3d box;
  for (const Vector3& p : points) box.extend(p);
  return box;
}

}  // namespace framehex
