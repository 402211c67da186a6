// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/mesh/mixed_mesh.hpp"

namespace framehex::test {

/// One cell of each kind, conforming: a unit cube, a prism beside it (volume 1/2), a pyramid above it (1/3), and a
/// tetrahedron against a triangle of the pyramid (1/6), with labels of every sort.
inline MixedMesh four_cells() {
  MixedMesh mesh;
  mesh.points = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1},
                 {1, 1, 1}, {0, 1, 1}, {2, 0, 0}, {2, 0, 1}, {0, 0, 2}, {-1, 0, 1}};
  const auto add = [&](CellKind kind, std::initializer_list<index_t> corners) {
    mesh.add(kind, std::span(corners.begin(), corners.size()));
  };
  add(CellKind::hexahedron, {0, 1, 2, 3, 4, 5, 6, 7});
  add(CellKind::prism, {1, 8, 2, 5, 9, 6});
  add(CellKind::pyramid, {4, 5, 6, 7, 10});
  add(CellKind::tetrahedron, {4, 10, 7, 11});
  mesh.regions = {0, 0, 2, 1};
  mesh.faces = {{{0, 3, 2, 1}, 0}, {{1, 2, 8, no_index}, 0}, {{5, 9, 6, no_index}, 3}};
  mesh.edges = {{{0, 1}, 0}, {{1, 8}, 4}};
  return mesh;
}

}  // namespace framehex::test
