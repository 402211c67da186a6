// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/geometry/detail/quadratic_map.hpp"
#include "framehex/geometry/quadratic_validity.hpp"

namespace framehex {

namespace detail {

/// The Jacobian's coefficients. Those of a pyramid have the square of the distance to the apex as a factor.
FRAMEHEX_INLINE Polynomial<double> jacobian_of(const QuadraticMap& map) {
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

FRAMEHEX_INLINE bool is_surely_valid(CellKind kind, std::span<const Vector3> corners,
                                     std::span<const Vector3> middles) {
  // No coefficient is the sum of more than 2^11 products of three, each of which has been through 2^6 sums at most.
  constexpr double rounding = 0x1p-53 * (0x1p11 + 0x1p8);
  for (const auto& term : detail::jacobian_of(detail::QuadraticMap(kind, corners, middles)).terms) {
    const bool is_beyond_apex = kind == CellKind::pyramid && (term.powers >> 16 & 15u) < 2;
    if (!is_beyond_apex && !(term.value > rounding * term.magnitude)) return false;
  }
  return true;
}

}  // namespace framehex
