// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/insertion/curve_inserter.hpp"
#include "framehex/surface/detail/curve_line.hpp"
#include "framehex/surface/limited_size.hpp"

#include <algorithm>
#include <numbers>

namespace framehex::detail {

/// How far a curve that closes may be from its sides, in diagonals of its own box: eight sides of a circle are as near.
inline constexpr double closed_share = 0.03;

inline double diagonal_of_curve(const Surface& surface, std::size_t c) {
  Eigen::AlignedBox3d box;
  for (const index_t v : surface.features.curves[c]) box.extend(surface.points[v]);
  return box.diagonal().norm();
}

/// The patches of the triangles at an edge, some twice.
inline std::vector<index_t> patches_beside(const Surface& surface, index_t a, index_t b) {
  std::vector<index_t> patches;
  for (const index_t t : surface.adjacency.triangles_of_vertex[a])
    if (const auto& v = surface.triangles()[t]; std::find(v.begin(), v.end(), b) != v.end())
      patches.push_back(surface.features.triangle_patch[t]);
  return patches;
}

/// Sum of the angles of a patch's triangles at a vertex, rad.
inline double angle_in_patch(const Surface& surface, index_t vertex, index_t patch) {
  double sum = 0;
  for (const index_t t : surface.adjacency.triangles_of_vertex[vertex]) {
    if (surface.features.triangle_patch[t] != patch) continue;
    const auto& v = surface.triangles()[t];
    const auto i = static_cast<std::size_t>(std::find(v.begin(), v.end(), vertex) - v.begin());
    const Vector3& p = surface.points[vertex];
    const Vector3 x = surface.points[v[(i + 1) % 3]] - p, y = surface.points[v[(i + 2) % 3]] - p;
    sum += std::atan2(x.cross(y).norm(), x.dot(y));
  }
  return sum;
}

/// Where the points of a curve lie along it, from its start or, if it closes without a corner, from the first of them.
struct CurveArcs {
  std::vector<double> arcs;
  bool closed = false;

  CurveArcs(const CurveInsertion& curves, std::size_t c, double length) {
    for (index_t i = curves.first_of_curve[c]; i < curves.first_of_curve[c + 1]; ++i)
      arcs.push_back(curves.samples[i].arc);
    closed = arcs.size() == curves.n_intervals[c];
    if (!closed) arcs.insert(arcs.begin(), 0.0);
    arcs.push_back(closed ? arcs.front() + length : length);
  }
};

/// Lengths that bring the sides between the points of curves nearer to these, where they are farther than is allowed.
///
/// A curve that closes without a corner may be no farther from its sides than a share of its own diagonal: four sides
/// are 64 % of a small hole, however near to it they are for the size of the whole. Others may be no farther than a sixth
/// of a side either, which only shortens sides down to a quarter of the size asked for: a rounding of next to no radius
/// stays cut.
///
/// @param asked      size without limits. @param size  with those that there are.
/// @param tolerance  host's unit, > 0.
template <SizeField Asked, SizeField Size>
std::vector<SizeLimit> limits_of_curves(const Surface& surface, const CurveInsertion& curves, const Asked& asked,
                                        const Size& size, double tolerance) {
  constexpr double margin = 0.8, least_ratio = 0.4;  // to a size that would just do
  constexpr double most_cut = 1.0 / 6, least_share = 0.25, nearly = 1.4;
  std::vector<SizeLimit> limits;
  index_t hint = no_index;
  for (std::size_t c = 0; c < surface.features.curves.size(); ++c) {
    const CurveLine line(surface.points, surface.features.curves[c]);
    const auto [arcs, closed] = CurveArcs(curves, c, line.length());
    const double allowed = closed ? std::min(tolerance, closed_share * diagonal_of_curve(surface, c)) : tolerance;
    for (std::size_t i = 1; i < arcs.size(); ++i) {
      const double side = arcs[i] - arcs[i - 1];
      const CurveLine::Farthest far = line.farthest(arcs[i - 1], arcs[i]);
      // Of a curve chords are off by the square of their length.
      double ratio = far.distance > allowed ? margin * std::sqrt(allowed / far.distance) : 1.0;
      double shortest = 0;
      if (far.distance > most_cut * side && ratio == 1) {
        shortest = least_share * checked_size(asked, far.place, hint);
        if (side <= nearly * shortest) continue;
        ratio = margin * most_cut * side / far.distance;
      }
      if (ratio < 1)
        limits.push_back({far.place, std::max(shortest, std::max(least_ratio, ratio) *
                                                            std::min(checked_size(size, far.place, hint), side))});
    }
  }
  return limits;
}

/// Lengths of sides that are much shorter than the size because their curve is, where cells spread from them: between
/// corners at which the domain is open wider than a straight line, as round a small hole of straight sides. A strip that
/// ends in such a side needs none, as its cells go on beside each other.
template <SizeField Size>
std::vector<SizeLimit> limits_beside_short_curves(const Surface& surface, const CurveInsertion& curves,
                                                  const Size& size) {
  constexpr double wide = 1.25 * std::numbers::pi, much = 1.5;
  const FeatureGraph& features = surface.features;
  std::vector<SizeLimit> limits;
  index_t hint = no_index;
  for (std::size_t c = 0; c < features.curves.size(); ++c) {
    const auto row = features.curves[c];
    const CurveLine line(surface.points, row);
    const auto [arcs, closed] = CurveArcs(curves, c, line.length());
    const double side = line.length() / curves.n_intervals[c];
    if (closed || much * side >= checked_size(size, line.at(line.length() / 2), hint)) continue;
    for (const index_t patch : patches_beside(surface, row[0], row[1]))
      if (angle_in_patch(surface, row.front(), patch) > wide && angle_in_patch(surface, row.back(), patch) > wide) {
        for (std::size_t i = 1; i < arcs.size(); ++i) limits.push_back({line.at((arcs[i - 1] + arcs[i]) / 2), side});
        break;
      }
  }
  return limits;
}

}  // namespace framehex::detail
