// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/geometry/size_field.hpp"
#include "framehex/surface/surface.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace framehex {

/// Which vertices inside patches stand out as the tips of cones, or as the middles of saddles that are as sharp.
struct TipOptions {
  /// rad, > 0; what is missing to a full turn, or beyond it, in the angles about the vertex; infinite: no tip stands out.
  double defect = std::numbers::pi / 2;

  template <class Options, class Visit>
  static void each_number(Options& o, Visit&& visit) {
    visit("TipOptions::defect", o.defect, least_positive, unbounded);
  }
};

namespace detail {

/// Angle defects of the vertices that are on no feature, and how they add up about one of them.
class AngleDefects {
public:
  explicit AngleDefects(const Surface& surface) : surface_(surface), defect_(surface.points.size(), 0) {
    const TriangleAdjacency& a = surface.adjacency;
    std::vector<char> on_feature(surface.points.size(), 0);
    std::vector<double> sum(surface.points.size(), 0);
    for (index_t h = 0; h < a.opposite.size(); ++h) {
      const index_t v = a.from(h);
      if (surface.features.is_feature[h]) on_feature[v] = on_feature[a.to(h)] = 1;
      const Vector3& p = surface.points[v];
      const Vector3 x = surface.points[a.to(h)] - p, y = surface.points[a.from(TriangleAdjacency::previous(h))] - p;
      sum[v] += std::atan2(x.cross(y).norm(), x.dot(y));
    }
    for (const index_t v : surface.features.corners) on_feature[v] = 1;
    for (std::size_t v = 0; v < sum.size(); ++v)
      if (!on_feature[v] && sum[v] > 0) defect_[v] = 2 * std::numbers::pi - sum[v];
    seen_.assign(sum.size(), 0);
  }

  double operator[](index_t v) const { return defect_[v]; }

  /// Does the surface about a vertex bend there, and next to nothing elsewhere? Smooth surfaces have vertices that bend
  /// alike, noise those that bend the other way.
  bool stands_alone(index_t v, double radius) {
    constexpr double share = 0.25, total = 0.5;
    constexpr std::size_t most = 2000;
    const double own = std::abs(defect_[v]);
    double others = 0;
    bool alone = true;
    found_.assign(1, v);
    seen_[v] = 1;
    for (std::size_t i = 0; i < found_.size() && alone; ++i)
      each_neighbour(found_[i], [&](index_t w) {
        if (seen_[w] || found_.size() == most || !((surface_.points[w] - surface_.points[v]).norm() <= radius)) return;
        seen_[w] = 1;
        found_.push_back(w);
        others += std::abs(defect_[w]);
        alone = alone && std::abs(defect_[w]) <= share * own && others <= total * own;
      });
    for (const index_t w : found_) seen_[w] = 0;
    return alone;
  }

private:
  template <class Visit>
  void each_neighbour(index_t v, Visit&& visit) const {
    for (const index_t t : surface_.adjacency.triangles_of_vertex[v])
      for (const index_t w : surface_.triangles()[t])
        if (w != v) visit(w);
  }

  const Surface& surface_;
  std::vector<double> defect_;  ///< rad; 0 on features
  std::vector<char> seen_;
  std::vector<index_t> found_;
};

}  // namespace detail

/// Finds the vertices inside patches that cells of the wished size would cut off visibly: tips of cones and the like. A
/// mesh without a vertex there would need ever smaller cells about them to come near.
///
/// A tip stands out where its defect is `options.defect` or more, and all about it, up to the wished size and no farther
/// than some thousand vertices, adds up to half of that at most.
///
/// @param size  wished edge length at a point, host's unit.
/// @return vertices, ascending: what `add_tips` takes.
/// @throws invalid_option; invalid_field  when the size at such a vertex is not positive and finite.
/// @par Complexity   O(n), and some thousand steps for each vertex of so great a defect.
template <SizeField Size>
std::vector<index_t> distinct_tips(const Surface& surface, const Size& size, const TipOptions& options = {}) {
  check_options(options);
  std::vector<index_t> tips;
  if (!std::isfinite(options.defect)) return tips;
  detail::AngleDefects defects(surface);
  index_t hint = no_index;
  for (index_t v = 0; v < surface.points.size(); ++v)
    if (std::abs(defects[v]) >= options.defect &&
        defects.stands_alone(v, detail::checked_size(size, surface.points[v], hint)))
      tips.push_back(v);
  return tips;
}

/// Makes vertices inside patches corners, on which no curve ends.
///
/// @param vertices  ascending; what is a corner already stays one.
inline void add_tips(FeatureGraph& features, std::span<const index_t> vertices) {
  std::vector<index_t> corners;
  std::set_union(features.corners.begin(), features.corners.end(), vertices.begin(), vertices.end(),
                 std::back_inserter(corners));
  features.corners = std::move(corners);
}

}  // namespace framehex
