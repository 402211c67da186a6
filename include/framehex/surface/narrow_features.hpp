// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/mesh/adjacency.hpp"
#include "framehex/mesh/concepts.hpp"
#include "framehex/mesh/indexed_mesh.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace framehex {

/// A surface without its narrowest features, and where its triangles come from.
struct MergedFeatures {
  IndexedTriangleMesh surface;
  std::vector<index_t> parent;  ///< triangle -> triangle of the input
  std::size_t n_merged = 0;     ///< vertices that became one with another
};

namespace detail {

/// Merges in rounds; in each one, edges whose surroundings do not touch.
class FeatureMerger {
public:
  FeatureMerger(IndexedTriangleMesh surface, double least) : least_(least) {
    result_.surface = std::move(surface);
    result_.parent.resize(result_.surface.triangles.size());
    std::iota(result_.parent.begin(), result_.parent.end(), index_t{0});
    has_taken_.assign(result_.surface.points.size(), 0);
  }

  /// Ends: each round but the last takes a vertex away.
  MergedFeatures run() {
    while (merge_some()) drop_flat();
    drop_unused();
    return std::move(result_);
  }

private:
  struct Edge {
    double length;
    index_t from, to;
  };

  std::vector<Edge> short_edges(const TriangleAdjacency& adjacency) const {
    std::vector<Edge> edges;
    for (index_t h = 0; h < adjacency.opposite.size(); ++h) {
      const index_t v = adjacency.from(h), w = adjacency.to(h);
      if (adjacency.opposite[h] == no_index || v > w) continue;
      const double length = (point(v) - point(w)).norm();
      if (length < least_) edges.push_back({length, v, w});
    }
    std::sort(edges.begin(), edges.end(), [](const Edge& a, const Edge& b) {
      return std::tuple(a.length, a.from, a.to) < std::tuple(b.length, b.from, b.to);
    });
    return edges;
  }

  bool merge_some() {
    const TriangleAdjacency adjacency = make_adjacency(result_.surface, Junctions::open);
    fixed_.assign(adjacency.n_vertices(), 0);
    for (index_t h = 0; h < adjacency.opposite.size(); ++h)
      if (adjacency.opposite[h] == no_index) fixed_[adjacency.from(h)] = fixed_[adjacency.to(h)] = 1;
    becomes_.resize(adjacency.n_vertices());
    std::iota(becomes_.begin(), becomes_.end(), index_t{0});
    bool merged = false;
    for (const Edge& edge : short_edges(adjacency)) {
      if (fixed_[edge.from] || fixed_[edge.to] || !keeps_topology(adjacency, edge)) continue;
      const double one_way = least_turn(adjacency, edge.from, edge.to);
      const double other_way = least_turn(adjacency, edge.to, edge.from);
      if (std::max(one_way, other_way) < least_cosine) continue;
      const auto [goes, stays] = one_way >= other_way ? std::pair(edge.from, edge.to) : std::pair(edge.to, edge.from);
      becomes_[goes] = stays;
      has_taken_[stays] = 1;
      ++result_.n_merged;
      merged = true;
      for (const index_t v : {goes, stays})
        for (const index_t w : adjacency.vertices_of_vertex[v]) fixed_[w] = 1;
    }
    return merged;
  }

  /// Whether no vertex is a neighbour of both but those of the edge's triangles: the surface stays a surface.
  static bool keeps_topology(const TriangleAdjacency& adjacency, const Edge& edge) {
    const auto a = adjacency.vertices_of_vertex[edge.from], b = adjacency.vertices_of_vertex[edge.to];
    std::size_t n_common = 0;
    for (const index_t v : a) n_common += std::binary_search(b.begin(), b.end(), v);
    return n_common == 2 && a.size() + b.size() > 6;  // a tetrahedron is as small as a surface gets
  }

