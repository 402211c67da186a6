// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/mesh/adjacency.hpp"
#include "framehex/mesh/indexed_mesh.hpp"

#include <span>

namespace framehex {

/// The boundary of a tetrahedral mesh, and what lies between its regions, as a surface of its own.
struct BoundarySurface {
  IndexedTriangleMesh surface;          ///< outward, between regions out of the lower label; vertices ascending in the
                                        ///< numbering of the tetrahedral mesh
  std::vector<index_t> vertex_of;       ///< surface vertex -> vertex of the tetrahedral mesh
  std::vector<index_t> surface_vertex;  ///< vertex of the tetrahedral mesh -> surface vertex, `no_index` inside
  std::vector<index_t> tet_of;          ///< triangle -> the tetrahedron behind it
};

/// Extracts the boundary triangles in the order of their tetrahedra.
///
/// @param regions  labels of the tetrahedra: facets between different ones are extracted too. Empty: one region.
/// @par Complexity   O(n).
template <TetMesh M>
BoundarySurface extract_boundary(const M& mesh, const TetAdjacency& adjacency, std::span<const index_t> regions = {}) {
  BoundarySurface b;
  b.surface_vertex.assign(adjacency.n_vertices(), no_index);
  for (std::size_t tet = 0; tet < adjacency.tets.size(); ++tet)
    for (int face = 0; face < 4; ++face) {
      const index_t other = adjacency.neighbours[tet][static_cast<std::size_t>(face)];
      if (other == no_index || (!regions.empty() && regions[tet] < regions[other])) {
        b.surface.triangles.push_back(facet(adjacency.tets[tet], face));
        b.tet_of.push_back(static_cast<index_t>(tet));
        for (const index_t v : b.surface.triangles.back()) b.surface_vertex[v] = 0;
      }
    }
  const std::vector<Vector3> points = positions(mesh);
  for (std::size_t v = 0; v < points.size(); ++v)
    if (b.surface_vertex[v] != no_index) {
      b.surface_vertex[v] = static_cast<index_t>(b.vertex_of.size());
      b.vertex_of.push_back(static_cast<index_t>(v));
      b.surface.points.push_back(points[v]);
    }
  for (auto& triangle : b.surface.triangles)
    for (index_t& v : triangle) v = b.surface_vertex[v];
  return b;
}

}  // namespace framehex
