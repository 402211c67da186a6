// SPDX-License-Identifier: BSL-1.0
// What each step of the lattice is worth, in hexahedra of the whole pipeline: makes the ablation of docs/lattice.md.
//   g++ -std=c++20 -O2 -Iinclude -isystem /usr/include/eigen3 docs/scripts/lattice_variants.cpp -o variants
//   ./variants [OPTION=NUMBER ...] SURFACE SIZE [SURFACE SIZE ...] [-- the same again, for another variant ...]
// OPTION is any number of MeshingOptions by the name under which its range is checked, as AxisScaleOptions::longest, or
// `order` (0: first in first out, 1: smoothness, 2: lattice, the default here).
#include "framehex/adapters/tetgen_process.hpp"
#include "framehex/io/surface_reader.hpp"
#include "framehex/pipeline/mesh_surface.hpp"
#include "framehex/verify/validity.hpp"

#include <ctime>
#include <iostream>
#include <string>

using namespace framehex;

namespace {

struct Assignment {
  std::string name;
  double value;
  bool known = false;
};

/// Sets the numbers that are named.
struct Assign {
  std::vector<Assignment>& all;

  template <class Number>
  void operator()(const char* name, Number& number, double, double) const {
    for (Assignment& a : all) {
      if (a.name != name) continue;
      number = static_cast<std::remove_cvref_t<Number>>(a.value);
      a.known = true;
    }
  }
  template <class Number>
  void operator()(const char* name, std::optional<Number>& number, double, double) const {
    for (Assignment& a : all) {
      if (a.name != name) continue;
      number = static_cast<Number>(a.value);
      a.known = true;
    }
  }
};

double enclosed(const IndexedTriangleMesh& surface) {
  double sum = 0;
  for (const auto& t : surface.triangles)
    sum += surface.points[t[0]].dot(surface.points[t[1]].cross(surface.points[t[2]])) / 6;
  return sum;
}

/// The 5th, 50th and 95th percentile of the edges of hexahedra.
std::array<double, 3> edge_lengths(const MixedMesh& mesh) {
  static constexpr int ends[12][2] = {{0, 1}, {1, 2}, {2, 3}, {3, 0}, {4, 5}, {5, 6},
                                      {6, 7}, {7, 4}, {0, 4}, {1, 5}, {2, 6}, {3, 7}};
  std::vector<double> lengths;
  for (std::size_t c = 0; c < mesh.n_cells(); ++c) {
    if (mesh.kinds[c] != CellKind::hexahedron) continue;
    const auto v = mesh.cells[c];
    for (const auto& [a, b] : ends)
      lengths.push_back(
          (mesh.points[v[static_cast<std::size_t>(a)]] - mesh.points[v[static_cast<std::size_t>(b)]]).norm());
  }
  if (lengths.empty()) return {};
  std::sort(lengths.begin(), lengths.end());
  const auto at = [&](double share) {
    return lengths[static_cast<std::size_t>(share * static_cast<double>(lengths.size() - 1))];
  };
  return {at(0.05), at(0.5), at(0.95)};
}

void run(const std::string& path, double size, std::vector<Assignment>& assignments, PointOrder order) {
  const IndexedTriangleMesh surface = read_surface(path).surface;
  MeshingOptions options;
  options.order = order;
  MeshingOptions::each_number(options, Assign{assignments});
  for (const Assignment& a : assignments)
    if (!a.known) throw invalid_option("there is no option " + a.name);
  const std::clock_t start = std::clock();
  const MeshingResult result = mesh_surface(surface, ConstantSize{size}, TetgenProcess{}, options);
  const MixedMesh& mesh = result.recombination.mesh;
  const verify::VolumeReport volume = verify::volume(mesh);
  std::size_t n_hexahedra = 0;
  for (const CellKind kind : mesh.kinds) n_hexahedra += kind == CellKind::hexahedron;
  const auto [low, median, high] = edge_lengths(mesh);
  const double hexahedra = volume.by_kind[static_cast<std::size_t>(CellKind::hexahedron)];
  char line[400];
  std::snprintf(line, sizeof line,
                "%-14s %.4g | %5.1f / %6.2f | points %zu | edges %.2f %.2f %.2f | volume %+.2f %% | regular %.3f | "
                "field %.2f insertion %.2f all %.1f s",
                path.substr(path.find_last_of('/') + 1).c_str(), size,
                100.0 * static_cast<double>(n_hexahedra) / static_cast<double>(mesh.n_cells()),
                100 * hexahedra / volume.cells, mesh.points.size(), low / size, median / size, high / size,
                100 * (volume.cells / enclosed(surface) - 1), result.statistics.lattice_volume,
                result.recombination.seconds.field, result.recombination.seconds.insertion,
                static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC);
  std::cout << line << std::endl;
}

}  // namespace

int main(int argc, char** argv) {
  std::vector<Assignment> assignments;
  PointOrder order = PointOrder::lattice;
  std::vector<std::pair<std::string, double>> surfaces;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    const auto equals = word.find('=');
    if (word == "--") {
      assignments.clear();
      order = PointOrder::lattice;
    } else if (equals == std::string::npos && i + 1 < argc) {
      try {
        run(word, std::stod(argv[++i]), assignments, order);
      } catch (const std::exception& e) {
        std::cout << word << ": " << e.what() << std::endl;
      }
    } else if (word.substr(0, equals) == "order") {
      order = static_cast<PointOrder>(std::stoi(word.substr(equals + 1)));
      std::cout << word << std::endl;
    } else {
      assignments.push_back({word.substr(0, equals), std::stod(word.substr(equals + 1))});
      std::cout << word << std::endl;
    }
  }
}
