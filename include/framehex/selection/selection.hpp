// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/observer.hpp"
#include "framehex/selection/incompatibility_graph.hpp"

#include <limits>

namespace framehex {

/// How a selection ended.
enum class SelectionStatus {
  optimal,           ///< no selection weighs more: weight equals bound
  gap_reached,       ///< the gap asked for is proven
  budget_exhausted,  ///< the method or the budget ended first
  cancelled          ///< the observer said stop
};

/// Candidates that can stand in one mesh: always independent, and maximal (none can be added).
struct Selection {
  std::vector<index_t> members;  ///< ascending
  double weight = 0;             ///< exact sum over the members
  double bound = 0;              ///< proven: no selection weighs more
  SelectionStatus status = SelectionStatus::budget_exhausted;
  std::size_t iterations = 0;  ///< steps of the bound, of the local search and of the tree search together

  /// Share of the bound that the selection may be missing, 0 to 1.
  double gap() const { return bound > weight ? (bound - weight) / bound : 0.0; }
};

namespace detail {

/// Weight of a set in units.
template <class Members>
std::int64_t weight_in_units(const IncompatibilityGraph& graph, const Members& members) {
  std::int64_t sum = 0;
  for (const index_t v : members) sum += graph.weights_in_units()[v];
  return sum;
}

inline double from_units(const IncompatibilityGraph& graph, std::int64_t units) {
  return static_cast<double>(units) * graph.unit();
}

/// Candidates by falling weight, equal ones by rising `key(v)`, then by number.
template <class Key>
void sort_by_falling_weight(const IncompatibilityGraph& graph, std::vector<index_t>& candidates, Key&& key) {
  const auto weights = graph.weights_in_units();
  std::sort(candidates.begin(), candidates.end(), [&](index_t u, index_t v) {
    if (weights[u] != weights[v]) return weights[u] > weights[v];
    return key(u) != key(v) ? key(u) < key(v) : u < v;
  });
}

/// Adds what still fits, heaviest first, among equals by rising `key(v)`: makes a set maximal.
template <class Key>
void complete(const IncompatibilityGraph& graph, std::vector<index_t>& members, Key&& key) {
  std::vector<std::uint8_t> blocked(graph.size(), 0);
  for (const index_t v : members) {
    blocked[v] = 1;
    for (const index_t u : graph.neighbours(v)) blocked[u] = 1;
  }
  std::vector<index_t> open;
  for (index_t v = 0; v < graph.size(); ++v)
    if (!blocked[v]) open.push_back(v);
  sort_by_falling_weight(graph, open, key);
  for (const index_t v : open) {
    if (blocked[v]) continue;
    members.push_back(v);
    for (const index_t u : graph.neighbours(v)) blocked[u] = 1;
  }
  std::sort(members.begin(), members.end());
}

inline void complete(const IncompatibilityGraph& graph, std::vector<index_t>& members) {
  complete(graph, members, [](index_t v) { return v; });
}

}  // namespace detail

}  // namespace framehex
