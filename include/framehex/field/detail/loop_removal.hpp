// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/field/singular_graph.hpp"

namespace framehex {

namespace detail {

/// Finds edges round which a singular line closes, and turns their frames.
class LoopRemover {
public:
  using Edge = std::array<index_t, 2>;

  LoopRemover(const TetAdjacency& adjacency, std::span<Quaternion> frames, std::span<const FrameConstraint> constraints,
              std::span<const Vector3> axes)
      : adjacency_(adjacency), frames_(frames), constraints_(constraints), axes_(axes) {}

  /// Edges with at least three singular facets, ascending.
  std::vector<Edge> candidates() const {
    std::vector<Edge> edges;
    for (index_t tet = 0; tet < adjacency_.tets.size(); ++tet)
      for (int face = 0; face < 4; ++face) {
        if (!is_counted(tet, face) || monodromy(frames_, facet(adjacency_.tets[tet], face)) == 0) continue;
        const auto t = detail::sorted(facet(adjacency_.tets[tet], face));
        edges.insert(edges.end(), {Edge{t[0], t[1]}, Edge{t[0], t[2]}, Edge{t[1], t[2]}});
      }
    std::sort(edges.begin(), edges.end());
    std::vector<Edge> found;
    for (std::size_t i = 2; i < edges.size(); ++i)
      if (edges[i] == edges[i - 2] && (found.empty() || found.back() != edges[i])) found.push_back(edges[i]);
    return found;
  }

  /// @return whether all facets at the edge were singular and there are fewer at its vertices now.
  bool remove_at(const Edge& edge) {
    const auto [v, w] = edge;
    index_t apex = no_index;
    for (const index_t tet : adjacency_.tets_of_vertex[v])
      for (int face = 0; face < 4; ++face) {
        const auto t = facet(adjacency_.tets[tet], face);
        if (std::count(t.begin(), t.end(), v) + std::count(t.begin(), t.end(), w) != 2) continue;
        if (monodromy(frames_, t) == 0) return false;
        apex = *std::find_if(t.begin(), t.end(), [&](index_t u) { return u != v && u != w; });
      }
    if (apex == no_index) return false;
    // All ways round the edge agree on this form of the frame of `w`, and the edge on another.
    using Group = CubeRotationGroup<>;
    const Quaternion from = frames_[v], to = frames_[w];
    const Quaternion form = Group::aligned(Group::aligned(from, frames_[apex]), to);
    const Vector3 rotation = Group::logarithm(form * from.conjugate());
    const int before = singular_facets(v, w);
    for (const double share : {1.0 / 64, 1.0 / 32, 1.0 / 16, 1.0 / 8, 1.0 / 4}) {
      frames_[v] = turned(v, from, share * rotation);
      frames_[w] = turned(w, to, -share * rotation);
      if (singular_facets(v, w) < before) return true;
    }
    frames_[v] = from;
    frames_[w] = to;
    return false;
  }

private:
  /// Whether it is this of the two tetrahedra of a facet that counts it.
  bool is_counted(index_t tet, int face) const {
    const index_t other = adjacency_.neighbours[tet][static_cast<std::size_t>(face)];
    return other == no_index || other > tet;
  }

  /// Facets at v or w, each counted once: no others change with the two frames.
  int singular_facets(index_t v, index_t w) const {
    return singular_facets_without(v, no_index) + singular_facets_without(w, v);
  }

  /// Facets at v that do not have the other vertex.
  int singular_facets_without(index_t v, index_t other) const {
    int n = 0;
    for (const index_t tet : adjacency_.tets_of_vertex[v])
      for (int face = 0; face < 4; ++face) {
        if (adjacency_.tets[tet][static_cast<std::size_t>(face)] == v || !is_counted(tet, face)) continue;
        const auto t = facet(adjacency_.tets[tet], face);
        if (std::find(t.begin(), t.end(), other) == t.end() && monodromy(frames_, t) != 0) ++n;
      }
    return n;
  }

  Quaternion turned(index_t v, const Quaternion& frame, Vector3 rotation) const {
    if (constraints_[v] == FrameConstraint::fixed) return frame;
    if (constraints_[v] == FrameConstraint::axis) rotation = axes_[v] * axes_[v].dot(rotation);
    return (CubeRotationGroup<>::exponential(rotation) * frame).normalized();
  }

  const TetAdjacency& adjacency_;
  std::span<Quaternion> frames_;
  std::span<const FrameConstraint> constraints_;
  std::span<const Vector3> axes_;
};

}  // namespace detail

/// Removes the singular lines that close round one edge.
///
/// Frames that turn by about 45 degrees over an edge are matched either way round. When the edge takes one way and all
/// paths over a third vertex the other, every facet at the edge is singular: a line that closes round it, or, on the
/// boundary, an arc from facet to facet, in a field that has none there. The two frames are turned towards each other
/// the way of the paths, by the least of a few shares of the angle that leaves fewer singular facets. Other lines are
/// not touched.
///
/// @param frames       n_vertices unit quaternions, changed in place.
/// @param constraints  fixed frames stay; those with an axis (in `axes` and in the frame) turn about it only.
/// @return how many edges were mended.
/// @par Complexity   O(tetrahedra).
/// @par Determinism  Edges are visited in ascending order, one at a time.
inline std::size_t remove_small_loops(const TetAdjacency& adjacency, std::span<Quaternion> frames,
                                      std::span<const FrameConstraint> constraints, std::span<const Vector3> axes) {
  detail::LoopRemover remover(adjacency, frames, constraints, axes);
  std::size_t n_removed = 0;
  // Every change leaves fewer singular facets in the mesh, each counted once, so this ends.
  for (bool changed = true; changed;) {
    changed = false;
    for (const auto& edge : remover.candidates())
      if (remover.remove_at(edge)) {
        ++n_removed;
        changed = true;
      }
  }
  return n_removed;
}

}  // namespace framehex
