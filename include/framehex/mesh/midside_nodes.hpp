// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/geometry/quadratic_validity.hpp"
#include "framehex/mesh/mixed_mesh.hpp"

#include <algorithm>
#include <array>
#include <utility>

namespace framehex {

/// A node on each edge of a mesh, which makes its cells quadratic: of 10, 13, 15 and 20 nodes.
struct MidsideNodes {
  std::vector<std::array<index_t, 2>> edges;  ///< of the cells; the smaller vertex first, ascending
  std::vector<Vector3> points;                ///< one an edge; where an edge is straight, its middle
  std::size_t n_curved = 0;                   ///< off the middle
  std::size_t n_straightened = 0;             ///< would be off it, but a cell would not surely be valid

  /// Number of the node of an edge of the mesh, either end first.
  index_t of(index_t a, index_t b) const {
    const std::array<index_t, 2> edge{std::min(a, b), std::max(a, b)};
    return static_cast<index_t>(std::lower_bound(edges.begin(), edges.end(), edge) - edges.begin());
  }
};

namespace detail {

inline std::vector<std::array<index_t, 2>> edges_of_cells(const MixedMesh& mesh) {
  std::vector<std::array<index_t, 2>> edges;
  for (std::size_t c = 0; c < mesh.n_cells(); ++c)
    for (const auto& [a, b] : edges_of(mesh.kinds[c])) {
      const index_t v = mesh.cells[c][static_cast<std::size_t>(a)], w = mesh.cells[c][static_cast<std::size_t>(b)];
      edges.push_back({std::min(v, w), std::max(v, w)});
    }
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  return edges;
}

/// Cells whose nodes are where they are wanted, but for edges that are made straight again until all are valid.
class EdgeCurver {
public:
  EdgeCurver(const MixedMesh& mesh, MidsideNodes& nodes) : mesh_(mesh), nodes_(nodes), is_curved_(nodes.edges.size()) {
    for (std::size_t e = 0; e < is_curved_.size(); ++e) is_curved_[e] = nodes.points[e] != middle(e);
    for (std::size_t c = 0; c < mesh.n_cells(); ++c) {
      for (const auto& [a, b] : edges_of(mesh.kinds[c]))
        edges_of_cell_.values.push_back(
            nodes.of(mesh.cells[c][static_cast<std::size_t>(a)], mesh.cells[c][static_cast<std::size_t>(b)]));
      edges_of_cell_.end_row();
    }
    cells_of_edge_ = make_csr(is_curved_.size(), [&](auto&& put) {
      for (index_t c = 0; c < edges_of_cell_.size(); ++c)
        for (const index_t e : edges_of_cell_[c])
          if (is_curved_[e]) put(e, c);
    });
  }

  /// Each round makes an edge straight, and no edge is ever curved again: it ends.
  void run() {
    std::vector<index_t> doubtful;
    for (index_t c = 0; c < edges_of_cell_.size(); ++c)
      if (has_curved_edge(c)) doubtful.push_back(c);
    while (!doubtful.empty()) {
      std::vector<index_t> next;
      for (const index_t c : doubtful)
        if (has_curved_edge(c) && !is_valid(c)) straighten(c, next);
      std::sort(next.begin(), next.end());
      next.erase(std::unique(next.begin(), next.end()), next.end());
      doubtful = std::move(next);
    }
    nodes_.n_curved = static_cast<std::size_t>(std::count(is_curved_.begin(), is_curved_.end(), 1));
  }

private:
  Vector3 middle(std::size_t edge) const {
    const auto& [a, b] = nodes_.edges[edge];
    return (mesh_.points[a] + mesh_.points[b]) / 2;
  }

  bool has_curved_edge(index_t cell) const {
    return std::ranges::any_of(edges_of_cell_[cell], [&](index_t e) { return is_curved_[e] != 0; });
  }

  bool is_valid(index_t cell) const {
    std::array<Vector3, 8> corners;
    std::array<Vector3, 12> middles;
    const auto row = mesh_.cells[cell];
    const auto edges = edges_of_cell_[cell];
    for (std::size_t i = 0; i < row.size(); ++i) corners[i] = mesh_.points[row[i]];
    for (std::size_t i = 0; i < edges.size(); ++i) middles[i] = nodes_.points[edges[i]];
    return is_surely_valid(mesh_.kinds[cell], std::span(corners).first(row.size()),
                           std::span(middles).first(edges.size()));
  }

  /// A neighbour that has lost some of its curved edges is another cell.
  void straighten(index_t cell, std::vector<index_t>& touched) {
    for (const index_t e : edges_of_cell_[cell]) {
      if (!is_curved_[e]) continue;
      is_curved_[e] = 0;
      nodes_.points[e] = middle(e);
      ++nodes_.n_straightened;
      touched.insert(touched.end(), cells_of_edge_[e].begin(), cells_of_edge_[e].end());
    }
  }

  const MixedMesh& mesh_;
  MidsideNodes& nodes_;
  std::vector<std::uint8_t> is_curved_;  // by edge
  Csr<index_t> edges_of_cell_, cells_of_edge_;
};

}  // namespace detail

/// Nodes on the edges of a mesh: of labelled faces and edges on the surface, where all cells stay valid; elsewhere, and
/// where one would not (`is_surely_valid`), in the middle.
///
/// @param mesh  valid cells. @param onto  callable `Vector3(int dimension, index_t label, const Vector3& middle)`: where
///              the node of an edge belongs that is on a patch (dimension 2) or a curve (1) of that label.
/// @return the nodes, and how many are off the middle.
/// @par Complexity   O(n log n), and about 100 microseconds for each cell that touches the surface.
/// @par Determinism  In the order of the mesh's faces, edges and cells.
template <class Onto>
MidsideNodes midside_nodes(const MixedMesh& mesh, Onto&& onto) {
  MidsideNodes nodes;
  nodes.edges = detail::edges_of_cells(mesh);
  const auto middle = [&](const std::array<index_t, 2>& edge) -> Vector3 {
    return (mesh.points[edge[0]] + mesh.points[edge[1]]) / 2;
  };
  for (const auto& edge : nodes.edges) nodes.points.push_back(middle(edge));
  const auto place = [&](index_t e, int dimension, index_t label) {
    const auto& [a, b] = nodes.edges[e];
    const Vector3 straight = middle(nodes.edges[e]), wanted = onto(dimension, label, straight);
    constexpr double rounding = 1e-6;  // of an edge's length: bends that are none
    const bool bends = (wanted - straight).norm() > rounding * (mesh.points[a] - mesh.points[b]).norm();
    nodes.points[e] = bends ? wanted : straight;
  };
  // An edge between two patches is on a curve, which has the last word.
  std::vector<std::uint8_t> placed(nodes.edges.size(), 0);
  for (const LabelledFace& face : mesh.faces)
    for (std::size_t i = 0; i < face.size() && face.label != no_index; ++i) {
      const index_t e = nodes.of(face.vertices[i], face.vertices[(i + 1) % face.size()]);
      if (!std::exchange(placed[e], std::uint8_t{1})) place(e, 2, face.label);
    }
  for (const LabelledEdge& edge : mesh.edges) place(nodes.of(edge.vertices[0], edge.vertices[1]), 1, edge.label);
  detail::EdgeCurver(mesh, nodes).run();
  return nodes;
}

}  // namespace framehex
