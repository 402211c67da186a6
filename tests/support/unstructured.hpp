// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/adapters/tetgen_process.hpp"

#include <numbers>

namespace framehex::test {

/// Cylinder about z with lids of m rings: 6 m vertices round it, and layers of triangles about as high as wide.
inline IndexedTriangleMesh ringed_cylinder_surface(double radius, double height, index_t m) {
  const index_t around = 6 * m, inside = 3 * m * (m - 1) + 1;
  const auto layers = static_cast<index_t>(std::lround(height * around / (2 * std::numbers::pi * radius)));
  IndexedTriangleMesh mesh;
  const auto ring = [&](index_t j, double z) {
    for (index_t i = 0; i < 6 * j; ++i) {
      const double angle = std::numbers::pi * i / (3 * j), r = radius * j / m;
      mesh.points.emplace_back(r * std::cos(angle), r * std::sin(angle), z);
    }
  };
  for (index_t k = 0; k <= layers; ++k) ring(m, height * k / layers);
  for (index_t k = 0; k < layers; ++k)
    for (index_t i = 0; i < around; ++i) {
      const index_t a = k * around + i, b = k * around + (i + 1) % around, c = b + around, d = a + around;
      mesh.triangles.push_back({a, b, c});
      mesh.triangles.push_back({a, c, d});
    }
  for (const index_t lid : {index_t{0}, layers}) {
    const auto first = static_cast<index_t>(mesh.points.size());
    mesh.points.emplace_back(0, 0, height * lid / layers);
    for (index_t j = 1; j < m; ++j) ring(j, height * lid / layers);
    const auto at = [&](index_t j, index_t i) {
      if (j == 0) return first;
      return j == m ? lid * around + i % around : first + 1 + 3 * j * (j - 1) + i % (6 * j);
    };
    const auto add = [&](index_t a, index_t b, index_t c) {
      if (lid == 0) std::swap(b, c);
      mesh.triangles.push_back({a, b, c});
    };
    for (index_t j = 1; j <= m; ++j)
      for (index_t sector = 0; sector < 6; ++sector)
        for (index_t i = 0; i < j; ++i) {
          const index_t outer = sector * j + i, inner = sector * (j - 1) + i;
          add(at(j - 1, inner), at(j, outer), at(j, outer + 1));
          if (i + 1 < j) add(at(j - 1, inner), at(j, outer + 1), at(j - 1, inner + 1));
        }
    if (mesh.points.size() != first + inside) throw std::logic_error("a lid of the cylinder is not as planned");
  }
  return mesh;
}

/// Fills a surface with tetrahedra of a greatest volume by TetGen, which adds vertices inside.
inline IndexedTetMesh filled(IndexedTriangleMesh surface, double volume) {
  const TetgenProcess tetgen{.switches = "-pq1.5Ya" + std::to_string(volume) + "BFQ"};
  const std::size_t n = surface.points.size();
  const auto result = tetgen({.points = surface.points, .n_surface_points = n, .triangles = surface.triangles});
  IndexedTetMesh mesh{.points = std::move(surface.points), .tets = result.tets};
  mesh.points.insert(mesh.points.end(), result.extra_points.begin(), result.extra_points.end());
  for (auto& t : mesh.tets)
    if (orientation(mesh.points[t[0]], mesh.points[t[1]], mesh.points[t[2]], mesh.points[t[3]]) < 0)
      std::swap(t[2], t[3]);
  return mesh;
}

}  // namespace framehex::test
