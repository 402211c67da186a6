// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/assembly/detail/cavity.hpp"
#include "framehex/mesh/adjacency.hpp"
#include "framehex/recombination/candidates.hpp"

namespace framehex::detail {

/// What the chosen cells were made of, so that a choice can be taken back.
struct Originals {
  const TetAdjacency& adjacency;
  const PotentialHexahedra& hexahedra;
  const PotentialPrisms& prisms;

  std::span<const index_t> tets_of(CellKind kind, index_t source) const {
    return kind == CellKind::hexahedron ? hexahedra.tets[source] : prisms.tets[source];
  }
  std::span<const index_t> tets_of(const CellComplex::Cell& cell) const { return tets_of(cell.kind, cell.source); }

  /// The tetrahedron outside a cell whose corners are those of one of its quadrilaterals, or `no_index`.
  index_t face_sliver(std::span<const index_t> tets, const std::array<index_t, 4>& quad) const {
    const FaceKey key = face_key(quad);
    for (const index_t tet : adjacency.tets_of_vertex[key[0]])
      if (face_key(adjacency.tets[tet]) == key && !std::binary_search(tets.begin(), tets.end(), tet)) return tet;
    return no_index;
  }

  /// Which diagonal of a quadrilateral the outermost triangles of the cell use: of its vertices 0 and 2, or 1 and 3.
  int inner_diagonal(std::span<const index_t> tets, const std::array<index_t, 4>& quad) const {
    for (const index_t tet : tets)
      for (std::size_t f = 0; f < 4; ++f) {
        const index_t beyond = adjacency.neighbours[tet][f];
        if (beyond != no_index && std::binary_search(tets.begin(), tets.end(), beyond)) continue;
        const auto triangle = facet(adjacency.tets[tet], static_cast<int>(f));
        const auto has = [&](std::size_t i) {
          return std::find(triangle.begin(), triangle.end(), quad[i]) != triangle.end();
        };
        if (has(0) && has(2) && (has(1) || has(3))) return 0;
        if (has(1) && has(3) && (has(0) || has(2))) return 1;
      }
    return 0;
  }
};

/// Takes a hexahedron or prism back into its tetrahedra; its quadrilateral neighbours become open.
/// @return false, with nothing changed, when a vertex has moved so that one of the tetrahedra is no longer valid, or
///         when a face is open with another diagonal than the tetrahedra have.
inline bool dissolve(CellComplex& complex, CavityFiller& filler, const Originals& originals, index_t id) {
  const CellComplex::Cell cell = complex.cells[id];
  if (cell.source == no_index) return false;
  const auto tets = originals.tets_of(cell);
  const auto valid = [&](const std::array<index_t, 4>& t) {
    return orientation(complex.points[t[0]], complex.points[t[1]], complex.points[t[2]], complex.points[t[3]]) > 0;
  };

  struct Side {
    std::array<index_t, 4> quad;
    index_t neighbour, sliver;
    int diagonal;
  };
  std::array<Side, 6> sides;
  std::size_t n_sides = 0;
  for (std::size_t f = 0; f < complex.n_faces(id); ++f) {
    const auto quad = complex.face(id, f);
    if (quad[3] == no_index) continue;
    Side& side = sides[n_sides++];
    side = {quad, complex.across(id, quad), no_index, originals.inner_diagonal(tets, quad)};
    const index_t open = complex.open_quad_at(quad);
    // A sliver between the cell and tetrahedra or the boundary was absorbed, and has to come back.
    if (side.neighbour == no_index && (open == no_index || complex.open_quads[open].diagonal != side.diagonal))
      side.sliver = originals.face_sliver(tets, quad);
    // Without a sliver two different diagonals cannot be reconciled by the tetrahedra of the cell.
    if (side.sliver == no_index && open != no_index && complex.open_quads[open].diagonal != side.diagonal) return false;
    if (side.sliver != no_index && !valid(originals.adjacency.tets[side.sliver])) return false;
  }
  for (const index_t tet : tets)
    if (!valid(originals.adjacency.tets[tet])) return false;

  for (std::size_t i = 0; i < n_sides; ++i) {
    const index_t open = complex.open_quad_at(sides[i].quad);
    if (open != no_index) complex.close_quad(open);
  }
  complex.remove(id);
  for (const index_t tet : tets)
    complex.add(CellKind::tetrahedron, originals.adjacency.tets[tet], cell.region, no_index);
  for (std::size_t i = 0; i < n_sides; ++i) {
    const Side& side = sides[i];
    if (side.sliver != no_index)
      complex.add(CellKind::tetrahedron, originals.adjacency.tets[side.sliver], cell.region, no_index);
    if (side.neighbour == no_index) continue;
    const auto quad = complex.face_like(side.neighbour, side.quad);
    const auto end = static_cast<std::size_t>(side.diagonal);
    const bool first = quad[0] == side.quad[end] || quad[2] == side.quad[end];
    complex.add_open_quad({quad, side.neighbour, first ? 0 : 1, false, true});
    if (complex.cells[side.neighbour].kind != CellKind::pyramid) continue;
    Cavity cavity;
    cavity.cells = {side.neighbour};
    // A pyramid that cannot be cut stays open, for the closer to try otherwise.
    if (filler.build(cavity)) static_cast<void>(filler.fill(cavity, complex.cells[side.neighbour].corners[4]));
  }
  return true;
}

}  // namespace framehex::detail
