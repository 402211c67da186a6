// SPDX-License-Identifier: BSL-1.0
// A host with raw arrays: its mesh is adapted in a dozen lines, then framehex runs on it where it lies.
#include "framehex/field/compute_frame_field.hpp"
#include "framehex/io/vtu_writer.hpp"
#include "framehex/pipeline/recombine.hpp"

#include <cstdio>

struct OwnMesh {
  std::vector<float> xyz;  // three a vertex
  std::vector<int> tets;   // four vertices a tetrahedron
};

template <>
struct framehex::mesh_traits<OwnMesh> {
  using vertex_type = int;
  using cell_type = int;
  using scalar_type = float;
  static auto vertices(const OwnMesh& m) { return std::views::iota(0, static_cast<int>(m.xyz.size() / 3)); }
  static auto cells(const OwnMesh& m) { return std::views::iota(0, static_cast<int>(m.tets.size() / 4)); }
  static std::size_t index(const OwnMesh&, int v) { return static_cast<std::size_t>(v); }
  static std::array<float, 3> point(const OwnMesh& m, int v) {
    const float* const p = m.xyz.data() + 3 * v;
    return {p[0], p[1], p[2]};
  }
  static std::array<int, 4> cell_vertices(const OwnMesh& m, int c) {
    const int* const t = m.tets.data() + 4 * c;
    return {t[0], t[1], t[2], t[3]};
  }
};
static_assert(framehex::TetMesh<OwnMesh>);

/// n^3 cubes, each cut into six tetrahedra round a diagonal.
OwnMesh make_mesh(int n) {
  OwnMesh mesh;
  const auto vertex = [n](int i, int j, int k) { return i + (n + 1) * (j + (n + 1) * k); };
  for (int k = 0; k <= n; ++k)
    for (int j = 0; j <= n; ++j)
      for (int i = 0; i <= n; ++i)
        mesh.xyz.insert(mesh.xyz.end(), {static_cast<float>(i), static_cast<float>(j), static_cast<float>(k)});
  for (int k = 0; k < n; ++k)
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) {
        const int a = vertex(i, j, k), g = vertex(i + 1, j + 1, k + 1);
        // The six other corners in a ring about the diagonal from a to g.
        const int ring[7] = {vertex(i + 1, j, k), vertex(i + 1, j + 1, k), vertex(i, j + 1, k), vertex(i, j + 1, k + 1),
                             vertex(i, j, k + 1), vertex(i + 1, j, k + 1), vertex(i + 1, j, k)};
        for (int r = 0; r < 6; ++r) mesh.tets.insert(mesh.tets.end(), {a, ring[r], ring[r + 1], g});
      }
  return mesh;
}

int main(int argc, char** argv) {
  const OwnMesh mesh = make_mesh(4);
  const auto field = framehex::compute_frame_field(mesh);
  const framehex::Recombination result = framehex::recombine(mesh, {.finder = {.quality_floor = 0.2}});
  std::size_t n_hexahedra = 0;
  for (const framehex::CellKind kind : result.mesh.kinds) n_hexahedra += kind == framehex::CellKind::hexahedron;
  std::printf("smoothness of vertex 0: %.3f; %zu tetrahedra became %zu cells, %zu of them hexahedra\n",
              field.smoothness()[0], mesh.tets.size() / 4, result.mesh.n_cells(), n_hexahedra);
  if (argc > 1) try {
      framehex::write_vtu(argv[1], result.mesh);
    } catch (const framehex::io_error& e) {
      std::fprintf(stderr, "%s\n", e.what());
      return 2;
    }
}
