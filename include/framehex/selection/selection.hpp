// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/observer.hpp"
#include "framehex/selection/detail/occupancy.hpp"

#include <limits>
#include <numeric>

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
template <ConflictSource G, class Members>
std::int64_t weight_in_units(const G& graph, const Members& members) {
  std::int64_t sum = 0;
  for (const index_t v : members) sum += graph.weights_in_units()[v];
  return sum;
}

template <ConflictSource G>
double from_units(const G& graph, std::int64_t units) {
  return static_cast<double>(units) * graph.unit();
}

inline constexpr auto by_number = [](index_t v) { return v; };
inline constexpr auto never = [] { return false; };

/// Heaviest first; equal ones by rising `key(v)`, then by number.
template <ConflictSource G, class Key>
auto heavier_first(const G& graph, Key&& key) {
  return [weights = graph.weights_in_units(), key](index_t u, index_t v) {
    if (weights[u] != weights[v]) return weights[u] > weights[v];
    return key(u) != key(v) ? key(u) < key(v) : u < v;
  };
}

/// Adds what still fits, heaviest first, among equals by rising `key(v)`: makes a set maximal.
///
/// @param stop  asked now and then; when it says so, the rest is left out.
template <ConflictSource G, class Key, class Stop>
void complete(const G& graph, std::vector<index_t>& members, Key&& key, Stop&& stop) {
  constexpr std::ptrdiff_t n_at_once = 4096;
  Occupancy<G> occupied(graph);
  for (const index_t v : members) occupied.add(v);
  std::vector<index_t> open(graph.size());
  std::iota(open.begin(), open.end(), index_t{0});
  const auto drop_blocked = [&] {
    std::size_t n_open = 0;
    for (std::size_t i = 0; i < open.size(); ++i) {
      if (i % n_at_once == 0 && stop()) return false;
      if (!occupied.blocks(open[i])) open[n_open++] = open[i];
    }
    open.resize(n_open);
    return true;
  };
  // Block by block: the heaviest block most others, which then need not be put in order.
  while (drop_blocked() && !open.empty()) {
    const std::ptrdiff_t n_open = std::ssize(open);
    const auto end = open.begin() + std::min(n_open, std::max(n_open / 8, n_at_once));
    if (end != open.end()) std::nth_element(open.begin(), end, open.end(), heavier_first(graph, key));
    std::sort(open.begin(), end, heavier_first(graph, key));
    for (auto v = open.begin(); v != end; ++v) {
      if ((v - open.begin()) % n_at_once == 0 && stop()) break;
      if (occupied.blocks(*v)) continue;
      members.push_back(*v);
      occupied.add(*v);
    }
    open.erase(open.begin(), end);
  }
  std::sort(members.begin(), members.end());
}

template <ConflictSource G, class Key>
void complete(const G& graph, std::vector<index_t>& members, Key&& key) {
  complete(graph, members, key, never);
}

template <ConflictSource G>
void complete(const G& graph, std::vector<index_t>& members) {
  complete(graph, members, by_number);
}

}  // namespace detail

}  // namespace framehex
