// SPDX-License-Identifier: BSL-1.0
#include "framehex/recombination/potential_hex_finder.hpp"
#include "support/kuhn_lattice.hpp"

#include <catch2/catch.hpp>

using namespace framehex;

// Counted by two other programs, and by brute force up to N = 6; polynomials through them.
TEST_CASE("Kuhn lattices have the known number of potential hexahedra") {
  const auto n = GENERATE(as<index_t>{}, 2, 3, 4, 5, 10, 20);
  const auto mesh = test::kuhn_lattice(n);
  const std::size_t N = n;
  const auto with_rule = find_potential_hexahedra(mesh, {.quality_floor = 1e-4});
  CHECK(with_rule.size() == 58 * N * N * N + 213 * N - 186 * N * N - 78);
  const auto without = find_potential_hexahedra(mesh, {.quality_floor = 1e-4, .boundary_rule = BoundaryRule::ignore});
  CHECK(without.size() == 58 * N * N * N + 63 * N - 114 * N * N - 6);
  for (std::size_t i = 0; i < without.size(); ++i) {
    REQUIRE(without.tets[i].size() >= 5);
    REQUIRE(without.tets[i].size() <= 7);
    REQUIRE(without.quality[i] > 0.288f);
  }
}
