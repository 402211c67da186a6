// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/surface/detail/delaunay_flips.hpp"

#include <numbers>

namespace framehex::detail {

/// Removes vertices of an EditableSurface by collapsing them into a neighbour, with flips in between.
class VertexRemover {
public:
  /// How bad the triangles may be that a removal makes.
  struct Limits {
    double upright;  ///< least cosine with the input's normals
    double shape;    ///< least area over squared edges, 1 for an equilateral triangle
  };

  VertexRemover(EditableSurface& surface, const SectorNormals& normals, Pulse& pulse)
      : surface_(surface), normals_(normals), pulse_(pulse), flipper_(surface, normals, pulse) {}

  /// Removes what it can of the given vertices and keeps the others in the list, in their order. Passes end when one
  /// removes none, or when it is told to stop.
  void run(std::vector<index_t>& unwanted, const Limits& limits) {
    for (bool progress = true; progress && !unwanted.empty();) {
      std::size_t kept = 0;
      const std::size_t before = unwanted.size();
      for (const index_t v : unwanted)
        if (!pulse_.beat() || !remove(v, limits)) unwanted[kept++] = v;
      unwanted.resize(kept);
      progress = kept < before;
    }
  }

  bool remove(index_t v, const Limits& limits) {
    if (surface_.has_copies(v)) return remove_from_junction(v, limits);
    index_t best = no_index;
    double best_score = 0;
    const index_t sharp = feature_valence(v);
    if (sharp != 0 && sharp != 2) return false;
    surface_.for_each_outgoing(v, [&](index_t h) {
      if (sharp == 2 && !surface_.feature[h]) return;
      const double score = collapse_score(h, limits);
      if (score > best_score || (score == best_score && best != no_index && surface_.to(h) < surface_.to(best))) {
        best_score = score;
        best = h;
      }
    });
    if (best == no_index || !(best_score > 0)) return false;
    const index_t w = surface_.to(best);
    surface_.collapse(best);
    flipper_.push_star(w);
    flipper_.run(DelaunayFlipper::Scope::within_patches);
    return true;
  }

  DelaunayFlipper& flipper() { return flipper_; }

  index_t feature_valence(index_t v) const {
    index_t n = 0;
    surface_.for_each_outgoing(v, [&](index_t h) {
      n += surface_.feature[h];
      const index_t incoming = EditableSurface::previous(h);
      if (surface_.opposite[incoming] == no_index) ++n;  // a rim that ends here has no half edge of its own
    });
    return n;
  }

private:
  /// A fan of the vertex and its rim that leads along the curve.
  struct Way {
    index_t copy, rim;
  };

  /// On a curve where several sheets end, all fans collapse along the same edge, or none.
  bool remove_from_junction(index_t v, const Limits& limits) {
    std::vector<Way> best;
    double best_score = 0;
    index_t target = no_index;
    visit_neighbours(v, [&](index_t w) {
      if (w == target) return;
      const std::vector<Way> ways = ways_to(v, w);
      if (ways.empty() || !link_condition(v, w, ways.size(), ways.size())) return;
      double score = 1;
      for (const Way& way : ways) score = std::min(score, fan_score(way, limits));
      if (score < best_score || (score == best_score && target != no_index && w > target)) return;
      best = ways;
      best_score = score;
      target = w;
    });
    if (best.empty() || !(best_score > 0)) return false;
    for (const Way& way : best) surface_.collapse_rim(way.rim, way.copy);
    flipper_.push_star(target);
    flipper_.run(DelaunayFlipper::Scope::within_patches);
    return true;
  }

  /// The rims from all fans of v to copies of w; none unless each fan has one, and no feature but its two rims.
  std::vector<Way> ways_to(index_t v, index_t w) const {
    std::vector<Way> ways;
    bool all = true;
    surface_.for_each_copy(v, [&](index_t copy) {
      if (surface_.half_edge_of[copy] == no_index) return;
      const std::size_t before = ways.size();
      surface_.for_each_outgoing(copy, [&](index_t h) {
        const index_t in = EditableSurface::previous(h);
        if (surface_.opposite[h] == no_index && surface_.name[surface_.to(h)] == w) ways.push_back({copy, h});
        if (surface_.opposite[in] == no_index && surface_.name[surface_.from(in)] == w) ways.push_back({copy, in});
      });
      all = all && ways.size() == before + 1 && feature_valence(copy) == 2;
    });
    if (!all) ways.clear();
    return ways;
  }

