// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/assembly/detail/cell_complex.hpp"

namespace framehex::detail {

/// `scaled_jacobian` of a tetrahedron, whose corners share their determinant.
inline double tetrahedron_quality(const Vector3& p0, const Vector3& p1, const Vector3& p2, const Vector3& p3) {
  const Vector3 a = p1 - p0, b = p2 - p0, c = p3 - p0;
  const double aa = a.squaredNorm(), bb = b.squaredNorm(), cc = c.squaredNorm();
  const double ab = (p2 - p1).squaredNorm(), ac = (p3 - p1).squaredNorm(), bc = (p3 - p2).squaredNorm();
  const double determinant = a.cross(b).dot(c);
  const double p[4] = {aa * bb * cc, aa * ab * ac, bb * ab * bc, cc * ac * bc};
  // The longest edges give the least corner, unless the tetrahedron is inside out.
  const double product = determinant > 0 ? std::max(std::max(p[0], p[1]), std::max(p[2], p[3]))
                                         : std::min(std::min(p[0], p[1]), std::min(p[2], p[3]));
  return product > 0 ? std::clamp(determinant / std::sqrt(product), -1.0, 1.0) : 0.0;
}

/// `scaled_jacobian` of a pyramid.
inline double pyramid_quality(const std::array<Vector3, 4>& base, const Vector3& apex) {
  std::array<Vector3, 4> side;
  std::array<double, 4> length;
  for (std::size_t i = 0; i < 4; ++i) {
    side[i] = base[(i + 1) % 4] - base[i];
    length[i] = side[i].squaredNorm();
  }
  double least = 1;  // of the square, with the sign
  for (std::size_t i = 0; i < 4; ++i) {
    const Vector3 up = apex - base[i];
    const double determinant = side[(i + 3) % 4].cross(side[i]).dot(up);
    const double product = length[(i + 3) % 4] * length[i] * up.squaredNorm();
    least = std::min(least, product > 0 ? determinant * std::abs(determinant) / product : 0.0);
  }
  return least >= 0 ? std::sqrt(least) : -std::sqrt(std::min(-least, 1.0));
}

/// What improvement lowers: the sum over all corners of all cells of (1 - s/target)^4, where the scaled Jacobian s is
/// below the target of its kind. Cells at or above their target cost nothing, so that work stays near bad cells.
struct QualityEnergy {
  double hexahedron_target, other_target;

  /// Over the target, above which a cell is not worked on: many end just below it, where nothing more is gained.
  static constexpr double good_enough = 0.85;
  /// The energy whose good enough cells reach given scaled Jacobians.
  static QualityEnergy reaching(double hexahedron, double other) {
    return {hexahedron / good_enough, other / good_enough};
  }

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
    if (kind == CellKind::tetrahedron || kind == CellKind::pyramid) {
      const double q = kind == CellKind::tetrahedron ? tetrahedron_quality(p[0], p[1], p[2], p[3])
                                                     : pyramid_quality({p[0], p[1], p[2], p[3]}, p[4]);
      if (factor * q >= 1) {
        worst = std::min(worst, factor * q);
        return 0;
      }
    }
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
