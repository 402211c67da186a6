// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/geometry/triangle_distance.hpp"
#include "framehex/surface/detail/segment_locator.hpp"

#include <algorithm>
#include <span>
#include <utility>
#include <vector>

namespace framehex::detail {

/// One curve of a surface by arc length, to tell how far chords are from it.
class CurveLine {
public:
  /// Where a stretch of the curve is farthest from its chord.
  struct Farthest {
    double distance = 0, arc = 0;
    Vector3 place = Vector3::Zero();
  };

  CurveLine(std::span<const Vector3> points, std::span<const index_t> row) : locator_(segments(points, row)) {
    for (std::size_t i = 0; i < row.size(); ++i) {
      const double step = i > 0 ? (points[row[i]] - points[row[i - 1]]).norm() : 0;
      points_.push_back(points[row[i]]);
      arcs_.push_back(arcs_.empty() ? 0 : arcs_.back() + step);
    }
    closed_ = row.front() == row.back();
  }

  double length() const { return arcs_.back(); }

  Vector3 at(double arc) const {
    const auto above = std::upper_bound(arcs_.begin() + 1, arcs_.end() - 1, arc);
    const auto i = static_cast<std::size_t>(above - arcs_.begin());
    const double step = arcs_[i] - arcs_[i - 1];
    const double x = step > 0 ? std::clamp((arc - arcs_[i - 1]) / step, 0.0, 1.0) : 0.0;
    return points_[i - 1] + x * (points_[i] - points_[i - 1]);
  }

  /// Nearest point of the curve.
  Vector3 nearest(const Vector3& p) const { return place(p).point; }

  /// The same, by arc length.
  double arc_of(const Vector3& p) const {
    const auto at = place(p);
    return arcs_[at.segment] + (at.point - points_[at.segment]).norm();
  }

  /// Of the stretch from one arc length to another that is greater, beyond the length where it passes the end of a closed
  /// curve. No point of stretch or chord is farther from the other than that: a vertex of the stretch is the farthest,
  /// and the stretch has a point over each of the chord.
  /// @par Complexity   O(log n + vertices between).
  Farthest farthest(double from, double to) const {
    const Vector3 a = at(from), b = at(to > length() ? to - length() : to);
    Farthest found;
    for (double turn = 0; turn <= to; turn += length()) {
      if (!(length() > 0)) break;
      const auto begin = std::upper_bound(arcs_.begin(), arcs_.end(), from - turn),
                 end = std::lower_bound(begin, arcs_.end(), to - turn);
      for (auto i = begin; i != end; ++i) {
        const Vector3& p = points_[static_cast<std::size_t>(i - arcs_.begin())];
        const double distance = (a + nearest_on_segment(p, a, b) * (b - a) - p).norm();
        if (distance > found.distance) found = {distance, *i, p};
      }
    }
    return found;
  }

  /// Between two points of the curve; of a closed one, along the shorter way.
  Farthest farthest(const Vector3& a, const Vector3& b) const {
    const auto [from, to] = std::minmax({arc_of(a), arc_of(b)});
    return closed_ && to - from > length() / 2 ? farthest(to, from + length()) : farthest(from, to);
  }

private:
  static std::vector<Segment> segments(std::span<const Vector3> points, std::span<const index_t> row) {
    std::vector<Segment> result;
    for (std::size_t i = 1; i < row.size(); ++i) result.push_back({points[row[i - 1]], points[row[i]]});
    return result;
  }

  SegmentLocator::Place place(const Vector3& p) const {
    return locator_.nearest_within(p, std::numeric_limits<double>::infinity()).value_or(SegmentLocator::Place{0, p});
  }

  std::vector<Vector3> points_;
  std::vector<double> arcs_;
  SegmentLocator locator_;
  bool closed_ = false;
};

}  // namespace framehex::detail
