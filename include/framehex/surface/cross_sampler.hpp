// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/geometry/rotation.hpp"
#include "framehex/surface/surface_walker.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <vector>

namespace framehex {

/// A cross field given by a frame per triangle, evaluated at points: continuous across edges that are not walls.
///
/// Each corner of a triangle gets the mean of the crosses of the triangles round it (as far as walls allow), kept as an
/// angle from the triangle's own cross; in the triangle this angle is interpolated linearly. A piecewise constant cross
/// would bend each path by what the field turns within a triangle.
class CrossSampler {
public:
  /// The cross at a point.
  struct Sample {
    Eigen::Matrix3d axes;  ///< columns: the cross's two axes and the outward normal
    double smoothness;
  };

  /// All are kept by reference.
  ///
  /// @param frames      n_triangles; z is the outward normal, x and y the cross.
  /// @param smoothness  n_vertices, or empty: 1 everywhere.
  CrossSampler(const Surface& surface, const SurfaceWalker& walker, std::span<const Quaternion> frames,
               std::span<const double> smoothness)
      : surface_(surface), walker_(walker), smoothness_(smoothness) {
    const auto n = static_cast<index_t>(surface.triangles().size());
    axes_.reserve(n);
    for (index_t t = 0; t < n; ++t) axes_.push_back(tangent_axes(t, frames[t]));
    corner_angle_.resize(3 * std::size_t{n});
    for (index_t half_edge = 0; half_edge < 3 * n; ++half_edge) corner_angle_[half_edge] = corner_angle(half_edge);
  }

  /// @param p  a point of the triangle, within rounding.
  Sample at(index_t triangle, const Vector3& p) const {
    const Vector3 weights = barycentric(triangle, p);
    double angle = 0, smoothness = smoothness_.empty() ? 1.0 : 0.0;
    for (int c = 0; c < 3; ++c) {
      const auto corner = static_cast<std::size_t>(c);
      angle += weights[c] * corner_angle_[3 * triangle + corner];
      if (!smoothness_.empty()) smoothness += weights[c] * smoothness_[surface_.triangles()[triangle][corner]];
    }
    const Eigen::Matrix3d& axes = axes_[triangle];
    Sample sample{axes, smoothness};
    sample.axes.col(0) = std::cos(angle) * axes.col(0) + std::sin(angle) * axes.col(1);
    sample.axes.col(1) = std::cos(angle) * axes.col(1) - std::sin(angle) * axes.col(0);
    return sample;
  }

private:
  Eigen::Matrix3d tangent_axes(index_t t, const Quaternion& frame) const {
    const Vector3& normal = walker_.normal(t);
    const Vector3 given = frame.toRotationMatrix().col(0);
    const Vector3 x = given - given.dot(normal) * normal;
    Eigen::Matrix3d axes;
    axes.col(0) = x.norm() > 1e-6 ? x.normalized() : normal.unitOrthogonal();
    axes.col(1) = normal.cross(axes.col(0));
    axes.col(2) = normal;
    return axes;
  }

  /// Angle from the cross of triangle t to that of s, in (-pi/4, pi/4].
  double difference(index_t t, index_t s) const {
    const Quaternion fold = rotation_between(walker_.normal(s), walker_.normal(t));
    const Vector3 x = fold * Vector3(axes_[s].col(0));
    return quarter_remainder(std::atan2(x.dot(axes_[t].col(1)), x.dot(axes_[t].col(0))));
  }

  /// Mean over the fan of the corner from which `half_edge` starts.
  double corner_angle(index_t half_edge) const {
    const TriangleAdjacency& adjacency = surface_.adjacency;
    const index_t t = half_edge / 3;
    double sum = 0;
    int n = 1;
    bool closed = false;
    for (index_t h = half_edge; !walker_.is_wall(h);) {
      h = TriangleAdjacency::next(adjacency.opposite[h]);
      if ((closed = h == half_edge)) break;
      sum += difference(t, h / 3);
      ++n;
    }
    if (closed) return sum / n;
    for (index_t h = TriangleAdjacency::previous(half_edge); !walker_.is_wall(h);) {
      h = TriangleAdjacency::previous(adjacency.opposite[h]);
      sum += difference(t, h / 3);
      ++n;
    }
    return sum / n;
  }

  Vector3 barycentric(index_t triangle, const Vector3& p) const {
    const auto& t = surface_.triangles()[triangle];
    const Vector3 &a = surface_.points[t[0]], &b = surface_.points[t[1]], &c = surface_.points[t[2]];
    const Vector3& normal = walker_.normal(triangle);
    const double area = (b - a).cross(c - a).dot(normal);
    if (!(area > 0)) return Vector3::Constant(1.0 / 3);
    const double u = (c - b).cross(p - b).dot(normal) / area, v = (a - c).cross(p - c).dot(normal) / area;
    const Vector3 weights = Vector3(u, v, 1 - u - v).cwiseMax(0.0);
    return weights / weights.sum();
  }

  const Surface& surface_;
  const SurfaceWalker& walker_;
  std::span<const double> smoothness_;
  std::vector<Eigen::Matrix3d> axes_;
  std::vector<double> corner_angle_;  // one a half edge: of the corner from which it starts
};

}  // namespace framehex
