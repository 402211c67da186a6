// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/executor.hpp"
#include "framehex/field/boundary_frames.hpp"

#include <cmath>
#include <numbers>
#include <span>
#include <vector>

namespace framehex {

namespace detail {

inline constexpr std::size_t block_size = 1024;

/// Weighted mean of frames, after turning each into the representative nearest to the heaviest one.
/// @pre at least one weight is positive, none is negative.
template <std::size_t N>
Quaternion mean_frame(const std::array<Quaternion, N>& frames, const std::array<double, N>& weights) {
  std::size_t heaviest = 0;
  for (std::size_t i = 1; i < N; ++i)
    if (weights[i] > weights[heaviest]) heaviest = i;
  Eigen::Vector4d sum = Eigen::Vector4d::Zero();
  for (std::size_t i = 0; i < N; ++i) {
    if (!(weights[i] > 0)) continue;
    // Within 45 degrees (cosine of half of it: 0.924) no other representative can be nearer.
    const double cosine = frames[heaviest].dot(frames[i]);
    if (std::abs(cosine) > 0.93)
      sum += std::copysign(weights[i], cosine) * frames[i].coeffs();
    else
      sum += weights[i] * CubeRotationGroup<>::aligned(frames[heaviest], frames[i]).coeffs();
  }
  return Quaternion(sum.normalized());
}

inline double vertex_smoothness(index_t v, std::span<const index_t> ring, std::span<const Quaternion> frames) {
  if (ring.empty()) return 1;
  double sum = 0;
  for (const index_t w : ring) sum += CubeRotationGroup<>::angle(frames[v], frames[w]);
  return 1 - 4 / (std::numbers::pi * static_cast<double>(ring.size())) * sum;
}

}  // namespace detail

/// Smoothness of every vertex, s = 1 - 4/(pi N) * sum of the least angles to the frames of its N neighbours.
///
/// @param frames  n_vertices unit quaternions.
/// @return n_vertices values from -0.40 (its neighbours are as far as frames can be) to 1 (all alike; also for a vertex
///         without neighbours).
/// @par Complexity   O(edges).
/// @par Source       The paper, section 3.3. Its lower bound "approximately 0" is -0.396: the greatest least angle is
///                   62.8 degrees, not 45.
template <Executor E = SerialExecutor>
std::vector<double> frame_smoothness(const TetAdjacency& adjacency, std::span<const Quaternion> frames,
                                     const E& executor = {}) {
  std::vector<double> smoothness(frames.size());
  for_blocks(executor, frames.size(), detail::block_size, [&](std::size_t first, std::size_t last) {
    for (std::size_t v = first; v < last; ++v)
      smoothness[v] = detail::vertex_smoothness(static_cast<index_t>(v), adjacency.vertices_of_vertex[v], frames);
  });
  return smoothness;
}

/// How much the gradients in a tetrahedron are worth: 1, but less and less the flatter it is below a height of some ten
/// thousandths of its length.
///
/// Four points of a plane that is turned are not quite in it, and a tetrahedron of them has weights that are as large as
/// it is flat: nothing can be solved beside them. In a body as thin as that all are worth little, and alike.
///
/// @param six_volumes  > 0, cubes of the points' unit.
inline double worth_of_gradients(double six_volumes, const std::array<Vector3, 4>& corners) {
  constexpr double flat = 1e-4;
  double longest = 0;
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t j = i + 1; j < 4; ++j) longest = std::max(longest, (corners[i] - corners[j]).squaredNorm());
  const double height = six_volumes / (longest * std::sqrt(longest)) / flat;
  return height < 1 ? height * height : 1;
}

