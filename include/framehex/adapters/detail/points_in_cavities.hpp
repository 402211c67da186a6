// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/config.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <span>
#include <vector>

namespace framehex::detail {

/// A point in each cavity: TetGen fills what it is not told to leave empty. The shell of a cavity encloses a negative
/// volume; the point lies just outside the body at the middle of its largest triangle.
inline std::vector<Vector3> points_in_cavities(std::span<const Vector3> points,
                                               std::span<const std::array<index_t, 3>> triangles) {
  std::vector<index_t> shell(points.size());
  std::iota(shell.begin(), shell.end(), index_t{0});
  const auto root = [&](index_t v) {
    while (shell[v] != v) v = shell[v] = shell[shell[v]];
    return v;
  };
  for (const auto& t : triangles)
    for (const index_t v : {t[1], t[2]}) shell[std::max(root(t[0]), root(v))] = std::min(root(t[0]), root(v));
  std::vector<double> volume(points.size(), 0.0), largest(points.size(), 0.0);
  std::vector<Vector3> beside(points.size());
  for (const auto& t : triangles) {
    const Vector3 &a = points[t[0]], &b = points[t[1]], &c = points[t[2]];
    const index_t s = root(t[0]);
    // From a corner of the shell itself, which keeps the digits.
    volume[s] += (a - points[s]).dot((b - points[s]).cross(c - points[s]));
    const Vector3 normal = (b - a).cross(c - a);
    if (normal.norm() <= largest[s]) continue;
    largest[s] = normal.norm();
    beside[s] = (a + b + c) / 3 + 0.01 * normal / std::sqrt(normal.norm());
  }
  std::vector<Vector3> inside;
  for (std::size_t s = 0; s < points.size(); ++s)
    if (volume[s] < 0) inside.push_back(beside[s]);
  return inside;
}

}  // namespace framehex::detail
