// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/geometry/cell_kinds.hpp"
#include "framehex/geometry/detail/jacobian_bezier.hpp"
#include "framehex/geometry/predicates.hpp"

#include <algorithm>
#include <cmath>
#include <span>

namespace framehex {

namespace detail {

template <std::size_t N>
std::array<Triple<double>, N> triples(std::span<const Vector3> corners) {
  std::array<Triple<double>, N> p;
  for (std::size_t i = 0; i < N; ++i) p[i] = triple(corners[i]);
  return p;
}

/// Largest component of the edges in one direction.
template <std::size_t N>
double magnitude(const std::array<Triple<double>, N>& edges) {
  double m = 0;
  for (const auto& e : edges) m = std::max({m, std::abs(e.x), std::abs(e.y), std::abs(e.z)});
  return m;
}

inline bool has_positive_corners(CellKind kind, std::span<const Vector3> corners) {
  const auto at = [&](std::int8_t i) -> const Vector3& { return corners[static_cast<std::size_t>(i)]; };
  return std::ranges::all_of(
      corners_of(kind), [&](const LocalCorner& c) { return orientation(at(c.corner), at(c.x), at(c.y), at(c.z)) > 0; });
}

/// Magnitudes in the three directions for which neither the filters' arithmetic nor their halvings leave the range of
/// a double, and what underflows is far below their error bounds.
inline bool in_filter_range(double u, double v, double w) {
  return std::min({u, v, w}) > 1e-70 && std::max({u, v, w}) < 1e70;
}

/// Bound on the rounding of `jacobian_bezier`. With u = 2^-53 and `product` that of the largest components in the three
/// directions, a determinant has six terms of at most `product`, each wrong by 9 u; times 8, and summed to the centre's
/// coefficient, less than 5600 u. Sixteen halvings with their rounding add four times that at most.
inline double hexahedron_error(double product) {
  return 0x1p-40 * product;
}

bool is_valid_hexahedron(std::span<const Vector3> corners);
bool is_valid_prism(std::span<const Vector3> corners);

}  // namespace detail

/// Whether the map of a cell is invertible: its Jacobian is positive everywhere on the closed reference cell (a
/// pyramid's apex, where it is null by construction, taken as the limit).
///
/// Decided for the coordinates as stored: floating-point arithmetic with an error bound first, integers of any length
/// where that does not tell. Tetrahedra and pyramids need their corners only, prisms three quadratics, hexahedra the 27
/// Bezier coefficients of the Jacobian and their subdivision.
///
/// @param kind     kind of cell.
/// @param corners  n_corners(kind) points, in the order of geometry/cell_kinds.hpp.
/// @pre finite coordinates.
/// @return true only if positive everywhere. The subdivision has to end: of a hexahedron whose Jacobian is positive but
///         comes nearer to 0 than some 1e-24 of its scale, elsewhere than at a corner, the answer is false.
/// @par Complexity   O(1); integers are some hundred times slower, and met on nearly degenerate cells only.
/// @par Source       Johnen, Weill, Remacle, Robust and efficient validation of the linear hexahedral element, 2017
///                   (arXiv:1706.01613). Departs: an error bound instead of a tolerance, and an exact second stage.
inline bool is_valid(CellKind kind, std::span<const Vector3> corners) {
  switch (kind) {
    case CellKind::hexahedron: return detail::is_valid_hexahedron(corners);
    case CellKind::prism: return detail::is_valid_prism(corners);
    // A pyramid's Jacobian, over the square of the distance to the apex, is bilinear.
    default: return detail::has_positive_corners(kind, corners);
  }
}

}  // namespace framehex

#ifndef FRAMEHEX_COMPILED
#include "framehex/geometry/detail/validity_impl.hpp"
#endif