/// Weight of every directed edge, in the order of `adjacency.vertices_of_vertex.values`, with which the sum of squared
/// differences over edges approximates the Dirichlet integral.
///
/// Linear finite elements (the "cotangent" weights), but never below a thousandth of the edge's share by volume:
/// negative weights, which obtuse dihedral angles give, would let an energy fall without bound. Flat tetrahedra count less
/// (`worth_of_gradients`).
///
/// @return lengths in the host's unit, all > 0 on a valid mesh; the same for both directions of an edge.
/// @par Complexity   O(tetrahedra).
inline std::vector<double> dirichlet_weights(const TetAdjacency& adjacency, std::span<const Vector3> points) {
  const Csr<index_t>& ring = adjacency.vertices_of_vertex;
  std::vector<double> weights(ring.values.size(), 0.0), floor(ring.values.size(), 0.0);
  const auto slot = [&](index_t v, index_t w) {
    const auto row = ring[v];
    return ring.offsets[v] + static_cast<offset_t>(std::lower_bound(row.begin(), row.end(), w) - row.begin());
  };
  for (const auto& tet : adjacency.tets) {
    const Vector3 &a = points[tet[0]], &b = points[tet[1]], &c = points[tet[2]], &d = points[tet[3]];
    // Gradients of the four hat functions, times six volumes.
    std::array<Vector3, 4> gradient;
    gradient[1] = (c - a).cross(d - a);
    gradient[2] = (d - a).cross(b - a);
    gradient[3] = (b - a).cross(c - a);
    gradient[0] = -(gradient[1] + gradient[2] + gradient[3]);
    const double six_volumes = gradient[1].dot(b - a);
    if (!(six_volumes > 0)) continue;
    const double worth = worth_of_gradients(six_volumes, {a, b, c, d});
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t j = i + 1; j < 4; ++j) {
        const double value = -worth * gradient[i].dot(gradient[j]) / (6 * six_volumes);
        const double share = 1e-3 * six_volumes / (6 * (points[tet[i]] - points[tet[j]]).squaredNorm());
        for (const offset_t s : {slot(tet[i], tet[j]), slot(tet[j], tet[i])}) {
          weights[s] += value;
          floor[s] += share;
        }
      }
  }
  for (std::size_t s = 0; s < weights.size(); ++s) weights[s] = std::max(weights[s], floor[s]);
  return weights;
}

/// Dirichlet energy of a field: half the integral of the squared gradient of the angle, rad^2 times length.
///
/// @param weights  of `dirichlet_weights`.
/// @par Complexity   O(edges).
inline double dirichlet_energy(const TetAdjacency& adjacency, std::span<const Quaternion> frames,
                               std::span<const double> weights) {
  const Csr<index_t>& ring = adjacency.vertices_of_vertex;
  double energy = 0;
  for (std::size_t v = 0; v < ring.size(); ++v) {
    double sum = 0;
    for (offset_t s = ring.offsets[v]; s < ring.offsets[v + 1]; ++s) {
      const index_t w = ring.values[s];
      if (w < v) continue;
      const double angle = CubeRotationGroup<>::angle(frames[v], frames[w]);
      sum += weights[s] * angle * angle;
    }
    energy += sum / 2;
  }
  return energy;
}

/// How far frames are from what the boundary asks: the largest angle between a given axis, or the normal of a boundary
/// triangle, and the nearest axis of a frame at it.
struct BoundaryMisalignment {
  double largest = 0;         ///< rad, over the vertices with the constraint `axis`
  index_t vertex = no_index;  ///< where
  double mean = 0;            ///< rad, over all corners of boundary triangles weighted by area: sharp places count too
};

/// @param frames, constraints, axes  per vertex of the mesh.
/// @par Complexity   O(tetrahedra).
inline BoundaryMisalignment boundary_misalignment(const TetAdjacency& adjacency, std::span<const Vector3> points,
                                                  std::span<const Quaternion> frames,
                                                  std::span<const FrameConstraint> constraints,
                                                  std::span<const Vector3> axes) {
  BoundaryMisalignment result;
  for (index_t v = 0; v < frames.size(); ++v) {
    if (constraints[v] != FrameConstraint::axis) continue;
    const double angle = detail::rotation_onto(frames[v], axes[v]).norm();
    if (result.vertex != no_index && angle <= result.largest) continue;
    result.largest = angle;
    result.vertex = v;
  }
  double sum = 0, area = 0;
  for (std::size_t tet = 0; tet < adjacency.tets.size(); ++tet)
    for (int face = 0; face < 4; ++face) {
      if (adjacency.neighbours[tet][static_cast<std::size_t>(face)] != no_index) continue;
      const auto t = facet(adjacency.tets[tet], face);
      const Vector3 normal = (points[t[1]] - points[t[0]]).cross(points[t[2]] - points[t[0]]);
      const double size = normal.norm();
      if (!(size > 0)) continue;
      for (const index_t v : t) sum += size * detail::rotation_onto(frames[v], normal / size).norm();
      area += 3 * size;
    }
  result.mean = area > 0 ? sum / area : 0;
  return result;
}

}  // namespace framehex
