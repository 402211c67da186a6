// SPDX-License-Identifier: BSL-1.0
// A host's program that includes one stage only.
#include <framehex/mesh/boundary.hpp>
#include <framehex/mesh/indexed_mesh.hpp>

int main() {
  const framehex::IndexedTetMesh mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 1, 2, 3}}};
  const framehex::TetAdjacency adjacency = framehex::make_adjacency(mesh);
  return framehex::extract_boundary(mesh, adjacency).surface.triangles.size() == 4 ? 0 : 1;
}
