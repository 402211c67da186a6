// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/selection/incompatibility_graph.hpp"

namespace framehex::detail {

/// Scrambles 64 bits. Source: the finalizer of SplitMix64 (Steele, Lea, Flood, OOPSLA 2014).
inline std::uint64_t scramble(std::uint64_t x) {
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9U;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebU;
  return x ^ (x >> 31);
}

/// A number for each candidate that depends on its weight and its surroundings within some steps, not on numbering.
inline std::vector<std::uint64_t> signatures(const IncompatibilityGraph& graph, int n_steps) {
  const std::size_t n = graph.size();
  std::vector<std::uint64_t> now(n), next(n);
  for (index_t v = 0; v < n; ++v)
    now[v] = scramble(static_cast<std::uint64_t>(graph.weights_in_units()[v]) + scramble(graph.degree(v)));
  for (int step = 0; step < n_steps; ++step) {
    for (index_t v = 0; v < n; ++v) {
      std::uint64_t sum = 0;  // the same in any order
      for (const index_t u : graph.neighbours(v)) sum += now[u];
      next[v] = scramble(now[v] + 3 * scramble(sum));
    }
    now.swap(next);
  }
  return now;
}

/// An order of the candidates that does not depend on their numbers, except where candidates look alike: breadth first,
/// so that neighbours are near in memory, from the least signature, neighbours by signature.
inline std::vector<index_t> canonical_order(const IncompatibilityGraph& graph,
                                            std::span<const std::uint64_t> signature) {
  const auto n = static_cast<index_t>(graph.size());
  const auto before = [&](index_t u, index_t v) {
    return signature[u] != signature[v] ? signature[u] < signature[v] : u < v;
  };
  std::vector<index_t> roots(n), order;
  std::iota(roots.begin(), roots.end(), index_t{0});
  std::sort(roots.begin(), roots.end(), before);
  std::vector<std::uint8_t> reached(n, 0);
  order.reserve(n);
  for (const index_t root : roots) {
    if (reached[root]) continue;
    reached[root] = 1;
    std::size_t next = order.size();
    order.push_back(root);
    for (; next < order.size(); ++next) {
      const std::size_t first = order.size();
      for (const index_t u : graph.neighbours(order[next]))
        if (!reached[u]) {
          reached[u] = 1;
          order.push_back(u);
        }
      std::sort(order.begin() + static_cast<std::ptrdiff_t>(first), order.end(), before);
    }
  }
  return order;
}

/// The same graph, candidate `order[i]` being number i.
///
/// @param stop  asked now and then; when it says so, the result is of no use.
template <class Stop>
IncompatibilityGraph renumber(const IncompatibilityGraph& graph, std::span<const index_t> order, Stop&& stop) {
  std::vector<index_t> number(order.size());
  QuantisedWeights weights;
  weights.unit = graph.unit();
  Csr<index_t> rows;
  rows.offsets.reserve(order.size() + 1);
  for (std::size_t i = 0; i < order.size(); ++i) {
    number[order[i]] = static_cast<index_t>(i);
    weights.values.push_back(graph.weights_in_units()[order[i]]);
    rows.offsets.push_back(rows.offsets.back() + graph.degree(order[i]));
  }
  // Emitted by rising number into the rows of the neighbours, each row comes out ascending.
  rows.values.resize(rows.offsets.back());
  std::vector<offset_t> next(rows.offsets.begin(), rows.offsets.end() - 1);
  for (std::size_t i = 0; i < order.size() && !(i % 4096 == 0 && stop()); ++i)
    for (const index_t u : graph.neighbours(order[i])) rows.values[next[number[u]]++] = static_cast<index_t>(i);
  return GraphAccess::unchecked(std::move(rows), std::move(weights));
}

}  // namespace framehex::detail
