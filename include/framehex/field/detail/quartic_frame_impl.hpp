// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/field/cube_rotation_group.hpp"
#include "framehex/field/quartic_frame.hpp"
#include "framehex/geometry/symmetric_matrix.hpp"

#include <cmath>
#include <numbers>

namespace framehex {

namespace detail {

/// A quartic form with its derivatives, by monomials.
class QuarticForm {
public:
  explicit QuarticForm(const Quartic& q) {
    const double a = std::sqrt(35.0) / 2, b = std::sqrt(17.5) / 2, c = std::sqrt(5.0) / 2, d = std::sqrt(2.5) / 2;
    // The basis of zonal_quartic with r2 = x2 + y2 + z2 multiplied out.
    x4 = 0.375 * q[4] - c / 2 * q[6] + a / 4 * q[8];
    y4 = 0.375 * q[4] + c / 2 * q[6] + a / 4 * q[8];
    z4 = q[4];
    x3y = a * q[0] - c * q[2];
    xy3 = -a * q[0] - c * q[2];
    x3z = -3 * d * q[5] + b * q[7];
    xz3 = 4 * d * q[5];
    y3z = -b * q[1] - 3 * d * q[3];
    yz3 = 4 * d * q[3];
    x2y2 = 0.75 * q[4] - 1.5 * a * q[8];
    x2z2 = -3 * q[4] + 3 * c * q[6];
    y2z2 = -3 * q[4] - 3 * c * q[6];
    x2yz = 3 * b * q[1] - 3 * d * q[3];
    xy2z = -3 * d * q[5] - 3 * b * q[7];
    xyz2 = 6 * c * q[2];
  }

  Vector3 gradient(const Vector3& p) const {
    const double x = p.x(), y = p.y(), z = p.z(), x2 = x * x, y2 = y * y, z2 = z * z, xy = x * y, xz = x * z,
                 yz = y * z;
    return {4 * x4 * x2 * x + 3 * x2 * (x3y * y + x3z * z) + xy3 * y2 * y + xz3 * z2 * z +
                2 * x * (x2y2 * y2 + x2z2 * z2 + x2yz * yz) + xy2z * y2 * z + xyz2 * y * z2,
            4 * y4 * y2 * y + 3 * y2 * (xy3 * x + y3z * z) + x3y * x2 * x + yz3 * z2 * z +
                2 * y * (x2y2 * x2 + y2z2 * z2 + xy2z * xz) + x2yz * x2 * z + xyz2 * x * z2,
            4 * z4 * z2 * z + 3 * z2 * (xz3 * x + yz3 * y) + x3z * x2 * x + y3z * y2 * y +
                2 * z * (x2z2 * x2 + y2z2 * y2 + xyz2 * xy) + x2yz * x2 * y + xy2z * x * y2};
  }

