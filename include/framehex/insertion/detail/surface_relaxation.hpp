// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/insertion/detail/surface_lattice.hpp"

#include <algorithm>

namespace framehex::detail {

/// One sweep: each sample in turn goes, along the surface, to the mean of what its lattice neighbours predict, a tenth
/// of the size at most, and only where it may stand. Samples of corners and curves stay.
template <class Lattice>
void relax_surface(Lattice& lattice) {
  constexpr double max_move = 0.1;  // in sizes
  const SurfaceInsertion& now = lattice.insertion();
  for (auto p = static_cast<index_t>(now.n_curve_samples); p < lattice.n_samples(); ++p) {
    const Eigen::Matrix3d& axes = lattice.axes(p);
    const Vector3 origin = now.samples[p].point;
    const double size = now.sizes[p];
    Vector3 sum = Vector3::Zero();
    double n = 0;
    for (std::size_t d = 0; d < 4; ++d) {
      const index_t q = now.links[p][d];
      if (q == no_index) continue;
      sum += lattice.predicted_from(q, lattice_direction(axes, d), size) - origin;
      ++n;
    }
    if (n < 2) continue;
    const Vector3 normal = axes.col(2), move = (sum - sum.dot(normal) * normal) / n;
    const double length = move.norm();
    if (length < 1e-9 * size) continue;
    const SurfaceWalk walk =
        lattice.walker().walk({now.samples[p].entity, origin, move / length}, std::min(length, max_move * size));
    if (walk.wall != no_index) continue;
    auto there = lattice.place(walk.end.triangle, walk.end.point);
    there.axes = renumbered(there.axes, axes);  // links keep their directions
    if (lattice.may_move(p, there) && lattice.clear_of_curves(there)) lattice.move(p, there);
  }
}

}  // namespace framehex::detail
