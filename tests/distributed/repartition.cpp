// SPDX-License-Identifier: BSL-1.0
#include "framehex/distributed/repartition.hpp"

#include "distributed/parts.hpp"
#include "framehex/adapters/ptscotch.hpp"
#include "framehex/distributed/validation.hpp"
#include "support/kuhn_lattice.hpp"

#include <catch2/catch.hpp>

using namespace framehex;
using namespace framehex::distributed;

TEST_CASE("neighbours by facets are those of the whole mesh, and PT-Scotch cuts few of them") {
  const MpiTransport transport(MPI_COMM_WORLD);
  const int n = transport.n_ranks(), rank = transport.rank();
  const IndexedTetMesh mesh = test::kuhn_lattice(10);
  const TetAdjacency adjacency = make_adjacency(mesh);
  const auto scattered = test::dealings()[1].ranks(mesh, n);
  const IndexedPart part = test::part_of(mesh, scattered, rank);
  const Csr<std::int64_t> neighbours = neighbours_by_facets(part, transport);
  const auto number_of = distributed::detail::gathered(transport, part.cell_ids);  // counted on -> in the mesh
  for (std::size_t c = 0; c < part.cell_ids.size(); ++c) {
    std::vector<std::int64_t> found, expected;
    for (const std::int64_t other : neighbours[c]) found.push_back(number_of[static_cast<std::size_t>(other)]);
    for (const index_t other : adjacency.neighbours[static_cast<std::size_t>(part.cell_ids[c])])
      if (other != no_index) expected.push_back(other);
    std::sort(found.begin(), found.end());
    std::sort(expected.begin(), expected.end());
    REQUIRE((found == expected));
  }

  const IndexedPart moved = repartition(part, ptscotch_partition(neighbours, transport.handle()), transport);
  distributed::validate(moved, transport);
  auto all = distributed::detail::gathered(transport, moved.cell_ids);
  std::vector<int> rank_of;
  for (const std::size_t count :
       distributed::detail::gathered(transport, std::vector<std::size_t>{moved.cell_ids.size()})) {
    CHECK(static_cast<double>(count) < 1.1 * static_cast<double>(mesh.tets.size()) / n);
    rank_of.insert(rank_of.end(), count, static_cast<int>(rank_of.empty() ? 0 : rank_of.back() + 1));
  }
  std::vector<int> rank_of_cell(mesh.tets.size(), -1);
  for (std::size_t i = 0; i < all.size(); ++i) rank_of_cell[static_cast<std::size_t>(all[i])] = rank_of[i];
  CHECK(std::count(rank_of_cell.begin(), rank_of_cell.end(), -1) == 0);
  const auto n_cut = [&](const std::vector<int>& ranks) {
    std::size_t cut = 0;
    for (std::size_t c = 0; c < mesh.tets.size(); ++c)
      for (const index_t other : adjacency.neighbours[c]) cut += other != no_index && ranks[c] != ranks[other];
    return cut / 2;
  };
  // A plane across the cube cuts 200 facets.
  CHECK(n_cut(rank_of_cell) <= 300 * static_cast<std::size_t>(n - 1));
  // Cells stay what they are.
  for (std::size_t c = 0; c < moved.cell_ids.size(); ++c)
    for (std::size_t i = 0; i < 4; ++i)
      REQUIRE(moved.vertex_ids[moved.mesh.tets[c][i]] == mesh.tets[static_cast<std::size_t>(moved.cell_ids[c])][i]);
}
