// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/geometry/cell_kinds.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

namespace framehex {

/// A polygon in space, cut into triangles from the mean of its corners, as finite volume solvers take it.
struct FaceGeometry {
  Vector3 area;     ///< vector; outward where the corners are anticlockwise seen from outside
  Vector3 centre;   ///< of its triangles, by their areas
  double flatness;  ///< length of `area` over the sum of the triangles' areas: 1 when plane, less when warped
};

/// @param corners  three or four points in order.
/// @par Complexity   O(1).
inline FaceGeometry face_geometry(std::span<const Vector3> corners) {
  Vector3 mean = Vector3::Zero();
  for (const Vector3& p : corners) mean += p / static_cast<double>(corners.size());
  FaceGeometry face{Vector3::Zero(), Vector3::Zero(), 1};
  double total = 0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vector3 &p = corners[i], &q = corners[(i + 1) % corners.size()];
    const Vector3 area = (p - mean).cross(q - mean) / 2;
    face.area += area;
    total += area.norm();
    face.centre += area.norm() * (p + q + mean) / 3;
  }
  face.centre = total > 0 ? Vector3(face.centre / total) : mean;
  face.flatness = total > 0 ? face.area.norm() / total : 0;
  return face;
}

/// Volume and centre of a cell from its faces, as pyramids over them from the mean of their centres.
struct CellGeometry {
  double volume;
  Vector3 centre;
};

/// @param faces  all of the cell, with areas outward.
/// @par Complexity   O(faces).
inline CellGeometry cell_geometry(std::span<const FaceGeometry> faces) {
  Vector3 mean = Vector3::Zero();
  for (const FaceGeometry& face : faces) mean += face.centre / static_cast<double>(faces.size());
  CellGeometry cell{0, Vector3::Zero()};
  for (const FaceGeometry& face : faces) {
    const double volume = face.area.dot(face.centre - mean) / 3;
    cell.volume += volume;
    cell.centre += volume * (0.75 * face.centre + 0.25 * mean);
  }
  cell.centre = cell.volume != 0 ? Vector3(cell.centre / cell.volume) : mean;
  return cell;
}

/// @param corners  of a cell, in the order of its kind.
inline CellGeometry cell_geometry(CellKind kind, std::span<const Vector3> corners) {
  std::array<FaceGeometry, 6> geometry{};
  const auto faces = faces_of(kind);
  for (std::size_t f = 0; f < faces.size(); ++f) {
    std::array<Vector3, 4> points{};
    const auto n = static_cast<std::size_t>(faces[f].size());
    for (std::size_t i = 0; i < n; ++i) points[i] = corners[static_cast<std::size_t>(faces[f].corners[i])];
    geometry[f] = face_geometry(std::span(points).first(n));
  }
  return cell_geometry(std::span(geometry).first(faces.size()));
}

/// Where a face stands between the centres of its cells: 0 at the first, 1 at the other, measured across the face.
/// @par Complexity   O(1).
inline double face_weight(const FaceGeometry& face, const Vector3& centre, const Vector3& other) {
  const double here = std::abs(face.area.dot(face.centre - centre)),
               there = std::abs(face.area.dot(other - face.centre));
  return here + there > 0 ? here / (here + there) : 0.0;
}

/// Least quality of the tetrahedra over the triangles into which a face is cut from one of its corners.
///
/// @param corners  of the face, anticlockwise seen from the side opposite `tip`.
/// @param base     the corner from which it is cut.
/// @param tip      their fourth corner, the centre of a cell.
/// @return volume over that of a regular tetrahedron with the longest edge, at most 1; negative when turned inside out.
/// @par Complexity   O(1).
inline double decomposition_quality(std::span<const Vector3> corners, std::size_t base, const Vector3& tip) {
  double least = 1;
  const std::size_t n = corners.size();
  for (std::size_t i = 1; i + 1 < n; ++i) {
    const std::array<Vector3, 4> p{corners[base], corners[(base + i) % n], corners[(base + i + 1) % n], tip};
    double longest = 0;
    for (std::size_t a = 0; a < 4; ++a)
      for (std::size_t b = 0; b < a; ++b) longest = std::max(longest, (p[a] - p[b]).squaredNorm());
    const double six_volumes = (p[0] - p[3]).cross(p[1] - p[3]).dot(p[2] - p[3]);
    const double regular = longest * std::sqrt(longest) / std::sqrt(2.0);
    least = std::min(least, regular > 0 ? six_volumes / regular : 0.0);
  }
  return least;
}

/// The same for a face between two cells, cut from the corner that suits the worse of them best.
///
/// @param corners  of the face, anticlockwise seen from the side opposite `tip`.
/// @param other    centre of the cell on the other side; null on the boundary.
/// @par Complexity   O(1).
inline double best_decomposition(std::span<const Vector3> corners, const Vector3& tip, const Vector3* other) {
  std::array<Vector3, 4> reversed{};
  const std::size_t n = corners.size();
  std::reverse_copy(corners.begin(), corners.end(), reversed.begin());
  double best = -1;
  for (std::size_t base = 0; base < n; ++base) {
    double least = decomposition_quality(corners, base, tip);
    if (other) least = std::min(least, decomposition_quality(std::span(reversed).first(n), n - 1 - base, *other));
    best = std::max(best, least);
  }
  return best;
}

/// What a cell's inner faces say of the directions into which it can pass something on.
struct InnerFaces {
  Eigen::Matrix3d areas = Eigen::Matrix3d::Zero();  ///< sum of S S^T, S the area vectors
  double area = 0;                                  ///< sum of |S|
  int n = 0;

  void add(const Vector3& s) {
    ++n;
    areas += s * s.transpose();
    area += s.norm();
  }

  /// 1 for a cube all of whose faces are inner, 0 where a direction is left out.
  double determinant() const {
    const double mean = n > 0 ? area / n : 0;
    return mean > 0 ? Eigen::Matrix3d(areas / (mean * mean)).determinant() / 8 : 0.0;
  }
};

}  // namespace framehex
