// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/mesh/adjacency.hpp"
#include "framehex/mesh/indexed_mesh.hpp"

namespace framehex::test {

template <TriangleMesh M>
long euler_characteristic(const M& surface) {
  const TriangleAdjacency a = make_adjacency(surface);
  long vertices = 0, edges = 0;
  for (std::size_t v = 0; v < a.n_vertices(); ++v) vertices += !a.triangles_of_vertex[v].empty();
  for (index_t h = 0; h < a.opposite.size(); ++h) edges += a.opposite[h] == no_index || h < a.opposite[h];
  return vertices - edges + static_cast<long>(a.triangles.size());
}

/// Volume by the divergence theorem.
template <TriangleMesh M>
double enclosed_volume(const M& mesh) {
  const auto& surface = detail::flat(mesh);
  double volume = 0;
  for (const auto& t : surface.triangles)
    volume += surface.points[t[0]].dot(surface.points[t[1]].cross(surface.points[t[2]])) / 6;
  return volume;
}

template <TriangleMesh M>
double area(const M& mesh, std::size_t triangle) {
  const auto& surface = detail::flat(mesh);
  const auto& t = surface.triangles[triangle];
  return (surface.points[t[1]] - surface.points[t[0]]).cross(surface.points[t[2]] - surface.points[t[0]]).norm() / 2;
}

}  // namespace framehex::test
