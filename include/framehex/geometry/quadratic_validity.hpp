// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/geometry/detail/quadratic_map.hpp"

namespace framehex {

namespace detail {

/// The Jacobian's coefficients. Those of a pyramid have the square of the distance to the apex as a factor.
inline Polynomial<double> jacobian_of(const QuadraticMap& map) {
  const Polynomial<Vector3> u = map.derivative(0), v = map.derivative(1), w = map.derivative(2);
  Polynomial<Vector3> across;
  for (const auto& a : u.terms)
    for (const auto& b : v.terms)
      across.terms.push_back({a.powers + b.powers, a.value.cross(b.value), 2 * a.magnitude * b.magnitude});
  across.collect();
  Polynomial<double> jacobian;
  for (const auto& a : across.terms)
    for (const auto& b : w.terms)
      jacobian.terms.push_back({a.powers + b.powers, a.value.dot(b.value), 3 * a.magnitude * b.magnitude});
  jacobian.collect();
  return jacobian;
}

}  // namespace detail

/// Whether the map of a cell with a node on each edge (10, 13, 15 or 20 nodes) is surely invertible: its Jacobian is
/// positive on the whole closed reference cell, at a pyramid's apex in the limit.
///
/// Looks at the Jacobian's Bezier coefficients, which bound it from below, in floating point with a bound on its rounding.
///
/// @param corners  n_corners(kind) points. @param middles  a node for each of edges_of(kind).
/// @return true only if it is; false also for cells that are valid by less than the bounds can tell.
/// @pre finite coordinates, the Jacobian within the range of a double.
/// @par Complexity   O(1): some 20 to 200 microseconds.
/// @par Source       A. Johnen, J.-F. Remacle, C. Geuzaine, Geometrical validity of curvilinear finite elements, J. Comput.
///                   Phys. 233 (2013) 359-372. Departs: coefficients by multiplication of homogeneous polynomials, no
///                   subdivision, pyramids.
inline bool is_surely_valid(CellKind kind, std::span<const Vector3> corners, std::span<const Vector3> middles) {
  // No coefficient is the sum of more than 2^11 products of three, each of which has been through 2^6 sums at most.
  constexpr double rounding = 0x1p-53 * (0x1p11 + 0x1p8);
  for (const auto& term : detail::jacobian_of(detail::QuadraticMap(kind, corners, middles)).terms) {
    const bool is_beyond_apex = kind == CellKind::pyramid && (term.powers >> 16 & 15u) < 2;
    if (!is_beyond_apex && !(term.value > rounding * term.magnitude)) return false;
  }
  return true;
}

}  // namespace framehex
