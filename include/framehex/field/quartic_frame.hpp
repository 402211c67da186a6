// SPDX-License-Identifier: BSL-1.0
#pragma once

#include <cmath>
#include "framehex/config.hpp"

namespace framehex {

/// Nine coefficients of a harmonic quartic (degree-4 spherical harmonics), in an orthonormal basis.
using Quartic = Eigen::Matrix<double, 9, 1>;

/// The basis at a point: homogeneous harmonic polynomials of degree 4, scaled so that their vector is a unit one for a
/// unit point. The quartic with these coefficients is the zonal one about `p`.
Quartic zonal_quartic(const Vector3& p);

/// The quartic of a frame: the harmonic part of x^4 + y^4 + z^4 in its axes, scaled to a unit vector. Frames that are
/// the same have the same quartic.
Quartic frame_quartic(const Quaternion& frame);

/// The quartics of all frames with a given axis: centre + cosine * cos(4 t) + sine * sin(4 t), with t the turn of the
/// frame from `frame` about the axis. `cosine` and `sine` are orthogonal, and as long as each other.
struct AxisQuartics {
  Quartic centre, cosine, sine;
  Quaternion frame;  ///< t = 0

  /// @param frame_  whose axis nearest to `axis` is exactly `axis`.
  AxisQuartics(const Quaternion& frame_, const Vector3& axis);

  /// The nearest frame to a quartic; `frame` where all are equally near.
  Quaternion nearest(const Quartic& q, const Vector3& axis) const;
};

/// The frame whose quartic is nearest to `q`, near a start: Newton's method on rotations with a damped step.
///
/// @param q      any quartic; the zero one returns `start`.
/// @param start  unit quaternion.
/// @return a unit quaternion where the distance is stationary and not greater than at the start.
/// @par Complexity   O(1), usually 3 to 5 steps of about 300 operations.
/// @par Source       Ray, Sokolov, Levy, "Practical 3D frame field generation" (2016), section 3; there by gradient.
Quaternion nearest_frame(const Quartic& q, const Quaternion& start);

/// The same without a start: from the best of 25 frames spread over all.
Quaternion nearest_frame(const Quartic& q);

}  // namespace framehex

#ifndef FRAMEHEX_COMPILED
#include "framehex/field/detail/quartic_frame_impl.hpp"
#endif
