// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/recombination/detail/find_cells.hpp"
#include "framehex/recombination/detail/hex_search.hpp"

namespace framehex {

#ifdef FRAMEHEX_COMPILED
extern template class detail::PotentialCellFinder<8, detail::HexSearch>;
#endif

/// Every potential hexahedron of a tetrahedral mesh, for those who want it vertex by vertex; see
/// `find_potential_hexahedra`.
///
/// Holds flat arrays of its own, and refers to the spans and the adjacency of the options, not to the mesh. Its
/// functions may be called by several threads at once.
template <TetMesh Mesh>
class PotentialHexFinder : public detail::PotentialCellFinder<8, detail::HexSearch> {
public:
  explicit PotentialHexFinder(const Mesh& mesh, const HexFinderOptions& options = {})
      : PotentialCellFinder(mesh, options) {}
};

/// Every potential hexahedron of a tetrahedral mesh.
///
/// A hexahedron is potential when the union of some tetrahedra is exactly a hexahedron with vertices of the mesh, whose
/// trilinear map is invertible and whose corners keep the quality floor, and when it keeps the rules of `options`. The
/// search goes by vertices and not by patterns, so that all of the 174 ways to cut a hexahedron are found.
///
/// @param mesh      n tetrahedra; not modified.
/// @param options   see FinderOptions.
/// @param executor  runs the blocks of first vertices.
/// @pre `validate(mesh)` passes; it is called unless `.input_check` says otherwise.
/// @return each hexahedron once, ordered by its smallest vertex, which is its corner 0; `status` is `cancelled` when
///         the observer stopped the search, and what was found up to some vertex is returned.
/// @throws invalid_option, and what `validate` throws.
/// @par Complexity   O(n) for bounded valence. Beside the result about 60 bytes a tetrahedron, the adjacency included.
/// @par Determinism  The result does not depend on the executor.
/// @par Source       Pellerin, Johnen, Verhetsel, Remacle, Identifying combinations of tetrahedra into hexahedra, 2017
///                   (arXiv:1705.02451). Departs: links of vertices as bit sets in place of look-ups of facets, and
///                   exact validity.
template <TetMesh Mesh, Executor E = SerialExecutor>
PotentialHexahedra find_potential_hexahedra(const Mesh& mesh, const HexFinderOptions& options = {},
                                            const E& executor = {}) {
  return PotentialHexFinder<Mesh>(mesh, options).find(executor);
}

}  // namespace framehex
