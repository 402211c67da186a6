// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/config.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace framehex {

/// Lattice neighbours of a point along its own axes: positions 2 a and 2 a + 1 are along and against axis a (column a
/// of its frame); `no_index` where there is none. Links are mutual: if q is a neighbour of p then p is one of q, along
/// whichever axis of q points back.
template <std::size_t Directions>
using LatticeLinks = std::vector<std::array<index_t, Directions>>;

/// Unit vector of one of the six directions of a frame.
inline Vector3 lattice_direction(const Eigen::Matrix3d& axes, std::size_t direction) {
  const auto column = axes.col(static_cast<Eigen::Index>(direction / 2));
  return direction % 2 == 0 ? Vector3(column) : Vector3(-column);
}

/// The direction that is nearest to a vector given along the axes; the first of equally near ones.
inline std::size_t nearest_direction(const Vector3& local) {
  const double x = std::abs(local[0]), y = std::abs(local[1]), z = std::abs(local[2]);
  const int axis = z > x && z > y ? 2 : y > x ? 1 : 0;
  return 2 * static_cast<std::size_t>(axis) + (local[axis] < 0 ? 1 : 0);
}

/// The direction of a frame that is nearest to `wanted`; the first of equally near ones.
inline std::size_t nearest_direction(const Eigen::Matrix3d& axes, const Vector3& wanted) {
  return nearest_direction(Vector3(axes.transpose() * wanted));
}

/// The same frame with its axes numbered and signed as those of `reference` that are nearest to them; `axes` itself
/// when the frames are too far apart for that.
inline Eigen::Matrix3d renumbered(const Eigen::Matrix3d& axes, const Eigen::Matrix3d& reference) {
  Eigen::Matrix3d result;
  for (int a = 0; a < 3; ++a) result.col(a) = lattice_direction(axes, nearest_direction(axes, reference.col(a)));
  return result.determinant() > 0.5 ? result : axes;
}

namespace detail {

template <std::size_t Directions>
bool connect(LatticeLinks<Directions>& links, index_t p, std::size_t p_direction, index_t q, std::size_t q_direction) {
  if (links[p][p_direction] != no_index || links[q][q_direction] != no_index) return false;
  for (const index_t other : links[p])
    if (other == q) return false;  // a strongly turning field could join the same two twice
  links[p][p_direction] = q;
  links[q][q_direction] = p;
  return true;
}

/// The point but `not_this` that both are linked to; `no_index` when there is none or it is not unique.
template <std::size_t Directions>
index_t common_neighbour(const LatticeLinks<Directions>& links, index_t a, index_t b, index_t not_this) {
  index_t found = no_index;
  for (const index_t x : links[a]) {
    if (x == no_index || x == not_this) continue;
    if (std::find(links[b].begin(), links[b].end(), x) == links[b].end()) continue;
    if (found != no_index) return no_index;
    found = x;
  }
  return found;
}

}  // namespace detail

/// Cells of eight points whose twelve edges are lattice links: hexahedra before there is a tetrahedron.
///
/// @return corners in the order of `CellKind::hexahedron` but for orientation; each cell once, its smallest index
/// first.
/// @par Complexity   O(n).
inline std::vector<std::array<index_t, 8>> lattice_cells(const LatticeLinks<6>& links) {
  std::vector<std::array<index_t, 8>> cells;
  for (index_t a = 0; a < links.size(); ++a)
    for (std::size_t corner = 0; corner < 8; ++corner) {
      const index_t b = links[a][corner & 1], d = links[a][2 + (corner >> 1 & 1)], e = links[a][4 + (corner >> 2)];
      if (b == no_index || d == no_index || e == no_index || std::min({b, d, e}) < a) continue;
      const index_t c = detail::common_neighbour(links, b, d, a);
      const index_t f = detail::common_neighbour(links, b, e, a);
      const index_t h = detail::common_neighbour(links, d, e, a);
      if (c == no_index || f == no_index || h == no_index || std::min({c, f, h}) < a) continue;
      const index_t g = detail::common_neighbour(links, c, f, b);
      if (g == no_index || g < a || std::find(links[h].begin(), links[h].end(), g) == links[h].end()) continue;
      cells.push_back({a, b, c, d, e, f, g, h});
    }
  return cells;
}

/// Quadrilaterals of four points whose edges are lattice links; each once, its smallest index first. The links of a
/// point may be in any order.
inline std::vector<std::array<index_t, 4>> lattice_cells(const LatticeLinks<4>& links) {
  std::vector<std::array<index_t, 4>> cells;
  for (index_t a = 0; a < links.size(); ++a)
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t j = i + 1; j < 4; ++j) {
        const index_t b = links[a][i], d = links[a][j];
        if (b == no_index || d == no_index || std::min(b, d) < a) continue;
        const index_t c = detail::common_neighbour(links, b, d, a);
        if (c != no_index && c > a) cells.push_back({a, b, c, d});
      }
  return cells;
}

}  // namespace framehex
