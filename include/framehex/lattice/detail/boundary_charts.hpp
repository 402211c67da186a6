// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/lattice/boundary_axes.hpp"

#include <utility>

namespace framehex::detail {

/// Union-find over the axes of all vertices, numbered 3 v + a, which knows of each whether it runs along or against the
/// first of its set.
class AxisSets {
public:
  explicit AxisSets(std::size_t n_vertices) : parent_(3 * n_vertices), against_(3 * n_vertices, 0) {
    for (index_t i = 0; i < parent_.size(); ++i) parent_[i] = i;
  }

  /// @return the set's least member, and 1 when i runs against it.
  std::pair<index_t, std::uint8_t> root(index_t i) const {
    std::uint8_t against = 0;
    for (; parent_[i] != i; i = parent_[i]) against ^= against_[i];
    return {i, against};
  }

  void unite(index_t i, index_t j, bool opposite) {
    auto [a, from_a] = root(i);
    auto [b, from_b] = root(j);
    shorten(i, a, from_a);
    shorten(j, b, from_b);
    if (a == b) return;
    if (a > b) std::swap(a, b);
    parent_[b] = a;
    against_[b] = from_a ^ from_b ^ static_cast<std::uint8_t>(opposite ? 1 : 0);
  }

private:
  void shorten(index_t i, index_t root, std::uint8_t against) {
    while (parent_[i] != root && i != root) {
      const index_t next = std::exchange(parent_[i], root);
      against ^= std::exchange(against_[i], against);
      i = next;
    }
  }

  std::vector<index_t> parent_;
  std::vector<std::uint8_t> against_;  // its parent
};

/// The sets of axes that hang together by the edges of a mesh: their coordinates may be shifted as a whole.
inline AxisSets connected_axes(const LatticeGraph& graph) {
  AxisSets parts(graph.n_vertices());
  for (index_t e = 0; e < graph.n_edges(); ++e) {
    const auto [v, w] = graph.edges()[e];
    for (index_t a = 0; a < 3; ++a) parts.unite(3 * v + a, 3 * w + graph.matching(e).axis[a], false);
  }
  return parts;
}

/// Weights of an edge's axes: charts are held together by stronger ones.
inline Vector3 chart_weights(const LatticeGraph& graph, std::span<const AxisMask> tangent, index_t e) {
  constexpr double stiffer = 32;
  Vector3 result = Vector3::Constant(graph.weights()[e]);
  for (int a = 0; a < 3; ++a)
    if (tangent[e] >> a & 1) result[a] *= stiffer;
  return result;
}

/// Sum of the weights at each vertex, per axis: the diagonal of the equations for coordinates.
inline std::vector<Vector3> chart_stiffness(const LatticeGraph& graph, std::span<const AxisMask> tangent) {
  std::vector<Vector3> result(graph.n_vertices(), Vector3::Zero());
  for (index_t e = 0; e < graph.n_edges(); ++e) {
    const auto [v, w] = graph.edges()[e];
    const Vector3 weights = chart_weights(graph, tangent, e);
    result[v] += weights;
    result[w] += graph.matching(e).to_second_unsigned(weights);
  }
  return result;
}

/// The entries beside the diagonal, along the axes of the edge's lower vertex.
inline Vector3 chart_coupling(const LatticeGraph& graph, std::span<const AxisMask> tangent, index_t e) {
  const AxisMatching& m = graph.matching(e);
  return -chart_weights(graph, tangent, e).cwiseProduct(Vector3(m.sign[0], m.sign[1], m.sign[2]));
}

/// Parts of the boundary on which one coordinate is constant, and whole: axes of boundary vertices joined by the edges
/// that take no step along them.
struct BoundaryCharts {
  struct Member {
    index_t node;          ///< 3 v + a
    std::uint8_t against;  ///< 1: minus the chart's coordinate
  };
  Csr<Member> charts;  ///< in the order of their first members

  /// @param whole, tangent  see `find_boundary_axes`, `tangent_edges`.
  BoundaryCharts(const LatticeGraph& graph, std::span<const AxisMask> whole, std::span<const AxisMask> tangent) {
    const auto n = static_cast<index_t>(3 * graph.n_vertices());
    AxisSets sets(graph.n_vertices());
    for (index_t e = 0; e < graph.n_edges(); ++e) {
      const auto [v, w] = graph.edges()[e];
      const AxisMatching& m = graph.matching(e);
      for (index_t a = 0; a < 3; ++a)
        if ((tangent[e] & whole[v]) >> a & 1) sets.unite(3 * v + a, 3 * w + m.axis[a], m.sign[a] < 0);
    }
    std::vector<index_t> chart_of(n, no_index);
    index_t n_charts = 0;
    const auto is_whole = [&](index_t node) { return (whole[node / 3] >> node % 3 & 1) != 0; };
    for (index_t node = 0; node < n; ++node)
      if (is_whole(node) && sets.root(node).first == node) chart_of[node] = n_charts++;
    charts = make_csr<Member>(n_charts, [&](auto&& put) {
      for (index_t node = 0; node < n; ++node) {
        const auto [root, against] = sets.root(node);
        if (is_whole(node) && chart_of[root] != no_index) put(chart_of[root], Member{node, against});
      }
    });
  }
};

}  // namespace framehex::detail
