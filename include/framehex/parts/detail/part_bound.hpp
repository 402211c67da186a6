// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/executor.hpp"
#include "framehex/parts/detail/border_candidates.hpp"
#include "framehex/parts/detail/calling_thread.hpp"
#include "framehex/recombination/detail/chosen.hpp"
#include "framehex/selection/detail/gap_search.hpp"

namespace framehex::detail {

/// No selection of some candidates weighs more. A relaxation of a few iterations, as `select` makes when no proof is asked
/// for.
inline double bound_of_some(const CandidatePool& pool, std::span<const index_t> some, const Observer& observer) {
  PotentialHexahedra candidates = chosen(pool.candidates, some);
  std::vector<index_t> tets = candidates.tets.values;
  std::sort(tets.begin(), tets.end());
  tets.erase(std::unique(tets.begin(), tets.end()), tets.end());
  for (index_t& tet : candidates.tets.values)
    tet = static_cast<index_t>(std::lower_bound(tets.begin(), tets.end(), tet) - tets.begin());
  const ImplicitIncompatibilityGraph graph(candidates, [&](index_t i) { return pool.weights[some[i]]; });
  Deadline deadline(std::numeric_limits<double>::infinity(), observer);
  const SerialExecutor serial;
  GapSearch search(graph, serial, 1, deadline);
  std::vector<index_t> members;
  search.run(members, 1, 0);
  return from_units(graph, search.bound_in_units());
}

/// A bound for all candidates of a rank: the sum of those for the candidates that begin in each of its leaves. What leaves
/// lose to one another at their borders is not seen.
template <Executor E>
std::vector<double> bounds_of_leaves(const CandidatePool& pool, const std::vector<index_t>& leaf_of_vertex,
                                     const std::array<index_t, 2>& leaves, const E& executor, CallingThread& thread) {
  const Csr<index_t> candidates_of_leaf = make_csr(leaves[1] - leaves[0], [&](auto&& put) {
    for (index_t i = 0; i < pool.n_own; ++i) put(leaf_of_vertex[pool.candidates.vertices[i][0]] - leaves[0], i);
  });
  std::vector<double> bounds(candidates_of_leaf.size(), 0);
  executor(candidates_of_leaf.size(), [&](std::size_t i, std::size_t) {
    if (!thread.stopped() && !candidates_of_leaf[i].empty())
      bounds[i] = bound_of_some(pool, candidates_of_leaf[i], thread.part("selection"));
  });
  return bounds;
}

}  // namespace framehex::detail
