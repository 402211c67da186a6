// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/geometry/quadrilateral.hpp"
#include "framehex/mesh/adjacency.hpp"
#include "framehex/mesh/quad_mesh.hpp"

#include <map>

namespace framehex::verify {

/// What a mesh of quadrilaterals is made of, and how good it is, each cell seen against its own plane.
struct QuadQuality {
  std::size_t n_quads = 0, n_triangles = 0;
  double area = 0, quad_area = 0;
  double least = 1, mean = 0;           ///< scaled Jacobian
  std::vector<double> scaled_jacobian;  ///< by cell
  std::vector<index_t> folded;          ///< cells that are not convex
  std::size_t n_irregular = 0;          ///< vertices inside that have other than four cells
  std::size_t n_rim_edges = 0;          ///< edges of one cell
  std::size_t n_bad_edges = 0;          ///< edges that two cells run along the same way
  long euler_characteristic = 0;        ///< vertices in use less edges plus cells
  /// Over all vertices 4 less twice the edges plus the cells round it, which is 4 less the cells inside and 2 less them on
  /// a rim: four times the Euler characteristic, where all cells are quadrilaterals.
  long index_sum = 0;
};

/// @param mesh  indices in range.
/// @par Complexity   O(n log n).
inline QuadQuality quad_quality(const QuadMesh& mesh) {
  QuadQuality q;
  struct Sides {
    int forth = 0, back = 0;
  };
  std::map<std::uint64_t, Sides> sides;
  std::vector<long> n_cells(mesh.points.size(), 0);
  std::vector<char> on_rim(mesh.points.size(), 0);
  std::array<Vector3, 4> storage;
  for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
    const QuadMesh::Cell& cell = mesh.cells[c];
    const std::size_t n = QuadMesh::n_corners(cell);
    for (std::size_t i = 0; i < n; ++i) {
      storage[i] = mesh.points[cell[i]];
      ++n_cells[cell[i]];
      const index_t next = cell[(i + 1) % n];
      Sides& side = sides[framehex::detail::edge_key(cell[i], next)];
      ++(cell[i] < next ? side.forth : side.back);
    }
    const std::span<const Vector3> corners = std::span(storage).first(n);
    const Vector3 area = n == 4 ? Vector3((corners[2] - corners[0]).cross(corners[3] - corners[1]) / 2)
                                : Vector3((corners[1] - corners[0]).cross(corners[2] - corners[0]) / 2);
    const double size = area.norm();
    const Vector3 normal = size > 0 ? Vector3(area / size) : Vector3(Vector3::UnitZ());
    q.scaled_jacobian.push_back(scaled_jacobian(corners, normal));
    q.least = std::min(q.least, q.scaled_jacobian.back());
    q.mean += q.scaled_jacobian.back() / static_cast<double>(mesh.cells.size());
    if (!is_convex(corners, normal)) q.folded.push_back(static_cast<index_t>(c));
    q.area += size;
    if (n == 4) q.quad_area += size;
    ++(n == 4 ? q.n_quads : q.n_triangles);
  }
  for (const auto& [key, side] : sides) {
    if (side.forth > 1 || side.back > 1) ++q.n_bad_edges;
    q.index_sum -= 4;  // twice the edge, at both ends
    if (side.forth + side.back != 1) continue;
    ++q.n_rim_edges;
    on_rim[key >> 32] = on_rim[key & 0xffffffff] = 1;
  }
  long n_used = 0;
  for (std::size_t v = 0; v < n_cells.size(); ++v) {
    if (n_cells[v] == 0) continue;
    ++n_used;
    q.index_sum += 4 + n_cells[v];
    q.n_irregular += !on_rim[v] && n_cells[v] != 4;
  }
  q.euler_characteristic = n_used - static_cast<long>(sides.size()) + static_cast<long>(mesh.cells.size());
  return q;
}

}  // namespace framehex::verify
