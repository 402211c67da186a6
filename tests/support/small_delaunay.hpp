// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/geometry/predicates.hpp"
#include "framehex/mesh/indexed_mesh.hpp"

#include <boost/random/uniform_real_distribution.hpp>

#include <random>

namespace framehex::test {

/// Delaunay tetrahedra of a few points in general position, straight from the definition: O(n^5).
inline IndexedTetMesh small_delaunay(const std::vector<Vector3>& points) {
  IndexedTetMesh mesh{points, {}};
  const auto n = static_cast<index_t>(points.size());
  const auto is_empty = [&](const std::array<index_t, 4>& t) {
    for (index_t v = 0; v < n; ++v) {
      if (std::find(t.begin(), t.end(), v) != t.end()) continue;
      Eigen::Matrix4d m;
      for (int i = 0; i < 4; ++i) {
        const Vector3 d = points[t[static_cast<std::size_t>(i)]] - points[v];
        m.row(i) << d.x(), d.y(), d.z(), d.squaredNorm();
      }
      if (m.determinant() < 0) return false;
    }
    return true;
  };
  for (index_t a = 0; a < n; ++a)
    for (index_t b = a + 1; b < n; ++b)
      for (index_t c = b + 1; c < n; ++c)
        for (index_t d = c + 1; d < n; ++d) {
          std::array<index_t, 4> t{a, b, c, d};
          const int side = orientation(points[a], points[b], points[c], points[d]);
          if (side == 0) continue;
          if (side < 0) std::swap(t[2], t[3]);
          if (is_empty(t)) mesh.tets.push_back(t);
        }
  return mesh;
}

/// Points of an nx x ny x nz lattice of side 1, each moved by up to `jitter` in each direction.
inline std::vector<Vector3> jittered_lattice(index_t nx, index_t ny, index_t nz, double jitter,
                                             std::mt19937_64& engine) {
  boost::random::uniform_real_distribution<> shift(-jitter, jitter);
  std::vector<Vector3> points;
  for (index_t k = 0; k < nz; ++k)
    for (index_t j = 0; j < ny; ++j)
      for (index_t i = 0; i < nx; ++i) {
        const double x = shift(engine), y = shift(engine), z = shift(engine);
        points.emplace_back(i + x, j + y, k + z);
      }
  return points;
}

}  // namespace framehex::test
