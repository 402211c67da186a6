// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/config.hpp"
#include "framehex/geometry/detail/triple.hpp"

#include <cmath>

namespace framehex {

/// Six times the signed volume of tetrahedron a b c d, in floating point: positive when d lies on the side to which
/// the normal (b-a) x (c-a) points.
inline double orientation_determinant(const Vector3& a, const Vector3& b, const Vector3& c, const Vector3& d) {
  return (b - a).cross(c - a).dot(d - a);
}

namespace detail {

inline Triple<double> triple(const Vector3& p) {
  return {p.x(), p.y(), p.z()};
}

inline int exact_orientation(const Vector3& a, const Vector3& b, const Vector3& c, const Vector3& d) {
  const std::array points{triple(a), triple(b), triple(c), triple(d)};
  const BinaryPlaces places = binary_places(points);
  // Six products of three differences, and a sign.
  return with_wide_integers(3 * (places.width() + 1) + 4, [&]<std::size_t Limbs>() {
    const auto p = scaled<Limbs>(places, points);
    return dot(cross(p[1] - p[0], p[2] - p[0]), p[3] - p[0]).sign();
  });
}

inline int exact_turn(const std::array<std::array<double, 2>, 3>& points) {
  BinaryPlaces places;
  for (const auto& p : points)
    for (const double x : p) places.add(x);
  return with_wide_integers(2 * (places.width() + 1) + 2, [&]<std::size_t Limbs>() {
    const auto difference = [&](std::size_t i, std::size_t axis) {
      return places.scaled<Limbs>(points[i][axis]) - places.scaled<Limbs>(points[0][axis]);
    };
    return (difference(1, 0) * difference(2, 1) - difference(1, 1) * difference(2, 0)).sign();
  });
}

}  // namespace detail

/// Exact sign (-1, 0, 1) of `orientation_determinant` for the coordinates as stored.
///
/// The sign does not depend on the compiler's flags: the filter's bound holds with and without fused multiply-adds,
/// and what it leaves undecided is decided by integers.
///
/// @pre finite coordinates.
/// @par Complexity   O(1): a floating-point filter, and integers (ten times slower when the coordinates are of similar
///                   size) for nearly flat input only.
/// @par Source       Filter bound of Shewchuk, Discrete Comput. Geom. 18 (1997) 305-363, section 4.4. Departs: integers
///                   of fixed width for his expansions, because they cannot underflow.
inline int orientation(const Vector3& a, const Vector3& b, const Vector3& c, const Vector3& d) {
  const Vector3 u = b - a, v = c - a, w = d - a;
  const double determinant = u.cross(v).dot(w);
  const Vector3 magnitude(std::abs(u.y() * v.z()) + std::abs(u.z() * v.y()),
                          std::abs(u.z() * v.x()) + std::abs(u.x() * v.z()),
                          std::abs(u.x() * v.y()) + std::abs(u.y() * v.x()));
  // Shewchuk's constant is (7 + 56 eps) eps with eps = 2^-53; rounded up to 8 eps. Where a product may have underflowed
  // (its error grows with w) the bound is not one.
  const double bound = 8.0 * 0x1p-53 * magnitude.dot(w.cwiseAbs());
  if (std::abs(determinant) > bound && bound > 1e-290 * (1 + w.cwiseAbs().maxCoeff())) return determinant > 0 ? 1 : -1;
  for (int axis = 0; axis < 3; ++axis)
    if (a[axis] == b[axis] && a[axis] == c[axis] && a[axis] == d[axis]) return 0;
  return detail::exact_orientation(a, b, c, d);
}

/// Exact sign (-1, 0, 1) of one component of the normal (b-a) x (c-a): the sense in which triangle a b c is seen
/// against that axis.
///
/// @param axis  0, 1 or 2.
/// @pre finite coordinates.
/// @par Complexity   O(1), as `orientation`.
/// @par Source       as `orientation`, section 4.2.
inline int projected_orientation(int axis, const Vector3& a, const Vector3& b, const Vector3& c) {
  const int x = (axis + 1) % 3, y = (axis + 2) % 3;
  const double left = (b[x] - a[x]) * (c[y] - a[y]), right = (b[y] - a[y]) * (c[x] - a[x]);
  const double determinant = left - right, bound = 4.0 * 0x1p-53 * (std::abs(left) + std::abs(right));
  if (std::abs(determinant) > bound && bound > 1e-290) return determinant > 0 ? 1 : -1;
  return detail::exact_turn({{{a[x], a[y]}, {b[x], b[y]}, {c[x], c[y]}}});
}

}  // namespace framehex
