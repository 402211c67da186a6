// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/errors.hpp"
#include "framehex/mesh/csr.hpp"

#include <mpi.h>

#include <cstdint>
#include <cstdio>
#include <limits>

#include <ptscotch.h>

namespace framehex {

/// Parts of a distributed graph by PT-Scotch: as many as there are ranks, of as many vertices each, with few edges between
/// them. Collective over `communicator`. Needs `libptscotch-dev` (CeCILL-C).
///
/// @param neighbours  for each vertex of this rank those it has an edge with, counted on from rank to rank; as
///                    `distributed::neighbours_by_facets` gives it for cells.
/// @return the rank of each vertex of this rank; for `distributed::repartition`.
/// @throws error  when PT-Scotch fails, or MPI was started without `MPI_THREAD_MULTIPLE`, without which PT-Scotch 7 hangs or
///                crashes now and then: its own threads send messages; invalid_option  when its integers are too short.
inline std::vector<int> ptscotch_partition(const Csr<std::int64_t>& neighbours, MPI_Comm communicator) {
  int n_ranks = 1, threads = MPI_THREAD_SINGLE;
  MPI_Query_thread(&threads);
  if (threads < MPI_THREAD_MULTIPLE) throw error("PT-Scotch needs MPI_Init_thread with MPI_THREAD_MULTIPLE");
  MPI_Comm_size(communicator, &n_ranks);
  std::vector<SCOTCH_Num> offsets, edges, parts(neighbours.size() + 1);
  for (const offset_t o : neighbours.offsets) offsets.push_back(static_cast<SCOTCH_Num>(o));
  for (const std::int64_t e : neighbours.values) {
    if (e > std::int64_t{std::numeric_limits<SCOTCH_Num>::max()})
      throw invalid_option("PT-Scotch was built with integers too short for vertex " + std::to_string(e));
    edges.push_back(static_cast<SCOTCH_Num>(e));
  }
  const auto n = static_cast<SCOTCH_Num>(neighbours.size()), n_edges = static_cast<SCOTCH_Num>(edges.size());
  edges.push_back(0);  // so that there is an address
  SCOTCH_Dgraph graph;
  SCOTCH_Strat strategy;
  if (SCOTCH_dgraphInit(&graph, communicator) != 0) throw error("PT-Scotch does not start");
  SCOTCH_stratInit(&strategy);
  const bool done = SCOTCH_dgraphBuild(&graph, 0, n, n, offsets.data(), offsets.data() + 1, nullptr, nullptr, n_edges,
                                       n_edges, edges.data(), nullptr, nullptr) == 0 &&
                    SCOTCH_dgraphPart(&graph, n_ranks, &strategy, parts.data()) == 0;
  SCOTCH_stratExit(&strategy);
  SCOTCH_dgraphExit(&graph);
  if (!done) throw error("PT-Scotch found no partition");
  return std::vector<int>(parts.begin(), parts.end() - 1);
}

}  // namespace framehex
