// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/geometry/face_geometry.hpp"
#include "framehex/mesh/mixed_faces.hpp"

#include <numbers>

namespace framehex::verify {

/// What finite volume solvers ask of a mesh, as the worst found and where.
struct SolverQuality {
  double non_orthogonality = 0;       ///< rad; largest angle between a face's normal and the line of its cells' centres
  double mean_non_orthogonality = 0;  ///< rad
  double flatness = 1;                ///< least of a face, see `FaceGeometry`
  double decomposition = 1;  ///< least of a face: `decomposition_quality` with its cells, cut from its best corner
  double volume_ratio = 1;   ///< least of the smaller to the larger cell at a face
  double determinant = 1;    ///< least of a cell: do its inner faces look into all directions? 0 to 1
  std::vector<index_t> bad_decomposition;  ///< the first cell of each face whose decomposition is 0 or less, ascending
  std::vector<index_t> small_determinant;  ///< cells with a determinant below 0.001, ascending
  std::vector<index_t> lonely;             ///< cells with one inner face at most, ascending
};

namespace detail {

struct SolverQualityMeasure {
  const MixedMesh& mesh;
  SolverQuality result;
  std::vector<CellGeometry> cells;
  std::vector<Eigen::Matrix3d> inner_areas;  // sum of S S^T over the inner faces of each cell
  std::vector<double> inner_area;            // sum of |S|
  std::vector<std::uint8_t> n_inner;
  std::size_t n_angles = 0;

  explicit SolverQualityMeasure(const MixedMesh& m)
      : mesh(m),
        inner_areas(m.n_cells(), Eigen::Matrix3d::Zero()),
        inner_area(m.n_cells(), 0.0),
        n_inner(m.n_cells(), 0) {}

  std::array<Vector3, 4> corners(const CellFace& face) const {
    std::array<Vector3, 4> p{};
    for (std::size_t i = 0; i < face.size(); ++i) p[i] = mesh.points[face.vertices[i]];
    return p;
  }

  void measure_cells() {
    std::array<FaceGeometry, 6> geometry{};
    std::array<std::array<Vector3, 4>, 6> points{};
    for (index_t c = 0; c < mesh.n_cells(); ++c) {
      const auto faces = faces_of(mesh.kinds[c]);
      for (std::size_t f = 0; f < faces.size(); ++f) {
        const auto n = static_cast<std::size_t>(faces[f].size());
        for (std::size_t i = 0; i < n; ++i)
          points[f][i] = mesh.points[mesh.cells[c][static_cast<std::size_t>(faces[f].corners[i])]];
        geometry[f] = face_geometry(std::span(points[f]).first(n));
        result.flatness = std::min(result.flatness, geometry[f].flatness);
      }
      cells.push_back(cell_geometry(std::span(geometry).first(faces.size())));
    }
  }

  /// The corner from which a face is cut is the one that suits its worse cell best.
  void decompose(std::span<const CellFace> uses) {
    double best = -1;
    const std::size_t n = uses[0].size();
    for (std::size_t base = 0; base < n; ++base) {
      double least = 1;
      for (const CellFace& face : uses) {
        // Each cell has the corners in its own order.
        const auto at = std::find(face.vertices.begin(), face.vertices.end(), uses[0].vertices[base]);
        const auto p = corners(face);
        least = std::min(
            least, decomposition_quality(std::span(p).first(n), static_cast<std::size_t>(at - face.vertices.begin()),
                                         cells[face.cell].centre));
      }
      best = std::max(best, least);
    }
    result.decomposition = std::min(result.decomposition, best);
    if (best <= 0) result.bad_decomposition.push_back(uses[0].cell);
  }

  void add_inner_face(const CellFace& face, index_t other) {
    const auto p = corners(face);
    const Vector3 area = face_geometry(std::span(p).first(face.size())).area;
    const double size = area.norm();
    for (const index_t cell : {face.cell, other}) {
      ++n_inner[cell];
      if (size == 0) continue;
      inner_areas[cell] += area * area.transpose();
      inner_area[cell] += size;
    }
    const Vector3 line = cells[other].centre - cells[face.cell].centre;
    const double angle = std::atan2(area.cross(line).norm(), area.dot(line));
    result.non_orthogonality = std::max(result.non_orthogonality, angle);
    result.mean_non_orthogonality += angle;
    ++n_angles;
    const auto [low, high] = std::minmax(cells[face.cell].volume, cells[other].volume);
    result.volume_ratio = std::min(result.volume_ratio, high > 0 ? low / high : 0.0);
  }

  void finish() {
    if (n_angles > 0) result.mean_non_orthogonality /= static_cast<double>(n_angles);
    for (index_t c = 0; c < mesh.n_cells(); ++c) {
      const double mean = n_inner[c] > 0 ? inner_area[c] / n_inner[c] : 0;
      const double determinant = mean > 0 ? Eigen::Matrix3d(inner_areas[c] / (mean * mean)).determinant() / 8 : 0.0;
      result.determinant = std::min(result.determinant, determinant);
      if (determinant < 1e-3) result.small_determinant.push_back(c);
      if (n_inner[c] <= 1) result.lonely.push_back(c);
    }
  }
};

}  // namespace detail

/// Measures a mixed mesh as finite volume solvers do.
///
/// The determinant of a cell is that of the sum of S S^T over its inner faces (S: area vector), in units of their mean
/// area and scaled to 1 for a cube inside. It is 0 where the inner faces leave a direction out, as those of a tetrahedron
/// with two faces on the boundary do, or of a wall one cell thick.
///
/// @param mesh  corners in range and distinct within a cell.
/// @par Complexity   O(n log n); some 200 bytes a cell.
/// @par Source       H. Jasak, Error analysis and estimation for the finite volume method, thesis, Imperial College 1996,
///                   section 3.3; names and limits are those that OpenFOAM's checkMesh prints.
inline SolverQuality solver_quality(const MixedMesh& mesh) {
  detail::SolverQualityMeasure measure(mesh);
  measure.measure_cells();
  const FaceTable table = make_face_table(mesh);
  for (std::size_t g = 0; g < table.n_groups(); ++g) {
    const auto uses = table.group(g);
    measure.decompose(uses);
    if (uses.size() == 2) measure.add_inner_face(uses[0], uses[1].cell);
  }
  std::sort(measure.result.bad_decomposition.begin(), measure.result.bad_decomposition.end());
  measure.finish();
  return std::move(measure.result);
}

}  // namespace framehex::verify
