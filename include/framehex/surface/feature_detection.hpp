// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/mesh/adjacency.hpp"
#include "framehex/mesh/indexed_mesh.hpp"
#include "framehex/option_ranges.hpp"
#include "framehex/surface/detail/triangle_normals.hpp"
#include "framehex/surface/feature_graph.hpp"

#include <numbers>
#include <span>

namespace framehex {

/// What counts as a feature.
struct FeatureOptions {
  double angle = 40 * std::numbers::pi / 180;  ///< rad, > 0 to pi; an edge bent by more than this from flat is sharp
  double corner_angle =
      50 * std::numbers::pi / 180;  ///< rad, > 0 to pi; a curve that turns by more at a vertex has a corner there
  index_t stray_edges = 20;         ///< a sharp curve with a loose end is kept from so many edges on
  std::vector<std::array<index_t, 2>> given_edges{};  ///< always features, in either direction
  std::vector<index_t> patches{};  ///< labels of the triangles; features run between different ones. Empty: none

  template <class Options, class Visit>
  static void each_number(Options& o, Visit&& visit) {
    visit("FeatureOptions::angle", o.angle, least_positive, std::numbers::pi);
    visit("FeatureOptions::corner_angle", o.corner_angle, least_positive, std::numbers::pi);
    visit("FeatureOptions::stray_edges", o.stray_edges, 0, unbounded);
  }
};

namespace detail {

/// Feature edges while they are being sorted out.
class FeatureDetector {
public:
  struct Edge {
    std::array<index_t, 2> vertices;
    index_t half_edge;
    bool given;
    bool alive = true;
  };

  FeatureDetector(std::span<const Vector3> points, const TriangleAdjacency& adjacency, const FeatureOptions& options)
      : points_(points), adjacency_(adjacency) {
    find_sharp(options);
    add_given(options);
    edges_of_vertex_ = make_csr(adjacency.n_vertices(), [&](auto&& put) {
      for (std::size_t e = 0; e < edges_.size(); ++e)
        for (const index_t v : edges_[e].vertices) put(v, static_cast<index_t>(e));
    });
    valence_.assign(adjacency.n_vertices(), 0);
    for (const Edge& e : edges_)
      for (const index_t v : e.vertices) ++valence_[v];
  }

  const std::vector<Edge>& edges() const { return edges_; }
  index_t valence(index_t v) const { return valence_[v]; }

  /// Removes what noise makes and design does not.
  void prune(index_t stray_edges) {
    const std::vector<index_t> component = components();
    std::vector<index_t> before(edges_.size(), 0), after(edges_.size(), 0);
    std::vector<char> keep(edges_.size(), 0);
    for (std::size_t e = 0; e < edges_.size(); ++e) {
      ++before[component[e]];
      if (edges_[e].given) keep[component[e]] = 1;
    }
    while (prune_strays(stray_edges)) {  // each time there are fewer edges
    }
    for (std::size_t e = 0; e < edges_.size(); ++e) after[component[e]] += edges_[e].alive;
    // What frays at its ends is noise throughout, and so is a loop about a single triangle.
    for (std::size_t e = 0; e < edges_.size(); ++e) {
      const index_t c = component[e];
      const bool frayed = 10 * (before[c] - after[c]) > before[c];
      if (edges_[e].alive && !keep[c] && (frayed || after[c] < 4)) remove(static_cast<index_t>(e));
    }
  }

  /// Corners by valence or turn, ascending.
  std::vector<index_t> corners(double corner_angle) const {
    std::vector<index_t> result;
    for (index_t v = 0; v < valence_.size(); ++v)
      if (valence_[v] == 0 ? is_pinched(v) : valence_[v] != 2 || turn(v) > corner_angle) result.push_back(v);
    return result;
  }

