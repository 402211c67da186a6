// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/mesh/adjacency.hpp"
#include "framehex/mesh/mixed_faces.hpp"

#include <span>

namespace framehex::verify {

/// Where the boundary of a mixed mesh is not that of the tetrahedra it was made of.
struct KeptBoundaryReport {
  std::vector<CellFace> strange;                ///< faces of the mesh that are not made of facets of the tetrahedra
  std::vector<std::array<index_t, 3>> missing;  ///< facets that no face covers; vertices of the tetrahedra, ascending
  explicit operator bool() const { return strange.empty() && missing.empty(); }
};

/// Checks that a mixed mesh has the boundary of a tetrahedral one: each of its boundary triangles is a facet there, each
/// quadrilateral two, cut along either diagonal, and none is left over.
///
/// @param mesh       well-formed cells.
/// @param vertex_of  vertex -> vertex of the tetrahedra, `no_index` for one that they have not.
/// @param tets       the tetrahedra.
/// @return both lists in ascending order of vertices.
/// @par Complexity   O(n log n).
inline KeptBoundaryReport keeps_boundary(const MixedMesh& mesh, std::span<const index_t> vertex_of,
                                         const TetAdjacency& tets) {
  using Triple = std::array<index_t, 3>;
  std::vector<Triple> facets;
  for (std::size_t tet = 0; tet < tets.tets.size(); ++tet)
    for (int f = 0; f < 4; ++f)
      if (tets.neighbours[tet][static_cast<std::size_t>(f)] == no_index)
        facets.push_back(framehex::detail::sorted(facet(tets.tets[tet], f)));
  std::sort(facets.begin(), facets.end());
  std::vector<std::uint8_t> covered(facets.size(), 0);
  constexpr auto none = static_cast<std::size_t>(-1);
  const auto find = [&](index_t a, index_t b, index_t c) {
    const Triple key = framehex::detail::sorted(Triple{a, b, c});
    const auto at = std::lower_bound(facets.begin(), facets.end(), key);
    return at != facets.end() && *at == key ? static_cast<std::size_t>(at - facets.begin()) : none;
  };
  KeptBoundaryReport report;
  for (const CellFace& face : faces_used_once(mesh)) {
    std::array<index_t, 4> v{};
    for (std::size_t i = 0; i < face.size(); ++i) v[i] = vertex_of[face.vertices[i]];
    std::array<std::size_t, 2> parts{find(v[0], v[1], v[2]),
                                     face.size() == 3 ? find(v[0], v[1], v[2]) : find(v[2], v[3], v[0])};
    if (face.size() == 4 && (parts[0] == none || parts[1] == none))
      parts = {find(v[1], v[2], v[3]), find(v[3], v[0], v[1])};
    if (parts[0] == none || parts[1] == none)
      report.strange.push_back(face);
    else
      for (const std::size_t part : parts) covered[part] = 1;
  }
  for (std::size_t i = 0; i < facets.size(); ++i)
    if (!covered[i]) report.missing.push_back(facets[i]);
  return report;
}

}  // namespace framehex::verify
