// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/insertion/curve_inserter.hpp"
#include "framehex/surface/detail/curve_line.hpp"
#include "framehex/surface/limited_size.hpp"

namespace framehex::detail {

/// Lengths that bring the sides between the points of curves nearer to these, where they are farther than is allowed.
///
/// A side may be no farther than a sixth of its length either: a small hole would be lost by four sides, however far it
/// is from the size of the whole. That only shortens sides down to a quarter of the size asked for: a rounding of next
/// to no radius stays cut.
///
/// @param asked      size without limits. @param size  with those that there are.
/// @param tolerance  host's unit, > 0.
template <SizeField Asked, SizeField Size>
std::vector<SizeLimit> limits_of_curves(const Surface& surface, const CurveInsertion& curves, const Asked& asked,
                                        const Size& size, double tolerance) {
  constexpr double margin = 0.8, least_ratio = 0.4;  // to a size that would just do
  constexpr double most_cut = 1.0 / 6, least_share = 0.25, nearly = 1.4;
  std::vector<SizeLimit> limits;
  std::vector<double> arcs;
  index_t hint = no_index;
  for (std::size_t c = 0; c < surface.features.curves.size(); ++c) {
    const CurveLine line(surface.points, surface.features.curves[c]);
    arcs.clear();
    for (index_t i = curves.first_of_curve[c]; i < curves.first_of_curve[c + 1]; ++i)
      arcs.push_back(curves.samples[i].arc);
    const bool closed = arcs.size() == curves.n_intervals[c];
    if (!closed) arcs.insert(arcs.begin(), 0.0);
    arcs.push_back(closed ? arcs.front() + line.length() : line.length());
    for (std::size_t i = 1; i < arcs.size(); ++i) {
      const double side = arcs[i] - arcs[i - 1];
      const CurveLine::Farthest far = line.farthest(arcs[i - 1], arcs[i]);
      // Of a curve chords are off by the square of their length.
      double ratio = far.distance > tolerance ? margin * std::sqrt(tolerance / far.distance) : 1.0;
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

}  // namespace framehex::detail
