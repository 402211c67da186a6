// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/assembly/detail/cavity_grower.hpp"
#include "framehex/assembly/detail/mixed_export.hpp"
#include "framehex/assembly/options.hpp"
#include "framehex/geometry/face_geometry.hpp"
#include "framehex/verify/solver_quality.hpp"

namespace framehex::detail {

/// Replaces the cells that finite volume solvers refuse: those whose inner faces leave a direction out (a tetrahedron
/// with two faces on the boundary), those of a face that cannot be cut into tetrahedra with their centres, and those
/// whose centre is all but on a face.
///
/// A cavity round such a cell is filled from a vertex inside the body. Each new cell then has at most one face on
/// the boundary, so that none of them leaves a direction out.
class FiniteVolumeFit {
public:
  explicit FiniteVolumeFit(CellComplex& complex) : complex_(complex), filler_(complex), grower_(complex, filler_) {}

  /// Replaces what it can, once. @return how many cells solvers refused before.
  std::size_t run(AssemblyStatistics& statistics) {
    const std::vector<index_t> refused = find_refused();
    for (const index_t cell : refused)
      if (complex_.cells[cell].alive && replace(cell)) ++statistics.n_refitted;
    return refused.size();
  }

  /// Living cells that solvers refuse; both cells of a bad face.
  std::vector<index_t> find_refused() const {
    const MixedExport exported = export_cells(complex_, 0);
    const verify::SolverQuality quality = verify::solver_quality(exported.mesh);
    std::vector<index_t> refused;
    for (const auto* cells : {&quality.small_determinant, &quality.bad_decomposition, &quality.small_weight})
      for (const index_t cell : *cells) refused.push_back(exported.cell_of[cell]);
    std::sort(refused.begin(), refused.end());
    refused.erase(std::unique(refused.begin(), refused.end()), refused.end());
    return refused;
  }

private:
  /// Least scaled Jacobian of the new cells for which no hexahedron or prism is taken as well.
  static constexpr double good_quality = 0.15;
  static constexpr double least_quality = 0.05;
  /// Of a face of the cavity with the centres of its cells: away from 0, where it is refused.
  static constexpr double least_decomposition = 1e-3;

  bool replace(index_t cell) {
    best_quality_ = least_quality;
    try_cavity({cell});
    try_neighbours(cell, is_soft);
    try_rings(cell, is_soft);
    const auto any = [](CellKind) { return true; };
    if (best_quality_ < good_quality) {
      try_neighbours(cell, any);
      try_rings(cell, any);
    }
    if (best_quality_ <= least_quality) try_balls(cell);
    if (best_quality_ <= least_quality) {
      grows_ = true;
      try_cavity({cell});
      try_neighbours(cell, any);
      try_rings(cell, any);
      try_balls(cell);
      grows_ = false;
    }
    if (best_quality_ <= least_quality) return false;
    if (best_apex_ != no_index) return filler_.fill(best_, best_apex_) > 0;
    return filler_.fill_from_new_vertex(best_, best_point_);
  }

  template <class Usable>
  void try_neighbours(index_t cell, Usable&& usable) {
    for (std::size_t f = 0; f < complex_.n_faces(cell); ++f) {
      const index_t other = complex_.across(cell, complex_.face(cell, f));
      if (other != no_index && usable(complex_.cells[other].kind)) try_cavity({cell, other});
    }
  }

  template <class Usable>
  void try_rings(index_t cell, Usable&& usable) {
    for_each_ring(complex_, cell, ring_, usable, [this] { try_cavity(ring_); });
  }

  /// The cells round each corner, of any kind.
  void try_balls(index_t cell) {
    for (std::size_t i = 0; i < complex_.corners(cell).size(); ++i) {
      ring_.clear();
      complex_.for_each_cell_at(complex_.corners(cell)[i], [&](index_t other) { ring_.push_back(other); });
      if (ring_.size() < Cavity::most_cells) try_cavity(ring_);
    }
  }

