// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/geometry/predicates.hpp"

#include <algorithm>
#include <array>
#include <numbers>
#include <span>

namespace framehex {

namespace detail {

/// Twice the area of a triangle as seen against a normal of unit length.
inline double seen_area(const Vector3& a, const Vector3& b, const Vector3& c, const Vector3& normal) {
  return (b - a).cross(c - a).dot(normal);
}

/// Sense in which a triangle is seen against a normal: exact where the normal is one of the axes.
inline int seen_orientation(const Vector3& a, const Vector3& b, const Vector3& c, const Vector3& normal) {
  for (int axis = 0; axis < 3; ++axis)
    if (normal[(axis + 1) % 3] == 0 && normal[(axis + 2) % 3] == 0)
      return normal[axis] > 0 ? projected_orientation(axis, a, b, c) : projected_orientation(axis, a, c, b);
  const double area = seen_area(a, b, c, normal);
  return area > 0 ? 1 : area < 0 ? -1 : 0;
}

}  // namespace detail

/// How far the worst corner of a flat cell is from a right angle.
///
/// @param corners  three or four points, anticlockwise seen against `normal`.
/// @param normal   of unit length.
/// @return the least sine of the angles, in space, at the corners, negative at those that turn the other way: 1 for a
///         rectangle, 0.87 for an equilateral triangle (it is not scaled to 1). A null edge gives 0.
/// @par Complexity   O(1).
/// @par Source       Stimpson et al., The Verdict geometric quality library, Sandia SAND2007-1751, quadrilaterals.
inline double scaled_jacobian(std::span<const Vector3> corners, const Vector3& normal) {
  double least = 1;
  const std::size_t n = corners.size();
  for (std::size_t i = 0; i < n; ++i) {
    const Vector3 x = corners[(i + 1) % n] - corners[i], y = corners[(i + n - 1) % n] - corners[i];
    const double lengths = std::sqrt(x.squaredNorm() * y.squaredNorm());
    least = std::min(least, lengths > 0 ? x.cross(y).dot(normal) / lengths : 0.0);
  }
  return least;
}

/// Does a flat cell turn the same way at all of its corners? A plane quadrilateral is convex then.
///
/// @param corners  three or four points.
/// @param normal   not null. Exact when it is along one of the axes.
/// @pre finite coordinates.
/// @par Complexity   O(1).
inline bool is_convex(std::span<const Vector3> corners, const Vector3& normal) {
  const std::size_t n = corners.size();
  for (std::size_t i = 0; i < n; ++i)
    if (detail::seen_orientation(corners[i], corners[(i + 1) % n], corners[(i + n - 1) % n], normal) <= 0) return false;
  return true;
}

/// Greatest deviation of an angle of a quadrilateral from the right angle.
///
/// @param corners  four points, anticlockwise seen against `normal`.
/// @return rad, 0 to 3 pi / 2: beyond pi / 2 the corner is reentrant, or the neighbouring ones are folded over it.
/// @par Source       Remacle et al., the paper's reference [4], section 2.
inline double angle_deviation(std::span<const Vector3, 4> corners, const Vector3& normal) {
  double largest = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    const Vector3 x = corners[(i + 1) % 4] - corners[i], y = corners[(i + 3) % 4] - corners[i];
    double angle = std::atan2(x.cross(y).dot(normal), x.dot(y));
    if (angle < 0) angle += 2 * std::numbers::pi;
    largest = std::max(largest, std::abs(angle - std::numbers::pi / 2));
  }
  return largest;
}

}  // namespace framehex
