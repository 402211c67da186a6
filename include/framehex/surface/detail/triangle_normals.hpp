// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/mesh/adjacency.hpp"

#include <numeric>
#include <span>

namespace framehex::detail {

/// Unit normals of triangles. One without area (height below 1e-9 of its longest edge) takes the normal across its
/// longest edge, from which it cannot be told apart; zero when there is none to take.
inline std::vector<Vector3> triangle_normals(std::span<const Vector3> points, const TriangleAdjacency& adjacency) {
  const std::size_t n = adjacency.triangles.size();
  std::vector<Vector3> normals(n, Vector3::Zero());
  std::vector<index_t> flat;
  const auto longest = [&](index_t t) {
    index_t best = 3 * t;
    double length = -1;
    for (index_t h = 3 * t; h < 3 * t + 3; ++h) {
      const double l = (points[adjacency.to(h)] - points[adjacency.from(h)]).squaredNorm();
      if (l > length) {
        length = l;
        best = h;
      }
    }
    return std::pair(best, length);
  };
  for (index_t t = 0; t < n; ++t) {
    const auto& v = adjacency.triangles[t];
    const Vector3 normal = (points[v[1]] - points[v[0]]).cross(points[v[2]] - points[v[0]]);
    const double area = normal.norm();
    if (area > 1e-9 * longest(t).second)
      normals[t] = normal / area;
    else
      flat.push_back(t);
  }
  // Flat triangles may lie side by side: repeat while one more can be settled. Each is settled once, so this ends.
  for (bool again = !flat.empty(); again;) {
    again = false;
    for (const index_t t : flat) {
      if (!normals[t].isZero()) continue;
      const index_t other = adjacency.opposite[longest(t).first];
      if (other == no_index || normals[other / 3].isZero()) continue;
      normals[t] = normals[other / 3];
      again = true;
    }
  }
  return normals;
}

}  // namespace framehex::detail
