// SPDX-License-Identifier: BSL-1.0
#pragma once

#include <Eigen/Dense>

#include <cmath>

namespace framehex::detail {

/// Changes whole numbers x by one, or two of them at once, while x A x - 2 b x falls.
inline void descend(const Eigen::MatrixXd& a, const Eigen::VectorXd& b, Eigen::VectorXd& x) {
  const Eigen::Index n = x.size();
  const double least = 1e-9 * (1 + a.diagonal().cwiseAbs().sum());
  Eigen::VectorXd slope = a * x - b;
  // Every move lowers the value; the bound is for rounding.
  for (Eigen::Index moves = 0; moves < 100 * n; ++moves) {
    double best = -least;
    Eigen::Index first = -1, second = -1;
    int up = 0, other_up = 0;
    for (Eigen::Index i = 0; i < n; ++i)
      for (const int s : {-1, 1}) {
        const double alone = a(i, i) + 2 * s * slope[i];
        if (alone < best) best = alone, first = i, up = s, second = -1;
        for (Eigen::Index j = 0; j < i; ++j) {
          const double cross = slope[j] + s * a(i, j);
          const int r = cross > 0 ? -1 : 1;
          const double both = alone + a(j, j) + 2 * r * cross;
          if (both < best) best = both, first = i, up = s, second = j, other_up = r;
        }
      }
    if (first < 0) return;
    x[first] += up;
    slope += up * a.col(first);
    if (second < 0) continue;
    x[second] += other_up;
    slope += other_up * a.col(second);
  }
}

/// Whole numbers x for which x A x - 2 b x is small: rounded one after the other, that nearest to a whole number first,
/// while the others answer; then changed as `descend` does.
///
/// @param a  symmetric, positive.
/// @par Complexity   O(n^3).
/// @par Source       The rounding: Bommes, Zimmer, Kobbelt, ACM Trans. Graph. 28 (2009), for surfaces.
inline Eigen::VectorXd nearest_whole(const Eigen::MatrixXd& a, const Eigen::VectorXd& b) {
  const Eigen::Index n = b.size();
  Eigen::MatrixXd inverse = a.ldlt().solve(Eigen::MatrixXd::Identity(n, n));
  Eigen::VectorXd x = inverse * b;
  Eigen::Array<bool, Eigen::Dynamic, 1> rounded = Eigen::Array<bool, Eigen::Dynamic, 1>::Constant(n, false);
  for (Eigen::Index step = 0; step < n; ++step) {
    Eigen::Index next = 0;
    rounded.select(2, (x.array() - x.array().round()).abs()).minCoeff(&next);
    const double whole = std::round(x[next]);
    const Eigen::VectorXd answer = inverse.col(next) / inverse(next, next);
    x += (whole - x[next]) * answer;
    inverse -= inverse(next, next) * answer * answer.transpose();
    x[next] = whole;
    rounded[next] = true;
  }
  x = x.array().round();
  descend(a, b, x);
  return x;
}

}  // namespace framehex::detail
