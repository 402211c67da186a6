// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/observer.hpp"
#include "framehex/option_ranges.hpp"
#include "framehex/surface/detail/delaunay_flips.hpp"
#include "framehex/surface/surface.hpp"
#include "framehex/surface/surface_locator.hpp"

#include <cmath>
#include <queue>
#include <unordered_map>

namespace framehex {

/// A surface of the same shape with shorter edges.
struct RefinedSurface {
  Surface surface;                   ///< the old vertices first, unchanged; the same corners, curves and patches
  std::vector<index_t> parent;       ///< triangle -> triangle of the old surface that it, or its centre, lies in
  Status status = Status::complete;  ///< or cancelled: then there is no surface
};

/// Whether a refinement may turn edges.
enum class RefinementFlips {
  none,      ///< every triangle lies in one of the old surface
  in_planes  ///< between coplanar triangles, towards Delaunay: far fewer and better triangles on the needles of CAD
};

/// How to refine, and how far.
struct RefinementOptions {
  RefinementFlips flips = RefinementFlips::in_planes;
  std::size_t max_triangles = 50'000'000;   ///< needing more is taken for a mistake in the lengths
  const SurfaceLocator* locator = nullptr;  ///< of the surface, by those who have one; else null
  Observer observer{};

  template <class Options, class Visit>
  static void each_number(Options& o, Visit&& visit) {
    visit("RefinementOptions::max_triangles", o.max_triangles, 0, TriangleAdjacency::most_triangles);
  }
};

namespace detail {

/// Cuts the longest edge (in units of its allowed length) in two until none is too long. A field of lengths without a
/// lower bound would never have enough: the number of triangles is bounded.
template <class SizeFn>
class Refiner {
public:
  Refiner(EditableSurface& surface, const SizeFn& max_edge, const RefinementOptions& options, Pulse& pulse)
      : surface_(surface), max_edge_(max_edge), options_(options), pulse_(pulse), mixed_(surface.n_triangles(), 0) {}

  /// Leaves the rest as it is when it is told to stop.
  void run() {
    if (options_.flips != RefinementFlips::none) {
      for (index_t h = 0; h < surface_.opposite.size(); ++h)
        if (surface_.opposite[h] != no_index && h < surface_.opposite[h]) doubtful_.push_back(h);
      flip_doubtful(Offer::no);
    }
    for (index_t h = 0; h < surface_.opposite.size(); ++h) {
      const index_t twin = surface_.opposite[h];
      if (twin == no_index || h < twin) offer(h);
    }
    // Each cut halves an edge that is too long, and flips only make edges shorter; `max_triangles` is the bound in any case.
    while (!queue_.empty() && pulse_.beat()) {
      const Long edge = queue_.top();
      queue_.pop();
      index_t h = edge.half_edge;  // the edge may have moved to another triangle, or have been cut
      if (surface_.from(h) != edge.from || surface_.to(h) != edge.to) h = surface_.find(edge.from, edge.to);
      if (h == no_index) h = surface_.find(edge.to, edge.from);
      if (h != no_index) split(h);
    }
  }

  /// Does triangle t straddle several of the old surface's?
  bool mixed(index_t t) const { return mixed_[t] != 0; }

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
  enum class Offer { no, yes };

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
    if (!(excess > 1)) return;
    // Edges that cannot be turned go before the slightly longer diagonals beside them, which then turn away by
    // themselves.
    const bool stays = surface_.opposite[h] == no_index || surface_.feature[h] || !coplanar(h);
    queue_.push({stays ? 1.3 * excess : excess, h, surface_.from(h), surface_.to(h)});
  }