  /// Vertices along each curve between corners, then the closed curves without a corner.
  Csr<index_t> curves(const std::vector<index_t>& corners) const {
    std::vector<char> stop(valence_.size(), 0), used(edges_.size(), 0);
    for (const index_t v : corners) stop[v] = 1;
    Csr<index_t> result;
    const auto trace = [&](index_t start, index_t edge) {
      result.values.push_back(start);
      for (index_t v = start;;) {
        used[edge] = 1;
        v = other_end(edge, v);
        result.values.push_back(v);
        if (stop[v] || v == start) break;
        edge = next_edge(v, edge);
      }
      result.end_row();
    };
    for (const index_t v : corners)
      for (const index_t e : edges_of_vertex_[v])
        if (edges_[e].alive && !used[e]) trace(v, e);
    for (index_t v = 0; v < valence_.size(); ++v) {
      if (valence_[v] == 0 || stop[v]) continue;
      for (const index_t e : edges_of_vertex_[v])
        if (edges_[e].alive && !used[e]) trace(v, e);
    }
    return result;
  }

private:
  void find_sharp(const FeatureOptions& options) {
    const std::vector<Vector3> normals = triangle_normals(points_, adjacency_);
    const double cosine = std::cos(options.angle);
    const auto& label = options.patches;
    const std::vector<index_t> first_side = first_sides();
    for (index_t h = 0; h < adjacency_.opposite.size(); ++h) {
      const index_t twin = adjacency_.opposite[h];
      const bool rim = twin == no_index;
      if (rim ? first_side[h] != h : twin < h) continue;
      const bool given = rim || (!label.empty() && label[h / 3] != label[twin / 3]);
      if (!given && !(normals[h / 3].dot(normals[twin / 3]) < cosine)) continue;
      edges_.push_back({{adjacency_.from(h), adjacency_.to(h)}, h, given});
    }
  }

  /// The smallest half edge on the edge of each rim: where several sheets end there is one edge all the same.
  std::vector<index_t> first_sides() const {
    std::vector<std::array<index_t, 3>> rims;
    for (index_t h = 0; h < adjacency_.opposite.size(); ++h)
      if (adjacency_.opposite[h] == no_index) {
        const auto [low, high] = std::minmax({adjacency_.from(h), adjacency_.to(h)});
        rims.push_back({low, high, h});
      }
    std::sort(rims.begin(), rims.end());
    std::vector<index_t> first(adjacency_.opposite.size(), no_index);
    for (std::size_t i = 0; i < rims.size(); ++i) {
      const bool same = i > 0 && rims[i][0] == rims[i - 1][0] && rims[i][1] == rims[i - 1][1];
      first[rims[i][2]] = same ? first[rims[i - 1][2]] : rims[i][2];
    }
    return first;
  }

  /// Do several sheets meet in a vertex without a feature?
  bool is_pinched(index_t v) const {
    const auto around = adjacency_.triangles_of_vertex[v];
    if (around.empty()) return false;
    index_t first = 3 * around[0];
    while (adjacency_.from(first) != v) ++first;
    std::size_t n_reached = 0;
    for (index_t h = first; n_reached == 0 || h != first; ++n_reached)
      h = adjacency_.opposite[TriangleAdjacency::previous(h)];
    return n_reached != around.size();
  }

  void add_given(const FeatureOptions& options) {
    if (options.given_edges.empty()) return;
    std::vector<index_t> edge_of(adjacency_.opposite.size(), no_index);
    for (std::size_t e = 0; e < edges_.size(); ++e) edge_of[edges_[e].half_edge] = static_cast<index_t>(e);
    for (const auto& given : options.given_edges) {
      const index_t h = find_half_edge(given);
      if (edge_of[h] == no_index) {
        edge_of[h] = static_cast<index_t>(edges_.size());
        edges_.push_back({{adjacency_.from(h), adjacency_.to(h)}, h, true});
      }
      edges_[edge_of[h]].given = true;
    }
  }

  /// The smaller half edge of an edge given by its vertices.
  index_t find_half_edge(const std::array<index_t, 2>& vertices) const {
    if (vertices[0] < adjacency_.n_vertices())
      for (const index_t t : adjacency_.triangles_of_vertex[vertices[0]])
        for (index_t h = 3 * t; h < 3 * t + 3; ++h) {
          const bool forth = adjacency_.from(h) == vertices[0] && adjacency_.to(h) == vertices[1];
          const bool back = adjacency_.from(h) == vertices[1] && adjacency_.to(h) == vertices[0];
          if (forth || back) return std::min(h, adjacency_.opposite[h]);
        }
    throw invalid_option("given feature edge (" + std::to_string(vertices[0]) + ", " + std::to_string(vertices[1]) +
                             ") is not an edge of the surface",
                         Entity::edge, {vertices[0], vertices[1]});
  }

  index_t other_end(index_t edge, index_t v) const {
    const auto& ends = edges_[edge].vertices;
    return ends[0] == v ? ends[1] : ends[0];
  }

  /// The live edge at a vertex of valence two that is not `edge`.
  index_t next_edge(index_t v, index_t edge) const {
    for (const index_t e : edges_of_vertex_[v])
      if (edges_[e].alive && e != edge) return e;
    return no_index;
  }

