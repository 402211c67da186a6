// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/recombination/detail/corner_faces.hpp"
#include "framehex/recombination/detail/find_cells.hpp"

namespace framehex {

namespace detail {

/// Enumerates five vertices with the connectivity of a pyramid: base a b c d with a the smallest of the four, apex p.
class PyramidSearch {
public:
  using Vertices = std::array<index_t, 5>;

  explicit PyramidSearch(const FinderInput& input) : faces_(input) {}

  /// Calls emit(vertices) for each pyramid whose base has smallest vertex `a`, once; see HexSearch.
  template <class Emit>
  void search(index_t a, Emit&& emit) {
    faces_.collect(a);
    const auto& links = faces_.links();
    const auto ring = links.neighbours(a);
    for (index_t i = 0; i < ring.size(); ++i)
      for (const auto& face : faces_.faces(i))
        links.for_each_common_link(a, i, face.other, [&](index_t k) {
          const index_t apex = ring[k];
          index_t b = ring[i], d = ring[face.other];
          if (!faces_.is_corner(a, b, d, apex)) std::swap(b, d);
          if (!faces_.is_corner(a, b, d, apex)) return;
          for (const index_t c : faces_.opposites(face))
            if (c != apex && links.is_facet(apex, b, c) && links.is_facet(apex, c, d)) emit(Vertices{a, b, c, d, apex});
        });
  }

private:
  CornerFaces faces_;
};

}  // namespace detail

/// Every potential pyramid of a tetrahedral mesh, for those who want it vertex by vertex; see PotentialHexFinder.
template <TetMesh Mesh>
class PotentialPyramidFinder : public detail::PotentialCellFinder<5, detail::PyramidSearch> {
public:
  explicit PotentialPyramidFinder(const Mesh& mesh, const PyramidFinderOptions& options = {})
      : PotentialCellFinder(mesh, options) {}
};

/// Every potential pyramid of a tetrahedral mesh; `find_potential_hexahedra` says the rest, with triangles that are
/// facets of the mesh for the four sides. Without interior vertices it is two tetrahedra with a common facet.
///
/// @return each pyramid once, ordered by the smallest vertex of its base, which is its corner 0.
template <TetMesh Mesh, Executor E = SerialExecutor>
PotentialPyramids find_potential_pyramids(const Mesh& mesh, const PyramidFinderOptions& options = {},
                                          const E& executor = {}) {
  return PotentialPyramidFinder<Mesh>(mesh, options).find(executor);
}

}  // namespace framehex
