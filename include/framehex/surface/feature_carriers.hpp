// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/geometry/bounding_box.hpp"
#include "framehex/surface/detail/curve_line.hpp"
#include "framehex/surface/detail/triangle_normals.hpp"
#include "framehex/surface/surface.hpp"
#include "framehex/surface/surface_locator.hpp"

namespace framehex {

/// The patches and curves of a surface, each for itself, as what points are brought back to.
///
/// Calls are const and safe from several threads at once.
class FeatureCarriers {
public:
  /// A point of a patch and the patch's normal there, of unit length.
  struct PatchPoint {
    Vector3 point, normal;
  };

  /// A point of a curve and how far it is from what was asked for, in the unit of the coordinates.
  struct CurvePoint {
    Vector3 point;
    double distance;
  };

  FeatureCarriers() = default;

  /// @par Complexity   O(n log n).
  explicit FeatureCarriers(const Surface& surface) {
    const FeatureGraph& features = surface.features;
    std::vector<IndexedTriangleMesh> patches(features.n_patches);
    normals_.resize(features.n_patches);
    const std::vector<Vector3> normals = detail::triangle_normals(surface.points, surface.adjacency);
    for (std::size_t t = 0; t < surface.triangles().size(); ++t) {
      IndexedTriangleMesh& patch = patches[features.triangle_patch[t]];
      const auto first = static_cast<index_t>(patch.points.size());
      for (const index_t v : surface.triangles()[t]) patch.points.push_back(surface.points[v]);
      patch.triangles.push_back({first, first + 1, first + 2});
      normals_[features.triangle_patch[t]].push_back(normals[t]);
    }
    for (std::size_t p = 0; p < patches.size(); ++p) {
      planes_.push_back(plane_of(patches[p], normals_[p]));
      patches_.emplace_back(patches[p]);
    }
    for (std::size_t c = 0; c < features.curves.size(); ++c) curves_.emplace_back(surface.points, features.curves[c]);
    if (!surface.points.empty()) diagonal_ = bounding_box(surface.points).diagonal().norm();
  }

  std::size_t n_patches() const { return patches_.size(); }
  std::size_t n_curves() const { return curves_.size(); }

  /// Nearest point of a patch; of its plane, where it lies in one.
  /// @par Complexity   O(log n) for points near it; O(1) in a plane.
  PatchPoint onto_patch(index_t patch, const Vector3& p) const {
    if (const Plane& plane = planes_[patch]; plane.normal != Vector3::Zero())
      return {p - (p - plane.origin).dot(plane.normal) * plane.normal, plane.normal};
    const SurfacePoint nearest = patches_[patch].nearest(p);
    return {nearest.point, normals_[patch][nearest.triangle]};
  }

  /// Nearest point of a patch, never outside its rim.
  Vector3 within_patch(index_t patch, const Vector3& p) const { return patches_[patch].nearest(p).point; }

  /// Nearest point of a curve.
  Vector3 onto_curve(index_t curve, const Vector3& p) const { return curves_[curve].nearest(p); }

  /// Where a curve is farthest from the chord of two points of it; of a closed curve, along the shorter way.
  /// @par Complexity   O(log n) and the curve's vertices between them.
  CurvePoint farthest_from_chord(index_t curve, const Vector3& a, const Vector3& b) const {
    const auto found = curves_[curve].farthest(a, b);
    return {found.place, found.distance};
  }

  double diagonal() const { return diagonal_; }  ///< of the box round the surface

private:
  struct Plane {
    Vector3 origin = Vector3::Zero(), normal = Vector3::Zero();  ///< null: none
  };

  /// The plane in which a patch lies exactly, as far as rounding shows; the axes' planes without any rounding.
  static Plane plane_of(const IndexedTriangleMesh& patch, std::span<const Vector3> normals) {
    if (patch.points.empty()) return {};
    Eigen::AlignedBox3d box;
    for (const Vector3& p : patch.points) box.extend(p);
    Vector3 normal = Vector3::Zero();
    for (const Vector3& n : normals)
      if (normal.isZero()) normal = n;
    for (int axis = 0; axis < 3; ++axis)
      if (box.sizes()[axis] == 0) normal = Vector3::Unit(axis) * (normal[axis] < 0 ? -1.0 : 1.0);
    const double tolerance = 1e-12 * box.diagonal().norm();
    for (const Vector3& p : patch.points)
      if (std::abs((p - patch.points[0]).dot(normal)) > tolerance) return {};
    return {patch.points[0], normal};
  }

  std::vector<SurfaceLocator> patches_;
  std::vector<std::vector<Vector3>> normals_;  ///< of the patches' triangles
  std::vector<Plane> planes_;
  std::vector<detail::CurveLine> curves_;
  double diagonal_ = 0;
};

}  // namespace framehex
