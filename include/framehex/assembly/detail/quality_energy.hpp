// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/assembly/detail/cell_complex.hpp"

namespace framehex::detail {

/// What improvement lowers: the sum over all corners of all cells of (1 - s/target)^4, where the scaled Jacobian s is
/// below the target of its kind. Cells at or above their target cost nothing, so that work stays near bad cells.
struct QualityEnergy {
  double hexahedron_target, other_target;

  double target(CellKind kind) const { return kind == CellKind::hexahedron ? hexahedron_target : other_target; }

  static double penalty(double relative) {
    const double lack = 1 - relative;
    if (lack <= 0) return 0;
    return lack * lack * lack * lack;
  }

  /// Energy of one cell; `worst` falls to its least corner over the target.
  double of(CellKind kind, std::span<const Vector3> p, double& worst) const {
    const double factor = 1 / target(kind);
    double energy = 0;
    const auto at = [&](std::int8_t i) -> const Vector3& { return p[static_cast<std::size_t>(i)]; };
    for (const LocalCorner& c : corners_of(kind)) {
      const double s =
          factor * normalised_determinant(at(c.x) - at(c.corner), at(c.y) - at(c.corner), at(c.z) - at(c.corner));
      worst = std::min(worst, s);
      energy += penalty(s);
    }
    return energy;
  }

  double of(const CellComplex& complex, index_t cell, double& worst) const {
    std::array<Vector3, 8> buffer;
    return of(complex.cells[cell].kind, complex.gather(cell, buffer), worst);
  }
};

/// Whether a change that lowers the energy may be made: the worst cell gets no worse, or stays acceptable.
inline bool acceptable(double worst_before, double worst_after) {
  return worst_after >= worst_before || worst_after >= 0.8;
}

}  // namespace framehex::detail
