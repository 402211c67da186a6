// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "support/kuhn_lattice.hpp"

#include <cmath>

namespace framehex::test {

/// A lattice of cubes over [-1, 1]^3 bent into the unit ball (n cubes along a side).
inline IndexedTetMesh ball_mesh(index_t n) {
  IndexedTetMesh mesh = kuhn_lattice(n, n, n, 2.0 / n);
  for (Vector3& p : mesh.points) {
    p -= Vector3::Ones();
    const Vector3 s = p.cwiseProduct(p);
    for (int i = 0; i < 3; ++i) {
      const double u = s[(i + 1) % 3], v = s[(i + 2) % 3];
      p[i] *= std::sqrt(1 - u / 2 - v / 2 + u * v / 3);
    }
  }
  return mesh;
}

/// A lattice of n x n x m cubes bent into a cylinder round the z axis.
inline IndexedTetMesh cylinder_mesh(index_t n, index_t m, double radius, double height) {
  IndexedTetMesh mesh = kuhn_lattice(n, n, m, 1.0);
  for (Vector3& p : mesh.points) {
    const double x = 2 * p.x() / n - 1, y = 2 * p.y() / n - 1;
    p = {radius * x * std::sqrt(1 - y * y / 2), radius * y * std::sqrt(1 - x * x / 2), height * p.z() / m};
  }
  return mesh;
}

}  // namespace framehex::test
