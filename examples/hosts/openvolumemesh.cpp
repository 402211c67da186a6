// SPDX-License-Identifier: BSL-1.0
// A tetrahedral mesh of OpenVolumeMesh, recombined into a polyhedral one.
#include <framehex/adapters/openvolumemesh.hpp>
#include <framehex/pipeline/recombine_into.hpp>

#include <cstdio>

int main() {
  OpenVolumeMesh::GeometricTetrahedralMeshV3d tets;
  OpenVolumeMesh::VertexHandle v[8];
  for (int i = 0; i < 8; ++i) v[i] = tets.add_vertex(OpenVolumeMesh::Vec3d(i & 1, i >> 1 & 1, i >> 2 & 1));
  const int ring[7] = {1, 3, 2, 6, 4, 5, 1};  // round the diagonal of the cube
  for (int r = 0; r < 6; ++r) tets.add_cell({v[0], v[ring[r]], v[ring[r + 1]], v[7]});

  OpenVolumeMesh::GeometricPolyhedralMeshV3d mixed;
  framehex::OpenVolumeMeshOutput output(mixed);
  framehex::recombine_into(output, tets);
  std::printf("%d tetrahedra became %d cells\n", static_cast<int>(tets.n_cells()), static_cast<int>(mixed.n_cells()));
}
