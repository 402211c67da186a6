// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/insertion/detail/insertion_checks.hpp"
#include "framehex/insertion/estimate.hpp"
#include "framehex/lattice/lattice_points.hpp"
#include "framehex/observer.hpp"
#include "framehex/option_ranges.hpp"
#include "framehex/surface/surface.hpp"
#include "framehex/surface/surface_sample.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <span>
#include <utility>
#include <vector>

namespace framehex {

/// Options of `insert_curve_points`.
struct CurveOptions {
  index_t closed_multiple =
      2;  ///< >= 1; intervals of a closed curve without a corner: a multiple of this, at least four
  double max_turn = std::numbers::pi / 2;  ///< rad, 1e-3 to 1e3: a curve gets its whole turn over this in intervals or
                                           ///< more, however large the size
  std::size_t max_points = 5'000'000;      ///< refuse sizes that ask for more
  std::span<const index_t> added = {};     ///< one a curve, or empty: intervals beyond what the size asks for
  Observer observer = {};

  template <class Options, class Visit>
  static void each_number(Options& o, Visit&& visit) {
    visit("CurveOptions::closed_multiple", o.closed_multiple, 1, unbounded);
    visit("CurveOptions::max_turn", o.max_turn, 1e-3, 1e3);
    visit("CurveOptions::max_points", o.max_points, 0, unbounded);
  }
};

/// Samples of the corners and feature curves.
struct CurveInsertion {
  std::vector<SurfaceSample> samples;  ///< first the corners in their order, then the inner samples curve by curve
  std::vector<index_t> n_intervals;    ///< one a curve
  std::vector<index_t>
      first_of_curve;                ///< n_curves + 1 positions in `samples`: where the inner samples of a curve begin
  Status status = Status::complete;  ///< or cancelled: then there are no samples
};

namespace detail {

/// A polyline with its length measured in units of the size: `metric[i]` at arc length `arc[i]`.
struct MeasuredCurve {
  std::vector<double> arc{0}, metric{0};
  double turn = 0;  // rad, sum of the angles between successive segments

