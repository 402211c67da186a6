// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/observer.hpp"
#include "framehex/option_ranges.hpp"
#include "framehex/surface/detail/cross_solver.hpp"
#include "framehex/surface/surface.hpp"

namespace framehex {

/// A vertex about which the crosses turn.
struct CrossSingularity {
  index_t vertex;
  int index;  ///< in quarter turns
};

/// A cross in each triangle of a surface.
struct SurfaceCrossField {
  std::vector<Quaternion> frames;               ///< n_triangles; z is the outward normal, x and y the cross
  std::vector<double> smoothness;               ///< n_vertices, 0 to 1
  std::vector<CrossSingularity> singularities;  ///< ascending vertices; on a closed surface the indices sum to 4 times
                                                ///< its Euler characteristic
  Status status = Status::complete;             ///< cancelled: all else is empty
};

/// How crosses are chosen where no feature prescribes them.
struct CrossFieldOptions {
  double curvature = 0;     ///< >= 0; on closed patches, pull of the principal directions (0: the smoothest field)
  int max_iterations = 30;  ///< >= 0; of the eigenvalue solver on closed patches
  double tolerance = 1e-3;  ///< > 0 to 1; relative change of the eigenvalue at which it stops
  int diffusion_steps = 3;  ///< >= 0; on closed patches, rounds of spreading and bringing back to unit size
  Observer observer = {};   ///< silent while a matrix is factorised

  template <class Options, class Visit>
  static void each_number(Options& o, Visit&& visit) {
    visit("CrossFieldOptions::curvature", o.curvature, 0, largest_finite);
    visit("CrossFieldOptions::max_iterations", o.max_iterations, 0, 1e9);
    visit("CrossFieldOptions::tolerance", o.tolerance, least_positive, 1);
    visit("CrossFieldOptions::diffusion_steps", o.diffusion_steps, 0, 1e9);
  }
};

namespace detail {

/// Turn of the cross from the triangle of the edge's smaller half edge to that of its opposite, in [-pi/4, pi/4].
inline std::vector<double> matchings(const TriangleAdjacency& adjacency, const EdgeConnection& connection,
                                     const std::vector<double>& cross) {
  std::vector<double> turn(connection.n_edges(), 0);
  for (std::size_t e = 0; e < turn.size(); ++e) {
    const index_t h = connection.half_edge_of[e], g = adjacency.opposite[h];
    if (g == no_index) continue;
    turn[e] = quarter_remainder((cross[g / 3] - connection.direction[g]) - (cross[h / 3] - connection.direction[h]));
  }
  return turn;
}

inline std::vector<CrossSingularity> find_singularities(const TriangleAdjacency& adjacency,
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
inline std::vector<double> cross_smoothness(const TriangleAdjacency& adjacency, const FeatureGraph& features,
                                            const EdgeConnection& connection, const std::vector<double>& turn) {
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

inline Quaternion cross_frame(const std::vector<Vector3>& points, const std::array<index_t, 3>& triangle,
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

/// Smoothest crosses on a surface that follow its features.
///
/// Unknown is one complex number a mid-edge, the fourth power of the cross relative to the edge (a Crouzeix-Raviart
/// element on the flat triangles, which are hinged at the edges). On feature edges it is 1: the cross follows the edge,
/// exactly, from both sides, and corners need no decision. Patches with features solve Laplace's equation; closed
/// patches without any take the eigenvector of the least eigenvalue, or with `options.curvature` > 0 one that is pulled
/// to the principal directions of curvature. Patches do not see each other.
///
/// @param surface  may have rims, which are features then. Needles are harmless, but crosses are per triangle: refine()
///                 large triangles first.
/// @return frames of unit quaternions without NaN, whatever the shape of the triangles.
/// @throws invalid_option  for a number outside its range.
/// @par Complexity   One sparse factorisation of n_edges complex unknowns for all patches with features and one for
///                   each closed one: O(n^1.5); about 1 kB an edge.
/// @par Determinism  The same everywhere up to rounding; closed patches start from a fixed pseudo-random vector.
/// @par Source       The paper, equation (1), for planar domains. Knoeppel, Crane, Pinkall, Schroeder, ACM Trans.
///                   Graph. 32 (2013) for closed surfaces. Departs from both: unknowns on edges instead of vertices,
///                   because no tangent plane has to be invented at corners and sharp edges.
inline SurfaceCrossField compute_cross_field(const Surface& surface, const CrossFieldOptions& options = {}) {
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
