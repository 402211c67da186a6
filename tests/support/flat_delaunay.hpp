// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/geometry/predicates.hpp"
#include "framehex/mesh/indexed_mesh.hpp"

#include <boost/random/uniform_real_distribution.hpp>

#include <random>

namespace framehex::test {

/// Random points of the unit square in the plane z = 0.
inline std::vector<Vector3> random_flat_points(std::size_t n, std::mt19937_64& engine) {
  boost::random::uniform_real_distribution<double> coordinate(0, 1);
  std::vector<Vector3> points;
  for (std::size_t i = 0; i < n; ++i) {
    const double x = coordinate(engine), y = coordinate(engine);
    points.emplace_back(x, y, 0);
  }
  return points;
}

/// Delaunay triangles of a few points in general position, straight from the definition: O(n^4).
inline IndexedTriangleMesh flat_delaunay(std::vector<Vector3> points) {
  IndexedTriangleMesh mesh{std::move(points), {}};
  const auto& p = mesh.points;
  const auto n = static_cast<index_t>(p.size());
  for (index_t a = 0; a < n; ++a)
    for (index_t b = a + 1; b < n; ++b)
      for (index_t c = b + 1; c < n; ++c) {
        std::array<index_t, 3> t{a, b, c};
        if (projected_orientation(2, p[a], p[b], p[c]) < 0) std::swap(t[1], t[2]);
        bool empty = true;
        for (index_t v = 0; v < n && empty; ++v) {
          if (v == a || v == b || v == c) continue;
          Eigen::Matrix3d m;
          for (int i = 0; i < 3; ++i) {
            const Vector3 d = p[t[static_cast<std::size_t>(i)]] - p[v];
            m.row(i) << d.x(), d.y(), d.squaredNorm();
          }
          empty = m.determinant() <= 0;
        }
        if (empty) mesh.triangles.push_back(t);
      }
  return mesh;
}

}  // namespace framehex::test
