// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/mesh/quad_mesh.hpp"
#include "framehex/quads/detail/pairing_graph.hpp"

#include <utility>

namespace framehex::detail {

/// Turns pairs of triangles into quadrilaterals.
///
/// Two that share an edge lose it. Two that share a vertex open it: between them, round the vertex, the triangles get a
/// copy of it, and each of the two gets the edge from the vertex to the copy as its fourth side.
class PairJoiner {
public:
  PairJoiner(const Surface& surface, const PatchSides& sides, const PairingGraph& graph, std::vector<index_t> mate)
      : surface_(surface),
        sides_(sides),
        graph_(graph),
        mate_(std::move(mate)),
        corners_(surface.triangles()),
        opened_(corners_.size()) {
    mesh_.points = surface.points;
    mesh_.corners = surface.features.corners;
    for (std::size_t c = 0; c < surface.features.curves.size(); ++c) {
      const auto row = surface.features.curves[c];
      for (std::size_t i = 1; i < row.size(); ++i)
        mesh_.edges.push_back({{row[i - 1], row[i]}, static_cast<index_t>(c)});
    }
  }

  QuadMesh run() {
    open_vertices();
    for (index_t t = 0; t < mate_.size(); ++t) {
      const index_t s = mate_[t];
      if (opened_[t].corner != no_index)
        add(t, with_copy(opened_[t]));
      else if (s == no_index)
        add(t, {corners_[t][0], corners_[t][1], corners_[t][2], no_index});
      else if (t < s)
        add(t, merged(graph_.shared_edge(t, s)));
    }
    return std::move(mesh_);
  }

  /// For each vertex added, after those of the surface: the one that it is a copy of.
  const std::vector<index_t>& copied() const { return copied_; }

private:
  /// A triangle that opens a vertex.
  struct Opened {
    index_t corner = no_index;  ///< half edge from the vertex
    index_t copy = no_index;
    bool copy_leads = false;  ///< the copy comes after the vertex seen clockwise from inside the triangle
  };

  index_t vertex(index_t half_edge) const { return corners_[half_edge / 3][half_edge % 3]; }

  void open_vertices() {
    std::vector<std::pair<index_t, index_t>> places;  // vertex, half edge from it
    for (index_t t = 0; t < mate_.size(); ++t) {
      if (mate_[t] == no_index || graph_.shared_edge(t, mate_[t]) != no_index) continue;
      index_t h = 3 * t;
      while (surface_.adjacency.from(h) != graph_.opened_vertex(t, mate_[t])) ++h;
      opened_[t].corner = h;
      places.emplace_back(surface_.adjacency.from(h), h);
    }
    std::sort(places.begin(), places.end());
    std::vector<char> done(corners_.size(), 0);
    TriangleFan fan;
    std::vector<std::size_t> marked;
    for (const auto& [v, h] : places) {
      if (done[h / 3]) continue;
      sides_.fan(h, fan);
      marked.clear();
      for (std::size_t i = 0; i < fan.outgoing.size(); ++i)
        if (opened_[fan.outgoing[i] / 3].corner == fan.outgoing[i]) {
          marked.push_back(i);
          done[fan.outgoing[i] / 3] = 1;
        }
      // Pairs may lie across one another; with the next one each they do not.
      for (std::size_t k = 0; k + 1 < marked.size(); k += 2) open(v, fan, marked[k], marked[k + 1]);
    }
  }

  /// Opens a vertex between two triangles of its fan, which need not have been each other's mates.
  void open(index_t v, const TriangleFan& fan, std::size_t begin, std::size_t end) {
    const index_t first = fan.outgoing[begin], last = fan.outgoing[end];
    mate_[first / 3] = last / 3;
    mate_[last / 3] = first / 3;
    if (graph_.shared_edge(first / 3, last / 3) != no_index) {
      opened_[first / 3] = opened_[last / 3] = {};
      return;
    }
    const auto copy = static_cast<index_t>(mesh_.points.size());
    opened_[first / 3] = {first, copy, false};
    opened_[last / 3] = {last, copy, true};
    copied_.push_back(v);
    Vector3 sum = Vector3::Zero();
    for (std::size_t i = begin + 1; i <= end; ++i) sum += surface_.points[surface_.adjacency.to(fan.outgoing[i])];
    mesh_.points.push_back((surface_.points[v] + sum / static_cast<double>(end - begin)) / 2);
    for (std::size_t i = begin + 1; i < end; ++i) corners_[fan.outgoing[i] / 3][fan.outgoing[i] % 3] = copy;
  }

  QuadMesh::Cell with_copy(const Opened& opened) const {
    const index_t v = vertex(opened.corner), next = vertex(TriangleAdjacency::next(opened.corner)),
                  previous = vertex(TriangleAdjacency::previous(opened.corner));
    return opened.copy_leads ? QuadMesh::Cell{opened.copy, next, previous, v}
                             : QuadMesh::Cell{v, next, previous, opened.copy};
  }

  QuadMesh::Cell merged(index_t h) const {
    const index_t g = surface_.adjacency.opposite[h];
    return {vertex(h), vertex(TriangleAdjacency::previous(g)), vertex(TriangleAdjacency::next(h)),
            vertex(TriangleAdjacency::previous(h))};
  }

  void add(index_t t, const QuadMesh::Cell& cell) {
    mesh_.cells.push_back(cell);
    mesh_.patches.push_back(surface_.features.triangle_patch[t]);
  }

  const Surface& surface_;
  const PatchSides& sides_;
  const PairingGraph& graph_;
  std::vector<index_t> mate_;
  std::vector<std::array<index_t, 3>> corners_;  ///< of the triangles, with copies
  std::vector<Opened> opened_;                   ///< one a triangle
  std::vector<index_t> copied_;
  QuadMesh mesh_;
};

}  // namespace framehex::detail
