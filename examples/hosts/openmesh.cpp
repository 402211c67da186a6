// SPDX-License-Identifier: BSL-1.0
// A surface of OpenMesh, filled; the boundary of the result as a polygon mesh of OpenMesh.
#include <framehex/adapters/openmesh.hpp>
#include <framehex/adapters/tetgen_process.hpp>
#include <framehex/io/vtu_writer.hpp>
#include <framehex/pipeline/mesh_surface.hpp>

#include <cstdio>

struct Traits : OpenMesh::DefaultTraits {
  using Point = OpenMesh::Vec3d;
};
using TriMesh = OpenMesh::TriMesh_ArrayKernelT<Traits>;
using PolyMesh = OpenMesh::PolyMesh_ArrayKernelT<Traits>;

TriMesh make_cube() {
  TriMesh mesh;
  OpenMesh::VertexHandle v[8];
  for (int i = 0; i < 8; ++i) v[i] = mesh.add_vertex(OpenMesh::Vec3d(i & 1, i >> 1 & 1, i >> 2 & 1));
  const int sides[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  for (const auto& s : sides) {
    mesh.add_face(v[s[0]], v[s[1]], v[s[2]]);
    mesh.add_face(v[s[0]], v[s[2]], v[s[3]]);
  }
  return mesh;
}

int main() {
  const TriMesh surface = make_cube();
  const auto result = framehex::mesh_surface(surface, framehex::ConstantSize{0.2}, framehex::TetgenProcess{});
  PolyMesh boundary;
  framehex::add_boundary(result.recombination.mesh, boundary);
  std::printf("%zu cells inside; the boundary has %zu faces\n", result.recombination.mesh.n_cells(),
              boundary.n_faces());
  framehex::write_vtu("openmesh.vtu", result.recombination.mesh);
}
