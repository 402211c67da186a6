// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/surface/feature_detection.hpp"

#include <utility>

namespace framehex {

/// A triangulated surface as all stages read it: its points, who touches whom, and its features. Made once from a
/// host's mesh, it takes the place of three arguments that belong together.
///
/// Vertices and triangles are dense indices in the host's order. It is a TriangleMesh itself. Every stage that takes
/// one takes a host's mesh as well, and finds its features by the default options then.
struct Surface {
  std::vector<Vector3> points;
  TriangleAdjacency adjacency;
  FeatureGraph features;  ///< of these triangles; empty arrays: none

  Surface() = default;

  /// @param triangle_adjacency  of the triangles.
  Surface(std::vector<Vector3> vertices, TriangleAdjacency triangle_adjacency, FeatureGraph feature_graph)
      : points(std::move(vertices)), adjacency(std::move(triangle_adjacency)), features(std::move(feature_graph)) {}

  /// Reads a host's mesh and finds its features; see `detect_features`.
  ///
  /// @param mesh  indices in range. Sheets may meet in edges of three or more triangles, which are features then.
  /// @throws invalid_option  as `detect_features`.
  /// @par Complexity   O(n).
  template <class M>
  requires(!std::same_as<M, Surface> && TriangleMesh<M>) Surface(const M& mesh, const FeatureOptions& options = {})
      : points(positions(mesh)),
        adjacency(make_adjacency(mesh, Junctions::open)),
        features(detail::find_features(points, adjacency, options)) {}

  const std::vector<std::array<index_t, 3>>& triangles() const { return adjacency.triangles; }
  TriangleView view() const { return {points, adjacency.triangles}; }
};

template <>
struct mesh_traits<Surface> : detail::indexed_traits<Surface> {
  static auto cells(const Surface& surface) {
    return std::views::iota(index_t{0}, static_cast<index_t>(surface.triangles().size()));
  }
  static std::array<index_t, 3> cell_vertices(const Surface& surface, index_t cell) {
    return surface.triangles()[cell];
  }
};

static_assert(TriangleMesh<Surface>);

/// Finds the sharp edges of a surface, and from them its corners, curves and patches.
///
/// An edge is a feature when it is given, lies on a rim, between patches of different labels or where several sheets
/// meet, or is bent by more than `options.angle` from flat. A corner is a vertex where other than two feature edges meet,
/// a curve turns by more than `options.corner_angle`, or sheets touch in nothing else.
///
/// Scans have bends that nobody designed. Unless given, a curve with a loose end and fewer than `options.stray_edges`
/// edges is dropped, again and again; so is a connected set of sharp edges that loses more than a tenth of itself by
/// that, or has fewer than four edges left. Sharp edges of CAD surfaces end in corners or close up, and are untouched.
///
/// @param mesh  indices in range.
/// @return curves between corners in the order of their first corner, then closed curves without a corner, which start
///         at their smallest vertex; a closed curve repeats its first vertex.
/// @throws invalid_option  for an angle outside its range, labels that are not one a triangle, and a given edge that is not
///         one (its two vertices).
/// @par Complexity   O(n).
template <TriangleMesh M>
FeatureGraph detect_features(const M& mesh, const FeatureOptions& options = {}) {
  return detail::find_features(positions(mesh), make_adjacency(mesh, Junctions::open), options);
}

}  // namespace framehex
