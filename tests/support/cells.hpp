// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/config.hpp"

#include <boost/random/uniform_real_distribution.hpp>

#include <algorithm>
#include <array>
#include <random>

namespace framehex::test {

inline const std::array<Vector3, 8> unit_cube{Vector3(0, 0, 0), Vector3(1, 0, 0), Vector3(1, 1, 0), Vector3(0, 1, 0),
                                              Vector3(0, 0, 1), Vector3(1, 0, 1), Vector3(1, 1, 1), Vector3(0, 1, 1)};

/// The unit cube with every corner moved by up to `amplitude` in each direction.
inline std::array<Vector3, 8> shaken_cube(double amplitude, std::mt19937_64& engine) {
  boost::random::uniform_real_distribution<> shift(-amplitude, amplitude);
  auto cube = unit_cube;
  for (Vector3& p : cube)
    for (double& x : p) x += shift(engine);
  return cube;
}

/// Jacobian of the trilinear map, from its definition.
inline double trilinear_jacobian(const std::array<Vector3, 8>& p, double u, double v, double w) {
  const auto mix = [](const Vector3& a, const Vector3& b, double t) -> Vector3 { return (1 - t) * a + t * b; };
  const Vector3 x = mix(mix(p[1] - p[0], p[2] - p[3], v), mix(p[5] - p[4], p[6] - p[7], v), w);
  const Vector3 y = mix(mix(p[3] - p[0], p[2] - p[1], u), mix(p[7] - p[4], p[6] - p[5], u), w);
  const Vector3 z = mix(mix(p[4] - p[0], p[5] - p[1], u), mix(p[7] - p[3], p[6] - p[2], u), v);
  return x.cross(y).dot(z);
}

/// Samples of the Jacobian on a regular grid over a box of the reference cube; 100 points in each direction make 10^6.
class SampledJacobian {
public:
  struct Sample {
    double value;
    Vector3 at;
  };

  explicit SampledJacobian(const std::array<Vector3, 8>& p) {
    constexpr std::array<double, 3> half{0, 0.5, 1};
    for (std::size_t k = 0; k < 3; ++k)
      for (std::size_t j = 0; j < 3; ++j)
        for (std::size_t i = 0; i < 3; ++i)
          nodes_[i + 3 * j + 9 * k] = trilinear_jacobian(p, half[i], half[j], half[k]);
  }

  /// The least of n^3 samples. It is a polynomial of degree 2 in each direction, known by its values at 27 nodes.
  template <std::size_t N>
  Sample least(const Vector3& low = {0, 0, 0}, const Vector3& high = {1, 1, 1}) const {
    std::array<std::array<std::array<double, 3>, N>, 3> basis;
    const auto place = [&](int axis, std::size_t i) {
      return low[axis] + (high[axis] - low[axis]) * static_cast<double>(i) / (N - 1);
    };
    for (std::size_t axis = 0; axis < 3; ++axis)
      for (std::size_t i = 0; i < N; ++i) {
        const double t = place(static_cast<int>(axis), i);
        basis[axis][i] = {(1 - t) * (1 - 2 * t), 4 * t * (1 - t), t * (2 * t - 1)};
      }
    Sample best{1e300, {0, 0, 0}};
    std::array<double, N> row;
    for (std::size_t i = 0; i < N; ++i)
      for (std::size_t j = 0; j < N; ++j) {
        std::array<double, 3> along{};
        for (std::size_t k = 0; k < 3; ++k)
          for (std::size_t b = 0; b < 3; ++b)
            for (std::size_t a = 0; a < 3; ++a) along[k] += nodes_[a + 3 * b + 9 * k] * basis[0][i][a] * basis[1][j][b];
        for (std::size_t k = 0; k < N; ++k)
          row[k] = along[0] * basis[2][k][0] + along[1] * basis[2][k][1] + along[2] * basis[2][k][2];
        const auto lowest = std::min_element(row.begin(), row.end());
        if (*lowest < best.value)
          best = {*lowest, {place(0, i), place(1, j), place(2, static_cast<std::size_t>(lowest - row.begin()))}};
      }
    return best;
  }

private:
  std::array<double, 27> nodes_;
};

}  // namespace framehex::test
