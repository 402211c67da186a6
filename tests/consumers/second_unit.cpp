// SPDX-License-Identifier: BSL-1.0
#include <framehex/framehex.hpp>

std::size_t n_boundary_triangles(const framehex::IndexedTetMesh& mesh) {
  return framehex::extract_boundary(mesh, framehex::make_adjacency(mesh)).surface.triangles.size();
}
