// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/mesh/indexed_mesh.hpp"

#include <cmath>
#include <numbers>

namespace framehex::test {

/// n tetrahedra round one edge: valence n of two vertices.
inline IndexedTetMesh fan(index_t n) {
  IndexedTetMesh mesh{{{0, 0, -1}, {0, 0, 1}}, {}};
  for (index_t i = 0; i < n; ++i) {
    const double angle = 2 * std::numbers::pi * i / n;
    mesh.points.emplace_back(std::cos(angle), std::sin(angle), 0.01 * (i % 3));
    mesh.tets.push_back({0, 1, 2 + i, 2 + (i + 1) % n});
  }
  return mesh;
}

/// The centre of a sphere against n bands of 2 n triangles: one vertex with 4 n (n - 1) tetrahedra, 2 n of
/// them round each of two edges.
inline IndexedTetMesh banded_star(index_t n) {
  IndexedTetMesh mesh{{{0, 0, 0}, {0, 0, -1}, {0, 0, 1}}, {}};
  const auto at = [n](index_t band, index_t i) {
    return band == 0 ? 1 : band == n ? 2 : 3 + (band - 1) * 2 * n + i % (2 * n);
  };
  for (index_t band = 1; band < n; ++band)
    for (index_t i = 0; i < 2 * n; ++i) {
      const double polar = std::numbers::pi * band / n, angle = std::numbers::pi * i / n;
      mesh.points.emplace_back(std::sin(polar) * std::cos(angle), std::sin(polar) * std::sin(angle), -std::cos(polar));
    }
  for (index_t band = 0; band < n; ++band)
    for (index_t i = 0; i < 2 * n; ++i) {
      if (band > 0) mesh.tets.push_back({0, at(band, i), at(band, i + 1), at(band + 1, i + 1)});
      if (band + 1 < n) mesh.tets.push_back({0, at(band, i), at(band + 1, i + 1), at(band + 1, i)});
    }
  return mesh;
}

}  // namespace framehex::test
