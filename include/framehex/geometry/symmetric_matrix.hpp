// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/config.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

namespace framehex {

/// Solution of A x = b for a symmetric 3 x 3 matrix, by Cholesky's factors.
///
/// @return nothing where a pivot is not positive: A is not positive definite.
/// @par Departs  Eigen's `LLT` does the same; for three rows written out it compiles ten times as fast.
inline std::optional<Vector3> solve_positive(const Eigen::Matrix3d& a, const Vector3& b) {
  if (!(a(0, 0) > 0)) return std::nullopt;
  const double l00 = std::sqrt(a(0, 0)), l10 = a(1, 0) / l00, l20 = a(2, 0) / l00;
  const double pivot1 = a(1, 1) - l10 * l10;
  if (!(pivot1 > 0)) return std::nullopt;
  const double l11 = std::sqrt(pivot1), l21 = (a(2, 1) - l20 * l10) / l11;
  const double pivot2 = a(2, 2) - (l20 * l20 + l21 * l21);
  if (!(pivot2 > 0)) return std::nullopt;
  const double l22 = std::sqrt(pivot2);
  const double y0 = b[0] / l00, y1 = (b[1] - l10 * y0) / l11, y2 = (b[2] - (l20 * y0 + l21 * y1)) / l22;
  const double x2 = y2 / l22, x1 = (y1 - l21 * x2) / l11, x0 = (y0 - (l10 * x1 + l20 * x2)) / l00;
  return Vector3(x0, x1, x2);
}

/// Least eigenvalue of a symmetric 3 x 3 matrix, in closed form.
///
/// @return exact to some 1e-8 of the largest entry: the cosine of the angle loses half the digits near its ends.
/// @par Source  O. K. Smith, Communications of the ACM 4 (1961) 168.
inline double least_eigenvalue(const Eigen::Matrix3d& a) {
  const double mean = (a(0, 0) + a(1, 1) + a(2, 2)) / 3;
  const double d0 = a(0, 0) - mean, d1 = a(1, 1) - mean, d2 = a(2, 2) - mean;
  const double square = d0 * d0 + d1 * d1 + d2 * d2 + 2 * (a(1, 0) * a(1, 0) + a(2, 0) * a(2, 0) + a(2, 1) * a(2, 1));
  const double radius = std::sqrt(square / 6);
  if (!(radius > 0)) return mean;
  const double determinant = d0 * (d1 * d2 - a(2, 1) * a(2, 1)) - a(1, 0) * (a(1, 0) * d2 - a(2, 1) * a(2, 0)) +
                             a(2, 0) * (a(1, 0) * a(2, 1) - d1 * a(2, 0));
  const double cosine = std::clamp(determinant / (2 * radius * radius * radius), -1.0, 1.0);
  return mean + 2 * radius * std::cos(std::acos(cosine) / 3 + 2 * std::numbers::pi / 3);
}

}  // namespace framehex
