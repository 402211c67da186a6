// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/mesh/csr.hpp"

#include <vector>

namespace framehex {

/// A domain of the plane, given by polylines over one set of points.
///
/// `loops` bound it: a point belongs to the domain when it lies inside an odd number of them, however they run. A loop
/// within another is a hole, one within that an island, and so where they share vertices or inner polylines join them.
/// A polyline of `loops` need not be closed by itself, as long as no end is loose: where an odd number of segments meet,
/// what the connected loops enclose are regions beside each other. `inner` ones lie in the domain; cells follow them on
/// both sides, and where they divide it, they divide it into regions.
struct PlanarOutline {
  std::vector<Vector2> points;
  Csr<index_t> loops;  ///< vertices along each; a closed one repeats its first
  Csr<index_t> inner;  ///< the same; open or closed
  double z = 0;        ///< of the plane, and so of the mesh; sizes are asked for at z = 0

  std::size_t n_polylines() const { return loops.size() + inner.size(); }
  /// By position: loops first.
  std::span<const index_t> polyline(std::size_t i) const {
    return i < loops.size() ? loops[i] : inner[i - loops.size()];
  }
};

}  // namespace framehex
