// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/surface/cross_field.hpp"
#include "framehex/surface/detail/cross_solver.hpp"

#include <cmath>
#include <numbers>

namespace framehex {

namespace detail {

/// Turn of the cross from the triangle of the edge's smaller half edge to that of its opposite, in [-pi/4, pi/4].
FRAMEHEX_INLINE std::vector<double> matchings(const TriangleAdjacency& adjacency, const EdgeConnection& connection,
                                              const std::vector<double>& cross) {
  std::vector<double> turn(connection.n_edges(), 0);
  for (std::size_t e = 0; e < turn.size(); ++e) {
    const index_t h = connection.half_edge_of[e], g = adjacency.opposite[h];
    if (g == no_index) continue;
    turn[e] = quarter_remainder((cross[g / 3] - connection.direction[g]) - (cross[h / 3] - connection.direction[h]));
  }
  return turn;
}

FRAMEHEX_INLINE std::vector<CrossSingularity> find_singularities(const TriangleAdjacency& adjacency,
                                                                 const EdgeConnection& connection,
                                                                 const std::vector<double>& turn) {
  std::vector<double> sum(adjacency.n_vertices(), 2 * std::numbers::pi);
  std::vector<char> rim(adjacency.n_vertices(), 0);
  for (index_t h = 0; h < adjacency.opposite.size(); ++h) {
    const index_t v = adjacency.from(h);
    sum[v] -= connection.angle[h];
    if (adjacency.opposite[h] == no_index) {
      rim[v] = rim[adjacency.to(h)] = 1;
      continue;
    }
    // Anticlockwise about v, edge h is crossed from its opposite's triangle into its own.
    const index_t e = connection.edge_of[h];
    sum[v] += connection.half_edge_of[e] == h ? -turn[e] : turn[e];
  }
  std::vector<CrossSingularity> singularities;
  for (index_t v = 0; v < sum.size(); ++v) {
    const auto index = static_cast<int>(std::lround(sum[v] / (std::numbers::pi / 2)));
    if (index != 0 && !rim[v] && !adjacency.triangles_of_vertex[v].empty()) singularities.push_back({v, index});
  }
  return singularities;
}

/// 1 minus the mean turn over the edges at each vertex, in units of the largest possible turn. Sharp edges do not
/// count: the crosses on their two sides are both aligned with them and have no reason to agree more.
FRAMEHEX_INLINE std::vector<double> cross_smoothness(const TriangleAdjacency& adjacency, const FeatureGraph& features,
                                                     const EdgeConnection& connection,
                                                     const std::vector<double>& turn) {
  std::vector<double> sum(adjacency.n_vertices(), 0), count(adjacency.n_vertices(), 0);
  for (std::size_t e = 0; e < turn.size(); ++e) {
    const index_t h = connection.half_edge_of[e];
    if (features.is_feature[h] || adjacency.opposite[h] == no_index) continue;
    for (const index_t v : {adjacency.from(h), adjacency.to(h)}) {
      sum[v] += std::abs(turn[e]);
      count[v] += 1;
    }
  }
  for (std::size_t v = 0; v < sum.size(); ++v)
    sum[v] = count[v] > 0 ? std::max(0.0, 1 - 4 / std::numbers::pi * sum[v] / count[v]) : 1.0;
  return sum;
}

FRAMEHEX_INLINE Quaternion cross_frame(const std::vector<Vector3>& points, const std::array<index_t, 3>& triangle,
                                       const Vector3& normal, double cross) {
  Vector3 z = normal.isZero() ? Vector3(Vector3::UnitZ()) : normal;
  Vector3 first = points[triangle[1]] - points[triangle[0]];
  first -= first.dot(z) * z;
  if (first.squaredNorm() == 0) first = z.unitOrthogonal();
  first.normalize();
  Eigen::Matrix3d axes;
  axes.col(0) = std::cos(cross) * first + std::sin(cross) * z.cross(first);
  axes.col(1) = z.cross(axes.col(0));
  axes.col(2) = z;
  return Quaternion(axes).normalized();
}

}  // namespace detail

FRAMEHEX_INLINE SurfaceCrossField compute_cross_field(const Surface& surface, const CrossFieldOptions& options) {
  check_options(options);
  const TriangleAdjacency& adjacency = surface.adjacency;
  const std::vector<Vector3> normals = detail::triangle_normals(surface.points, adjacency);
  const detail::EdgeConnection connection = detail::make_edge_connection(surface.points, adjacency);
  detail::CrossSolver solver(adjacency, surface.features, connection,
                             [&](double fraction) { return keep_going(options.observer, "cross field", fraction); });
  if (!solver.solve_patches_with_features() ||
      !solver.solve_closed_patches(
          detail::curvature_crosses(surface.points, adjacency, connection, normals),
          {options.curvature, options.max_iterations, options.tolerance, options.diffusion_steps}))
    return {.frames = {}, .smoothness = {}, .singularities = {}, .status = Status::cancelled};
  const std::vector<double> cross = solver.triangle_crosses();

  SurfaceCrossField field;
  field.frames.reserve(cross.size());
  for (std::size_t t = 0; t < cross.size(); ++t)
    field.frames.push_back(detail::cross_frame(surface.points, surface.triangles()[t], normals[t], cross[t]));
  const std::vector<double> turn = detail::matchings(adjacency, connection, cross);
  field.singularities = detail::find_singularities(adjacency, connection, turn);
  field.smoothness = detail::cross_smoothness(adjacency, surface.features, connection, turn);
  return field;
}

}  // namespace framehex
