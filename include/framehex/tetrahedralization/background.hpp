// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/errors.hpp"
#include "framehex/executor.hpp"
#include "framehex/geometry/bounding_box.hpp"
#include "framehex/surface/surface_locator.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>
#include <vector>

namespace framehex {

/// Refuses an edge of the background mesh that would ask for more than `max_points`, before anything is made of it.
///
/// @param mesh  n triangles, to be split to that edge; finite coordinates.
/// @throws invalid_option  when `edge` is not positive and finite, or for too many points in the box of the surface or
///                         triangles on it, with the number.
/// @par Complexity   O(n).
template <TriangleMesh M>
void check_background_edge(const M& mesh, double edge, double max_points) {
  const auto& surface = detail::flat(mesh);
  if (!(edge > 0) || !std::isfinite(edge)) throw invalid_option("the background edge must be positive and finite");
  double area = 0;
  for (const auto& t : surface.triangles)
    area +=
        0.5 * (surface.points[t[1]] - surface.points[t[0]]).cross(surface.points[t[2]] - surface.points[t[0]]).norm();
  const Vector3 cubes = bounding_box(surface.points).sizes() / edge + Vector3::Ones();
  // Two points a cube; equilateral triangles of that edge cover its square 2.3 times.
  const double n = std::max(2 * cubes.prod(), 2.3 * area / (edge * edge));
  if (n <= max_points) return;
  std::ostringstream message;
  message << "a background edge of " << edge << " asks for about " << n << " points, more than " << max_points
          << "; use a larger size, give background_edge, or raise max_background_points if this is meant";
  throw invalid_option(message.str());
}

/// Interior points of a background mesh: a body-centred cubic lattice cut by the surface.
///
/// The frame field is computed on the tetrahedra of these points and of the surface's own; their size decides how
/// sharply it is resolved, not where the points of the result are. Body-centred lattices give well-shaped tetrahedra.
///
/// @param mesh     closed, outward, n triangles.
/// @param locator  of that surface, however its triangles are split.
/// @param edge     side of the cubes, in the surface's unit, > 0.
/// @return points inside, ascending by layer, none nearer than edge / 2 to the surface.
/// @throws invalid_option  as `check_background_edge`.
/// @par Complexity   O(m log n) time for m lattice points in the bounding box, O(m) memory.
template <TriangleMesh M, Executor E = SerialExecutor>
std::vector<Vector3> background_points(const M& mesh, const SurfaceLocator& locator, double edge,
                                       const E& executor = {}, double max_points = 2e7) {
  check_background_edge(mesh, edge, max_points);
  const auto& surface = detail::flat(mesh);
  const Eigen::AlignedBox3d box = bounding_box(surface.points);
  const Vector3& low = box.min();
  const Vector3 extent = box.sizes() / edge;

  // Layers at half-cube heights; every second one is shifted by half a cube.
  const auto n_layers = static_cast<std::size_t>(2 * extent.z()) + 1;
  std::vector<std::vector<Vector3>> layers(n_layers);
  executor(n_layers, [&](std::size_t layer, std::size_t) {
    const double shift = layer % 2 == 0 ? 0.25 : 0.75;
    for (double y = shift; y < extent.y(); ++y)
      for (double x = shift; x < extent.x(); ++x) {
        const Vector3 p = low + edge * Vector3(x, y, 0.25 + 0.5 * static_cast<double>(layer));
        if (locator.inside(p) && !locator.nearest_within(p, 0.5 * edge)) layers[layer].push_back(p);
      }
  });
  std::vector<Vector3> points;
  for (const auto& layer : layers) points.insert(points.end(), layer.begin(), layer.end());
  return points;
}

}  // namespace framehex
