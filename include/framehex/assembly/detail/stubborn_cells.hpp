// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/assembly/detail/cavity_grower.hpp"
#include "framehex/assembly/detail/quality_energy.hpp"
#include "framehex/assembly/options.hpp"

namespace framehex::detail {

/// What is left for a bad cell that neither moving vertices nor reconnecting improves: a new vertex beside it, or a
/// hexahedron or prism next to it split from its centre.
class StubbornCells {
public:
  StubbornCells(CellComplex& complex, const QualityEnergy& energy, AssemblyStatistics& statistics)
      : complex_(complex), filler_(complex), grower_(complex, filler_), energy_(energy), statistics_(statistics) {}

  /// Replaces the cell, by cells with a new vertex among tetrahedra and pyramids.
  bool insert_vertex(index_t cell) {
    begin();
    if (is_soft(complex_.cells[cell].kind)) {
      try_cavity({cell});
      try_rings(cell, is_soft);
    }
    return commit(statistics_.n_raised);
  }

  /// Replaces the cell together with hexahedra and prisms that it has a face in common with.
  /// @param enough  quality of the new cells, over their target, that is enough however good the old ones were.
  bool split_neighbour(index_t cell, double enough = 1.0) {
    begin(enough);
    if (!is_soft(complex_.cells[cell].kind)) try_cavity({cell});
    for (std::size_t f = 0; f < complex_.n_faces(cell); ++f) {
      const index_t other = complex_.across(cell, complex_.face(cell, f));
      if (other == no_index || is_soft(complex_.cells[other].kind)) continue;
      try_cavity({other});
      try_cavity({cell, other});
    }
    // A tetrahedron that lies flat under two triangles of the boundary hides them from all but what is round its edges.
    if (best_quality_ <= 0 && is_soft(complex_.cells[cell].kind)) try_rings(cell, [](CellKind) { return true; });
    return commit(statistics_.n_split);
  }

private:
  void begin(double enough = 1.0) {
    best_quality_ = -1;
    enough_ = enough;
  }

  template <class Usable>
  void try_rings(index_t cell, Usable&& usable) {
    for_each_ring(complex_, cell, ring_, usable, [this] { try_cavity(ring_); });
  }

  void try_cavity(const std::vector<index_t>& cells) {
    trial_.cells = cells;
    if (!filler_.build(trial_)) return;
    Vector3 point = Vector3::Zero();
    for (const index_t v : trial_.vertices) point += complex_.points[v] / static_cast<double>(trial_.vertices.size());
    const double size = (complex_.points[trial_.vertices[0]] - point).norm();
    double quality = filler_.improve_point(trial_, point, 0.2 * size, filler_.evaluate(trial_, point, no_index));
    grower_.grow(trial_, quality, point, 0.1 * size);
    double worst = std::numeric_limits<double>::infinity();
    for (const index_t cell : trial_.cells) energy_.of(complex_, cell, worst);
    // The least improvement that is worth new cells.
    if (quality <= best_quality_ || quality / energy_.other_target < std::min(1.5 * worst + 0.02, enough_)) return;
    best_quality_ = quality;
    best_point_ = point;
    best_ = trial_;
  }

  bool commit(std::size_t& counter) {
    if (best_quality_ <= 0) return false;
    if (!filler_.fill_from_new_vertex(best_, best_point_)) return false;
    ++counter;
    return true;
  }

  CellComplex& complex_;
  CavityFiller filler_;
  CavityGrower grower_;
  QualityEnergy energy_;
  AssemblyStatistics& statistics_;
  std::vector<index_t> ring_;
  Cavity trial_, best_;
  Vector3 best_point_ = Vector3::Zero();
  double best_quality_ = -1, enough_ = 1;
};

}  // namespace framehex::detail
