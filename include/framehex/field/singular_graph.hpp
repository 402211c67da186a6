// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/field/frame_measures.hpp"

#include <array>
#include <vector>

namespace framehex {

/// A facet round which the frame comes back as another of its 24 forms: a singular line passes through it.
struct SingularFacet {
  std::array<index_t, 3> vertices;  ///< anticlockwise seen from the side of tets[1] (from outside on the boundary)
  std::array<index_t, 2> tets;      ///< on either side; the second `no_index` on the boundary
  int symmetry;                     ///< element of CubeRotationGroup, at the frame of vertices[0]
  double index;                     ///< signed turns of the frame along the facet's edges: 1/4, -1/4, 1/2, 1/3 ...
};

/// The singular lines of a field.
struct SingularGraph {
  std::vector<SingularFacet> facets;  ///< in the order of their first tetrahedron
  Csr<index_t> curves;                ///< facets along each line; a closed line repeats its first
  std::vector<double> curve_index;    ///< 1/4 (three hexahedra would meet) or -1/4 (five); 0 where it is not the same
                                      ///< kind of turn all along
  Csr<Vector3> polylines;             ///< the lines as points, in the order of `curves`
  std::vector<index_t> boundary_facets;  ///< those on the boundary: the singular points of the surface
};

namespace detail {

inline int edge_symmetry(std::span<const Quaternion> frames, index_t v, index_t w) {
  // Always asked from the smaller vertex, so that both directions agree also where two symmetries are equally near.
  if (v > w) return CubeRotationGroup<>::inverse(edge_symmetry(frames, w, v));
  return CubeRotationGroup<>::nearest(frames[v].conjugate() * frames[w]);
}

/// What the frame has become after a round, as an element at the frame of the first vertex.
inline int monodromy(std::span<const Quaternion> frames, const std::array<index_t, 3>& t) {
  using Group = CubeRotationGroup<>;
  return Group::compose(Group::compose(edge_symmetry(frames, t[0], t[1]), edge_symmetry(frames, t[1], t[2])),
                        edge_symmetry(frames, t[2], t[0]));
}

}  // namespace detail

/// Finds the singular lines of a field.
///
/// Frames live on the vertices, so the smallest loops are the facets' edges: a facet is singular when the three closest
/// matchings round it do not compose to the identity. Singular facets follow one another through tetrahedra; a
/// tetrahedron has none, two (a line passes), or three or four (lines meet). Lines end on the boundary or where they
/// meet.
///
/// @param frames  n_vertices unit quaternions.
/// @par Complexity   O(tetrahedra).
/// @par Source       Dual to the usual definition by matchings of cells round an edge; it needs no frame per cell.
SingularGraph singular_graph(const TetAdjacency& adjacency, std::span<const Vector3> points,
                             std::span<const Quaternion> frames);

}  // namespace framehex

#ifndef FRAMEHEX_COMPILED
#include "framehex/field/detail/singular_graph_impl.hpp"
#endif
