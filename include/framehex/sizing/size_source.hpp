// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/field/vertex_size_field.hpp"
#include "framehex/mesh/validation.hpp"
#include "framehex/surface/surface.hpp"

#include <array>
#include <span>
#include <vector>

namespace framehex {

/// A triangle on which a length is wanted: that of each corner, linear in between. A `GradedSize` grows from it.
struct SizeSource {
  std::array<Vector3, 3> corners;  ///< in the host's unit
  std::array<double, 3> lengths;   ///< the same unit, > 0; infinite on all three: nothing is wanted
};

/// A length on some triangles of a surface.
///
/// @param lengths  n_triangles, in the host's unit, > 0; an infinite one is no wish.
/// @return a source for each triangle with a finite length, in their order.
/// @throws invalid_option  when there is not one length a triangle; invalid_field  with the triangle of one that is NaN, 0 or
///         less.
/// @par Complexity   O(n).
template <TriangleMesh M>
std::vector<SizeSource> triangle_sources(const M& mesh, std::span<const double> lengths) {
  const auto& surface = detail::flat(mesh);
  if (lengths.size() != surface.triangles.size()) throw invalid_option("there must be one length per triangle");
  std::vector<SizeSource> sources;
  for (index_t t = 0; t < lengths.size(); ++t) {
    if (!(lengths[t] > 0))
      throw invalid_field("the size of triangle " + std::to_string(t) + " is not positive", Entity::triangle, {t});
    if (std::isinf(lengths[t])) continue;
    const auto& v = surface.triangles[t];
    sources.push_back(
        {{surface.points[v[0]], surface.points[v[1]], surface.points[v[2]]}, {lengths[t], lengths[t], lengths[t]}});
  }
  return sources;
}

/// Lengths at the vertices of a surface, limited to what their neighbours allow (`limit_gradation`).
///
/// @param lengths  n_vertices, in the host's unit, > 0 and finite. @param growth  dimensionless, >= 0.
/// @return a source for each triangle, in their order.
/// @throws invalid_option  when there is not one length a vertex, and for the growth; invalid_field  with the vertex.
/// @par Complexity   O(n log n).
template <TriangleMesh M>
std::vector<SizeSource> vertex_sources(const M& mesh, std::vector<double> lengths, double growth) {
  const auto& surface = detail::flat(mesh);
  if (lengths.size() != surface.points.size()) throw invalid_option("there must be one length per vertex");
  const Csr<index_t> triangles_of_vertex = detail::incident_cells(lengths.size(), surface.triangles);
  const Csr<index_t> neighbours = detail::vertex_neighbours(surface.triangles, triangles_of_vertex);
  limit_gradation(neighbours, surface.points, lengths, growth);
  std::vector<SizeSource> sources;
  for (const auto& v : surface.triangles)
    sources.push_back({{surface.points[v[0]], surface.points[v[1]], surface.points[v[2]]},
                       {lengths[v[0]], lengths[v[1]], lengths[v[2]]}});
  return sources;
}

}  // namespace framehex
