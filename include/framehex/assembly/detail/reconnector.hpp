// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/assembly/detail/cavity.hpp"
#include "framehex/assembly/detail/quality_energy.hpp"

namespace framehex::detail {

/// Changes the connectivity of tetrahedra and pyramids round a bad cell to lower the energy.
///
/// Tried are the cavities round its edges, its faces and its vertices, each filled from any of its vertices. Hexahedra,
/// prisms and all quadrilaterals stay.
class Reconnector {
public:
  Reconnector(CellComplex& complex, const QualityEnergy& energy)
      : complex_(complex), filler_(complex), energy_(energy) {}

  /// @return whether the cell was replaced.
  bool improve(index_t cell) {
    best_gain_ = 0;
    const CellKind kind = complex_.cells[cell].kind;
    if (kind != CellKind::tetrahedron && kind != CellKind::pyramid) return false;
    const auto corner = [&](std::int8_t i) { return complex_.cells[cell].corners[static_cast<std::size_t>(i)]; };
    for (const auto& edge : edges_of(kind)) try_edge(corner(edge[0]), corner(edge[1]));
    for (std::size_t f = 0; f < complex_.n_faces(cell); ++f) try_face(cell, complex_.face(cell, f));
    for (std::size_t i = 0; i < static_cast<std::size_t>(n_corners(kind)); ++i) {
      const index_t v = complex_.cells[cell].corners[i];
      if (!complex_.is_protected[v] && !complex_.on_boundary[v]) try_vertex(v);
    }
    return best_gain_ > 0 && filler_.fill(best_, best_apex_) > 0;
  }

  const std::vector<index_t>& new_cells() const { return filler_.new_cells; }

private:
  void try_edge(index_t v, index_t w) {
    trial_.cells.clear();
    bool usable = true;
    complex_.for_each_cell_at(v, [&](index_t cell) {
      if (!usable || !complex_.has_vertex(cell, w)) return;
      if (is_soft(complex_.cells[cell].kind) && complex_.has_edge(cell, v, w))
        trial_.cells.push_back(cell);
      else
        usable = false;
    });
    if (usable && trial_.cells.size() > 1 && trial_.cells.size() < Cavity::most_cells) try_cavity();
  }

  void try_face(index_t cell, const std::array<index_t, 4>& face) {
    if (face[3] != no_index) return;
    const index_t other = complex_.across(cell, face);
    if (other == no_index || !is_soft(complex_.cells[other].kind)) return;
    trial_.cells = {cell, other};
    try_cavity();
  }

  void try_vertex(index_t v) {
    trial_.cells.clear();
    bool usable = true;
    complex_.for_each_cell_at(v, [&](index_t cell) {
      usable = usable && is_soft(complex_.cells[cell].kind);
      trial_.cells.push_back(cell);
    });
    if (usable && trial_.cells.size() < Cavity::most_cells) try_cavity();
  }

  void try_cavity() {
    double worst_before = std::numeric_limits<double>::infinity(), before = 0;
    for (const index_t cell : trial_.cells) before += energy_.of(complex_, cell, worst_before);
    if (before <= best_gain_ || !filler_.gather(trial_)) return;
    bool fillable = false;
    for (const index_t apex : trial_.vertices) {
      const double gain = before - star_energy(apex, before - best_gain_, worst_before);
      if (gain <= best_gain_ + 1e-9 * before) continue;
      // Asked only where it matters: most cavities have no better filling.
      if (!fillable && !filler_.is_fillable(trial_)) return;
      fillable = true;
      best_gain_ = gain;
      best_apex_ = apex;
      best_ = trial_;
    }
  }

  /// Energy of the cavity filled from a vertex; infinite above `limit` and where the worst cell is not acceptable.
  double star_energy(index_t apex, double limit, double worst_before) const {
    double energy = 0, worst = std::numeric_limits<double>::infinity();
    std::array<Vector3, 5> p;
    for (const auto& face : trial_.faces) {
      const bool quad = face[3] != no_index;
      if (std::find(face.begin(), face.end(), apex) != face.end()) {
        if (quad) return std::numeric_limits<double>::infinity();
        continue;
      }
      const StarCell cell = star_cell(face, apex);
      const std::size_t n = quad ? 5 : 4;
      for (std::size_t i = 0; i < n; ++i) p[i] = complex_.points[cell.corners[i]];
      energy += energy_.of(cell.kind, {p.data(), n}, worst);
      if (energy >= limit || worst <= 0 || !acceptable(worst_before, worst))
        return std::numeric_limits<double>::infinity();
    }
    return energy;
  }

  CellComplex& complex_;
  CavityFiller filler_;
  QualityEnergy energy_;
  Cavity trial_, best_;
  double best_gain_ = 0;
  index_t best_apex_ = no_index;
};

}  // namespace framehex::detail