  /// Keeps a cavity that can be filled better than the best so far, from one of its inner vertices or from a new one.
  void try_cavity(std::vector<index_t> cells) {
    trial_.cells = std::move(cells);
    if (!filler_.build(trial_)) return;
    for (const index_t v : trial_.vertices)
      if (!complex_.on_boundary[v])
        keep_if_better(filler_.evaluate(trial_, complex_.points[v], v, best_quality_), complex_.points[v], v);
    Vector3 point = Vector3::Zero();
    for (const index_t v : trial_.vertices) point += complex_.points[v] / static_cast<double>(trial_.vertices.size());
    const double step = 0.2 * (complex_.points[trial_.vertices[0]] - point).norm();
    double quality = filler_.improve_point(trial_, point, step, filler_.evaluate(trial_, point, no_index));
    if (grows_) grower_.grow(trial_, quality, point, 0.5 * step);
    if (quality > least_quality && fit(point, no_index) < 1) quality = move_to_fit(point, step, quality);
    keep_if_better(quality, point, no_index);
  }

  /// The best shape need not be one that fits: moves the new vertex to where both shape and fit are above their least.
  /// @return its quality there.
  double move_to_fit(Vector3& point, double step, double quality) const {
    const auto excess = [&](const Vector3& p, double) {
      return std::min(filler_.evaluate(trial_, p, no_index) / least_quality, fit(p, no_index));
    };
    CavityFiller::climb(point, 0.5 * step, std::min(quality / least_quality, fit(point, no_index)), excess);
    return filler_.evaluate(trial_, point, no_index);
  }

  void keep_if_better(double quality, const Vector3& point, index_t apex) {
    if (quality <= best_quality_ || fit(point, apex) < 1) return;
    best_quality_ = quality;
    best_point_ = point;
    best_apex_ = apex;
    best_ = trial_;
  }

  /// How far the faces of the trial cavity can be cut into tetrahedra with the centres of the cells on both sides, and lie
  /// between them: 1 where both are as little as is taken.
  double fit(const Vector3& point, index_t apex) const {
    double least = std::numeric_limits<double>::infinity();
    for (const auto& face : trial_.faces) {
      if (apex != no_index && std::find(face.begin(), face.end(), apex) != face.end()) continue;
      std::array<Vector3, 4> corners{};
      const std::size_t n = face[3] == no_index ? 3 : 4;
      for (std::size_t i = 0; i < n; ++i) corners[i] = complex_.points[face[i]];
      const index_t beyond = cell_behind(complex_, trial_, face);
      const Vector3 here = centre_of_star(face, point), other = beyond == no_index ? Vector3::Zero() : centre(beyond);
      least =
          std::min(least, best_decomposition(std::span(corners).first(n), here, beyond == no_index ? nullptr : &other) /
                              least_decomposition);
      if (beyond == no_index) continue;
      const double weight = face_weight(face_geometry(std::span(corners).first(n)), here, other);
      least = std::min(least, std::min(weight, 1 - weight) / verify::least_weight);
    }
    return least;
  }

  Vector3 centre_of_star(const std::array<index_t, 4>& face, const Vector3& point) const {
    const StarCell star = star_cell(face, 0);
    const std::size_t apex = star.kind == CellKind::tetrahedron ? 0 : 4;
    std::array<Vector3, 8> corners{};
    for (std::size_t i = 0; i < static_cast<std::size_t>(n_corners(star.kind)); ++i)
      corners[i] = i == apex ? point : complex_.points[star.corners[i]];
    return cell_geometry(star.kind, corners).centre;
  }

  Vector3 centre(index_t cell) const {
    std::array<Vector3, 8> corners{};
    return cell_geometry(complex_.cells[cell].kind, complex_.gather(cell, corners)).centre;
  }

  CellComplex& complex_;
  CavityFiller filler_;
  CavityGrower grower_;
  bool grows_ = false;  // cavities take in what hides their faces from the new vertex
  std::vector<index_t> ring_;
  Cavity trial_, best_;
  Vector3 best_point_ = Vector3::Zero();
  index_t best_apex_ = no_index;
  double best_quality_ = 0;
};

}  // namespace framehex::detail