  double length() const { return metric.back(); }
  double arc_at(double m) const {
    const auto above = std::upper_bound(metric.begin(), metric.end(), m);
    if (above == metric.end()) return arc.back();
    const auto i = static_cast<std::size_t>(above - metric.begin());
    const double s = (m - metric[i - 1]) / (metric[i] - metric[i - 1]);
    return arc[i - 1] + s * (arc[i] - arc[i - 1]);
  }
};

/// @param closed  the turn from the last segment to the first counts.
/// @param limit   of the length: beyond it the curve is measured no further, nor when the pulse stops it.
template <SizeField Size>
MeasuredCurve measure_curve(std::span<const Vector3> points, std::span<const index_t> vertices, bool closed,
                            const Size& size, double limit, Pulse& pulse) {
  constexpr double steps_per_size = 4, max_steps = 100'000;
  MeasuredCurve curve;
  index_t hint = no_index;
  Vector3 first_direction = Vector3::Zero(), last_direction = Vector3::Zero();
  const auto turn_to = [&](const Vector3& direction) {
    if (!last_direction.isZero()) curve.turn += std::acos(std::clamp(direction.dot(last_direction), -1.0, 1.0));
    last_direction = direction;
  };
  for (std::size_t i = 0; i + 1 < vertices.size(); ++i) {
    const Vector3 &a = points[vertices[i]], &b = points[vertices[i + 1]];
    const double length = (b - a).norm();
    if (length == 0) continue;
    const Vector3 direction = (b - a) / length;
    turn_to(direction);
    if (first_direction.isZero()) first_direction = direction;
    const auto size_at = [&](double s) { return checked_size(size, Vector3(a + s * (b - a)), hint); };
    const double least = std::min({size_at(0), size_at(0.5), size_at(1)});
    const double n = std::clamp(std::ceil(steps_per_size * length / least), 1.0, max_steps);
    double before = 1 / size_at(0);
    const double arc = curve.arc.back();
    for (double k = 1; k <= n && curve.length() <= limit && pulse.beat(); ++k) {  // Simpson's rule on each step
      const double after = 1 / size_at(k / n);
      const double mean = (before + 4 / size_at((k - 0.5) / n) + after) / 6;
      curve.metric.push_back(curve.metric.back() + mean * length / n);
      curve.arc.push_back(arc + length * (k / n));
      before = after;
    }
  }
  if (closed) turn_to(first_direction);
  return curve;
}

/// Length of all curves in units of the size, by Simpson's rule on each segment: what a message needs.
template <SizeField Size>
double estimate_length(std::span<const Vector3> points, const Csr<index_t>& curves, const Size& size) {
  double sum = 0;
  for (std::size_t c = 0; c < curves.size(); ++c)
    for (std::size_t i = 0; i + 1 < curves[c].size(); ++i) {
      const Vector3 &a = points[curves[c][i]], &b = points[curves[c][i + 1]];
      sum += (b - a).norm() / 6 *
             (1 / checked_size(size, a) + 4 / checked_size(size, Vector3(0.5 * (a + b))) + 1 / checked_size(size, b));
    }
  return sum;
}

/// Fewest intervals with which a curve, together with the others, bounds surfaces that can still be triangulated.
inline std::vector<index_t> least_intervals(const FeatureGraph& features) {
  std::map<std::pair<index_t, index_t>, index_t> n_between;
  const auto ends = [&](std::size_t curve) {
    return std::minmax({features.curves[curve].front(), features.curves[curve].back()});
  };
  for (std::size_t c = 0; c < features.curves.size(); ++c) ++n_between[ends(c)];
  std::vector<index_t> least(features.curves.size());
  for (std::size_t c = 0; c < least.size(); ++c) {
    const auto [a, b] = ends(c);
    least[c] = a == b ? 3 : n_between[{a, b}] > 1 ? 2 : 1;
  }
  return least;
}

/// Walks along a polyline to points of ascending arc length.
class CurveWalker {
public:
  CurveWalker(std::span<const Vector3> points, std::span<const index_t> vertices)
      : points_(points), vertices_(vertices) {}

