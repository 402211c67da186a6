// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/quads/matching.hpp"

#include <boost/graph/adjacency_list.hpp>
#include <boost/graph/max_cardinality_matching.hpp>

namespace framehex {

/// Boost.Graph's maximum cardinality matching, started from the cheapest pairs: as many pairs as can be, at a cost that
/// is low but not the least. For those who want quadrilaterals alone and have Boost only.
///
/// @par Complexity   O(n m) at worst; a few seconds for 10^5 triangles.
/// @par Source       Edmonds' algorithm, as Boost implements it. Departs: not its weighted matching, which in many releases
///                   crashes or does not end on some graphs.
struct BoostMatcher {
  std::vector<index_t> operator()(std::size_t n_vertices, std::span<const MatchingEdge> edges) const {
    using Graph = boost::adjacency_list<boost::vecS, boost::vecS, boost::undirectedS>;
    using Vertex = Graph::vertex_descriptor;
    using VertexIndex = boost::property_map<Graph, boost::vertex_index_t>::type;
    Graph graph(n_vertices);  // its greedy matching takes edges in the order in which they came
    for (const std::size_t e : detail::by_cost(edges)) boost::add_edge(edges[e].a, edges[e].b, graph);
    std::vector<Vertex> mate(n_vertices);
    boost::matching<Graph, Vertex*, VertexIndex, boost::edmonds_augmenting_path_finder, boost::greedy_matching,
                    boost::no_matching_verifier>(graph, mate.data(), boost::get(boost::vertex_index, graph));
    std::vector<index_t> result(n_vertices, no_index);
    for (std::size_t v = 0; v < n_vertices; ++v)
      if (mate[v] != boost::graph_traits<Graph>::null_vertex()) result[v] = static_cast<index_t>(mate[v]);
    return result;
  }
};

static_assert(Matcher<BoostMatcher>);

}  // namespace framehex
