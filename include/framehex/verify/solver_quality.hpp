// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/geometry/face_geometry.hpp"
#include "framehex/mesh/mixed_faces.hpp"

#include <numbers>

namespace framehex::verify {

/// A cell with a smaller determinant is refused by solvers.
inline constexpr double least_determinant = 1e-3;
/// As is a face that is nearer to the centre of one of its cells, by this share of the way to the other's.
inline constexpr double least_weight = 0.05;

/// What finite volume solvers ask of a mesh, as the worst found and where.
struct SolverQuality {
  double non_orthogonality = 0;       ///< rad; largest angle between a face's normal and the line of its cells' centres
  double mean_non_orthogonality = 0;  ///< rad
  double flatness = 1;                ///< least of a face, see `FaceGeometry`
  double decomposition = 1;  ///< least of a face: `decomposition_quality` with its cells, cut from its best corner
  double weight = 0.5;       ///< least of an inner face: its share of the way between its cells' centres, across it
  double volume_ratio = 1;   ///< least of the smaller to the larger cell at a face
  double determinant = 1;    ///< least of a cell: do its inner faces look into all directions? 0 to 1
  std::vector<index_t> bad_decomposition;  ///< both cells of faces whose decomposition is 0 or less, ascending
  std::vector<index_t> small_determinant;  ///< cells with a determinant below `least_determinant`, ascending
  std::vector<index_t> small_weight;       ///< the cell that is nearer to each face below `least_weight`, ascending
  std::vector<index_t> lonely;             ///< cells with one inner face at most, ascending
};

namespace detail {

struct SolverQualityMeasure {
  const MixedMesh& mesh;
  SolverQuality result;
  std::vector<CellGeometry> cells;
  std::vector<InnerFaces> inner_faces;
  std::size_t n_angles = 0;

  explicit SolverQualityMeasure(const MixedMesh& m) : mesh(m), inner_faces(m.n_cells()) {}

  std::array<Vector3, 4> corners(const CellFace& face) const {
    std::array<Vector3, 4> p{};
    for (std::size_t i = 0; i < face.size(); ++i) p[i] = mesh.points[face.vertices[i]];
    return p;
  }

  void measure_cells() {
    std::array<Vector3, 8> corners{};
    for (index_t c = 0; c < mesh.n_cells(); ++c) {
      const auto n = static_cast<std::size_t>(n_corners(mesh.kinds[c]));
      for (std::size_t i = 0; i < n; ++i) corners[i] = mesh.points[mesh.cells[c][i]];
      cells.push_back(cell_geometry(mesh.kinds[c], std::span(corners).first(n)));
    }
  }

  /// @param other  the cell on the other side, `no_index` on the boundary.
  void measure_face(const CellFace& face, index_t other) {
    const auto p = corners(face);
    result.flatness = std::min(result.flatness, face_geometry(std::span(p).first(face.size())).flatness);
    const double quality = best_decomposition(std::span(p).first(face.size()), cells[face.cell].centre,
                                              other == no_index ? nullptr : &cells[other].centre);
    result.decomposition = std::min(result.decomposition, quality);
    if (quality > 0) return;
    result.bad_decomposition.push_back(face.cell);
    if (other != no_index) result.bad_decomposition.push_back(other);
  }

  void add_inner_face(const CellFace& face, index_t other) {
    const auto p = corners(face);
    const FaceGeometry geometry = face_geometry(std::span(p).first(face.size()));
    const Vector3& area = geometry.area;
    const double weight = face_weight(geometry, cells[face.cell].centre, cells[other].centre);
    const double nearer = std::min(weight, 1 - weight);
    result.weight = std::min(result.weight, nearer);
    if (nearer < least_weight) result.small_weight.push_back(weight < 0.5 ? face.cell : other);
    for (const index_t cell : {face.cell, other}) inner_faces[cell].add(area);
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
      const double determinant = inner_faces[c].determinant();
      result.determinant = std::min(result.determinant, determinant);
      if (determinant < least_determinant) result.small_determinant.push_back(c);
      if (inner_faces[c].n <= 1) result.lonely.push_back(c);
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
    measure.measure_face(uses[0], uses.size() == 2 ? uses[1].cell : no_index);
    if (uses.size() == 2) measure.add_inner_face(uses[0], uses[1].cell);
  }
  std::ranges::sort(measure.result.small_weight);
  auto& bad = measure.result.bad_decomposition;
  std::ranges::sort(bad);
  bad.erase(std::unique(bad.begin(), bad.end()), bad.end());
  measure.finish();
  return std::move(measure.result);
}

}  // namespace framehex::verify
