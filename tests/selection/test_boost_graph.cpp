// SPDX-License-Identifier: BSL-1.0
#include "framehex/adapters/boost_graph.hpp"
#include "support/random_graphs.hpp"

#include <boost/graph/breadth_first_search.hpp>
#include <boost/graph/connected_components.hpp>
#include <boost/graph/graph_concepts.hpp>
#include <boost/graph/sequential_vertex_coloring.hpp>
#include <catch2/catch.hpp>

#include <set>

using namespace framehex;

BOOST_CONCEPT_ASSERT((boost::VertexListGraphConcept<IncompatibilityGraph>));
BOOST_CONCEPT_ASSERT((boost::AdjacencyGraphConcept<IncompatibilityGraph>));
BOOST_CONCEPT_ASSERT((boost::IncidenceGraphConcept<IncompatibilityGraph>));
BOOST_CONCEPT_ASSERT((boost::EdgeListGraphConcept<IncompatibilityGraph>));
BOOST_CONCEPT_ASSERT((boost::AdjacencyMatrixConcept<IncompatibilityGraph>));
BOOST_CONCEPT_ASSERT((boost::ReadablePropertyMapConcept<CandidateWeightMap, index_t>));

TEST_CASE("Boost's algorithms run on an incompatibility graph", "[selection][boost]") {
  std::mt19937_64 engine(9);
  const auto graph = test::random_graph(engine, 60, 0.02, test::Weights::reals);

  std::vector<index_t> component(graph.size());
  const auto index = get(boost::vertex_index, graph);
  const auto n = boost::connected_components(graph, boost::make_iterator_property_map(component.begin(), index));
  CHECK(static_cast<std::size_t>(n) == statistics(graph).n_components);

  std::vector<index_t> colour(graph.size());
  boost::sequential_vertex_coloring(graph, boost::make_iterator_property_map(colour.begin(), index));
  for (index_t v = 0; v < graph.size(); ++v)
    for (const index_t u : graph.neighbours(v)) CHECK(colour[u] != colour[v]);

  for (index_t v = 0; v < graph.size(); ++v) CHECK(get(weight_map(graph), v) == graph.weight(v));
}

TEST_CASE("edges come once, and from both ends", "[selection][boost]") {
  std::mt19937_64 engine(10);
  for (const double density : {0.0, 0.1, 0.9}) {
    const auto graph = test::random_graph(engine, 25, density, test::Weights::ones);
    std::set<std::pair<index_t, index_t>> seen;
    const auto [first, last] = edges(graph);
    for (auto it = first; it != last; ++it) {
      CHECK(graph.adjacent((*it).source, (*it).target));
      CHECK(seen.insert({(*it).source, (*it).target}).second);
      CHECK(edge((*it).target, (*it).source, graph) == std::pair(*it, true));
    }
    CHECK(seen.size() == num_edges(graph));
    for (index_t v = 0; v < graph.size(); ++v) {
      std::size_t n = 0;
      const auto [out, out_end] = out_edges(v, graph);
      for (auto it = out; it != out_end; ++it, ++n) {
        CHECK(source(*it, graph) == v);
        CHECK(graph.adjacent(v, target(*it, graph)));
      }
      CHECK(n == out_degree(v, graph));
    }
  }
}
