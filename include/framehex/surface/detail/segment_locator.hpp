// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/geometry/triangle_distance.hpp"
#include "framehex/surface/detail/box_tree.hpp"

#include <optional>
#include <utility>
#include <vector>

namespace framehex::detail {

/// Two points, which may be one.
struct Segment {
  Vector3 a, b;
};

/// Nearest points on segments. Queries are const and safe from several threads at once.
class SegmentLocator {
public:
  struct Place {
    index_t segment;
    Vector3 point;
  };

  /// @par Complexity   O(n log n).
  explicit SegmentLocator(std::vector<Segment> segments) : segments_(std::move(segments)) {
    std::vector<BoxTree::Bounds> boxes;
    boxes.reserve(segments_.size());
    for (const Segment& s : segments_) boxes.push_back(triangle_bounds(s.a, s.a, s.b));
    tree_ = BoxTree(boxes);
  }

  /// Nearest point at most `radius` away, on the segment of least index when several are equally near.
  /// @par Complexity   O(log n) for points near the segments.
  std::optional<Place> nearest_within(const Vector3& p, double radius) const {
    double best = radius * radius;
    std::optional<Place> result;
    tree_.nearest(p, best, [&](index_t first, index_t count) {
      for (index_t i = first; i < first + count; ++i) {
        const index_t id = tree_.order()[i];
        const Segment& s = segments_[id];
        const Vector3 q = s.a + nearest_on_segment(p, s.a, s.b) * (s.b - s.a);
        const double distance = (q - p).squaredNorm();
        if (distance > best || (distance == best && result && id > result->segment)) continue;
        best = distance;
        result = Place{id, q};
      }
      return best;
    });
    return result;
  }

private:
  std::vector<Segment> segments_;
  BoxTree tree_;
};

}  // namespace framehex::detail
