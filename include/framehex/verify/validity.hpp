// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/geometry/quality.hpp"
#include "framehex/geometry/validity.hpp"
#include "framehex/verify/conformity.hpp"

namespace framehex::verify {

/// Which cells are not valid.
struct ValidityReport {
  std::vector<index_t> malformed_cells;  ///< a corner out of range, the same vertex twice, or a coordinate not finite
  std::vector<index_t> invalid_cells;    ///< the map is not invertible: Jacobian zero or negative somewhere
  explicit operator bool() const { return malformed_cells.empty() && invalid_cells.empty(); }
};

/// Checks every cell of a mixed mesh by the exact test of geometry/validity.hpp.
///
/// @param mesh  any cells, also malformed ones.
/// @return offending cells, ascending.
/// @par Complexity   O(n).
inline ValidityReport is_valid(const MixedMesh& mesh) {
  ValidityReport report;
  std::array<Vector3, 8> points;
  for (index_t cell = 0; cell < mesh.n_cells(); ++cell) {
    bool usable = detail::is_well_formed(mesh, cell);
    const auto corners = mesh.cells[cell];
    for (std::size_t i = 0; usable && i < corners.size(); ++i) {
      points[i] = mesh.points[corners[i]];
      usable = points[i].allFinite();
    }
    if (!usable)
      report.malformed_cells.push_back(cell);
    else if (!framehex::is_valid(mesh.kinds[cell], {points.data(), corners.size()}))
      report.invalid_cells.push_back(cell);
  }
  return report;
}

/// Volumes of a mixed mesh.
struct VolumeReport {
  std::array<double, 4> by_kind{};       ///< by CellKind
  double cells = 0;                      ///< sum over the cells
  double boundary = 0;                   ///< inside the faces used once
  std::size_t n_boundary_triangles = 0;  ///< faces used once, a quadrilateral counting two
  std::vector<index_t> inverted_cells;   ///< volume zero or negative, ascending

  /// |cells - boundary| over |boundary|; 0 when both are.
  double relative_difference() const {
    const double difference = std::abs(cells - boundary);
    return difference == 0 ? 0 : difference / std::abs(boundary);
  }
};

/// Adds up the volumes of the cells, and compares with the volume inside the boundary.
///
/// A quadrilateral is taken as its bilinear patch. In a conforming mesh both sums are the same but for rounding.
///
/// @pre well-formed cells (see `is_conforming`).
/// @par Complexity   O(n log n).
inline VolumeReport volume(const MixedMesh& mesh) {
  VolumeReport report;
  std::array<Vector3, 8> points;
  for (index_t cell = 0; cell < mesh.n_cells(); ++cell) {
    const auto corners = mesh.cells[cell];
    for (std::size_t i = 0; i < corners.size(); ++i) points[i] = mesh.points[corners[i]];
    const double v = cell_volume(mesh.kinds[cell], {points.data(), corners.size()});
    report.by_kind[static_cast<std::size_t>(mesh.kinds[cell])] += v;
    report.cells += v;
    if (!(v > 0)) report.inverted_cells.push_back(cell);
  }
  if (mesh.n_cells() == 0) return report;
  const Vector3 origin = mesh.points[mesh.cells.values[0]];
  for (const CellFace& face : faces_used_once(mesh)) {
    const auto p = [&](std::size_t i) -> Vector3 { return mesh.points[face.vertices[i]] - origin; };
    report.n_boundary_triangles += face.size() - 2;
    if (face.size() == 3)
      report.boundary += p(0).cross(p(1)).dot(p(2)) / 6;
    else
      report.boundary += (p(0).cross(p(2)).dot(p(3) - p(1)) + p(1).cross(p(3)).dot(p(0) - p(2))) / 12;
  }
  return report;
}

}  // namespace framehex::verify
