// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/surface/surface_locator.hpp"
#include "framehex/verify/conformity.hpp"

namespace framehex::verify {

/// How far the boundary of a mesh is from the surface it should fill.
struct DeviationReport {
  double mesh_to_surface_max = 0, mesh_to_surface_mean = 0;  ///< from points of the mesh's boundary, unit of the host
  double surface_to_mesh_max = 0, surface_to_mesh_mean = 0;  ///< from points of the surface
  double diagonal = 0;                                       ///< of the box round the surface
  std::vector<CellFace> faces;                               ///< boundary faces with a point beyond the tolerance
  std::vector<index_t> cells() const {
    std::vector<index_t> all;
    for (const CellFace& face : faces) all.push_back(face.cell);
    std::sort(all.begin(), all.end());
    all.erase(std::unique(all.begin(), all.end()), all.end());
    return all;
  }
};

namespace detail {

/// Calls `visit(point)` for the corners, the middles of the sides and the centroid of a triangle.
template <class Visit>
void visit_samples(const Vector3& a, const Vector3& b, const Vector3& c, Visit&& visit) {
  for (const Vector3& p :
       {a, b, c, Vector3((a + b) / 2), Vector3((b + c) / 2), Vector3((c + a) / 2), Vector3((a + b + c) / 3)})
    visit(p);
}

}  // namespace detail

/// Distances between the boundary of a mesh and a surface, both ways, at corners, middles of sides and centroids of
/// triangles; a quadrilateral counts as its two triangles.
///
/// @param mesh       its faces used once are taken as the boundary.
/// @param host       the surface: any TriangleMesh with at least one triangle.
/// @param tolerance  distance beyond which a boundary face is reported, in the unit of the coordinates.
/// @return distances at the sampled points (a lower bound of the Hausdorff distance), and the offending faces.
/// @par Complexity   O(n log n).
template <TriangleMesh Host>
DeviationReport boundary_deviation(const MixedMesh& mesh, const Host& host,
                                   double tolerance = std::numeric_limits<double>::infinity()) {
  const auto& surface = framehex::detail::flat(host);
  DeviationReport report;
  IndexedTriangleMesh boundary;
  boundary.points = mesh.points;
  const SurfaceLocator to_surface(surface);
  std::size_t n = 0;
  for (const CellFace& face : faces_used_once(mesh)) {
    const auto& v = face.vertices;
    boundary.triangles.push_back({v[0], v[1], v[2]});
    if (face.size() == 4) boundary.triangles.push_back({v[0], v[2], v[3]});
    double largest = 0;
    for (std::size_t i = boundary.triangles.size() - (face.size() - 2); i < boundary.triangles.size(); ++i) {
      const auto& t = boundary.triangles[i];
      detail::visit_samples(mesh.points[t[0]], mesh.points[t[1]], mesh.points[t[2]], [&](const Vector3& p) {
        const double d = to_surface.nearest(p).distance;
        largest = std::max(largest, d);
        report.mesh_to_surface_mean += d;
        ++n;
      });
    }
    report.mesh_to_surface_max = std::max(report.mesh_to_surface_max, largest);
    if (largest > tolerance) report.faces.push_back(face);
  }
  if (n > 0) report.mesh_to_surface_mean /= static_cast<double>(n);
  Eigen::AlignedBox3d box;
  for (const Vector3& p : surface.points) box.extend(p);
  if (!box.isEmpty()) report.diagonal = box.diagonal().norm();
  if (boundary.triangles.empty()) return report;
  const SurfaceLocator to_mesh(boundary);
  n = 0;
  for (const auto& t : surface.triangles)
    detail::visit_samples(surface.points[t[0]], surface.points[t[1]], surface.points[t[2]], [&](const Vector3& p) {
      const double d = to_mesh.nearest(p).distance;
      report.surface_to_mesh_max = std::max(report.surface_to_mesh_max, d);
      report.surface_to_mesh_mean += d;
      ++n;
    });
  if (n > 0) report.surface_to_mesh_mean /= static_cast<double>(n);
  return report;
}

}  // namespace framehex::verify
