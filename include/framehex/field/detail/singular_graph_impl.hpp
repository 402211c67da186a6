// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/field/singular_graph.hpp"

namespace framehex {

namespace detail {

class SingularTracer {
public:
  SingularTracer(const TetAdjacency& adjacency, std::span<const Vector3> points, std::span<const Quaternion> frames)
      : adjacency_(adjacency), points_(points), frames_(frames) {}

  SingularGraph run() {
    find_facets();
    visited_.assign(graph_.facets.size(), 0);
    for (index_t f = 0; f < graph_.facets.size(); ++f)
      for (std::size_t side = 0; side < 2; ++side)
        if (!visited_[f] && is_end(graph_.facets[f].tets[side])) trace(f, side);
    for (index_t f = 0; f < graph_.facets.size(); ++f)
      if (!visited_[f]) trace(f, 0);
    return std::move(graph_);
  }

private:
  void find_facets() {
    facets_of_tet_ = {};
    for (index_t tet = 0; tet < adjacency_.tets.size(); ++tet)
      for (int face = 0; face < 4; ++face) {
        const index_t other = adjacency_.neighbours[tet][static_cast<std::size_t>(face)];
        if (other < tet) continue;
        const auto vertices = facet(adjacency_.tets[tet], face);
        const int g = monodromy(frames_, vertices);
        if (g == 0) continue;
        if (other == no_index) graph_.boundary_facets.push_back(static_cast<index_t>(graph_.facets.size()));
        graph_.facets.push_back({vertices, {tet, other}, g, turn(vertices, g)});
      }
    facets_of_tet_ = make_csr(adjacency_.tets.size(), [&](auto&& put) {
      for (index_t f = 0; f < graph_.facets.size(); ++f)
        for (const index_t tet : graph_.facets[f].tets)
          if (tet != no_index) put(tet, f);
    });
  }

  /// Axis of the turn in space, of unit length.
  Vector3 axis(const std::array<index_t, 3>& t, int g) const {
    const Quaternion q = CubeRotationGroup<>::element(CubeRotationGroup<>::inverse(g));
    return frames_[t[0]] * ((q.w() < 0 ? -1 : 1) * q.vec()).normalized();
  }
  Vector3 normal(const std::array<index_t, 3>& t) const {
    return (points_[t[1]] - points_[t[0]]).cross(points_[t[2]] - points_[t[0]]);
  }
  double turn(const std::array<index_t, 3>& t, int g) const {
    const double size = 1.0 / CubeRotationGroup<>::order(g);
    return axis(t, g).dot(normal(t)) < 0 ? -size : size;
  }

  bool is_end(index_t tet) const { return tet == no_index || facets_of_tet_[tet].size() != 2; }
  Vector3 centre(const std::array<index_t, 3>& t) const { return (points_[t[0]] + points_[t[1]] + points_[t[2]]) / 3; }
  void add_node(index_t tet) {
    if (tet == no_index) return;
    Vector3 sum = Vector3::Zero();
    for (const index_t v : adjacency_.tets[tet]) sum += points_[v] / 4;
    graph_.polylines.values.push_back(sum);
  }

  /// Follows a line that comes into facet `f` from its side `side`.
  void trace(index_t f, std::size_t side) {
    const index_t start = f;
    const int order = CubeRotationGroup<>::order(graph_.facets[f].symmetry);
    bool pure = true;
    double alignment = 0;
    const bool from_end = is_end(graph_.facets[f].tets[side]);
    if (from_end) add_node(graph_.facets[f].tets[side]);
    while (true) {  // a line goes through each facet once, and comes to an end or back to its start
      const SingularFacet& facet = graph_.facets[f];
      visited_[f] = 1;
      graph_.curves.values.push_back(f);
      graph_.polylines.values.push_back(centre(facet.vertices));
      pure = pure && CubeRotationGroup<>::order(facet.symmetry) == order;
      // Facets cut the line at any slant: the sign is that of the sum, in which those across the line weigh most.
      alignment += axis(facet.vertices, facet.symmetry).dot(normal(facet.vertices));
      const index_t tet = facet.tets[1 - side];
      if (is_end(tet)) {
        add_node(tet);
        break;
      }
      const auto pair = facets_of_tet_[tet];
      f = pair[0] == f ? pair[1] : pair[0];
      if (f == start && !from_end) {
        graph_.curves.values.push_back(f);
        graph_.polylines.values.push_back(centre(graph_.facets[f].vertices));
        break;
      }
      side = graph_.facets[f].tets[0] == tet ? 0 : 1;
    }
    graph_.curves.end_row();
    graph_.polylines.end_row();
    graph_.curve_index.push_back(!pure ? 0 : alignment < 0 ? -1.0 / order : 1.0 / order);
  }

  const TetAdjacency& adjacency_;
  std::span<const Vector3> points_;
  std::span<const Quaternion> frames_;
  SingularGraph graph_;
  Csr<index_t> facets_of_tet_;
  std::vector<std::uint8_t> visited_;
};

}  // namespace detail

FRAMEHEX_INLINE SingularGraph singular_graph(const TetAdjacency& adjacency, std::span<const Vector3> points,
                                             std::span<const Quaternion> frames) {
  return detail::SingularTracer(adjacency, points, frames).run();
}

}  // namespace framehex
