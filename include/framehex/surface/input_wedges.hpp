// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/surface/detail/segment_locator.hpp"
#include "framehex/surface/regions.hpp"

#include <cmath>
#include <limits>

namespace framehex {

/// Where a surface's own angles leave no room for good cells: edges at which two faces enclose a small angle inside a region,
/// and vertices at which two feature edges do on a patch.
///
/// Edges of three or more faces are not looked at. Queries are const and safe from several threads at once.
class InputWedges {
public:
  /// @par Complexity   O(n log n).
  InputWedges(const Surface& surface, const SurfaceRegions& regions) : tips_({}) {
    std::vector<detail::Segment> tips;
    const auto add = [&](const Vector3& a, const Vector3& b, double angle) {
      if (angle > most_angle) return;
      tips.push_back({a, b});
      angles_.push_back(angle);
    };
    for (index_t h = 0; h < surface.adjacency.opposite.size(); ++h) {
      const Vector3 &from = surface.points[surface.adjacency.from(h)], &to = surface.points[surface.adjacency.to(h)];
      const index_t g = surface.adjacency.opposite[h];
      if (g != no_index && g > h && has_body_between(surface, regions, h))
        add(from, to, angle_between_faces(surface, h));
      if (surface.features.is_feature[h]) add(from, from, sector_angle(surface, h));
    }
    tips_ = detail::SegmentLocator(std::move(tips));
  }

  /// Is a wedge so narrow at a point that no good cells of a size have room?
  bool hold(const Vector3& p, double size) const {
    constexpr double least_width = 0.07;  // in sizes: what a cell of scaled Jacobian 0.05 to 0.07 takes
    const auto nearest = tips_.nearest_within(p, std::numeric_limits<double>::infinity());
    return nearest && angles_[nearest->segment] * (nearest->point - p).norm() < least_width * size;
  }

private:
  static constexpr double most_angle = 0.1;  // rad

  static double angle(const Vector3& u, const Vector3& v) { return std::atan2(u.cross(v).norm(), u.dot(v)); }

  static double angle_between_faces(const Surface& surface, index_t h) {
    const TriangleAdjacency& adjacency = surface.adjacency;
    const Vector3& a = surface.points[adjacency.from(h)];
    const Vector3 along = surface.points[adjacency.to(h)] - a;
    return angle(along.cross(surface.points[adjacency.apex(h)] - a),
                 along.cross(surface.points[adjacency.apex(adjacency.opposite[h])] - a));
  }

  /// Whether there is a region on the side on which the faces of an edge enclose less than a straight angle.
  static bool has_body_between(const Surface& surface, const SurfaceRegions& regions, index_t h) {
    const TriangleAdjacency& adjacency = surface.adjacency;
    const bool opens_to_front =
        orientation(surface.points[adjacency.from(h)], surface.points[adjacency.to(h)],
                    surface.points[adjacency.apex(h)], surface.points[adjacency.apex(adjacency.opposite[h])]) > 0;
    return regions.sides[surface.features.triangle_patch[h / 3]][opens_to_front ? 1 : 0] != no_index;
  }

  /// The angle on the surface from a feature edge to the next at the vertex where it begins.
  static double sector_angle(const Surface& surface, index_t h) {
    const TriangleAdjacency& adjacency = surface.adjacency;
    const Vector3& p = surface.points[adjacency.from(h)];
    double sum = 0;
    while (sum <= most_angle) {
      sum += angle(surface.points[adjacency.to(h)] - p, surface.points[adjacency.apex(h)] - p);
      const index_t last = TriangleAdjacency::previous(h);
      h = adjacency.opposite[last];
      if (surface.features.is_feature[last] || h == no_index) break;
    }
    return sum;
  }

  detail::SegmentLocator tips_;
  std::vector<double> angles_;  // by tip, rad
};

}  // namespace framehex
