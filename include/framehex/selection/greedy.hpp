// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/selection/detail/indexed_heap.hpp"
#include "framehex/selection/selection.hpp"

namespace framehex {

/// Takes candidates by falling weight, each unless a neighbour was taken before.
///
/// @return the members, ascending: a maximal independent set.
/// @par Complexity   O(n log n), and the conflicts of the members; an implicit graph looks at none.
/// @par Determinism  Equal weights by number.
/// @par Source       Paper, section 2.2.
template <ConflictSource G>
std::vector<index_t> select_greedily(const G& graph) {
  std::vector<index_t> members;
  detail::complete(graph, members);
  return members;
}

/// Takes, again and again, the candidate with the largest share of the weight that its choice decides: its own, over
/// its own and that of the neighbours still open.
///
/// @return the members, ascending: a maximal independent set, usually much heavier than the greedy one.
/// @par Complexity   O((n + conflicts) log n); 24 bytes a candidate.
/// @param stop  asked for each member; when it says so, the rest is filled up by weight.
/// @par Determinism  Equal shares by number.
template <ConflictSource G, class Stop>
std::vector<index_t> select_dynamically(const G& graph, Stop&& stop) {
  const auto n = static_cast<index_t>(graph.size());
  const auto weights = graph.weights_in_units();
  // A zero weight must not make a share of 0/0, and must still be taken in the end.
  const auto share = [&](index_t v, std::int64_t closed) {
    return closed > 0 ? static_cast<double>(weights[v]) / static_cast<double>(closed) : 0.0;
  };
  std::vector<std::int64_t> closed_weight(n);
  std::vector<double> keys(n);
  for (index_t v = 0; v < n; ++v) {
    closed_weight[v] = weights[v];
    graph.for_each_conflict(v, [&](index_t u) { closed_weight[v] += weights[u]; });
    keys[v] = share(v, closed_weight[v]);
  }
  detail::IndexedMaxHeap heap(std::move(keys));
  std::vector<index_t> members, touched;
  std::vector<index_t> touched_by(n, no_index);
  while (!heap.empty() && !stop()) {
    const index_t chosen = heap.pop();
    members.push_back(chosen);
    touched.clear();
    graph.for_each_conflict(chosen, [&](index_t u) {
      if (heap.contains(u)) heap.erase(u), touched.push_back(u);
    });
    const std::size_t n_removed = touched.size();
    for (std::size_t i = 0; i < n_removed; ++i) {
      const index_t removed = touched[i];
      graph.for_each_conflict(removed, [&](index_t x) {
        if (!heap.contains(x)) return;
        closed_weight[x] -= weights[removed];
        if (touched_by[x] == chosen) return;
        touched_by[x] = chosen;
        touched.push_back(x);
      });
    }
    for (std::size_t i = n_removed; i < touched.size(); ++i)
      heap.raise(touched[i], share(touched[i], closed_weight[touched[i]]));
  }
  detail::complete(graph, members);
  return members;
}

/// The same without an end before its time.
template <ConflictSource G>
std::vector<index_t> select_dynamically(const G& graph) {
  return select_dynamically(graph, [] { return false; });
}

}  // namespace framehex
