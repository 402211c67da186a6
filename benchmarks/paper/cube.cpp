// SPDX-License-Identifier: BSL-1.0
// The paper's Table 1 and Fig. 2 on lattices of cubes, as JSON; the two meshes of Fig. 2 are written as pages.
//   paper_cube [FOLDER]     folder for best.html and worse.html; without it, only the numbers
#include "framehex/assembly/assemble.hpp"
#include "framehex/io/html_writer.hpp"
#include "framehex/recombination/potential_hex_finder.hpp"
#include "framehex/selection/tomita.hpp"
#include "support/delaunay_lattice.hpp"
#include "support/kuhn_lattice.hpp"

#include <filesystem>
#include <iostream>

using namespace framehex;

namespace {

constexpr double quality_floor = 0.25;

struct Candidates {
  IndexedTetMesh mesh;
  PotentialHexahedra hexahedra;
  IncompatibilityGraph graph;

  explicit Candidates(IndexedTetMesh tets)
      : mesh(std::move(tets)),
        hexahedra(find_potential_hexahedra(mesh, {.quality_floor = quality_floor})),
        graph(build_incompatibility_graph(hexahedra)) {}
};

std::string list(std::span<const index_t> values) {
  std::string text;
  for (const index_t v : values) text += (text.empty() ? "" : ", ") + std::to_string(v);
  return "[" + text + "]";
}

/// One line for each lattice: how cubes are cut (bias 0: by chance), its tetrahedra, candidates and their conflicts.
void print_table_1() {
  std::cout << "  \"table_1\": [";
  bool first = true;
  const auto row = [&](index_t n, const std::string& ties, IndexedTetMesh mesh) {
    const Candidates c(std::move(mesh));
    const GraphStatistics s = statistics(c.graph);
    std::cout << (first ? "\n" : ",\n") << "    {\"cubes\": " << n << ", \"ties\": \"" << ties
              << "\", \"tetrahedra\": " << c.mesh.tets.size() << ", \"hexahedra\": " << s.n_candidates
              << ", \"degree\": " << s.mean_degree << "}";
    first = false;
  };
  for (index_t n = 3; n <= 5; ++n) {
    for (unsigned seed = 0; seed < 5; ++seed) {
      row(n, "chance", test::DelaunayLattice(n, seed).mesh);
      row(n, "half-way", test::DelaunayLattice(n, seed, 0.75).mesh);
    }
    row(n, "alike", test::kuhn_lattice(n));
  }
  std::cout << "\n  ],\n";
}

/// Sets of the cube of two that nothing can be added to: a greatest one, and a worse one of as near to 6 as there is.
struct Sets {
  std::vector<index_t> best, worse;
  std::size_t n = 0;
};

Sets maximal_sets(const IncompatibilityGraph& graph) {
  Sets sets;
  const auto from_six = [](std::size_t n) { return n > 6 ? n - 6 : 6 - n; };
  sets.n = for_each_maximal_independent_set(graph, [&](std::span<const index_t> members) {
             if (members.size() > sets.best.size()) sets.best.assign(members.begin(), members.end());
             if (sets.worse.empty() || from_six(members.size()) < from_six(sets.worse.size()))
               sets.worse.assign(members.begin(), members.end());
           }).n_sets;
  return sets;
}

/// The lattice of 2 x 2 x 2 cubes, of many ways to cut them, whose graph is nearest to the paper's: 12 candidates, 3
/// conflicts each, 8 hexahedra at best and a maximal set of 6.
std::pair<Candidates, Sets> find_figure_2() {
  std::optional<Candidates> best;
  Sets best_sets;
  double nearest = 1e9;
  for (unsigned seed = 0; seed < 400; ++seed) {
    Candidates c(test::DelaunayLattice(2, seed, 0.3).mesh);
    const Sets sets = maximal_sets(c.graph);
    const double distance = std::abs(static_cast<double>(c.hexahedra.size()) - 12) +
                            std::abs(statistics(c.graph).mean_degree - 3) +
                            4 * std::abs(static_cast<double>(sets.best.size()) - 8) +
                            4 * std::abs(static_cast<double>(sets.worse.size()) - 6);
    if (distance >= nearest) continue;
    nearest = distance;
    best_sets = sets;
    best.emplace(std::move(c));
  }
  return {std::move(*best), best_sets};
}

void write_page(const std::filesystem::path& path, const Candidates& c, std::span<const index_t> members) {
  const Assembly assembly = assemble(c.mesh, make_adjacency(c.mesh), c.hexahedra, members,
                                     {.interfaces = InterfaceMode::open, .improvement = ImprovementMode::none});
  write_html(path, assembly.mesh);
}

}  // namespace

int main(int argc, char** argv) {
  std::cout << "{\n";
  print_table_1();
  const auto [c, sets] = find_figure_2();
  std::cout << "  \"figure_2\": {\"tetrahedra\": " << c.mesh.tets.size() << ", \"candidates\": " << c.hexahedra.size()
            << ", \"mean_degree\": " << statistics(c.graph).mean_degree << ", \"maximal_sets\": " << sets.n
            << ",\n    \"best\": " << list(sets.best) << ", \"worse\": " << list(sets.worse)
            << ",\n    \"conflicts\": [";
  for (index_t v = 0, n = 0; v < c.graph.size(); ++v)
    c.graph.for_each_conflict(v, [&](index_t u) {
      if (v < u) std::cout << (n++ ? ", " : "") << "[" << v << ", " << u << "]";
    });
  std::cout << "]}\n}\n";
  if (argc > 1) {
    write_page(std::filesystem::path(argv[1]) / "best.html", c, sets.best);
    write_page(std::filesystem::path(argv[1]) / "worse.html", c, sets.worse);
  }
}