  void split(index_t h) {
    if (surface_.n_triangles() + 2 > options_.max_triangles)
      throw invalid_option("refining the surface needs more than " + std::to_string(options_.max_triangles) +
                           " triangles: the greatest edge length is too small");
    const index_t a = surface_.from(h), b = surface_.to(h), g = surface_.opposite[h];
    const std::vector<index_t> others = surface_.other_sides(h);
    const index_t v = surface_.add_vertex((surface_.points[a] + surface_.points[b]) / 2);
    const bool sharp = surface_.feature[h] != 0;
    if (sharp) middle_.emplace(edge_key(surface_.name[a], surface_.name[b]), v);
    const index_t left = surface_.sector[h];
    const index_t right = g == no_index ? left : sharp ? surface_.sector[g] : left;
    const index_t second = surface_.split_edge(h, v, left, right);
    offer(h);
    offer(second);
    offer(surface_.next(h));
    if (g != no_index) offer(surface_.next(g));
    mixed_.resize(surface_.n_triangles(), mixed_[h / 3]);
    if (g != no_index) mixed_.back() = mixed_[g / 3];
    for (const index_t o : others) {
      const index_t beyond = surface_.split_edge(o, surface_.add_copy(v), surface_.sector[o], surface_.sector[o]);
      mixed_.push_back(mixed_[o / 3]);
      for (const index_t changed : {o, beyond, EditableSurface::next(o)}) offer(changed);
    }
    if (options_.flips == RefinementFlips::none) return;
    surface_.for_each_copy(v, [&](index_t copy) {
      surface_.for_each_outgoing(copy, [&](index_t o) {
        doubtful_.insert(doubtful_.end(), {o, EditableSurface::next(o)});
      });
    });
    flip_doubtful(Offer::yes);
  }

  /// Flips edges between coplanar triangles until they are Delaunay. No vertex moves, so the shape stays. In one plane that
  /// ends by itself; nearly in one it need not, and a budget ends it.
  void flip_doubtful(Offer offers) {
    std::size_t budget = 64 + 20 * doubtful_.size();
    while (!doubtful_.empty() && pulse_.beat()) {
      const index_t h = doubtful_.back();
      doubtful_.pop_back();
      if (budget == 0 || !is_not_delaunay(surface_, h) || !coplanar(h) || !can_turn(h)) continue;
      --budget;
      const index_t t = h / 3, s = surface_.opposite[h] / 3;
      if (surface_.parent[t] != surface_.parent[s] || mixed_[t] || mixed_[s]) mixed_[t] = mixed_[s] = 1;
      surface_.flip(h);
      if (offers == Offer::yes) offer(3 * t + 1);
      doubtful_.insert(doubtful_.end(), {3 * t, 3 * t + 2, 3 * s, 3 * s + 2});
    }
  }

  /// Are the two triangles of an edge coplanar, within what single precision leaves of a plane?
  bool coplanar(index_t h) const {
    constexpr double flat = 1e-6;
    const index_t g = surface_.opposite[h];
    const Vector3 &a = surface_.points[surface_.from(h)], &b = surface_.points[surface_.to(h)];
    const Vector3 &c = surface_.points[surface_.apex(h)], &d = surface_.points[surface_.apex(g)];
    const Vector3 normal = larger_normal(h);
    const double height = std::max(std::abs((c - a).dot(normal)), std::abs((d - a).dot(normal)));
    return height <= flat * std::sqrt(std::max((b - a).squaredNorm(), (c - d).squaredNorm())) * normal.norm();
  }

  /// Would the two triangles of an edge stay as they stand when it is turned?
  bool can_turn(index_t h) const {
    const index_t g = surface_.opposite[h];
    const Vector3 &a = surface_.points[surface_.from(h)], &b = surface_.points[surface_.to(h)];
    const Vector3 &c = surface_.points[surface_.apex(h)], &d = surface_.points[surface_.apex(g)];
    const Vector3 normal = larger_normal(h);
    return uprightness(a, d, c, normal) > 0.99 && uprightness(b, c, d, normal) > 0.99 &&
           !surface_.joined(surface_.apex(h), surface_.apex(g));
  }

  Vector3 larger_normal(index_t h) const {
    const Vector3 &a = surface_.points[surface_.from(h)], &b = surface_.points[surface_.to(h)];
    const Vector3 &c = surface_.points[surface_.apex(h)], &d = surface_.points[surface_.apex(surface_.opposite[h])];
    const Vector3 first = (b - a).cross(c - a), second = (d - a).cross(b - a);
    return first.squaredNorm() > second.squaredNorm() ? first : second;
  }

