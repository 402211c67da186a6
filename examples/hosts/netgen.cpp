// SPDX-License-Identifier: BSL-1.0
// Netgen fills a cube whose surface has short edges; its tetrahedra are recombined where they lie.
#include <framehex/adapters/netgen.hpp>
#include <framehex/geometry/size_field.hpp>
#include <framehex/io/vtu_writer.hpp>
#include <framehex/pipeline/recombine.hpp>
#include <framehex/surface/refinement.hpp>

#include <cstdio>

using namespace nglib;

int main() {
  const framehex::IndexedTriangleMesh cube{
      {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {0, 0, 1}, {1, 0, 1}, {0, 1, 1}, {1, 1, 1}},
      {{0, 2, 3},
       {0, 3, 1},
       {4, 5, 7},
       {4, 7, 6},
       {0, 1, 5},
       {0, 5, 4},
       {2, 6, 7},
       {2, 7, 3},
       {0, 4, 6},
       {0, 6, 2},
       {1, 3, 7},
       {1, 7, 5}}};
  const framehex::RefinedSurface fine = framehex::refine(framehex::Surface(cube), framehex::ConstantSize{0.3});

  Ng_Init();
  Ng_Mesh* const mesh = Ng_NewMesh();
  for (framehex::Vector3 p : fine.surface.points) Ng_AddPoint(mesh, p.data());
  for (const auto& t : fine.surface.triangles()) {
    int v[3] = {static_cast<int>(t[0]) + 1, static_cast<int>(t[1]) + 1, static_cast<int>(t[2]) + 1};
    Ng_AddSurfaceElement(mesh, NG_TRIG, v);
  }
  Ng_Meshing_Parameters parameters;
  parameters.maxh = 0.3;
  if (Ng_GenerateVolumeMesh(mesh, &parameters) != NG_OK) return 1;

  const framehex::NetgenTets tets(*mesh);
  const auto result = framehex::recombine(tets);
  std::printf("%d tetrahedra became %zu cells\n", tets.n_cells(), result.mesh.n_cells());
  framehex::write_vtu("netgen.vtu", result.mesh);
  Ng_DeleteMesh(mesh);
  Ng_Exit();
}