  Vector3 at(double arc) {
    while (segment_ + 2 < vertices_.size() && arc > start_ + segment_length()) {
      start_ += segment_length();
      ++segment_;
    }
    const Vector3 &a = points_[vertices_[segment_]], &b = points_[vertices_[segment_ + 1]];
    const double length = segment_length();
    return length > 0 ? Vector3(a + std::clamp((arc - start_) / length, 0.0, 1.0) * (b - a)) : a;
  }

private:
  double segment_length() const { return (points_[vertices_[segment_ + 1]] - points_[vertices_[segment_]]).norm(); }
  std::span<const Vector3> points_;
  std::span<const index_t> vertices_;
  std::size_t segment_ = 0;
  double start_ = 0;
};

}  // namespace detail

/// Samples corners and feature curves, each curve with a whole number of intervals that are equally long in units of
/// the size field.
///
/// A curve from corner to corner gets its length in units of the size, rounded to the nearest whole number and at least
/// one; a closed curve the nearest multiple of `closed_multiple`, at least four. Two curves between the same corners
/// get two intervals at least and a loop at a corner three, or no triangulation could tell them apart.
///
/// @param surface  coordinates in the host's unit.
/// @param size     wished distance between neighbours at a point, host's unit.
/// @param lattice  when given: curves that it can use, with intervals enough, get its points in place of equal
///                 intervals.
/// @return corners and samples; those of a curve lie on its segments, exactly where these are straight. When the
///         observer stops it: nothing, and the status says so.
/// @throws invalid_field   when the size at a point is not positive and finite.
/// @throws invalid_option  with the estimate when more than `max_points` would result.
/// @par Complexity   O(vertices + samples) evaluations of `size`.
/// @par Source       Remacle et al., Int. J. Numer. Meth. Engng 94 (2013) 494-512, section 4. Departs: parity, least
/// counts.
template <SizeField Size>
CurveInsertion insert_curve_points(const Surface& surface, const Size& size, const CurveOptions& options = {},
                                   const CurveLattice* lattice = nullptr) {
  const FeatureGraph& features = surface.features;
  check_options(options);
  detail::Pulse pulse(options.observer, "curve insertion");
  pulse.report(0);
  if (!options.added.empty()) detail::one_each(options.added, features.curves.size(), "added intervals", "curves");
  if (lattice) {
    detail::one_each(std::span(lattice->is_usable), features.curves.size(), "marks of the lattice", "curves");
    detail::one_each(std::span(lattice->arcs.offsets), features.curves.size() + 1, "ends of the lattice's rows",
                     "curves and their end");
  }
  const auto is_corner = [&](index_t v) {
    return std::binary_search(features.corners.begin(), features.corners.end(), v);
  };

  CurveInsertion result;
  const auto is_closed = [&](std::span<const index_t> row) {
    return row.front() == row.back() && !is_corner(row.front());
  };
  std::vector<detail::MeasuredCurve> measured;
  const std::vector<index_t> least = detail::least_intervals(features);
  std::vector<double> lengths, floors;
  const auto n_corners = static_cast<double>(features.corners.size()), most = static_cast<double>(options.max_points);
  double total = n_corners;
  for (std::size_t c = 0; c < features.curves.size(); ++c) {
    const std::span<const index_t> row = features.curves[c];
    const auto& curve = measured.emplace_back(
        detail::measure_curve<Size>(surface.points, row, is_closed(row), size, most - total, pulse));
    if (pulse.stopped()) return detail::cancelled<CurveInsertion>();
    total += curve.length();
    if (total > most)
      detail::check_estimate(
          "curves", std::max(total, n_corners + detail::estimate_length(surface.points, features.curves, size)),
          options.max_points);
    lengths.push_back(curve.length());
    floors.push_back(std::max<double>(least[c], std::ceil(curve.turn / options.max_turn - 1e-6)));
  }
  total = n_corners;
  std::vector<std::uint8_t> by_lattice(features.curves.size(), 0);
  for (std::size_t c = 0; c < features.curves.size(); ++c) {
    const std::span<const index_t> row = features.curves[c];
    const bool closed = is_closed(row);
    const double multiple = closed ? static_cast<double>(options.closed_multiple) : 1.0;
    const double fewest = std::ceil(std::max(closed ? 4.0 : 1.0, floors[c]) / multiple);
    double n = multiple * std::max(std::round(lengths[c] / multiple), fewest);
    if (lattice && lattice->is_usable[c]) {
      const double given = static_cast<double>(lattice->arcs[c].size()) + (closed ? 0.0 : 1.0);
      if (given >= std::max(closed ? 4.0 : 1.0, floors[c])) n = given, by_lattice[c] = 1;
    }
    if (!options.added.empty()) n += options.added[c];
    total += n;
    detail::check_estimate("curves", total, options.max_points);
    result.n_intervals.push_back(static_cast<index_t>(n));
  }

  for (std::size_t i = 0; i < features.corners.size(); ++i)
    result.samples.push_back({surface.points[features.corners[i]], SampleKind::corner, static_cast<index_t>(i), 0.0});
  for (std::size_t c = 0; c < features.curves.size(); ++c) {
    result.first_of_curve.push_back(static_cast<index_t>(result.samples.size()));
    const std::span<const index_t> row = features.curves[c];
    const index_t n = result.n_intervals[c];
    detail::CurveWalker walker(surface.points, row);
    const auto add = [&](double arc) {
      if (!pulse.beat(0.9)) return;
      result.samples.push_back({walker.at(arc), SampleKind::curve, static_cast<index_t>(c), arc});
    };
    if (by_lattice[c])
      for (const double arc : lattice->arcs[c]) add(arc);
    else
      for (index_t k = is_closed(row) ? 0 : 1; k < n; ++k)
        add(measured[c].arc_at(measured[c].length() * (static_cast<double>(k) / n)));
  }
  result.first_of_curve.push_back(static_cast<index_t>(result.samples.size()));
  if (!pulse.report(1)) return detail::cancelled<CurveInsertion>();
  return result;
}

}  // namespace framehex
