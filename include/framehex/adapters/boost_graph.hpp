// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/selection/incompatibility_graph.hpp"

#include <boost/graph/graph_traits.hpp>
#include <boost/graph/properties.hpp>
#include <boost/iterator/counting_iterator.hpp>
#include <boost/iterator/iterator_facade.hpp>
#include <boost/iterator/transform_iterator.hpp>
#include <boost/property_map/property_map.hpp>

/// Makes IncompatibilityGraph a model of Boost.Graph's VertexListGraph, AdjacencyGraph, IncidenceGraph, EdgeListGraph
/// and AdjacencyMatrix, undirected, so that Boost's algorithms run on it. Include this before they are used.
///
/// Vertices are candidates. Their numbers are the property `vertex_index`; `weight_map(graph)` reads their weights.
namespace framehex {

/// A conflict seen from one side; equal to that seen from the other.
struct Conflict {
  index_t source = no_index, target = no_index;

  friend bool operator==(const Conflict& a, const Conflict& b) {
    return (a.source == b.source && a.target == b.target) || (a.source == b.target && a.target == b.source);
  }
};

}  // namespace framehex

namespace boost {

template <>
struct graph_traits<framehex::IncompatibilityGraph> {
  using vertex_descriptor = framehex::index_t;
  using edge_descriptor = framehex::Conflict;
  using directed_category = undirected_tag;
  using edge_parallel_category = disallow_parallel_edge_tag;
  struct traversal_category : virtual vertex_list_graph_tag,
                              virtual adjacency_graph_tag,
                              virtual incidence_graph_tag,
                              virtual edge_list_graph_tag,
                              virtual adjacency_matrix_tag {};
  using vertices_size_type = std::size_t;
  using edges_size_type = std::size_t;
  using degree_size_type = std::size_t;
  using vertex_iterator = counting_iterator<framehex::index_t>;
  using adjacency_iterator = const framehex::index_t*;

  struct MakeConflict {
    framehex::index_t source = framehex::no_index;
    framehex::Conflict operator()(framehex::index_t target) const { return {source, target}; }
  };
  using out_edge_iterator = transform_iterator<MakeConflict, adjacency_iterator>;

  /// Each conflict once, from its smaller candidate.
  class edge_iterator
      : public iterator_facade<edge_iterator, framehex::Conflict, forward_traversal_tag, framehex::Conflict> {
  public:
    edge_iterator() = default;
    edge_iterator(const framehex::IncompatibilityGraph& graph, std::size_t source) : graph_(&graph), source_(source) {
      skip();
    }

  private:
    friend class boost::iterator_core_access;
    framehex::Conflict dereference() const {
      const auto v = static_cast<framehex::index_t>(source_);
      return {v, graph_->neighbours(v)[place_]};
    }
    bool equal(const edge_iterator& other) const { return source_ == other.source_ && place_ == other.place_; }
    void increment() {
      ++place_;
      skip();
    }
    void skip() {
      for (; source_ < graph_->size(); ++source_, place_ = 0) {
        const auto row = graph_->neighbours(static_cast<framehex::index_t>(source_));
        while (place_ < row.size() && row[place_] < source_) ++place_;
        if (place_ < row.size()) return;
      }
    }

    const framehex::IncompatibilityGraph* graph_ = nullptr;
    std::size_t source_ = 0, place_ = 0;
  };

  static framehex::index_t null_vertex() { return framehex::no_index; }
};

template <>
struct property_map<framehex::IncompatibilityGraph, vertex_index_t> {
  using type = typed_identity_property_map<framehex::index_t>;
  using const_type = type;
};

}  // namespace boost

namespace framehex {

namespace detail {
using ConflictTraits = boost::graph_traits<IncompatibilityGraph>;
}

/// Boost.Graph, VertexListGraph: all candidates.
inline std::pair<detail::ConflictTraits::vertex_iterator, detail::ConflictTraits::vertex_iterator> vertices(
    const IncompatibilityGraph& graph) {
  using Iterator = detail::ConflictTraits::vertex_iterator;
  return {Iterator(0), Iterator(static_cast<index_t>(graph.size()))};
}
/// Boost.Graph, VertexListGraph.
inline std::size_t num_vertices(const IncompatibilityGraph& graph) {
  return graph.size();
}

/// Boost.Graph, EdgeListGraph: each conflict once.
inline std::pair<detail::ConflictTraits::edge_iterator, detail::ConflictTraits::edge_iterator> edges(
    const IncompatibilityGraph& graph) {
  using Iterator = detail::ConflictTraits::edge_iterator;
  return {Iterator(graph, 0), Iterator(graph, graph.size())};
}
/// Boost.Graph, EdgeListGraph.
inline std::size_t num_edges(const IncompatibilityGraph& graph) {
  return graph.n_conflicts();
}

/// Boost.Graph, AdjacencyGraph.
inline std::pair<const index_t*, const index_t*> adjacent_vertices(index_t v, const IncompatibilityGraph& graph) {
  const auto row = graph.neighbours(v);
  return {row.data(), row.data() + row.size()};
}
/// Boost.Graph, IncidenceGraph.
inline std::pair<detail::ConflictTraits::out_edge_iterator, detail::ConflictTraits::out_edge_iterator> out_edges(
    index_t v, const IncompatibilityGraph& graph) {
  using Iterator = detail::ConflictTraits::out_edge_iterator;
  const auto [first, last] = adjacent_vertices(v, graph);
  return {Iterator(first, {v}), Iterator(last, {v})};
}
/// Boost.Graph, IncidenceGraph.
inline std::size_t out_degree(index_t v, const IncompatibilityGraph& graph) {
  return graph.degree(v);
}
/// Boost.Graph, IncidenceGraph.
inline index_t source(const Conflict& conflict, const IncompatibilityGraph&) {
  return conflict.source;
}
/// Boost.Graph, IncidenceGraph.
inline index_t target(const Conflict& conflict, const IncompatibilityGraph&) {
  return conflict.target;
}

/// The conflict of u and v, and whether there is one.
inline std::pair<Conflict, bool> edge(index_t u, index_t v, const IncompatibilityGraph& graph) {
  return {{u, v}, graph.adjacent(u, v)};
}

/// Boost.Graph, PropertyGraph: `vertex_index`.
inline boost::typed_identity_property_map<index_t> get(boost::vertex_index_t, const IncompatibilityGraph&) {
  return {};
}
/// Boost.Graph, PropertyGraph: the number of one candidate.
inline index_t get(boost::vertex_index_t, const IncompatibilityGraph&, index_t v) {
  return v;
}

/// Weights of the candidates as a readable property map.
struct CandidateWeightMap {
  using key_type = index_t;
  using value_type = double;
  using reference = double;
  using category = boost::readable_property_map_tag;
  const IncompatibilityGraph* graph = nullptr;
  friend double get(const CandidateWeightMap& map, index_t v) { return map.graph->weight(v); }
};
/// Weights of the candidates as a readable property map.
inline CandidateWeightMap weight_map(const IncompatibilityGraph& graph) {
  return {&graph};
}

}  // namespace framehex
