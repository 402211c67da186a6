// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/surface/detail/editable_surface.hpp"
#include "framehex/surface/detail/triangle_normals.hpp"

namespace framehex::detail {

/// Normals of the input surface at the vertices of an EditableSurface, one for each smooth sector.
///
/// They are what new triangles are compared with: a triangle stands upright when its normal agrees with the mean of its
/// corners' normals, which come from the input and do not drift while the surface is edited.
class SectorNormals {
public:
  /// @pre `surface` has not been edited yet.
  SectorNormals(const EditableSurface& surface, const TriangleAdjacency& adjacency)
      : surface_(surface),
        original_patch_(surface.patch),
        original_points_(surface.points),
        original_corners_(surface.corners),
        original_sector_(surface.sector) {
    triangle_ = triangle_normals(surface.points, adjacency);
    normals_.assign(surface.n_sectors(), Vector3::Zero());
    for (index_t h = 0; h < original_sector_.size(); ++h) {
      const Vector3 &p = surface.points[surface.from(h)], a = surface.points[surface.to(h)] - p,
                    b = surface.points[surface.apex(h)] - p;
      normals_[original_sector_[h]] += std::atan2(a.cross(b).norm(), a.dot(b)) * triangle_[h / 3];
    }
    for (Vector3& n : normals_)
      if (n.norm() > 1e-12) n.normalize();
  }

  /// Of the input triangle.
  const Vector3& of_triangle(index_t parent) const { return triangle_[parent]; }
  std::size_t n_triangles() const { return original_corners_.size(); }
  const Vector3& point(index_t v) const { return original_points_[v]; }  ///< of the input, before samples took it over
  index_t patch_of(index_t parent) const { return original_patch_[parent]; }
  const std::array<index_t, 3>& corners_of(index_t parent) const { return original_corners_[parent]; }

  /// Normal at the corner from which half edge h starts.
  const Vector3& at(index_t h) const { return normals_[surface_.sector[h]]; }
  const Vector3& of_sector(index_t sector) const { return normals_[sector]; }

  /// Adds the normal of a new vertex inside an input triangle. @return its sector, to be given to the vertex.
  index_t add(EditableSurface& surface, index_t parent, const Vector3& barycentric) {
    Vector3 n = Vector3::Zero();
    for (index_t i = 0; i < 3; ++i) n += barycentric[static_cast<int>(i)] * normals_[original_sector_[3 * parent + i]];
    return add(surface, n.norm() > 1e-12 ? n : triangle_[parent]);
  }

  /// Adds a normal of any length.
  index_t add(EditableSurface& surface, const Vector3& normal) {
    normals_.push_back(normal.norm() > 1e-12 ? Vector3(normal.normalized()) : Vector3(Vector3::Zero()));
    return surface.add_sector();
  }

  /// The same on edge (a, b) of the input triangle, at `position` from a (0) to b (1).
  index_t add_on_edge(EditableSurface& surface, index_t parent, index_t a, index_t b, double position) {
    Vector3 weights = Vector3::Zero();
    for (int i = 0; i < 3; ++i) {
      const index_t v = surface.name[original_corners_[parent][static_cast<std::size_t>(i)]];
      weights[i] = v == a ? 1 - position : v == b ? position : 0;
    }
    return add(surface, parent, weights);
  }

private:
  const EditableSurface& surface_;
  std::vector<index_t> original_patch_;
  std::vector<Vector3> original_points_;
  std::vector<std::array<index_t, 3>> original_corners_;
  std::vector<index_t> original_sector_;
  std::vector<Vector3> triangle_;
  std::vector<Vector3> normals_;
};

}  // namespace framehex::detail
