// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/quads/matching.hpp"

#include <lemon/matching.h>
#include <lemon/smart_graph.h>

#include <type_traits>

namespace framehex::detail {

struct LemonGraphBase : lemon::SmartGraphBase {};
using LemonGraph = lemon::GraphExtender<LemonGraphBase>;

}  // namespace framehex::detail

namespace lemon {

/// LEMON keeps values of classes and enumerations in arrays that it fills by functions of allocators which C++20 has no
/// more; in vectors, as numbers, they do as well.
template <class Item, class Value>
requires(!std::is_arithmetic_v<Value> &&
         !std::is_pointer_v<Value>) struct DefaultMapSelector<framehex::detail::LemonGraph, Item, Value> {
  using Map = VectorMap<framehex::detail::LemonGraph, Item, Value>;
};

}  // namespace lemon

namespace framehex {

/// LEMON's weighted matching as an exact Matcher (package liblemon-dev, Boost's licence).
///
/// @par Complexity   O(n m log n) at worst; about n^1.1 where most of the cheapest pairs do not compete.
/// @par Source       Edmonds' algorithm from a fractional matching, as LEMON 1.3 implements it.
struct LemonMatcher {
  std::vector<index_t> operator()(std::size_t n_vertices, std::span<const MatchingEdge> edges) const {
    using Graph = detail::LemonGraph;
    using Weights = Graph::EdgeMap<std::int64_t>;
    Graph graph;
    for (std::size_t v = 0; v < n_vertices; ++v) graph.addNode();
    for (const MatchingEdge& edge : edges)
      graph.addEdge(Graph::nodeFromId(static_cast<int>(edge.a)), Graph::nodeFromId(static_cast<int>(edge.b)));
    Weights weights(graph);
    const auto weigh = [&](std::int64_t offset) {
      for (std::size_t e = 0; e < edges.size(); ++e)
        weights[Graph::edgeFromId(static_cast<int>(e))] = offset - edges[e].cost;
    };
    std::vector<index_t> mate(n_vertices, no_index);
    const auto read = [&](const auto& matching) {
      for (std::size_t v = 0; v < n_vertices; ++v) {
        const Graph::Node other = matching.mate(Graph::nodeFromId(static_cast<int>(v)));
        if (other != lemon::INVALID) mate[v] = static_cast<index_t>(Graph::id(other));
      }
    };
    weigh(0);
    lemon::MaxWeightedPerfectMatching<Graph, Weights> perfect(graph, weights);
    if (n_vertices % 2 == 0 && perfect.run()) {
      read(perfect);
      return mate;
    }
    std::int64_t largest = 0;
    for (const MatchingEdge& edge : edges) largest = std::max(largest, edge.cost);
    // So much that joining more vertices always pays, whatever it costs.
    weigh(static_cast<std::int64_t>(n_vertices / 2 + 1) * (largest + 1));
    lemon::MaxWeightedMatching<Graph, Weights> matching(graph, weights);
    matching.run();
    read(matching);
    return mate;
  }
};

static_assert(Matcher<LemonMatcher>);

}  // namespace framehex
