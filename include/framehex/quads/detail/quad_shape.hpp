// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/config.hpp"

#include <cmath>

namespace framehex::detail {

/// How far a corner is from a right angle between equal sides, with a barrier at the flat angle that folded corners can
/// pass: the square of (|x|^2 + |y|^2) / (2 x cross y), 1 at best.
///
/// @par Source   The condition number of the corner's Jacobian; the regularised determinant of Escobar et al., Comput.
///               Methods Appl. Mech. Eng. 192 (2003) 2775-2787.
struct CornerShape {
  double squares;    ///< |x|^2 + |y|^2
  double area;       ///< x cross y along the normal, regularised: positive
  double slope;      ///< of the regularised area by the true one
  double condition;  ///< squares / (2 area)

  /// @param shape  area of the corner wished for over that of a right one: 1, or less for triangles.
  /// @param least  areas well below this count as this.
  CornerShape(const Vector3& x, const Vector3& y, const Vector3& normal, double shape, double least) {
    const double true_area = x.cross(y).dot(normal) / shape;
    const double root = std::sqrt(true_area * true_area + 4 * least * least);
    squares = x.squaredNorm() + y.squaredNorm();
    area = (true_area + root) / 2;
    slope = (1 + true_area / root) / (2 * shape);
    condition = squares / (2 * area);
  }

  double energy() const { return condition * condition; }
};

/// Second-order model of an energy by the place of a vertex.
struct VertexModel {
  double energy = 0;
  Vector3 gradient = Vector3::Zero();
  Eigen::Matrix3d curvature = Eigen::Matrix3d::Zero();

  /// @param d_squares, d_area  gradients of the corner's sums by the vertex; `n_sides` of its sides end there.
  void add(const CornerShape& corner, const Vector3& d_squares, const Vector3& d_area, int n_sides) {
    const double c = corner.condition;
    const Vector3 d = d_squares / (2 * corner.area) - (c * corner.slope / corner.area) * d_area;
    energy += c * c;
    gradient += 2 * c * d;
    curvature += 2 * d * d.transpose() + (2 * c * n_sides / corner.area) * Eigen::Matrix3d::Identity();
  }
};

}  // namespace framehex::detail