  void remove(index_t edge) {
    edges_[edge].alive = false;
    for (const index_t v : edges_[edge].vertices) --valence_[v];
  }

  double turn(index_t v) const {
    Vector3 sum = Vector3::Zero(), last = Vector3::Zero();
    for (const index_t e : edges_of_vertex_[v]) {
      if (!edges_[e].alive) continue;
      last = (points_[other_end(e, v)] - points_[v]).normalized();
      sum += last;
    }
    const Vector3 first = sum - last;
    return std::numbers::pi - std::atan2(first.cross(last).norm(), first.dot(last));
  }

  /// Follows curves from loose ends to the next branch and removes the short ones. @return whether it removed any.
  bool prune_strays(index_t stray_edges) {
    bool pruned = false;
    std::vector<index_t> chain;
    for (index_t end = 0; end < valence_.size(); ++end) {
      if (valence_[end] != 1) continue;
      chain.clear();
      bool given = false;
      index_t v = end;
      for (index_t e = next_edge(v, no_index);;) {
        chain.push_back(e);
        given = given || edges_[e].given;
        v = other_end(e, v);
        if (valence_[v] != 2) break;
        e = next_edge(v, e);
      }
      if (given || chain.size() >= stray_edges) continue;
      for (const index_t e : chain) remove(e);
      pruned = true;
    }
    return pruned;
  }

  /// Number of the connected component of each edge: the smallest edge in it.
  std::vector<index_t> components() const {
    std::vector<index_t> component(edges_.size(), no_index), stack;
    for (index_t seed = 0; seed < edges_.size(); ++seed) {
      if (component[seed] != no_index) continue;
      component[seed] = seed;
      stack.assign(1, seed);
      while (!stack.empty()) {
        const index_t e = stack.back();
        stack.pop_back();
        for (const index_t v : edges_[e].vertices)
          for (const index_t next : edges_of_vertex_[v]) {
            if (component[next] != no_index) continue;
            component[next] = seed;
            stack.push_back(next);
          }
      }
    }
    return component;
  }

  std::span<const Vector3> points_;
  const TriangleAdjacency& adjacency_;
  std::vector<Edge> edges_;
  Csr<index_t> edges_of_vertex_;
  std::vector<index_t> valence_;
};

/// Labels regions bounded by feature edges, in the order of their first triangles.
inline void label_patches(const TriangleAdjacency& adjacency, FeatureGraph& graph) {
  graph.triangle_patch.assign(adjacency.triangles.size(), no_index);
  graph.n_patches = 0;
  std::vector<index_t> stack;
  for (index_t seed = 0; seed < adjacency.triangles.size(); ++seed) {
    if (graph.triangle_patch[seed] != no_index) continue;
    graph.triangle_patch[seed] = graph.n_patches;
    stack.assign(1, seed);
    while (!stack.empty()) {
      const index_t t = stack.back();
      stack.pop_back();
      for (index_t h = 3 * t; h < 3 * t + 3; ++h) {
        const index_t twin = adjacency.opposite[h];
        if (twin == no_index || graph.is_feature[h] || graph.triangle_patch[twin / 3] != no_index) continue;
        graph.triangle_patch[twin / 3] = graph.n_patches;
        stack.push_back(twin / 3);
      }
    }
    ++graph.n_patches;
  }
}

/// See `detect_features`.
inline FeatureGraph find_features(std::span<const Vector3> points, const TriangleAdjacency& adjacency,
                                  const FeatureOptions& options) {
  if (!options.patches.empty() && options.patches.size() != adjacency.triangles.size())
    throw invalid_option("there are " + std::to_string(options.patches.size()) + " patch labels for " +
                         std::to_string(adjacency.triangles.size()) + " triangles");
  check_options(options);
  FeatureDetector edges(points, adjacency, options);
  edges.prune(options.stray_edges);

  FeatureGraph graph;
  graph.corners = edges.corners(options.corner_angle);
  graph.curves = edges.curves(graph.corners);
  graph.is_feature.assign(adjacency.opposite.size(), 0);
  for (const auto& edge : edges.edges()) {
    if (!edge.alive) continue;
    graph.is_feature[edge.half_edge] = 1;
    const index_t twin = adjacency.opposite[edge.half_edge];
    if (twin != no_index) graph.is_feature[twin] = 1;
  }
  for (index_t h = 0; h < adjacency.opposite.size(); ++h)
    if (adjacency.opposite[h] == no_index) graph.is_feature[h] = 1;
  label_patches(adjacency, graph);
  return graph;
}

}  // namespace detail

}  // namespace framehex
