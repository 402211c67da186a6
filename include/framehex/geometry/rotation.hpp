// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/config.hpp"

#include <cmath>
#include <numbers>

namespace framehex {

/// The least rotation that takes one direction onto another.
///
/// @param from, to  unit vectors. Where they are opposite the axis is one across `from`, chosen by its components.
/// @return a unit quaternion.
/// @par Departs  Eigen's `FromTwoVectors` does the same but instantiates a singular value decomposition: 12 s of compile time.
inline Quaternion rotation_between(const Vector3& from, const Vector3& to) {
  // (1 + cos, sin * axis) is twice the cosine of the half angle times the quaternion wanted.
  const double w = 1 + from.dot(to);
  if (w > 1e-12) {
    const Vector3 v = from.cross(to);
    return Quaternion(w, v.x(), v.y(), v.z()).normalized();
  }
  const Vector3 axis = from.unitOrthogonal();
  return Quaternion(0, axis.x(), axis.y(), axis.z());
}

/// An angle (rad) brought to [-pi/4, pi/4] by quarter turns: the difference of two crosses.
inline double quarter_remainder(double angle) {
  constexpr double quarter = std::numbers::pi / 2;
  return angle - quarter * std::round(angle / quarter);
}

}  // namespace framehex
