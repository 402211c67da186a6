// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/selection/detail/scramble.hpp"
#include "framehex/selection/incompatibility_graph.hpp"

namespace framehex::detail {

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
///
/// @return a row for each connected component.
inline Csr<index_t> canonical_components(const IncompatibilityGraph& graph, std::span<const std::uint64_t> signature) {
  const auto n = static_cast<index_t>(graph.size());
  const auto before = [&](index_t u, index_t v) {
    return signature[u] != signature[v] ? signature[u] < signature[v] : u < v;
  };
  std::vector<index_t> roots(n);
  Csr<index_t> parts;
  std::vector<index_t>& order = parts.values;
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
    parts.end_row();
  }
  return parts;
}

/// Place of each candidate in its row; for rows that hold each once.
inline std::vector<index_t> places_in_rows(const Csr<index_t>& rows) {
  std::vector<index_t> place(rows.values.size());
  for (std::size_t row = 0; row < rows.size(); ++row)
    for (std::size_t i = 0; i < rows[row].size(); ++i) place[rows[row][i]] = static_cast<index_t>(i);
  return place;
}

/// The graph on some candidates that has all their conflicts, candidate `order[i]` being number i.
///
/// @param number  of each of them: the reverse of `order`.
/// @param stop    asked now and then; when it says so, the result is of no use.
template <class Stop>
IncompatibilityGraph renumber(const IncompatibilityGraph& graph, std::span<const index_t> order,
                              std::span<const index_t> number, Stop&& stop) {
  QuantisedWeights weights;
  weights.unit = graph.unit();
  Csr<index_t> rows;
  rows.offsets.reserve(order.size() + 1);
  for (const index_t v : order) {
    weights.values.push_back(graph.weights_in_units()[v]);
    rows.offsets.push_back(rows.offsets.back() + graph.degree(v));
  }
  // Emitted by rising number into the rows of the neighbours, each row comes out ascending.
  rows.values.resize(rows.offsets.back());
  std::vector<offset_t> next(rows.offsets.begin(), rows.offsets.end() - 1);
  for (std::size_t i = 0; i < order.size() && !(i % 4096 == 4095 && stop()); ++i)
    for (const index_t u : graph.neighbours(order[i])) rows.values[next[number[u]]++] = static_cast<index_t>(i);
  return GraphAccess::unchecked(std::move(rows), std::move(weights));
}

}  // namespace framehex::detail
