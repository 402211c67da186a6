// SPDX-License-Identifier: BSL-1.0
// Netgen fills a cube; its tetrahedra are recombined where they lie.
#include <framehex/adapters/netgen.hpp>
#include <framehex/io/vtu_writer.hpp>
#include <framehex/pipeline/recombine.hpp>

#include <cstdio>

using namespace nglib;

int main() {
  Ng_Init();
  Ng_Mesh* const mesh = Ng_NewMesh();
  for (int i = 0; i < 8; ++i) {
    double p[3] = {i & 1 ? 1. : 0., i & 2 ? 1. : 0., i & 4 ? 1. : 0.};
    Ng_AddPoint(mesh, p);
  }
  const int sides[6][4] = {{1, 3, 4, 2}, {5, 6, 8, 7}, {1, 2, 6, 5}, {3, 7, 8, 4}, {1, 5, 7, 3}, {2, 4, 8, 6}};
  for (const auto& s : sides)
    for (int half = 1; half < 3; ++half) {
      int v[3] = {s[0], s[half], s[half + 1]};
      Ng_AddSurfaceElement(mesh, NG_TRIG, v);
    }
  Ng_Meshing_Parameters parameters;
  parameters.maxh = 0.2;
  if (Ng_GenerateVolumeMesh(mesh, &parameters) != NG_OK) return 1;

  const framehex::NetgenTets tets(*mesh);
  const auto result = framehex::recombine(tets);
  std::printf("%d tetrahedra became %zu cells\n", tets.n_cells(), result.mesh.n_cells());
  framehex::write_vtu("netgen.vtu", result.mesh);
  Ng_DeleteMesh(mesh);
  Ng_Exit();
}
