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

/// The steps of `insert_curve_points`.
template <SizeField Size>
class CurveInserter {
public:
  CurveInserter(const Surface& surface, const Size& size, const CurveOptions& options, const CurveLattice* lattice)
      : points_(surface.points),
        features_(surface.features),
        curves_(surface.features.curves),
        size_(size),
        options_(options),
        lattice_(lattice),
        n_corners_(static_cast<double>(surface.features.corners.size())),
        pulse_(options.observer, "curve insertion") {
    if (!options.added.empty()) one_each(options.added, curves_.size(), "added intervals", "curves");
    if (!lattice) return;
    one_each(std::span(lattice->is_usable), curves_.size(), "marks of the lattice", "curves");
    one_each(std::span(lattice->arcs.offsets), curves_.size() + 1, "ends of the lattice's rows",
             "curves and their end");
  }

  CurveInsertion run() {
    pulse_.report(0);
    if (!measure()) return cancelled<CurveInsertion>();
    choose_intervals();
    place_samples();
    if (!pulse_.report(1)) return cancelled<CurveInsertion>();
    return std::move(result_);
  }

private:
  static constexpr double least_of_closed = 4;

  bool is_closed(std::size_t curve) const {
    const index_t end = curves_[curve].front();
    return end == curves_[curve].back() && !std::binary_search(features_.corners.begin(), features_.corners.end(), end);
  }

  /// @return false when told to stop.
  bool measure() {
    const auto most = static_cast<double>(options_.max_points);
    double total = n_corners_;
    for (std::size_t c = 0; c < curves_.size(); ++c) {
      measured_.push_back(measure_curve<Size>(points_, curves_[c], is_closed(c), size_, most - total, pulse_));
      if (pulse_.stopped()) return false;
      total += measured_.back().length();
      if (total > most)
        check_estimate("curves", std::max(total, n_corners_ + estimate_length(points_, curves_, size_)),
                       options_.max_points);
    }
    return true;
  }

  void choose_intervals() {
    const std::vector<index_t> least = least_intervals(features_);
    by_lattice_.assign(curves_.size(), 0);
    double total = n_corners_;
    for (std::size_t c = 0; c < curves_.size(); ++c) {
      const double of_turn = std::ceil(measured_[c].turn / options_.max_turn - 1e-6);
      const double fewest = std::max({is_closed(c) ? least_of_closed : 1.0, static_cast<double>(least[c]), of_turn});
      double n = intervals_of_size(c, fewest);
      if (lattice_ && lattice_->is_usable[c]) {
        const double given = static_cast<double>(lattice_->arcs[c].size()) + (is_closed(c) ? 0.0 : 1.0);
        if (given >= fewest) n = given, by_lattice_[c] = 1;
      }
      if (!options_.added.empty()) n += options_.added[c];
      total += n;
      check_estimate("curves", total, options_.max_points);
      result_.n_intervals.push_back(static_cast<index_t>(n));
    }
  }

  double intervals_of_size(std::size_t c, double fewest) const {
    const double multiple = is_closed(c) ? static_cast<double>(options_.closed_multiple) : 1.0;
    return multiple * std::max(std::round(measured_[c].length() / multiple), std::ceil(fewest / multiple));
  }

  void place_samples() {
    for (std::size_t i = 0; i < features_.corners.size(); ++i)
      result_.samples.push_back({points_[features_.corners[i]], SampleKind::corner, static_cast<index_t>(i), 0.0});
    for (std::size_t c = 0; c < curves_.size(); ++c) {
      result_.first_of_curve.push_back(static_cast<index_t>(result_.samples.size()));
      CurveWalker walker(points_, curves_[c]);
      const auto add = [&](double arc) {
        if (!pulse_.beat(0.9)) return;
        result_.samples.push_back({walker.at(arc), SampleKind::curve, static_cast<index_t>(c), arc});
      };
      const index_t n = result_.n_intervals[c];
      if (by_lattice_[c])
        for (const double arc : lattice_->arcs[c]) add(arc);
      else
        for (index_t k = is_closed(c) ? 0 : 1; k < n; ++k)
          add(measured_[c].arc_at(measured_[c].length() * (static_cast<double>(k) / n)));
    }
    result_.first_of_curve.push_back(static_cast<index_t>(result_.samples.size()));
  }

  std::span<const Vector3> points_;
  const FeatureGraph& features_;
  const Csr<index_t>& curves_;
  const Size& size_;
  const CurveOptions& options_;
  const CurveLattice* lattice_;
  double n_corners_;
  Pulse pulse_;
  std::vector<MeasuredCurve> measured_;
  std::vector<std::uint8_t> by_lattice_;  ///< per curve: does it get the lattice's points?
  CurveInsertion result_;
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
  check_options(options);
  return detail::CurveInserter<Size>(surface, size, options, lattice).run();
}

}  // namespace framehex
