// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "support/kuhn_lattice.hpp"

#include <cmath>

namespace framehex::test {

/// A lattice of cubes over [-1, 1]^3 bent into the unit ball (n cubes along a side).
///
/// @param fill  scales the lattice before it is bent. Of a whole one (1) the twelve edges become flat, and beyond n of
///              about 20 their tetrahedra with them; 0.95 leaves a nearly round cushion that is sound for any n.
inline IndexedTetMesh ball_mesh(index_t n, double fill = 1) {
  IndexedTetMesh mesh = kuhn_lattice(n, n, n, 2.0 / n);
  for (Vector3& p : mesh.points) {
    p = fill * (p - Vector3::Ones());
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

/// A half ball of radius 1 on a slab of 3 x 3 x 1, as the paper's dome: n cubes (even) across the ball.
inline IndexedTetMesh dome_mesh(index_t n) {
  IndexedTetMesh mesh = kuhn_lattice(2 * n, 2 * n, n, 2.0 / n);
  const double below = 2.0 / n * (n / 2);
  std::erase_if(mesh.tets, [&](const auto& t) {
    Vector3 c = Vector3::Zero();
    for (const index_t v : t) c += mesh.points[v] / 4;
    return c.z() > below && (std::abs(c.x() - 2) > 1 || std::abs(c.y() - 2) > 1);
  });
  for (Vector3& p : mesh.points) {
    // The ball's square section covers [-1, 1]^2 of the lattice, the slab [-2, 2]^2.
    const Vector3 q = p - Vector3(2, 2, below);
    const double ring = std::max({1.0, std::abs(q.x()), std::abs(q.y())}), x = q.x() / ring, y = q.y() / ring,
                 w = std::max(0.0, q.z());
    const auto bend = [&](double a, double b, double c) {
      return a * std::sqrt(1 - b * b / 2 - c * c / 2 + b * b * c * c / 3);
    };
    p = {bend(x, y, w), bend(y, x, w), q.z() > 0 ? bend(w, x, y) : q.z()};
    p.x() += (ring - 1) * (1.5 * x - p.x());
    p.y() += (ring - 1) * (1.5 * y - p.y());
  }
  return mesh;
}

}  // namespace framehex::test
