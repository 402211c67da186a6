// SPDX-License-Identifier: BSL-1.0
// Makes the tables of docs/insertion.md: what each remedy for the lattice is worth, in hexahedra of the whole pipeline.
//   g++ -std=c++20 -O2 -Iinclude -Itests -isystem /usr/include/eigen3 docs/scripts/insertion_options.cpp -o options
//   ./options [best] dome.stl 0.156 [more surfaces and sizes ...]
// The field is `best` or, without that word, `smoothed`.
#include "framehex/adapters/tetgen_process.hpp"
#include "framehex/pipeline/mesh_surface.hpp"
#include "framehex/verify/validity.hpp"
#include "support/stl.hpp"

#include <functional>
#include <iostream>
#include <string>
#include <vector>

using namespace framehex;

namespace {

struct Variant {
  std::string name;
  std::function<void(MeshingOptions&)> change;
};

void without_rounds(MeshingOptions& o) {
  o.surface.rounds = o.volume.rounds = 0;
}
void without_averaging(MeshingOptions& o) {
  o.surface.averaging = o.volume.averaging = ParentAveraging::none;
}
void without_links(MeshingOptions& o) {
  o.surface.link_distance = o.volume.link_distance = 0;
}

std::vector<Variant> variants() {
  return {
      {"default", [](MeshingOptions&) {}},
      {"no links, averaging or rounds", without_links},
      {"links", [](MeshingOptions& o) { without_rounds(o), without_averaging(o); }},
      {"links, averaging", without_rounds},
      {"links, rounds", without_averaging},
      {"no rounds on surfaces", [](MeshingOptions& o) { o.surface.rounds = 0; }},
      {"no rounds in the volume", [](MeshingOptions& o) { o.volume.rounds = 0; }},
      {"surface rejection 0.6", [](MeshingOptions& o) { o.surface.rejection = 0.6; }},
      {"surface rejection 0.7", [](MeshingOptions& o) { o.surface.rejection = 0.7; }},
      {"volume rejection 0.5", [](MeshingOptions& o) { o.volume.rejection = 0.5; }},
      {"volume rejection 0.65", [](MeshingOptions& o) { o.volume.rejection = 0.65; }},
      {"volume rejection 0.7", [](MeshingOptions& o) { o.volume.rejection = 0.7; }},
      {"FIFO", [](MeshingOptions& o) { o.order = PointOrder::fifo; }},
      {"FIFO, no links, averaging or rounds", [](MeshingOptions& o) { o.order = PointOrder::fifo, without_links(o); }},
      {"FIFO, links, averaging", [](MeshingOptions& o) { o.order = PointOrder::fifo, without_rounds(o); }},
  };
}

void run(const std::string& path, double size, FieldMethod method) {
  const IndexedTriangleMesh surface = test::read_stl(path);
  for (const Variant& variant : variants()) {
    MeshingOptions options;
    options.field.method = method;
    options.order = PointOrder::smoothness;
    variant.change(options);
    const MeshingResult result = mesh_surface(
        surface, [size](const Vector3&) { return size; }, TetgenProcess{}, options);
    const MixedMesh& mesh = result.recombination.mesh;
    const verify::VolumeReport volume = verify::volume(mesh);
    const auto hexahedron = static_cast<std::size_t>(CellKind::hexahedron);
    std::size_t n_hexahedra = 0;
    for (const CellKind kind : mesh.kinds) n_hexahedra += kind == CellKind::hexahedron;
    std::cout << path << " | " << variant.name << " | "
              << 100.0 * static_cast<double>(n_hexahedra) / static_cast<double>(mesh.n_cells()) << " | "
              << 100 * volume.by_kind[hexahedron] / volume.cells << " | " << result.recombination.n_candidates
              << std::endl;
  }
}

}  // namespace

int main(int argc, char** argv) {
  std::cout << "model | variant | hexahedra % | by volume % | candidates" << std::endl;
  const bool best = argc > 1 && std::string(argv[1]) == "best";
  for (int i = best ? 2 : 1; i + 1 < argc; i += 2)
    run(argv[i], std::stod(argv[i + 1]), best ? FieldMethod::best : FieldMethod::smoothed);
}
