// SPDX-License-Identifier: BSL-1.0
// Meshes surfaces in both orders of points, and writes what comes out, bit by bit: mesh SURFACE SIZE ... RESULT

#include "framehex/adapters/tetgen_process.hpp"
#include "framehex/pipeline/mesh_surface.hpp"
#include "support/ply.hpp"
#include "support/stl.hpp"

#include <fstream>

using namespace framehex;

namespace {

template <class T>
void write(std::ofstream& file, const std::vector<T>& values) {
  file.write(reinterpret_cast<const char*>(values.data()), static_cast<std::streamsize>(values.size() * sizeof(T)));
}

void write(std::ofstream& file, const MeshingResult& result) {
  const MixedMesh& mesh = result.recombination.mesh;
  write(file, mesh.points);
  write(file, mesh.kinds);
  write(file, mesh.cells.values);
  write(file, mesh.faces);
  write(file, mesh.edges);
  write(file, result.smoothness);
}

}  // namespace

int main(int n_arguments, char** arguments) {
  std::ofstream file(arguments[n_arguments - 1], std::ios::binary);
  for (int i = 1; i + 1 < n_arguments; i += 2) {
    const std::string path = arguments[i];
    const IndexedTriangleMesh surface = path.ends_with(".stl") ? test::read_stl(path) : test::read_ply(path);
    const ConstantSize size{std::stod(arguments[i + 1])};
    for (const PointOrder order : {PointOrder::smoothness, PointOrder::lattice})
      write(file, mesh_surface(surface, size, TetgenProcess{}, {.order = order}));
  }
  return file.flush() ? 0 : 1;
}
