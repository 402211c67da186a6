// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/config.hpp"

#include <algorithm>

namespace framehex {

/// A point of a triangle, as nearest to some query.
struct TrianglePoint {
  Vector3 barycentric;      ///< weights of the three corners, >= 0, sum 1
  Vector3 point;            ///< the same in space
  double squared_distance;  ///< to the query
};

namespace detail {

inline TrianglePoint triangle_point(const Vector3& p, const Vector3& a, const Vector3& b, const Vector3& c, double v,
                                    double w) {
  const Vector3 point = a + v * (b - a) + w * (c - a);
  return {Vector3(std::max(0.0, 1.0 - v - w), v, w), point, (point - p).squaredNorm()};
}

/// Position in [0, 1] along segment ab of its point nearest to p; 0 for a segment of no length.
inline double nearest_on_segment(const Vector3& p, const Vector3& a, const Vector3& b) {
  const Vector3 ab = b - a;
  const double length = ab.squaredNorm();
  return length > 0 ? std::clamp((p - a).dot(ab) / length, 0.0, 1.0) : 0.0;
}

/// Nearest point on the rim: right for every triangle, also one without area.
inline TrianglePoint nearest_on_rim(const Vector3& p, const Vector3& a, const Vector3& b, const Vector3& c) {
  const double ab = nearest_on_segment(p, a, b), ac = nearest_on_segment(p, a, c), bc = nearest_on_segment(p, b, c);
  TrianglePoint best = triangle_point(p, a, b, c, ab, 0);
  const TrianglePoint on_ac = triangle_point(p, a, b, c, 0, ac);
  if (on_ac.squared_distance < best.squared_distance) best = on_ac;
  const TrianglePoint on_bc = triangle_point(p, a, b, c, 1 - bc, bc);
  if (on_bc.squared_distance < best.squared_distance) best = on_bc;
  return best;
}

}  // namespace detail

/// Nearest point of triangle abc to p.
///
/// @param p,a,b,c  points, one unit of length. A triangle without area is taken as its rim.
/// @return the point with its barycentric weights.
/// @par Complexity   O(1), no trigonometry.
/// @par Source       C. Ericson, Real-Time Collision Detection (2005), section 5.1.5. Departs: a triangle so thin that
///                   the projection on its plane is all rounding error falls back on its three edges.
inline TrianglePoint nearest_on_triangle(const Vector3& p, const Vector3& a, const Vector3& b, const Vector3& c) {
  const Vector3 ab = b - a, ac = c - a, ap = p - a;
  const double d1 = ab.dot(ap), d2 = ac.dot(ap);
  if (d1 <= 0 && d2 <= 0) return detail::triangle_point(p, a, b, c, 0, 0);
  const Vector3 bp = p - b;
  const double d3 = ab.dot(bp), d4 = ac.dot(bp);
  if (d3 >= 0 && d4 <= d3) return detail::triangle_point(p, a, b, c, 1, 0);
  const Vector3 cp = p - c;
  const double d5 = ab.dot(cp), d6 = ac.dot(cp);
  if (d6 >= 0 && d5 <= d6) return detail::triangle_point(p, a, b, c, 0, 1);

  const double area = ab.cross(ac).squaredNorm();
  if (!(area > 1e-20 * ab.squaredNorm() * ac.squaredNorm())) return detail::nearest_on_rim(p, a, b, c);
  const double vc = d1 * d4 - d3 * d2, vb = d5 * d2 - d1 * d6, va = d3 * d6 - d5 * d4;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return detail::triangle_point(p, a, b, c, d1 / (d1 - d3), 0);
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return detail::triangle_point(p, a, b, c, 0, d2 / (d2 - d6));
  if (va <= 0 && d4 >= d3 && d5 >= d6) {
    const double w = (d4 - d3) / ((d4 - d3) + (d5 - d6));
    return detail::triangle_point(p, a, b, c, 1 - w, w);
  }
  const double sum = va + vb + vc;
  if (!(sum > 0)) return detail::nearest_on_rim(p, a, b, c);
  return detail::triangle_point(p, a, b, c, vb / sum, vc / sum);
}

}  // namespace framehex
