// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "bytes.hpp"
#include "support/kuhn_lattice.hpp"

namespace framehex::test {

/// Up to 4 x 3 x 3 cubes of tetrahedra, of which some are left out, with points moved out of their places: by so little
/// that the tetrahedra stay what they are, or by so much that some turn over. Parts may touch in an edge or a vertex.
inline IndexedTetMesh polycube(Bytes& bytes) {
  const index_t nx = 1 + bytes.below(4), ny = 1 + bytes.below(3), nz = 1 + bytes.below(3);
  IndexedTetMesh mesh = kuhn_lattice(nx, ny, nz);
  std::vector<std::array<index_t, 4>> kept;
  for (std::size_t cube = 0; 6 * cube < mesh.tets.size(); ++cube) {
    if (cube > 0 && bytes.below(4) == 3) continue;
    for (std::size_t i = 0; i < 6; ++i) kept.push_back(mesh.tets[6 * cube + i]);
  }
  mesh.tets = std::move(kept);
  const double amplitude = std::array{0.0, 1e-9, 0.05, 0.2, 0.45}[bytes.below(5)];
  if (amplitude > 0)
    for (Vector3& p : mesh.points) p += amplitude * Vector3{bytes.unit(), bytes.unit(), bytes.unit()};
  return mesh;
}

}  // namespace framehex::test
