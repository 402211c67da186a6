// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/geometry/bounding_box.hpp"
#include "framehex/geometry/triangle_distance.hpp"
#include "framehex/mesh/validation.hpp"
#include "framehex/pipeline/detail/mesh_quads.hpp"
#include "framehex/surface/detail/least_distance.hpp"

#include <sstream>

namespace framehex {

namespace detail {

/// @throws nonmanifold  where two triangles, and no others, run along an edge the same way: a Moebius strip, or one of
///         them is turned.
inline void check_orientation(const Surface& surface) {
  const TriangleAdjacency& a = surface.adjacency;
  for (index_t h = 0; h < a.opposite.size(); ++h) {
    if (a.opposite[h] != no_index) continue;
    std::size_t n_same = 0, n_other = 0;
    index_t other = no_index;
    for (const index_t t : a.triangles_of_vertex[a.from(h)])
      for (index_t g = 3 * t; g < 3 * t + 3; ++g) {
        n_other += a.from(g) == a.to(h) && a.to(g) == a.from(h);
        if (g == h || a.from(g) != a.from(h) || a.to(g) != a.to(h)) continue;
        ++n_same;
        other = t;
      }
    if (n_same == 1 && n_other == 0)
      throw nonmanifold("triangles " + std::to_string(h / 3) + " and " + std::to_string(other) +
                            " run along their edge the same way: one is turned, or the surface has one side only",
                        Entity::triangle, {h / 3, other});
  }
}

/// @throws invalid_connectivity  where two triangles have the same three vertices, in any order.
inline void check_no_twins(std::span<const std::array<index_t, 3>> triangles) {
  std::vector<std::pair<std::array<index_t, 3>, index_t>> sorted_triangles;
  sorted_triangles.reserve(triangles.size());
  for (index_t t = 0; t < triangles.size(); ++t) sorted_triangles.emplace_back(sorted(triangles[t]), t);
  std::sort(sorted_triangles.begin(), sorted_triangles.end());
  for (std::size_t i = 1; i < sorted_triangles.size(); ++i) {
    const auto [a, b] = std::pair{sorted_triangles[i - 1], sorted_triangles[i]};
    if (a.first == b.first)
      throw invalid_connectivity(
          "triangles " + std::to_string(a.second) + " and " + std::to_string(b.second) + " have the same vertices",
          Entity::triangle, {a.second, b.second});
  }
}

/// Refuses what an outline may not have either: vertices of a curve that are next to the same point, and a surface that is
/// next to nothing between a rim and a vertex. Flat triangles elsewhere do no harm.
inline void check_separation(const Surface& surface) {
  const TriangleAdjacency& a = surface.adjacency;
  const double least = least_curve_distance * bounding_box(surface.points).diagonal().norm();
  const auto text = [](const std::string& what, double distance) {
    std::ostringstream out;
    out << what << distance << " apart, less than " << least_curve_distance << " of the surface's diagonal";
    return out.str();
  };
  for (index_t h = 0; h < a.opposite.size(); ++h) {
    if (!surface.features.is_feature[h]) continue;
    const index_t v = a.from(h), w = a.to(h);
    if (const double length = (surface.points[w] - surface.points[v]).norm(); length < least)
      throw invalid_surface(
          text("vertices " + std::to_string(v) + " and " + std::to_string(w) + " of a curve are ", length),
          Entity::vertex, {v, w});
  }
  for (index_t h = 0; h < a.opposite.size(); ++h) {
    if (a.opposite[h] != no_index) continue;
    const index_t v = a.from(h), w = a.to(h);
    const Vector3 &p = surface.points[v], &q = surface.points[w],
                  &apex = surface.points[a.to(TriangleAdjacency::next(h))];
    const double height = (p + nearest_on_segment(apex, p, q) * (q - p) - apex).norm();
    if (height < least)
      throw invalid_surface(text("triangle " + std::to_string(h / 3) + " on a rim is flat: its corner and its side (" +
                                     std::to_string(v) + ", " + std::to_string(w) + ") are ",
                                 height),
                            Entity::triangle, {h / 3});
  }
}

}  // namespace detail

/// From a triangulated surface, open or closed, to quadrilaterals that follow it and its features.
///
/// Where cells of the size would be too far from the surface (`RetriangulationOptions::max_deviation`; infinite: nowhere)
/// they are smaller, and the result tells how far it is. Sheets may meet in edges of three or more triangles. Patches between features get an even number of intervals each,
/// as regions do in `mesh_planar`.
///
/// @param surface  any TriangleMesh. Coordinates in the host's unit.
/// @param size     wished edge length at a point: a callable `double(const Vector3&)` > 0, host's unit.
/// @param matcher  see `mesh_planar`.
/// @return cells that turn one way at all corners, seen against the surface's normal; vertices on its triangles, those
///         of feature curves on their edges.
/// @throws invalid_coordinate, invalid_connectivity (two triangles of the same vertices too), open_surface (no triangles),
///         nonmanifold  with two triangles that run along their edge the same way; invalid_surface  with two vertices of a
///         curve or a triangle on a rim that are nearer to each other, or flatter, than 1e-8 of the diagonal, or with three
///         vertices near which no cell fits; invalid_option, invalid_field.
/// @par Complexity   about O(n log n) in the number of points, beside the matcher's.
/// @par Determinism  The same everywhere up to rounding.
/// @par Source       as `mesh_planar`.
template <TriangleMesh M, Matcher Match, SizeField Size>
QuadMeshing mesh_shell(const M& surface, const Size& size, const Match& matcher,
                       const QuadMeshingOptions& options = {}) {
  check_options(options);
  validate_surface(surface);
  Surface input(surface, options.features);
  detail::check_no_twins(input.triangles());
  detail::check_orientation(input);
  detail::check_separation(input);
  return detail::mesh_quads(input, size, matcher, options);
}

}  // namespace framehex