  /// Least cosine of the angle by which a triangle turns when a vertex goes to its neighbour; -1 where that must not be.
  /// A triangle narrower than what is merged has no direction worth keeping.
  double least_turn(const TriangleAdjacency& adjacency, index_t goes, index_t stays) {
    if (has_taken_[goes]) return -1;  // what it has taken would move too far
    normals_.clear();
    double least = 1;
    for (const index_t t : adjacency.triangles_of_vertex[stays])
      if (is_wide(t)) normals_.push_back(area_vector(result_.surface.triangles[t]).normalized());
    for (const index_t t : adjacency.triangles_of_vertex[goes]) {
      std::array<index_t, 3> triangle = result_.surface.triangles[t];
      if (std::find(triangle.begin(), triangle.end(), stays) != triangle.end() || !is_wide(t)) continue;
      const Vector3 before = area_vector(triangle).normalized();
      std::replace(triangle.begin(), triangle.end(), goes, stays);
      const Vector3 after = area_vector(triangle);
      least = std::min(least, after.norm() > 0 ? before.dot(after.normalized()) : -1.0);
      normals_.push_back(before);
    }
    if (normals_.empty()) return -1;  // all is as small here
    // The two sides of a sheet, or of a slot, are no feature of it.
    for (const Vector3& n : normals_)
      for (const Vector3& m : normals_)
        if (n.dot(m) < most_opposed) return -1;
    return least;
  }

  bool is_wide(index_t t) const {
    const auto& [a, b, c] = result_.surface.triangles[t];
    const double longest =
        std::max({(point(a) - point(b)).norm(), (point(b) - point(c)).norm(), (point(c) - point(a)).norm()});
    return 2 * area_vector(result_.surface.triangles[t]).norm() >= least_ * longest;
  }

  /// Half the cross product of two edges.
  Vector3 area_vector(const std::array<index_t, 3>& t) const {
    return 0.5 * (point(t[1]) - point(t[0])).cross(point(t[2]) - point(t[0]));
  }

  const Vector3& point(index_t v) const { return result_.surface.points[v]; }

  void drop_flat() {
    auto& triangles = result_.surface.triangles;
    std::size_t n = 0;
    for (std::size_t t = 0; t < triangles.size(); ++t) {
      std::array<index_t, 3> triangle = triangles[t];
      for (index_t& v : triangle) v = becomes_[v];
      if (triangle[0] == triangle[1] || triangle[1] == triangle[2] || triangle[2] == triangle[0]) continue;
      triangles[n] = triangle;
      result_.parent[n++] = result_.parent[t];
    }
    triangles.resize(n);
    result_.parent.resize(n);
  }

  void drop_unused() {
    auto& [points, triangles] = result_.surface;
    std::vector<index_t> number(points.size(), no_index);
    for (const auto& triangle : triangles)
      for (const index_t v : triangle) number[v] = 0;
    index_t n = 0;
    for (index_t v = 0; v < points.size(); ++v) {
      if (number[v] == no_index) continue;
      points[n] = points[v];
      number[v] = n++;
    }
    points.resize(n);
    for (auto& triangle : triangles)
      for (index_t& v : triangle) v = number[v];
  }

  static constexpr double least_cosine = 0.5;
  static constexpr double most_opposed = -0.5;

  double least_;
  MergedFeatures result_;
  std::vector<std::uint8_t> fixed_;      ///< by vertex: not in this round
  std::vector<std::uint8_t> has_taken_;  ///< by vertex: others have become one with it, and it stays where it is
  std::vector<index_t> becomes_;
  std::vector<Vector3> normals_;
};

}  // namespace detail

/// Takes out ledges, steps and grooves narrower than a length: edges shorter than it are merged, shortest first, where the
/// surface stays a surface and none of its wider triangles turns by more than 60 degrees.
///
/// Sheets, slots and slender bodies stay, however thin, as do rims and edges where sheets meet, and surfaces whose triangles
/// are all as small. A surface without edges shorter than `least` stays as it is.
///
/// @param surface  n triangles of any kind, closed or open; vertices without triangles are left out.
/// @param least    in the unit of the coordinates; each vertex goes to another that is nearer than this, and stays there.
/// @pre the vertices of triangles are in range and differ.
/// @par Complexity   O(n log n) a round; as many rounds as vertices of one feature have neighbours that are merged too, two
///                   to six on ledges.
/// @par Determinism  Depends on nothing but the arguments; equal lengths by number.
template <TriangleMesh M>
MergedFeatures merge_narrow_features(const M& surface, double least) {
  return detail::FeatureMerger({positions(surface), triangles(surface)}, least).run();
}

}  // namespace framehex
