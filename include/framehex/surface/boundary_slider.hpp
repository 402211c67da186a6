// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/mesh/mixed_mesh.hpp"
#include "framehex/surface/surface.hpp"
#include "framehex/surface/surface_locator.hpp"

#include <algorithm>
#include <limits>
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
  /// @par Complexity   O(n log n); a call is O(log n) on a patch, O(length) on a curve.
  BoundarySlider(const Surface& surface, std::span<const Vector3> points, std::span<const LabelledEdge> edges,
                 double tolerance)
      : BoundarySlider(surface, SurfaceLocator(surface), points, edges, tolerance) {}

  /// @param locator  of `surface`, for those who have one.
  BoundarySlider(const Surface& surface, const SurfaceLocator& locator, std::span<const Vector3> points,
                 std::span<const LabelledEdge> edges, double tolerance)
      : data_(std::make_shared<Data>()) {
    const FeatureGraph& features = surface.features;
    Data& d = *data_;
    d.tolerance = tolerance;
    std::vector<IndexedTriangleMesh> patches(features.n_patches);
    for (std::size_t t = 0; t < surface.triangles().size(); ++t) {
      IndexedTriangleMesh& patch = patches[features.triangle_patch[t]];
      const auto first = static_cast<index_t>(patch.points.size());
      for (const index_t v : surface.triangles()[t]) patch.points.push_back(surface.points[v]);
      patch.triangles.push_back({first, first + 1, first + 2});
    }
    for (const IndexedTriangleMesh& patch : patches) d.patches.emplace_back(patch);
    for (std::size_t c = 0; c < features.curves.size(); ++c) {
      std::vector<Vector3>& curve = d.curves.emplace_back();
      for (const index_t v : features.curves[c]) curve.push_back(surface.points[v]);
    }
    for (const index_t v : features.corners) d.corners.push_back(surface.points[v]);
    classify(locator, features, points, edges);
  }

  /// Moves `place` to the nearest point of the patch or curve of a vertex. @return false: the vertex may not move.
  bool operator()(index_t vertex, Vector3& place) const {
    const Data& d = *data_;
    if (vertex >= d.carrier.size() || d.carrier[vertex] == no_index) return false;
    const index_t id = d.carrier[vertex];
    place = d.on_curve[vertex] ? nearest_on(d.curves[id], place) : d.patches[id].nearest(place).point;
    return true;
  }

private:
  struct Data {
    std::vector<SurfaceLocator> patches;
    std::vector<std::vector<Vector3>> curves;
    std::vector<Vector3> corners;
    std::vector<index_t> carrier;  ///< by vertex: patch or curve, `no_index`: fixed
    std::vector<std::uint8_t> on_curve;
    double tolerance = 0;
  };

  static Vector3 nearest_on(const std::vector<Vector3>& curve, const Vector3& p) {
    double least = std::numeric_limits<double>::infinity();
    Vector3 nearest = p;
    for (std::size_t i = 0; i + 1 < curve.size(); ++i) {
      const Vector3 d = curve[i + 1] - curve[i];
      const double t = std::clamp(d.dot(p - curve[i]) / std::max(d.squaredNorm(), 1e-300), 0.0, 1.0);
      const Vector3 q = curve[i] + t * d;
      if ((q - p).squaredNorm() >= least) continue;
      least = (q - p).squaredNorm();
      nearest = q;
    }
    return nearest;
  }

  void classify(const SurfaceLocator& whole, const FeatureGraph& features, std::span<const Vector3> points,
                std::span<const LabelledEdge> edges) {
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
      if (!at || is_at_corner(points[v])) continue;
      if (n_edges[v] == 2) {
        const index_t curve = nearest_curve(points[v]);
        d.carrier[v] = curve;
        d.on_curve[v] = 1;
      } else {
        d.carrier[v] = features.triangle_patch[at->triangle];
      }
    }
  }

  /// A curve that closes at its only corner has one label on both sides of it.
  bool is_at_corner(const Vector3& p) const {
    return std::ranges::any_of(
        data_->corners, [&](const Vector3& c) { return (c - p).squaredNorm() <= data_->tolerance * data_->tolerance; });
  }

  index_t nearest_curve(const Vector3& p) const {
    index_t found = no_index;
    double least = data_->tolerance;
    for (index_t c = 0; c < data_->curves.size(); ++c) {
      const double distance = (nearest_on(data_->curves[c], p) - p).norm();
      if (distance > least) continue;
      least = distance;
      found = c;
    }
    return found;
  }

  std::shared_ptr<Data> data_;
};

}  // namespace framehex