  EditableSurface& surface_;
  const SizeFn& max_edge_;
  const RefinementOptions& options_;
  Pulse& pulse_;
  std::priority_queue<Long> queue_;
  std::vector<char> mixed_;                            ///< triangle: made by a flip between different parents
  std::vector<index_t> doubtful_;                      ///< half edges to be looked at
  std::unordered_map<std::uint64_t, index_t> middle_;  ///< of cut feature edges; looked up only, never walked over
};

/// Finds the old triangles that the centres of those lie in that straddle several.
template <class SizeFn>
void locate_parents(const Refiner<SizeFn>& refiner, const SurfaceLocator& locator, RefinedSurface& refined,
                    Pulse& pulse) {
  const std::vector<Vector3>& p = refined.surface.points;
  for (index_t t = 0; t < refined.parent.size() && pulse.beat(); ++t) {
    if (!refiner.mixed(t)) continue;
    const auto& v = refined.surface.triangles()[t];
    refined.parent[t] = locator.nearest((p[v[0]] + p[v[1]] + p[v[2]]) / 3).triangle;
  }
}

}  // namespace detail

/// Cuts long edges at their middles until none is longer than allowed; the shape does not change.
///
/// The edge that is longest compared with what is allowed goes first, which keeps angles from getting smaller than
/// about half of what they were. Wanted before a cross field or samples can be computed on the large triangles of CAD.
///
/// @param surface   may have rims.
/// @param max_edge  callable: point -> greatest length of an edge there; infinite for no limit.
/// @return when the observer stops it: nothing, and the status says so.
/// @throws invalid_field  with the edge, for a length that is NaN or not positive; invalid_option when
///         `options.max_triangles` is exceeded; nonmanifold.
/// @par Complexity   O(n log n) for n triangles in the result.
/// @par Source       Rivara, Int. J. Numer. Methods Eng. 20 (1984) 745-756. Departs: the queue replaces the propagation
///                   along longest edges.
template <class SizeFn>
RefinedSurface refine(const Surface& surface, const SizeFn& max_edge, const RefinementOptions& options = {}) {
  check_options(options);
  detail::EditableSurface editable(surface);
  detail::Pulse pulse(options.observer, "refinement");
  pulse.report(0);
  detail::Refiner<SizeFn> refiner(editable, max_edge, options, pulse);
  refiner.run();
  if (!pulse.report(0.8)) return detail::cancelled<RefinedSurface>();

  RefinedSurface result;
  FeatureGraph& features = result.surface.features;
  features.corners = surface.features.corners;
  features.n_patches = surface.features.n_patches;
  for (std::size_t c = 0; c < surface.features.curves.size(); ++c) {
    const auto curve = surface.features.curves[c];
    features.curves.values.push_back(curve[0]);
    for (std::size_t i = 0; i + 1 < curve.size(); ++i) refiner.expand(curve[i], curve[i + 1], features.curves.values);
    features.curves.end_row();
  }
  const std::vector<index_t> number = editable.join_copies();
  for (index_t& v : features.curves.values) v = number[v];
  features.triangle_patch = std::move(editable.patch);
  features.is_feature = std::move(editable.feature);
  result.surface.points = std::move(editable.points);
  if (!pulse.report(0.85)) return detail::cancelled<RefinedSurface>();
  result.surface.adjacency = make_adjacency(TriangleView{result.surface.points, editable.corners}, Junctions::open);
  result.parent = std::move(editable.parent);
  if (!pulse.report(0.9)) return detail::cancelled<RefinedSurface>();
  if (options.flips != RefinementFlips::none) {
    const SurfaceLocator own = options.locator ? SurfaceLocator() : SurfaceLocator(surface);
    locate_parents(refiner, options.locator ? *options.locator : own, result, pulse);
  }
  if (!pulse.report(1)) return detail::cancelled<RefinedSurface>();
  return result;
}

}  // namespace framehex
