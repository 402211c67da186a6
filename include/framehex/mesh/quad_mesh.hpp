// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/mesh/mixed_mesh.hpp"

#include <utility>

namespace framehex {

/// Quadrilaterals, and triangles where some are left, over one set of points: a surface in space or in the plane z = 0.
struct QuadMesh {
  using Cell = std::array<index_t, 4>;

  std::vector<Vector3> points;
  std::vector<Cell> cells;          ///< anticlockwise seen from outside; a triangle's fourth corner is `no_index`
  std::vector<index_t> patches;     ///< n_cells labels
  std::vector<LabelledEdge> edges;  ///< of the feature curves and rims, with the curve's number
  std::vector<index_t> corners;     ///< vertices in which curves end or turn, ascending

  static std::size_t n_corners(const Cell& cell) { return cell[3] == no_index ? 3 : 4; }
  std::size_t n_triangles() const {
    std::size_t n = 0;
    for (const Cell& cell : cells) n += cell[3] == no_index;
    return n;
  }
};

/// The cells as labelled faces of a mesh without a volume: what the writers take.
inline MixedMesh mixed_mesh(const QuadMesh& quads) {
  MixedMesh mesh;
  mesh.points = quads.points;
  mesh.edges = quads.edges;
  for (std::size_t c = 0; c < quads.cells.size(); ++c) mesh.faces.push_back({quads.cells[c], quads.patches[c]});
  return mesh;
}

}  // namespace framehex