  double fan_score(const Way& way, const Limits& limits) const {
    if (merges_features(way.rim)) return 0;
    const index_t tip = surface_.from(way.rim) == way.copy ? EditableSurface::next(way.rim) : way.rim;
    double score = 1;
    surface_.for_each_outgoing(way.copy, [&](index_t h) {
      if (h / 3 != way.rim / 3) score = std::min(score, quality(h, surface_.from(tip), surface_.sector[tip], limits));
    });
    return score;
  }

  /// The only neighbours that v and w share are the apexes of their edge: else the surface would be pinched.
  bool link_condition(index_t v, index_t w, std::size_t n_apexes, std::size_t n_fans) const {
    stamp_.resize(surface_.points.size(), 0);  // vertices may have been added since
    now_ += 2;
    visit_neighbours(w, [&](index_t x) { stamp_[x] = now_; });
    std::size_t common = 0, direct = 0;
    visit_neighbours(v, [&](index_t x) {
      direct += x == surface_.name[w];
      if (stamp_[x] != now_) return;
      ++common;
      stamp_[x] = now_ + 1;
    });
    return common == n_apexes && direct == n_fans;
  }

  /// Calls `visit` with the names of the neighbours, in each fan of v.
  template <class Visit>
  void visit_neighbours(index_t v, Visit&& visit) const {
    surface_.for_each_copy(v, [&](index_t copy) {
      surface_.for_each_outgoing(copy, [&](index_t h) {
        visit(surface_.name[surface_.to(h)]);
        const index_t incoming = EditableSurface::previous(h);
        if (surface_.opposite[incoming] == no_index) visit(surface_.name[surface_.from(incoming)]);
      });
    });
  }

  /// Joining the sides of the vanishing triangle of half edge h must not lay one feature on another.
  bool merges_features(index_t h) const {
    return surface_.feature[EditableSurface::next(h)] && surface_.feature[EditableSurface::previous(h)];
  }

  /// Quality of the triangle of half edge h with its first corner moved to w, where it belongs to `sector`.
  double quality(index_t h, index_t w, index_t sector, const Limits& limits) const {
    const index_t x = EditableSurface::next(h), y = EditableSurface::previous(h);
    const Vector3 &p = surface_.points[w], &q = surface_.points[surface_.from(x)];
    const Vector3& r = surface_.points[surface_.from(y)];
    const double cosine = uprightness(p, q, r, normals_.of_sector(sector) + normals_.at(x) + normals_.at(y));
    const double shape = 2 * std::numbers::sqrt3 * (q - p).cross(r - p).norm() /
                         ((q - p).squaredNorm() + (r - q).squaredNorm() + (p - r).squaredNorm());
    return cosine < limits.upright || shape < limits.shape ? 0 : cosine * shape;
  }

  /// Worst quality of the triangles that the collapse of h makes; 0 when it must not be.
  double collapse_score(index_t h, const Limits& limits) const {
    const index_t g = surface_.opposite[h], w = surface_.to(h);
    if (merges_features(h) || (g != no_index && merges_features(g))) return 0;
    if (!link_condition(surface_.from(h), w, g == no_index ? 1 : 2, 1)) return 0;
    const index_t left = surface_.sector[EditableSurface::next(h)];
    const index_t right = g == no_index ? left : surface_.sector[g];
    double score = 1;
    bool beyond = false;
    const auto judge = [&](index_t o) { score = std::min(score, quality(o, w, beyond ? right : left, limits)); };
    // Anticlockwise from h, leaving out its own triangle and that of its opposite.
    index_t o = surface_.opposite[EditableSurface::previous(h)];
    for (; o != no_index && o != h && score > 0; o = surface_.opposite[EditableSurface::previous(o)]) {
      if (surface_.feature[o]) beyond = true;
      if (g != no_index && o / 3 == g / 3) continue;
      judge(o);
    }
    if (o == no_index && g != no_index && score > 0) {  // a rim was met: the rest is clockwise from h
      beyond = true;
      for (o = surface_.opposite[EditableSurface::next(g)]; o != no_index && score > 0; o = surface_.opposite[o]) {
        o = EditableSurface::next(o);
        judge(o);
      }
    }
    return score;
  }

  EditableSurface& surface_;
  const SectorNormals& normals_;
  Pulse& pulse_;
  DelaunayFlipper flipper_;
  mutable std::vector<index_t> stamp_;  // of a vertex: when it was last seen
  mutable index_t now_ = 0;
};

}  // namespace framehex::detail
