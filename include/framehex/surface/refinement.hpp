// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/surface/detail/editable_surface.hpp"

#include <cmath>
#include <queue>
#include <unordered_map>

namespace framehex {

/// A surface of the same shape with shorter edges.
struct RefinedSurface {
  IndexedTriangleMesh surface;  ///< the old vertices first, unchanged
  FeatureGraph features;        ///< the same corners, curves and patches
  std::vector<index_t> parent;  ///< triangle -> triangle of the surface that was refined
};

/// Limits of a refinement.
struct RefinementOptions {
  std::size_t max_triangles = 50'000'000;  ///< needing more is taken for a mistake in the lengths
};

namespace detail {

inline std::uint64_t edge_key(index_t a, index_t b) {
  return (std::uint64_t{std::min(a, b)} << 32) | std::max(a, b);
}

/// Cuts the longest edge (in units of its allowed length) in two until none is too long.
template <class SizeFn>
class Refiner {
public:
  Refiner(EditableSurface& surface, const SizeFn& max_edge, std::size_t max_triangles)
      : surface_(surface), max_edge_(max_edge), max_triangles_(max_triangles) {}

  void run() {
    for (index_t h = 0; h < surface_.opposite.size(); ++h) {
      const index_t twin = surface_.opposite[h];
      if (twin == no_index || h < twin) offer(h);
    }
    while (!queue_.empty()) {
      const Long edge = queue_.top();
      queue_.pop();
      index_t h = edge.half_edge;  // the edge may have moved to another triangle, or have been cut
      if (surface_.from(h) != edge.from || surface_.to(h) != edge.to) h = surface_.find(edge.from, edge.to);
      if (h == no_index) h = surface_.find(edge.to, edge.from);
      if (h != no_index) split(h);
    }
  }

  /// Appends the vertices of edge (a, b) after a, as it has been cut.
  void expand(index_t a, index_t b, std::vector<index_t>& out) const {
    const auto it = middle_.find(edge_key(a, b));
    if (it == middle_.end()) {
      out.push_back(b);
      return;
    }
    expand(a, it->second, out);
    expand(it->second, b, out);
  }

private:
  struct Long {
    double excess;
    index_t half_edge, from, to;

    bool operator<(const Long& o) const {
      if (excess != o.excess) return excess < o.excess;
      return std::pair(std::min(from, to), std::max(from, to)) >
             std::pair(std::min(o.from, o.to), std::max(o.from, o.to));
    }
  };

  void offer(index_t h) {
    const Vector3 &a = surface_.points[surface_.from(h)], &b = surface_.points[surface_.to(h)];
    const double allowed = max_edge_(Vector3((a + b) / 2));
    if (!(allowed > 0))
      throw invalid_field("the greatest edge length at edge (" + std::to_string(surface_.from(h)) + ", " +
                              std::to_string(surface_.to(h)) + ") is " + std::to_string(allowed),
                          Entity::edge, {surface_.from(h), surface_.to(h)});
    const double excess = (b - a).norm() / allowed;
    if (excess > 1) queue_.push({excess, h, surface_.from(h), surface_.to(h)});
  }

  void split(index_t h) {
    if (surface_.n_triangles() + 2 > max_triangles_)
      throw invalid_option("refining the surface needs more than " + std::to_string(max_triangles_) +
                           " triangles: the greatest edge length is too small");
    const index_t a = surface_.from(h), b = surface_.to(h), g = surface_.opposite[h];
    const index_t v = surface_.add_vertex((surface_.points[a] + surface_.points[b]) / 2);
    const bool sharp = surface_.feature[h] != 0;
    if (sharp) middle_.emplace(edge_key(a, b), v);
    const index_t left = surface_.sector[h];
    const index_t right = g == no_index ? left : sharp ? surface_.sector[g] : left;
    const index_t second = surface_.split_edge(h, v, left, right);
    offer(h);
    offer(second);
    offer(surface_.next(h));
    if (g != no_index) offer(surface_.next(g));
  }

  EditableSurface& surface_;
  const SizeFn& max_edge_;
  std::size_t max_triangles_;
  std::priority_queue<Long> queue_;
  std::unordered_map<std::uint64_t, index_t> middle_;  ///< of cut feature edges; looked up only, never walked over
};

}  // namespace detail

/// Cuts long edges at their middles until none is longer than allowed; the shape does not change.
///
/// The edge that is longest compared with what is allowed goes first, which keeps angles from getting smaller than
/// about half of what they were. Wanted before a cross field or samples can be computed on the large triangles of CAD.
///
/// @param surface   edge-manifold, indices in range; may have rims.
/// @param features  of `surface`.
/// @param max_edge  callable: point -> greatest length of an edge there; infinite for no limit.
/// @throws invalid_field  with the edge, for a length that is NaN or not positive; invalid_option when
///         `options.max_triangles` is exceeded; nonmanifold.
/// @par Complexity   O(n log n) for n triangles in the result.
/// @par Source       Rivara, Int. J. Numer. Methods Eng. 20 (1984) 745-756. Departs: the queue replaces the propagation
///                   along longest edges.
template <class SizeFn>
RefinedSurface refine(const IndexedTriangleMesh& surface, const FeatureGraph& features, const SizeFn& max_edge,
                      const RefinementOptions& options = {}) {
  detail::EditableSurface editable(surface, make_adjacency(surface), features);
  detail::Refiner<SizeFn> refiner(editable, max_edge, options.max_triangles);
  refiner.run();

  RefinedSurface result;
  result.features.corners = features.corners;
  result.features.n_patches = features.n_patches;
  for (std::size_t c = 0; c < features.curves.size(); ++c) {
    const auto curve = features.curves[c];
    auto& values = result.features.curves.values;
    values.push_back(curve[0]);
    for (std::size_t i = 0; i + 1 < curve.size(); ++i) refiner.expand(curve[i], curve[i + 1], values);
    result.features.curves.end_row();
  }
  result.surface.points = std::move(editable.points);
  result.surface.triangles = std::move(editable.corners);
  result.features.triangle_patch = std::move(editable.patch);
  result.features.is_feature = std::move(editable.feature);
  result.parent = std::move(editable.parent);
  return result;
}

}  // namespace framehex
