// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/assembly/options.hpp"
#include "framehex/mesh/adjacency.hpp"
#include "framehex/mesh/mixed_mesh.hpp"
#include "framehex/recombination/candidates.hpp"

namespace framehex {

/// A mixed mesh and where its parts come from.
///
/// The tetrahedral mesh is the input. With `VertexNumbers::kept`, the default, its vertices keep their numbers.
struct Assembly {
  MixedMesh mesh;
  std::vector<index_t> vertex_of;  ///< vertex -> vertex of the input, `no_index` for a new or removed one
  std::vector<index_t> result_of;  ///< the inverse: vertex of the input -> vertex, `no_index` for one that is left out
  std::vector<index_t> moved;      ///< vertices of the input that improvement moved, ascending
  std::vector<index_t> candidate_of;  ///< cell -> hexahedral candidate, `no_index` for cells of other kinds
  Csr<index_t> cell_of;             ///< cell -> the cells of the input that fill it, ascending; none if it is made anew
  std::vector<OpenInterface> open;  ///< quadrilaterals that face two triangles; empty unless in mode `open`
  AssemblyStatistics statistics;
  Status status = Status::complete;  ///< cancelled: there is no mesh
};

namespace detail {

/// Of any host's mesh, by its points.
Assembly assemble(const std::vector<Vector3>& points, const TetAdjacency& adjacency,
                  const PotentialHexahedra& candidates, std::span<const index_t> selected,
                  const AssemblyOptions& options);

}  // namespace detail

/// Replaces the tetrahedra of the selected hexahedra by them, and closes the interfaces to the others.
///
/// First the hexahedra take the place of their tetrahedra; face slivers vanish into the quadrilaterals they lie in.
/// Then the mode decides on the quadrilaterals that face two triangles.
///
/// @param mesh        tetrahedra; coordinates are read, nothing is modified.
/// @param adjacency   of `mesh`.
/// @param candidates  potential hexahedra of `mesh`.
/// @param selected    the chosen candidates, in any order.
/// @param options     mode, quality bounds (scaled Jacobians), labels.
/// @pre `validate(mesh)` passes.
/// @return cells that fill the same domain, all valid by the exact test; in the two conforming modes no quadrilateral
///         faces a triangle: chosen cells at which closing fails are left out, and closing begins anew. New vertices are
///         inside only; vertices of the boundary stay, unless improvement may move them. When the observer stops it:
///         nothing, and `status` says so.
/// @throws incompatible_selection  with one candidate that does not fit the mesh, or two that do not fit together.
/// @throws invalid_option          a number outside its range; labels of regions of another count; the position of a
///                                 labelled face or edge that is none of the mesh, as `facet_labels` says.
/// @par Complexity   O(n) but for the search of places for new vertices, which is bounded per open quadrilateral; that
///                   again for each time that closing begins anew, which is rare but on meshes of very poor tetrahedra.
/// @par Determinism  Depends on nothing but the arguments.
/// @par Source       Owen, Canann, Saigal, Pyramid elements for maintaining tetrahedra to hexahedra conformability,
///                   1997. Departs: the cavity round the diagonal is filled from any of its vertices or from a new one,
///                   grows where that helps, and a hexahedron that cannot be closed well is split from its centre.
template <TetMesh M>
Assembly assemble(const M& mesh, const TetAdjacency& adjacency, const PotentialHexahedra& candidates,
                  std::span<const index_t> selected, const AssemblyOptions& options = {}) {
  return detail::assemble(positions(mesh), adjacency, candidates, selected, options);
}

}  // namespace framehex

#ifndef FRAMEHEX_COMPILED
#include "framehex/assembly/detail/assemble_impl.hpp"
#endif
