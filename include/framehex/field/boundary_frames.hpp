// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/errors.hpp"
#include "framehex/field/cube_rotation_group.hpp"
#include "framehex/option_ranges.hpp"
#include "framehex/surface/surface.hpp"

#include <numbers>
#include <span>
#include <vector>

namespace framehex {

/// What the surface asks of the frame of a vertex.
enum class FrameConstraint : std::uint8_t {
  none,   ///< nothing
  axis,   ///< one axis is given, the frame may turn about it
  fixed,  ///< the whole frame is given
};

/// Frames on a surface, per surface vertex.
struct BoundaryFrames {
  std::vector<Quaternion> frames;            ///< unit
  std::vector<FrameConstraint> constraints;  ///< axis: a smooth place, or a curve whose two normals do not agree
  std::vector<Vector3> axes;                 ///< unit: the outward normal, or the curve's tangent; zero where fixed
};

/// Options of `make_boundary_frames`.
struct BoundaryFrameOptions {
  /// A vertex of a feature curve is fixed when the normals on its two sides can be met within this angle (rad, 0 to pi);
  /// otherwise only the curve's tangent is kept.
  double curve_tolerance = 15 * std::numbers::pi / 180;

  template <class Options, class Visit>
  static void each_number(Options& o, Visit&& visit) {
    visit("BoundaryFrameOptions::curve_tolerance", o.curve_tolerance, 0, std::numbers::pi);
  }
};

namespace detail {

/// A direction that an axis of the frame should have, up to sign.
struct WeightedDirection {
  Vector3 direction;
  double weight;
};

/// Least rotation that brings the nearest of the six half axes of a frame onto a direction, as axis times angle.
inline Vector3 rotation_onto(const Quaternion& frame, const Vector3& direction) {
  const Vector3 local = frame.conjugate() * direction;
  Vector3::Index nearest = 0;
  local.cwiseAbs().maxCoeff(&nearest);
  Vector3 axis = Vector3::Zero();
  axis[nearest] = local[nearest] < 0 ? -1 : 1;
  const Vector3 cross = axis.cross(local);
  const double sine = cross.norm();
  if (sine == 0) return Vector3::Zero();
  return frame * Vector3(cross * (std::atan2(sine, local.dot(axis)) / sine));
}

/// Turns a frame by the least rotation so that `direction` is one of its axes.
inline Quaternion snapped(const Quaternion& frame, const Vector3& direction) {
  return (CubeRotationGroup<>::exponential(rotation_onto(frame, direction)) * frame).normalized();
}

/// The form of a frame whose z axis is `direction`, which is one of its axes up to sign.
inline Quaternion with_z(const Quaternion& frame, const Vector3& direction) {
  Quaternion best = frame;
  double cosine = -2;
  for (int g = 0; g < CubeRotationGroup<>::size(); ++g) {
    const Quaternion form = frame * CubeRotationGroup<>::element(g);
    const double c = (form * Vector3::UnitZ()).dot(direction);
    if (c > cosine + 1e-9) {
      best = form;
      cosine = c;
    }
  }
  return best;
}

struct FrameFit {
  Quaternion frame = Quaternion::Identity();
  double cost = 0;  ///< weighted sum of the squared angles
};

/// Least-squares frame through directions, from a start.
FrameFit fit_frame(Quaternion frame, std::span<const WeightedDirection> directions);

}  // namespace detail

/// Frames of the vertices of a surface from its crosses, normals and features.
///
/// At a smooth place the frame is the mean normal with the mean cross. On a feature the frame is the nearest, in least
/// squares of angles, to the normals of the parts that meet there and to the tangents of the curves: normals that are
/// not orthogonal to one another are so met half way and not forced.
///
/// @param surface          its `features.is_feature` may be empty (no features).
/// @param triangle_frames  n_triangles unit quaternions, z the outward normal, x and y the cross.
/// @return per vertex; a vertex without triangles has the constraint `none`.
/// @throws invalid_field  with the triangle whose frame is not a unit quaternion, or the vertex that has only triangles
///                        without area; invalid_option when a count does not match.
/// @par Complexity   O(n log d) for vertices of up to d triangles.
/// @par Source       The paper, section 3.3 (the boundary condition). Departs: features and corners, of which the paper
///                   does not speak.
BoundaryFrames make_boundary_frames(const Surface& surface, std::span<const Quaternion> triangle_frames,
                                    const BoundaryFrameOptions& options = {});

}  // namespace framehex

#ifndef FRAMEHEX_COMPILED
#include "framehex/field/detail/boundary_frames_impl.hpp"
#endif
