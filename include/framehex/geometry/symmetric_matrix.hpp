// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/config.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>

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

/// Solution of A x = b for a symmetric 3 x 3 matrix that need be neither definite nor regular, by pivoted L D L^T.
///
/// @return x without a part along what A gives nothing for: its pivot is then as small as a number can be.
/// @par Departs  Eigen's `LDLT` does the same, to the last bit; for three rows written out it compiles ten times as fast.
inline Vector3 solve_symmetric(Eigen::Matrix3d a, const Vector3& b) {
  Vector3 x = b;
  std::array<int, 3> pivots{};
  for (int k = 0; k < 3; ++k) {  // L and D take the place of the lower half of A
    int p = k;
    for (int i = k + 1; i < 3; ++i)
      if (std::abs(a(i, i)) > std::abs(a(p, p))) p = i;
    pivots[static_cast<std::size_t>(k)] = p;
    if (p != k) {  // of the lower half only
      std::swap(x[k], x[p]);
      std::swap(a(k, k), a(p, p));
      for (int j = 0; j < k; ++j) std::swap(a(k, j), a(p, j));
      for (int i = k + 1; i < p; ++i) std::swap(a(i, k), a(p, i));
      for (int i = p + 1; i < 3; ++i) std::swap(a(i, k), a(i, p));
    }
    double taken = 0;
    for (int j = 0; j < k; ++j) taken += a(k, j) * (a(j, j) * a(k, j));
    a(k, k) -= taken;
    if (k == 1) a(2, 1) -= a(2, 0) * (a(0, 0) * a(1, 0));
    if (a(k, k) != 0)
      for (int i = k + 1; i < 3; ++i) a(i, k) /= a(k, k);
  }
  x[1] -= a(1, 0) * x[0];
  x[2] -= a(2, 0) * x[0] + a(2, 1) * x[1];
  for (int i = 0; i < 3; ++i) x[i] = std::abs(a(i, i)) > std::numeric_limits<double>::min() ? x[i] / a(i, i) : 0.0;
  x[1] -= a(2, 1) * x[2];
  x[0] -= a(1, 0) * x[1] + a(2, 0) * x[2];
  for (int k = 2; k >= 0; --k) std::swap(x[k], x[pivots[static_cast<std::size_t>(k)]]);
  return x;
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
