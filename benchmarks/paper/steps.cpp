// SPDX-License-Identifier: BSL-1.0
// What steps that the program has no option for are worth, as JSON: lattice links and relaxation of the fronts, and the
// search for every hexahedron against the paper's three patterns on the same tetrahedra.
//   paper_steps SURFACE SIZE
//   paper_steps --graph SURFACE SIZE     a row of the paper's Table 1 instead: tetrahedra, candidates and their conflicts
#include "framehex/adapters/tetgen_process.hpp"
#include "framehex/io/surface_reader.hpp"
#include "framehex/pipeline/detail/better_mesh.hpp"
#include "framehex/pipeline/mesh_surface.hpp"
#include "framehex/recombination/pattern_search.hpp"
#include "framehex/selection/conflict_search.hpp"
#include "framehex/verify/conformity.hpp"

#include <sys/resource.h>

#include <cstdlib>
#include <iostream>
#include <string_view>

using namespace framehex;

namespace {

/// Of this process and of the tetrahedralisers it has waited for.
double cpu_seconds() {
  double sum = 0;
  for (const auto who : {RUSAGE_SELF, RUSAGE_CHILDREN}) {
    rusage usage{};
    getrusage(who, &usage);
    for (const timeval& t : {usage.ru_utime, usage.ru_stime})
      sum += static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  }
  return sum;
}

double percent(double part, double whole) {
  return 100 * part / whole;
}

std::string_view separator = "{\n";

/// Runs one variant and prints its row; `mesh_of` returns the mesh and what else the row says, as JSON members.
template <class Make>
void print_row(const std::string& variant, Make&& mesh_of) {
  const double start = cpu_seconds();
  const auto [mesh, more] = mesh_of();
  const double seconds = cpu_seconds() - start;
  const auto is_hexahedron = [](CellKind kind) { return kind == CellKind::hexahedron; };
  const auto n_hexahedra = std::ranges::count_if(mesh.kinds, is_hexahedron);
  std::array<Vector3, 8> corners;
  double least = 1;
  for (std::size_t c = 0; c < mesh.n_cells(); ++c) {
    const auto row = mesh.cells[c];
    for (std::size_t i = 0; i < row.size(); ++i) corners[i] = mesh.points[row[i]];
    least = std::min(least, scaled_jacobian(mesh.kinds[c], std::span(corners).first(row.size())));
  }
  const verify::ConformityReport conformity = verify::is_conforming(mesh);
  std::cout << std::exchange(separator, ",\n") << "  \"" << variant << "\": {\"cells\": " << mesh.n_cells()
            << ", \"hex_number\": " << percent(static_cast<double>(n_hexahedra), static_cast<double>(mesh.n_cells()))
            << ", \"hex_volume\": " << 100 * detail::share_of_hexahedra(mesh) << ", \"least\": " << least
            << ", \"open\": " << conformity.open_quadrilaterals.size() << ", \"cpu\": " << seconds << more << "}"
            << std::flush;
}

/// Remembers the last mesh that a tetrahedraliser made: the one that is recombined.
class Remembering {
public:
  TetrahedralizationResult operator()(const TetrahedralizationRequest& request) const {
    TetrahedralizationResult result = tetgen_(request);
    last_ = {{request.points.begin(), request.points.end()}, result.tets};
    last_.points.insert(last_.points.end(), result.extra_points.begin(), result.extra_points.end());
    return result;
  }

  const IndexedTetMesh& last() const { return last_; }

private:
  TetgenProcess tetgen_;
  mutable IndexedTetMesh last_;
};

/// As `recombine` does it, from whatever hexahedra were found; without labels, so that no vertex of the boundary moves.
MixedMesh recombine_found(const IndexedTetMesh& mesh, const TetAdjacency& adjacency, PotentialHexahedra found) {
  const Selection selection = select(ImplicitIncompatibilityGraph(found, volume_times_quality(found)),
                                     RecombineOptions{}.selection, SerialExecutor{});
  found = detail::chosen(found, selection.members);
  std::vector<index_t> all(found.size());
  std::iota(all.begin(), all.end(), index_t{0});
  const auto assemble_chosen = [&](std::span<const index_t> selected, const AssemblyOptions& how) {
    return assemble(mesh, adjacency, found, selected, how);
  };
  return detail::assemble_soundly(assemble_chosen, adjacency, found, std::move(all), AssemblyOptions{}).assembly.mesh;
}

void compare_searches(const IndexedTetMesh& mesh) {
  const TetAdjacency adjacency = make_adjacency(mesh);
  const FinderOptions options{.input_check = InputCheck::skip, .adjacency = &adjacency};
  const auto row = [&](const std::string& variant, auto&& search) {
    print_row(variant, [&] {
      PotentialHexahedra found = search();
      const std::string more = ", \"candidates\": " + std::to_string(found.size());
      return std::pair(recombine_found(mesh, adjacency, std::move(found)), more);
    });
  };
  row("every hexahedron", [&] { return find_potential_hexahedra(mesh, options); });
  row("three patterns", [&] { return find_pattern_hexahedra(mesh, options); });
}

/// By the paper's floor.
void print_graph(const IndexedTetMesh& mesh) {
  const PotentialHexahedra found = find_potential_hexahedra(mesh, {.quality_floor = 0.25});
  const GraphStatistics graph = statistics(build_incompatibility_graph(found));
  std::cout << "{\"tetrahedra\": " << mesh.tets.size() << ", \"hexahedra\": " << graph.n_candidates
            << ", \"degree\": " << graph.mean_degree << "}\n";
}

}  // namespace

int main(int n_arguments, char** arguments) {
  const bool graph_alone = n_arguments == 4 && std::string_view(arguments[1]) == "--graph";
  if (n_arguments != 3 && !graph_alone) {
    std::cerr << "usage: paper_steps [--graph] SURFACE SIZE\n";
    return 2;
  }
  try {
    const IndexedTriangleMesh surface = read_surface(arguments[n_arguments - 2]).surface;
    const double h = std::strtod(arguments[n_arguments - 1], nullptr);
    const auto size = [h](const Vector3&) { return h; };
    const Remembering tetgen;
    const auto row = [&](const std::string& variant, const MeshingOptions& options) {
      print_row(variant, [&] {
        MeshingResult result = mesh_surface(surface, size, tetgen, options);
        return std::pair(std::move(result.recombination.mesh), std::string());
      });
    };
    // Sizes that shrink at poor cells would hide what a step is worth.
    const MeshingOptions fronts{.order = PointOrder::smoothness, .least_quality = 0};
    if (graph_alone) {
      mesh_surface(surface, size, tetgen, fronts);
      print_graph(tetgen.last());
      return 0;
    }
    row("fronts", fronts);
    compare_searches(tetgen.last());
    MeshingOptions no_rounds = fronts;
    no_rounds.surface.rounds = no_rounds.volume.rounds = 0;
    row("fronts, no relaxation", no_rounds);
    MeshingOptions no_links = no_rounds;  // which relaxation goes by
    no_links.surface.link_distance = no_links.volume.link_distance = 0;
    no_links.surface.averaging = no_links.volume.averaging = ParentAveraging::none;
    row("fronts, no links", no_links);
    std::cout << "\n}\n";
  } catch (const std::exception& failure) {
    std::cerr << failure.what() << "\n";
    return 1;
  }
}
