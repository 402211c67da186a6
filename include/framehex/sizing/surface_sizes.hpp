// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/geometry/bounding_box.hpp"
#include "framehex/sizing/size_source.hpp"
#include "framehex/surface/detail/triangle_normals.hpp"
#include "framehex/surface/regions.hpp"
#include "framehex/surface/surface_locator.hpp"

#include <numbers>

namespace framehex {

namespace detail {

/// Unit normals at the corners of triangles, from the triangles of the same patch round the vertex by their angles.
inline std::vector<Vector3> corner_normals(const Surface& surface) {
  const TriangleAdjacency& adjacency = surface.adjacency;
  const std::vector<Vector3> flat = triangle_normals(surface.points, adjacency);
  const std::vector<index_t>& patch = surface.features.triangle_patch;
  std::vector<Vector3> normals(3 * flat.size());
  for (index_t h = 0; h < normals.size(); ++h) {
    Vector3 sum = Vector3::Zero();
    const index_t v = adjacency.from(h);
    for (const index_t t : adjacency.triangles_of_vertex[v]) {
      if (patch[t] != patch[h / 3]) continue;
      index_t g = 3 * t;
      while (adjacency.from(g) != v) ++g;
      const Vector3 a = surface.points[adjacency.to(g)] - surface.points[v],
                    b = surface.points[adjacency.apex(g)] - surface.points[v];
      sum += std::atan2(a.cross(b).norm(), a.dot(b)) * flat[t];
    }
    normals[h] = sum.norm() > 1e-12 ? Vector3(sum.normalized()) : flat[h / 3];
  }
  return normals;
}

/// The greater of a triangle's principal curvatures, by amount: the second fundamental form that fits best to how the
/// normal turns along its edges.
inline double triangle_curvature(const std::array<Vector3, 3>& p, const std::array<Vector3, 3>& n) {
  Vector3 normal = (p[1] - p[0]).cross(p[2] - p[0]);
  if (!(normal.norm() > 1e-9 * (p[1] - p[0]).squaredNorm())) return 0;
  normal.normalize();
  const Vector3 u = (p[1] - p[0]).normalized(), v = normal.cross(u);
  Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
  Vector3 load = Vector3::Zero();
  for (std::size_t i = 0; i < 3; ++i) {
    const Vector3 edge = p[(i + 1) % 3] - p[i], turn = n[(i + 1) % 3] - n[i];
    const double x = edge.dot(u), y = edge.dot(v);
    for (const auto& [row, value] : {std::pair(Vector3(x, y, 0), turn.dot(u)), {Vector3(0, x, y), turn.dot(v)}}) {
      squares += row * row.transpose();
      load += value * row;
    }
  }
  const Vector3 form = squares.inverse() * load;  // u u, u v, v v
  const double mean = (form[0] + form[2]) / 2;
  return std::abs(mean) + std::hypot((form[0] - form[2]) / 2, form[1]);
}

/// How far the next wall is, straight across the material from the middle of a triangle; infinite where there is none
/// within reach that faces it within 30 degrees.
inline double thickness_at(const SurfaceLocator& locator, const std::vector<Vector3>& normals,
                           const std::array<Vector3, 3>& corners, index_t triangle, const Vector3& into, double reach) {
  constexpr double least_facing = 0.866;
  const Vector3 middle = (corners[0] + corners[1] + corners[2]) / 3;
  const auto hit = locator.first_hit(middle, into, reach, triangle);
  if (!hit || std::abs(normals[hit->triangle].dot(into)) < least_facing) return unbounded;
  return hit->distance;
}

}  // namespace detail

/// Greatest curvature of each triangle of a surface, 1 / the host's unit, >= 0.
///
/// Patches end at features, so that a sharp edge is no curvature.
///
/// @par Complexity   O(n) for bounded valence.
/// @par Source       S. Rusinkiewicz, Estimating curvatures and their derivatives on triangle meshes, 3DPVT 2004, section 3.
///                   Departs: by triangle only, normals of one patch each.
inline std::vector<double> surface_curvature(const Surface& surface) {
  const std::vector<Vector3> normals = detail::corner_normals(surface);
  std::vector<double> curvature;
  for (std::size_t t = 0; t < surface.triangles().size(); ++t) {
    const auto& v = surface.triangles()[t];
    curvature.push_back(detail::triangle_curvature({surface.points[v[0]], surface.points[v[1]], surface.points[v[2]]},
                                                   {normals[3 * t], normals[3 * t + 1], normals[3 * t + 2]}));
  }
  return curvature;
}

/// Lengths of which so many go round a circle as curved as the surface.
///
/// @param segments  >= 3.
/// @return n_triangles lengths in the host's unit, infinite where the surface is plane.
/// @throws invalid_option  for fewer segments.
/// @par Complexity   as `surface_curvature`.
inline std::vector<double> curvature_sizes(const Surface& surface, double segments) {
  if (!(segments >= 3) || std::isinf(segments)) throw invalid_option("a circle has three segments at least");
  std::vector<double> lengths = surface_curvature(surface);
  // Bends by less than rounding errors of the normals are none.
  const double flat = 1e-6 / bounding_box(surface.points).diagonal().norm();
  for (double& x : lengths) x = x > flat ? 2 * std::numbers::pi / (segments * x) : unbounded;
  return lengths;
}

/// Thickness of the walls under each triangle: how far it is from its middle straight through the material to the surface
/// again, where that faces back within 30 degrees.
///
/// @param regions  on which sides of each patch there is material; from interfaces both are looked at.
/// @param reach    > 0, host's unit: thicker walls are not looked for. Triangles should be no longer (`refine`).
/// @return n_triangles lengths, infinite where there is no wall of less than `reach`.
/// @par Complexity   O(n log n).
inline std::vector<double> wall_thickness(const Surface& surface, const SurfaceRegions& regions, double reach) {
  const SurfaceLocator locator(surface);
  const std::vector<Vector3> normals = detail::triangle_normals(surface.points, surface.adjacency);
  std::vector<double> thickness(surface.triangles().size(), unbounded);
  for (index_t t = 0; t < thickness.size(); ++t) {
    const auto& v = surface.triangles()[t];
    const std::array<Vector3, 3> corners{surface.points[v[0]], surface.points[v[1]], surface.points[v[2]]};
    const auto& sides = regions.sides[surface.features.triangle_patch[t]];
    for (std::size_t side = 0; side < 2; ++side) {
      if (sides[side] == no_index) continue;
      const Vector3 into = side == 0 ? Vector3(-normals[t]) : normals[t];
      thickness[t] = std::min(thickness[t], detail::thickness_at(locator, normals, corners, t, into, reach));
    }
  }
  return thickness;
}

/// Sizes of which so many go across the walls under the triangles of a surface.
///
/// Sources lie on the surface and, half a length from one to the next, in the wall as deep as its middle, so that sizes do
/// not grow within it by more than a quarter of `GradedSizeOptions::growth`.
///
/// @param surface, regions, thickness  as `wall_thickness` takes and gives them.
/// @param cells   so many go across, >= 1. @param least  no length is smaller, host's unit; 0: any.
/// @throws invalid_option  for fewer cells, or when there is not one thickness a triangle.
/// @par Complexity   O(n cells).
inline std::vector<SizeSource> wall_sources(const Surface& surface, const SurfaceRegions& regions,
                                            std::span<const double> thickness, double cells, double least = 0) {
  if (!(cells >= 1) || std::isinf(cells)) throw invalid_option("one cell at least goes across a wall");
  if (thickness.size() != surface.triangles().size()) throw invalid_option("there must be one thickness per triangle");
  const std::vector<Vector3> normals = detail::triangle_normals(surface.points, surface.adjacency);
  std::vector<SizeSource> sources;
  for (index_t t = 0; t < thickness.size(); ++t) {
    if (std::isinf(thickness[t])) continue;
    const double length = std::max(thickness[t] / cells, least);
    const auto& v = surface.triangles()[t];
    const auto& sides = regions.sides[surface.features.triangle_patch[t]];
    const auto n_sheets = static_cast<int>(thickness[t] / length);
    for (int sheet = 0; sheet <= n_sheets; ++sheet)
      for (std::size_t side = 0; side < 2; ++side) {
        if (sides[side] == no_index) continue;
        const Vector3 off = (side == 0 ? -0.5 : 0.5) * sheet * length * normals[t];
        sources.push_back({{surface.points[v[0]] + off, surface.points[v[1]] + off, surface.points[v[2]] + off},
                           {length, length, length}});
      }
  }
  return sources;
}

}  // namespace framehex
