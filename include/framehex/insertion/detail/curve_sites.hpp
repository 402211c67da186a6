// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/insertion/curve_inserter.hpp"
#include "framehex/surface/surface_walker.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <span>
#include <vector>

namespace framehex::detail {

/// One way to leave a sample of a curve: into this triangle, by directions at `low` to `high` (rad) from `reference`
/// anticlockwise about the normal.
struct Sector {
  index_t triangle;
  Vector3 reference;
  double low, high;
};

/// Where the samples of corners and curves lie among the triangles.
class CurveSites {
public:
  CurveSites(const Surface& surface, const SurfaceWalker& walker)
      : adjacency_(surface.adjacency), features_(surface.features), walker_(walker) {
    for (std::size_t c = 0; c < features_.curves.size(); ++c) {
      const auto row = features_.curves[c];
      for (std::size_t i = 0; i < row.size(); ++i)
        arcs_.push_back(i == 0 ? 0 : arcs_.back() + (surface.points[row[i]] - surface.points[row[i - 1]]).norm());
    }
  }

  /// All sectors round a sample, by ascending triangle.
  std::vector<Sector> sectors(const SurfaceSample& sample) const {
    if (sample.kind == SampleKind::corner) return round_vertex(features_.corners[sample.entity]);
    const std::span<const index_t> row = features_.curves[sample.entity];
    const std::span<const double> arcs(arcs_.data() + features_.curves.offsets[sample.entity], row.size());
    const auto after = std::upper_bound(arcs.begin() + 1, arcs.end() - 1, sample.arc) - arcs.begin();
    const auto i = static_cast<std::size_t>(after) - 1;
    const double slack = 1e-9 * (arcs[i + 1] - arcs[i]);
    if (sample.arc - arcs[i] <= slack) return round_vertex(row[i]);
    if (arcs[i + 1] - sample.arc <= slack) return round_vertex(row[i + 1]);
    return beside_edge(row[i], row[i + 1]);
  }

private:
  // A direction nearer than this to a feature edge runs along the curve, which has its samples already.
  static constexpr double off_wall = 0.3;
  // Neighbouring triangles have slightly different crosses; without an overlap a direction could fall between them.
  static constexpr double overlap = 0.1;

  std::vector<Sector> round_vertex(index_t v) const {
    std::vector<Sector> result;
    for (const index_t t : adjacency_.triangles_of_vertex[v]) {
      index_t h = 3 * t;
      while (adjacency_.from(h) != v) ++h;
      const index_t back = TriangleAdjacency::previous(h);
      const Vector3 first = walker_.edge_direction(h), last = -walker_.edge_direction(back);
      const double angle = std::atan2(first.cross(last).norm(), first.dot(last));
      result.push_back({t, first, walker_.is_wall(h) ? off_wall : -overlap,
                        walker_.is_wall(back) ? angle - off_wall : angle + overlap});
    }
    return result;
  }

  std::vector<Sector> beside_edge(index_t a, index_t b) const {
    std::vector<Sector> result;
    for (const index_t t : adjacency_.triangles_of_vertex[a])
      for (index_t h = 3 * t; h < 3 * t + 3; ++h)
        if (std::minmax(adjacency_.from(h), adjacency_.to(h)) == std::minmax(a, b))
          result.push_back({t, walker_.edge_direction(h), off_wall, std::numbers::pi - off_wall});
    return result;
  }

  const TriangleAdjacency& adjacency_;
  const FeatureGraph& features_;
  const SurfaceWalker& walker_;
  std::vector<double> arcs_;  // at the vertices of the curves, one after the other
};

/// Calls `visit(a, b)` for each interval of the curves: two samples that follow each other.
template <class Visit>
void for_each_interval(const FeatureGraph& features, const CurveInsertion& curves, Visit&& visit) {
  const auto corner_at = [&](index_t v) {
    const auto at = std::lower_bound(features.corners.begin(), features.corners.end(), v);
    return at != features.corners.end() && *at == v ? static_cast<index_t>(at - features.corners.begin()) : no_index;
  };
  for (std::size_t c = 0; c < features.curves.size(); ++c) {
    const std::span<const index_t> row = features.curves[c];
    const index_t first = curves.first_of_curve[c], last = curves.first_of_curve[c + 1];
    const index_t end = corner_at(row.back());
    index_t previous = corner_at(row.front());
    const auto go_to = [&](index_t sample) {
      if (previous != no_index && previous != sample) visit(previous, sample);
      previous = sample;
    };
    for (index_t i = first; i < last; ++i) go_to(i);
    go_to(end != no_index ? end : first);
  }
}

}  // namespace framehex::detail
