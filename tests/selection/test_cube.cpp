// SPDX-License-Identifier: BSL-1.0
#include "framehex/recombination/potential_hex_finder.hpp"
#include "framehex/selection/conflict_search.hpp"
#include "framehex/selection/select.hpp"
#include "framehex/selection/tomita.hpp"
#include "framehex/verify/independence.hpp"
#include "support/kuhn_lattice.hpp"

#include <catch2/catch.hpp>

using namespace framehex;

TEST_CASE("the cube of 2 x 2 x 2: eight hexahedra are the best, and there are worse maximal sets",
          "[selection][cube]") {
  const auto mesh = test::kuhn_lattice(2);
  const auto candidates = find_potential_hexahedra(mesh, {.quality_floor = 1e-4});
  REQUIRE(candidates.size() == 68);
  const auto graph = build_incompatibility_graph(candidates, count_with_quality(candidates, 0.1));
  for (const Selection& selection : {select(graph), select_by_branch_and_bound(graph)}) {
    CHECK(selection.status == SelectionStatus::optimal);
    CHECK(selection.members.size() == 8);
    for (const index_t v : selection.members) CHECK(candidates.quality[v] == Approx(1.0));
  }
  std::vector<std::size_t> n_of_size(9, 0);
  const auto listed = for_each_maximal_independent_set(graph, [&](std::span<const index_t> members) {
    REQUIRE(members.size() <= 8);
    ++n_of_size[members.size()];
  });
  CHECK(listed.status == Status::complete);
  CHECK(n_of_size[8] == 1);
  CHECK(n_of_size[6] > 0);  // as on the left of the paper's Fig. 2
  CHECK(listed.n_sets > 1);
}
