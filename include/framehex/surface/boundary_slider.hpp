// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/mesh/mixed_mesh.hpp"
#include "framehex/surface/detail/segment_locator.hpp"
#include "framehex/surface/feature_carriers.hpp"
#include "framehex/surface/surface.hpp"
#include "framehex/surface/surface_locator.hpp"

#include <memory>

namespace framehex {

/// Keeps boundary vertices on the patch or curve of a surface that they started on: for
/// `AssemblyOptions::boundary_projection`. Corners, and vertices that did not start on the surface, may not move.
///
/// Copies share what they know; calls are const and safe from several threads at once.
class BoundarySlider {
public:
  /// @param surface    geometry to stay on, and its patches, curves and corners.
  /// @param points     vertices of the tetrahedral mesh where they start.
  /// @param edges      feature edges of the tetrahedral mesh; a vertex on two or more labels, where other than two
  ///                   edges meet, or at a corner of `surface` is a corner.
  /// @param tolerance  how far a vertex may start from the surface, in the unit of the coordinates.
  /// @par Complexity   O(n log n); a call is O(log n).
  BoundarySlider(const Surface& surface, std::span<const Vector3> points, std::span<const LabelledEdge> edges,
                 double tolerance)
      : BoundarySlider(surface, SurfaceLocator(surface), points, edges, tolerance) {}

  /// @param locator  of `surface`, for those who have one.
  BoundarySlider(const Surface& surface, const SurfaceLocator& locator, std::span<const Vector3> points,
                 std::span<const LabelledEdge> edges, double tolerance)
      : data_(std::make_shared<Data>()) {
    const FeatureGraph& features = surface.features;
    Data& d = *data_;
    d.carriers = FeatureCarriers(surface);
    d.tolerance = tolerance;
    std::vector<detail::Segment> all;
    std::vector<index_t> curve_of_segment;
    for (std::size_t c = 0; c < features.curves.size(); ++c) {
      const auto row = features.curves[c];
      for (std::size_t i = 0; i + 1 < row.size(); ++i) {
        all.push_back({surface.points[row[i]], surface.points[row[i + 1]]});
        curve_of_segment.push_back(static_cast<index_t>(c));
      }
    }
    std::vector<detail::Segment> corners;
    for (const index_t v : features.corners) corners.push_back({surface.points[v], surface.points[v]});
    classify(locator, features, points, edges, detail::SegmentLocator(std::move(all)), curve_of_segment,
             detail::SegmentLocator(std::move(corners)));
  }

  /// Moves `place` to the nearest point of the patch or curve of a vertex. @return false: the vertex may not move.
  bool operator()(index_t vertex, Vector3& place) const {
    const Data& d = *data_;
    if (vertex >= d.carrier.size() || d.carrier[vertex] == no_index) return false;
    const index_t id = d.carrier[vertex];
    place = d.on_curve[vertex] ? d.carriers.onto_curve(id, place) : d.carriers.within_patch(id, place);
    return true;
  }

private:
  struct Data {
    FeatureCarriers carriers;
    std::vector<index_t> carrier;  ///< by vertex: patch or curve, `no_index`: fixed
    std::vector<std::uint8_t> on_curve;
    double tolerance = 0;
  };

  void classify(const SurfaceLocator& whole, const FeatureGraph& features, std::span<const Vector3> points,
                std::span<const LabelledEdge> edges, const detail::SegmentLocator& curves,
                std::span<const index_t> curve_of_segment, const detail::SegmentLocator& corners) {
    Data& d = *data_;
    d.carrier.assign(points.size(), no_index);
    d.on_curve.assign(points.size(), 0);
    std::vector<index_t> n_edges(points.size(), 0), label(points.size(), no_index);
    std::vector<std::uint8_t> is_corner(points.size(), 0);
    for (const LabelledEdge& edge : edges)
      for (const index_t v : edge.vertices) {
        if (n_edges[v]++ > 0 && label[v] != edge.label) is_corner[v] = 1;
        label[v] = edge.label;
      }
    for (index_t v = 0; v < points.size(); ++v) {
      if (is_corner[v] || (n_edges[v] != 0 && n_edges[v] != 2)) continue;
      const auto at = whole.nearest_within(points[v], d.tolerance);
      // A curve that closes at its only corner has one label on both sides of it.
      if (!at || corners.nearest_within(points[v], d.tolerance)) continue;
      if (n_edges[v] == 2) {
        const auto nearest = curves.nearest_within(points[v], d.tolerance);
        d.carrier[v] = nearest ? curve_of_segment[nearest->segment] : no_index;
        d.on_curve[v] = 1;
      } else {
        d.carrier[v] = features.triangle_patch[at->triangle];
      }
    }
  }

  std::shared_ptr<Data> data_;
};

}  // namespace framehex
