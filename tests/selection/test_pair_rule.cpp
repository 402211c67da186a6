// SPDX-License-Identifier: BSL-1.0
#include "framehex/recombination/compatibility.hpp"
#include "framehex/recombination/potential_hex_finder.hpp"
#include "framehex/selection/conflict_search.hpp"
#include "support/kuhn_lattice.hpp"

#include <catch2/catch.hpp>

using namespace framehex;

TEST_CASE("the graph agrees with the pairwise rule of recombination", "[selection][graph]") {
  const auto candidates = find_potential_hexahedra(test::kuhn_lattice(3), {.quality_floor = 1e-4});
  const auto graph = build_incompatibility_graph(candidates);
  for (index_t i = 0; i < graph.size(); ++i)
    for (index_t j = 0; j < i; ++j)
      if (graph.adjacent(i, j) == compatible(candidates, i, j)) FAIL(i << " and " << j);
}
