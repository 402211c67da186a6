// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/config.hpp"

#include <boost/multiprecision/cpp_int.hpp>

#include <cmath>

namespace framehex {

/// Six times the signed volume of tetrahedron a b c d, in floating point: positive when d lies on the side to which
/// the normal (b-a) x (c-a) points.
inline double orientation_determinant(const Vector3& a, const Vector3& b, const Vector3& c, const Vector3& d) {
  return (b - a).cross(c - a).dot(d - a);
}

namespace detail {

inline int exact_orientation(const Vector3& a, const Vector3& b, const Vector3& c, const Vector3& d) {
  using Rational = boost::multiprecision::cpp_rational;
  Rational m[3][3];
  for (int i = 0; i < 3; ++i) {
    const Rational origin(a[i]);
    m[0][i] = Rational(b[i]) - origin;
    m[1][i] = Rational(c[i]) - origin;
    m[2][i] = Rational(d[i]) - origin;
  }
  const Rational det = m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
                       m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
                       m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
  return det.sign();
}

}  // namespace detail

/// Exact sign (-1, 0, 1) of `orientation_determinant` for the coordinates as stored.
///
/// @pre finite coordinates.
/// @par Complexity   O(1): a floating-point filter, and rationals (a thousand times slower) for nearly flat input only.
/// @par Source       Filter bound of Shewchuk, Discrete Comput. Geom. 18 (1997) 305-363, section 4.4.
inline int orientation(const Vector3& a, const Vector3& b, const Vector3& c, const Vector3& d) {
  const Vector3 u = b - a, v = c - a, w = d - a;
  const double determinant = u.cross(v).dot(w);
  const Vector3 magnitude(std::abs(u.y() * v.z()) + std::abs(u.z() * v.y()),
                          std::abs(u.z() * v.x()) + std::abs(u.x() * v.z()),
                          std::abs(u.x() * v.y()) + std::abs(u.y() * v.x()));
  // Shewchuk's constant is (7 + 56 eps) eps with eps = 2^-53; rounded up to 8 eps, and underflow is left to the exact
  // branch.
  const double bound = 8.0 * 0x1p-53 * magnitude.dot(w.cwiseAbs());
  if (std::abs(determinant) > bound && bound > 1e-290) return determinant > 0 ? 1 : -1;
  return detail::exact_orientation(a, b, c, d);
}

}  // namespace framehex
