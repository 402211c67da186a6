// SPDX-License-Identifier: BSL-1.0
// A host's program: includes everything in two translation units, so that a function that is not inline fails to link.
#include <framehex/framehex.hpp>

std::size_t n_boundary_triangles(const framehex::IndexedTetMesh& mesh);

int main() {
  const framehex::IndexedTetMesh mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 1, 2, 3}}};
  framehex::validate(mesh);
  return n_boundary_triangles(mesh) == 4 ? 0 : 1;
}
