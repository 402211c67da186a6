// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/assembly/detail/cavity.hpp"

namespace framehex::detail {

/// Adds tetrahedra and pyramids to a cavity so that a new vertex sees its faces better.
class CavityGrower {
public:
  CavityGrower(CellComplex& complex, CavityFiller& filler) : complex_(complex), filler_(filler) {}

  /// Adds one by one the cell behind the face that limits the quality, as long as the best place is then better.
  /// @param step  first step of the search for a place.
  void grow(Cavity& cavity, double& quality, Vector3& point, double step) {
    constexpr int max_cells = 8;
    for (int i = 0; i < max_cells; ++i) {
      const index_t beyond = cell_beyond(worst_face(cavity, point), cavity);
      if (beyond == no_index) return;
      trial_.cells = cavity.cells;
      trial_.cells.push_back(beyond);
      if (!filler_.build(trial_)) return;
      Vector3 trial_point = point;
      const double start = filler_.evaluate(trial_, trial_point, no_index);
      const double trial_quality = filler_.improve_point(trial_, trial_point, step, start);
      if (trial_quality <= quality) return;
      quality = trial_quality;
      point = trial_point;
      std::swap(cavity, trial_);
    }
  }

  /// Adds all cells that hide a face from a point, until every face is seen with a least quality, or gives up when they
  /// are too many: each turn adds one at least.
  bool uncover(const Vector3& point, double least_quality, Cavity& cavity) {
    constexpr std::size_t max_cells = 40;
    for (bool grown = true; grown;) {
      grown = false;
      for (const auto& face : cavity.faces) {
        if (filler_.quality_from(face, point) >= least_quality) continue;
        const index_t beyond = cell_beyond(face, cavity);
        if (beyond == no_index) return false;
        if (!cavity.contains(beyond)) cavity.cells.push_back(beyond);
        grown = true;
      }
      if (grown && (cavity.cells.size() > max_cells || !filler_.build(cavity))) return false;
    }
    return true;
  }

private:
  std::array<index_t, 4> worst_face(const Cavity& cavity, const Vector3& point) const {
    double worst = std::numeric_limits<double>::infinity();
    std::array<index_t, 4> found = cavity.faces.front();
    for (const auto& face : cavity.faces) {
      const double q = filler_.quality_from(face, point);
      if (q >= worst) continue;
      worst = q;
      found = face;
    }
    return found;
  }

  /// The tetrahedron or pyramid on the other side of a face of the cavity.
  index_t cell_beyond(const std::array<index_t, 4>& face, const Cavity& cavity) const {
    const index_t cell = cell_behind(complex_, cavity, face);
    return cell != no_index && is_soft(complex_.cells[cell].kind) ? cell : no_index;
  }

  CellComplex& complex_;
  CavityFiller& filler_;
  Cavity trial_;
};

}  // namespace framehex::detail
