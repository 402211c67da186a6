// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/insertion/curve_inserter.hpp"
#include "framehex/insertion/surface_inserter.hpp"
#include "framehex/insertion/volume_inserter.hpp"
#include "support/surfaces.hpp"

#include <algorithm>
#include <vector>

namespace framehex::test {

/// The middle one, the upper of two. @pre not empty.
inline double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// The same frame everywhere.
struct ConstantFrames {
  struct Sample {
    Quaternion frame;
    double smoothness;
  };
  Quaternion frame = Quaternion::Identity();
  Sample sample(const Vector3&, index_t&) const { return {frame, 1.0}; }
};

/// A box with a corner at the origin, turned about it.
struct BoxDomain {
  Quaternion rotation;
  Vector3 extent;
  double clearance(const Vector3& p, double) const {
    const Vector3 u = rotation.conjugate() * p;
    return std::min(u.minCoeff(), (extent - u).minCoeff());
  }
};

/// The same surface turned about the origin.
inline IndexedTriangleMesh turned(IndexedTriangleMesh surface, const Quaternion& rotation) {
  for (Vector3& p : surface.points) p = rotation * p;
  return surface;
}

/// Frames of the triangles: z the outward normal, x the tangential part of the axis of `frame` that is least along it.
inline std::vector<Quaternion> triangle_frames(const IndexedTriangleMesh& surface, const Quaternion& frame) {
  std::vector<Quaternion> frames;
  const Eigen::Matrix3d axes = frame.toRotationMatrix();
  for (const auto& t : surface.triangles) {
    const Vector3 &a = surface.points[t[0]], &b = surface.points[t[1]], &c = surface.points[t[2]];
    const Vector3 normal = (b - a).cross(c - a).normalized();
    Eigen::Index axis = 0;
    (axes.transpose() * normal).cwiseAbs().minCoeff(&axis);
    Eigen::Matrix3d m;
    m.col(0) = (axes.col(axis) - axes.col(axis).dot(normal) * normal).normalized();
    m.col(1) = normal.cross(m.col(0));
    m.col(2) = normal;
    frames.emplace_back(m);
  }
  return frames;
}

}  // namespace framehex::test