  Eigen::Matrix3d hessian(const Vector3& p) const {
    const double x = p.x(), y = p.y(), z = p.z(), x2 = x * x, y2 = y * y, z2 = z * z, xy = x * y, xz = x * z,
                 yz = y * z;
    Eigen::Matrix3d h;
    h(0, 0) = 12 * x4 * x2 + 6 * x * (x3y * y + x3z * z) + 2 * (x2y2 * y2 + x2z2 * z2 + x2yz * yz);
    h(1, 1) = 12 * y4 * y2 + 6 * y * (xy3 * x + y3z * z) + 2 * (x2y2 * x2 + y2z2 * z2 + xy2z * xz);
    h(2, 2) = 12 * z4 * z2 + 6 * z * (xz3 * x + yz3 * y) + 2 * (x2z2 * x2 + y2z2 * y2 + xyz2 * xy);
    h(0, 1) = h(1, 0) = 3 * (x3y * x2 + xy3 * y2) + 4 * x2y2 * xy + 2 * (x2yz * xz + xy2z * yz) + xyz2 * z2;
    h(0, 2) = h(2, 0) = 3 * (x3z * x2 + xz3 * z2) + 4 * x2z2 * xz + 2 * (x2yz * xy + xyz2 * yz) + xy2z * y2;
    h(1, 2) = h(2, 1) = 3 * (y3z * y2 + yz3 * z2) + 4 * y2z2 * yz + 2 * (xy2z * xy + xyz2 * xz) + x2yz * x2;
    return h;
  }

private:
  double x4, y4, z4, x3y, xy3, x3z, xz3, y3z, yz3, x2y2, x2z2, y2z2, x2yz, xy2z, xyz2;
};

}  // namespace detail

FRAMEHEX_INLINE Quartic zonal_quartic(const Vector3& p) {
  const double x = p.x(), y = p.y(), z = p.z(), x2 = x * x, y2 = y * y, z2 = z * z, r2 = x2 + y2 + z2;
  // sqrt(4 pi / 9) times the real spherical harmonics Y(4, -4) to Y(4, 4).
  const double a = std::sqrt(35.0) / 2, b = std::sqrt(17.5) / 2, c = std::sqrt(5.0) / 2, d = std::sqrt(2.5) / 2;
  Quartic q;
  q << a * x * y * (x2 - y2), b * (3 * x2 - y2) * y * z, c * x * y * (7 * z2 - r2), d * y * z * (7 * z2 - 3 * r2),
      (35 * z2 * z2 - 30 * z2 * r2 + 3 * r2 * r2) / 8, d * x * z * (7 * z2 - 3 * r2), c / 2 * (x2 - y2) * (7 * z2 - r2),
      b * (x2 - 3 * y2) * x * z, a / 4 * (x2 * x2 - 6 * x2 * y2 + y2 * y2);
  return q;
}

FRAMEHEX_INLINE Quartic frame_quartic(const Quaternion& frame) {
  const Eigen::Matrix3d axes = frame.toRotationMatrix();
  return (zonal_quartic(axes.col(0)) + zonal_quartic(axes.col(1)) + zonal_quartic(axes.col(2))) / std::sqrt(5.25);
}

FRAMEHEX_INLINE AxisQuartics::AxisQuartics(const Quaternion& frame_, const Vector3& axis)
    : centre(zonal_quartic(axis) * std::sqrt(7.0 / 12)), frame(frame_) {
  cosine = frame_quartic(frame) - centre;
  sine = frame_quartic(Quaternion(Eigen::AngleAxisd(std::numbers::pi / 8, axis)) * frame) - centre;
}

FRAMEHEX_INLINE Quaternion AxisQuartics::nearest(const Quartic& q, const Vector3& axis) const {
  const double c = q.dot(cosine), s = q.dot(sine);
  if (c * c + s * s < 1e-24) return frame;
  return (Quaternion(Eigen::AngleAxisd(std::atan2(s, c) / 4, axis)) * frame).normalized();
}

FRAMEHEX_INLINE Quaternion nearest_frame(const Quartic& q, const Quaternion& start) {
  const double size = q.norm();
  if (!(size > 1e-12) || !std::isfinite(size)) return start;
  const Quartic unit = q / size;
  const detail::QuarticForm form(unit);
  Quaternion frame = start;
  double value = unit.dot(frame_quartic(frame));
  for (int iteration = 0; iteration < 30; ++iteration) {
    const Eigen::Matrix3d axes = frame.toRotationMatrix();
    Vector3 slope = Vector3::Zero();
    Eigen::Matrix3d curvature = Eigen::Matrix3d::Zero();  // minus the second derivative
    for (int i = 0; i < 3; ++i) {
      const Vector3 f = axes.col(i), g = form.gradient(f);
      slope += f.cross(g);
      Eigen::Matrix3d cross;
      cross << 0, -f.z(), f.y(), f.z(), 0, -f.x(), -f.y(), f.x(), 0;
      curvature -= cross.transpose() * form.hessian(f) * cross + 0.5 * (g * f.transpose() + f * g.transpose());
      curvature += g.dot(f) * Eigen::Matrix3d::Identity();
    }
    std::optional<Vector3> newton = solve_positive(curvature, slope);
    if (!newton) {
      // Away from a maximum: shift the least eigenvalue until the step goes uphill.
      curvature.diagonal().array() += 0.3 - least_eigenvalue(curvature);
      newton = solve_positive(curvature, slope);
    }
    Vector3 step = *newton;
    const double length = step.norm();
    if (length < 1e-9) break;
    if (length > 0.4) step *= 0.4 / length;
    bool accepted = false;
    for (int halving = 0; halving < 8 && !accepted; ++halving, step /= 2) {
      const Quaternion next = (CubeRotationGroup<>::exponential(step) * frame).normalized();
      const double next_value = unit.dot(frame_quartic(next));
      if (next_value <= value) continue;
      frame = next;
      value = next_value;
      accepted = true;
    }
    if (!accepted || length < 1e-5) break;
  }
  return frame;
}

FRAMEHEX_INLINE Quaternion nearest_frame(const Quartic& q) {
  // The identity and turns by 45 and 22 degrees about the 12 axes of the cube's edges and corners (both ways).
  Quaternion best = Quaternion::Identity();
  double value = q.dot(frame_quartic(best));
  const auto propose = [&](const Quaternion& frame) {
    const double v = q.dot(frame_quartic(frame));
    if (v > value) {
      best = frame;
      value = v;
    }
  };
  for (int i = 0; i < 3; ++i) propose(Quaternion(Eigen::AngleAxisd(std::numbers::pi / 4, Vector3::Unit(i))));
  for (int s = -1; s <= 1; s += 2)
    for (int i = 0; i < 3; ++i) {
      Vector3 edge = Vector3::Unit(i) + s * Vector3::Unit((i + 1) % 3);
      edge.normalize();
      for (const double turn : {-0.55, 0.55, 1.0}) propose(Quaternion(Eigen::AngleAxisd(turn, edge)));
    }
  for (int bits = 0; bits < 4; ++bits) {
    const Vector3 corner(1, bits & 1 ? -1 : 1, bits & 2 ? -1 : 1);
    propose(Quaternion(Eigen::AngleAxisd(std::numbers::pi / 3, corner.normalized())));
  }
  return nearest_frame(q, best);
}

}  // namespace framehex
