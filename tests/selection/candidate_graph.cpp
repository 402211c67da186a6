// SPDX-License-Identifier: BSL-1.0
// Writes the graph of a benchmark ball in METIS's format, for solvers from outside:
//   candidate_graph CELLS_ACROSS FLOOR FILE
#include "framehex/io/metis_format.hpp"
#include "framehex/recombination/potential_hex_finder.hpp"
#include "framehex/selection/conflict_search.hpp"
#include "lattice_ball.hpp"

#include <fstream>
#include <iostream>

using namespace framehex;

int main(int argc, char** argv) {
  if (argc != 4) {
    std::cerr << "usage: " << argv[0] << " CELLS_ACROSS FLOOR FILE\n";
    return 2;
  }
  const IndexedTetMesh ball = benchmarks::lattice_ball(std::stoi(argv[1]));
  const PotentialHexahedra hexahedra = find_potential_hexahedra(ball, {.quality_floor = std::stod(argv[2])});
  const auto weight = [&](index_t i) { return std::round(1e4 * static_cast<double>(hexahedra.quality[i])); };
  std::ofstream out(argv[3]);
  write_metis(out, build_incompatibility_graph(hexahedra, weight));
  return out.flush() ? 0 : 1;
}
