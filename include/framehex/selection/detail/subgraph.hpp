// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/selection/conflict_search.hpp"
#include "framehex/selection/detail/clique_cover.hpp"
#include "framehex/selection/implicit_graph.hpp"

namespace framehex::detail {

template <ConflictSource G>
QuantisedWeights weights_of(const G& graph, std::span<const index_t> kept) {
  QuantisedWeights weights{{}, graph.unit()};
  for (const index_t v : kept) weights.values.push_back(graph.weights_in_units()[v]);
  return weights;
}

/// The graph on some candidates, renumbered in their order; the same unit.
///
/// @param kept    ascending.
/// @param number  scratch, `no_index` for every candidate of `graph`, and so again afterwards: with it the work is that of
///                the rows of `kept`, however large the graph.
template <ConflictSource G>
IncompatibilityGraph induced_subgraph(const G& graph, std::span<const index_t> kept, std::span<index_t> number) {
  for (std::size_t i = 0; i < kept.size(); ++i) number[kept[i]] = static_cast<index_t>(i);
  Csr<index_t> rows;
  rows.offsets.reserve(kept.size() + 1);
  for (const index_t v : kept) {
    const std::size_t first = rows.values.size();
    graph.for_each_conflict(v, [&](index_t u) {
      if (number[u] != no_index) rows.values.push_back(number[u]);
    });
    std::sort(rows.values.begin() + static_cast<std::ptrdiff_t>(first), rows.values.end());
    rows.end_row();
  }
  for (const index_t v : kept) number[v] = no_index;
  return GraphAccess::unchecked(std::move(rows), weights_of(graph, kept));
}

template <ConflictSource G, Executor E = SerialExecutor>
IncompatibilityGraph induced_subgraph(const G& graph, std::span<const index_t> kept, const E& = {}) {
  std::vector<index_t> number(graph.size(), no_index);
  return induced_subgraph(graph, kept, std::span<index_t>(number));
}

/// The same, from the keys of these candidates alone.
template <Executor E = SerialExecutor>
IncompatibilityGraph induced_subgraph(const ImplicitIncompatibilityGraph& graph, std::span<const index_t> kept,
                                      const E& executor = {}) {
  PotentialHexahedra part;
  part.vertices.reserve(kept.size());
  for (const index_t v : kept) {
    part.vertices.push_back(graph.candidates().vertices[v]);
    const auto tets = graph.candidates().tets[v];
    part.tets.values.insert(part.tets.values.end(), tets.begin(), tets.end());
    part.tets.end_row();
  }
  return GraphAccess::unchecked(find_conflicts(part, graph.n_vertices(), graph.n_tets(), executor),
                                weights_of(graph, kept));
}

/// The connected components among some candidates, each ascending, by their smallest member.
inline Csr<index_t> components(const IncompatibilityGraph& graph, std::span<const index_t> kept) {
  std::vector<std::uint8_t> open(graph.size(), 0);
  for (const index_t v : kept) open[v] = 1;
  Csr<index_t> parts;
  for (const index_t root : kept) {
    if (!open[root]) continue;
    const std::size_t first = parts.values.size();
    parts.values.push_back(root);
    open[root] = 0;
    for (std::size_t next = first; next < parts.values.size(); ++next)
      for (const index_t u : graph.neighbours(parts.values[next]))
        if (open[u]) {
          open[u] = 0;
          parts.values.push_back(u);
        }
    std::sort(parts.values.begin() + static_cast<std::ptrdiff_t>(first), parts.values.end());
    parts.end_row();
  }
  return parts;
}

/// The part of a cover, with its prices, that concerns some candidates; cliques of fewer than two of them fall away.
struct CoverPart {
  CliqueCover cover;
  std::vector<float> primal, dual;
};

inline CoverPart restrict_cover(const CliqueCover& cover, std::span<const float> primal, std::span<const float> dual,
                                std::span<const index_t> kept) {
  std::vector<index_t> number(primal.size(), no_index);
  for (std::size_t i = 0; i < kept.size(); ++i) number[kept[i]] = static_cast<index_t>(i);
  CoverPart part;
  Csr<index_t>& rows = part.cover.cliques;
  for (std::size_t c = 0; c < cover.size(); ++c) {
    const std::size_t first = rows.values.size();
    for (const index_t v : cover.cliques[c])
      if (number[v] != no_index) rows.values.push_back(number[v]);
    if (rows.values.size() < first + 2) {
      rows.values.resize(first);
      continue;
    }
    rows.end_row();
    part.dual.push_back(dual[c]);
  }
  part.cover.cliques_of_vertex = transpose(rows, kept.size());
  for (const index_t v : kept) part.primal.push_back(primal[v]);
  return part;
}

}  // namespace framehex::detail
