// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/mesh/indexed_mesh.hpp"

#include <array>

namespace framehex::test {

/// nx x ny x nz cubes of side h, each cut alike into the six tetrahedra round its diagonal (0,0,0)-(1,1,1).
inline IndexedTetMesh kuhn_lattice(index_t nx, index_t ny, index_t nz, double h = 1.0) {
  IndexedTetMesh mesh;
  const auto vertex = [&](index_t i, index_t j, index_t k) { return i + (nx + 1) * (j + (ny + 1) * k); };
  for (index_t k = 0; k <= nz; ++k)
    for (index_t j = 0; j <= ny; ++j)
      for (index_t i = 0; i <= nx; ++i) mesh.points.emplace_back(h * i, h * j, h * k);
  // One tetrahedron for each order in which the three steps from corner to corner are taken; odd orders are mirrored.
  constexpr std::array<std::array<int, 3>, 6> orders{
      {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}}};
  for (index_t k = 0; k < nz; ++k)
    for (index_t j = 0; j < ny; ++j)
      for (index_t i = 0; i < nx; ++i)
        for (std::size_t o = 0; o < 6; ++o) {
          std::array<index_t, 3> at{i, j, k};
          std::array<index_t, 4> tet{};
          tet[0] = vertex(at[0], at[1], at[2]);
          for (std::size_t step = 0; step < 3; ++step) {
            ++at[static_cast<std::size_t>(orders[o][step])];
            tet[step + 1] = vertex(at[0], at[1], at[2]);
          }
          if (o >= 3) std::swap(tet[2], tet[3]);
          mesh.tets.push_back(tet);
        }
  return mesh;
}

inline IndexedTetMesh kuhn_lattice(index_t n) {
  return kuhn_lattice(n, n, n);
}

}  // namespace framehex::test
