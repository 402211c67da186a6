// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/mesh/mixed_mesh.hpp"
#include "framehex/observer.hpp"
#include "framehex/option_ranges.hpp"

#include <functional>

namespace framehex {

/// Whether optimisation may change the connectivity of tetrahedra and pyramids.
enum class Reconnection { none, allowed };

/// Options of `optimize`.
struct OptimizationOptions {
  Reconnection reconnection = Reconnection::none;
  /// Scaled Jacobian below which a hexahedron, or another cell, is worked on, 1e-3 to 1.
  double hexahedron_target = 0.37;
  double quality_target = 0.23;
  int max_rounds = 8;  ///< 0 to 1e6
  /// As in `AssemblyOptions`, with vertices of the mixed mesh. Empty: no boundary vertex moves.
  std::function<bool(index_t vertex, Vector3& place)> boundary_projection{};
  Observer observer{};

  template <class Options, class Visit>
  static void each_number(Options& o, Visit&& visit) {
    visit("OptimizationOptions::hexahedron_target", o.hexahedron_target, 1e-3, 1);
    visit("OptimizationOptions::quality_target", o.quality_target, 1e-3, 1);
    visit("OptimizationOptions::max_rounds", o.max_rounds, 0, 1e6);
  }
};

/// Least scaled Jacobian before and after, by CellKind; 2 for a kind that is not there.
struct OptimizationResult {
  std::array<double, 4> before{2, 2, 2, 2}, after{2, 2, 2, 2};
  std::size_t n_moved = 0;           ///< vertices
  Status status = Status::complete;  ///< cancelled: the mesh is as it was
};

/// Raises the quality of the bad cells of a mixed mesh by moving vertices near them.
///
/// Interior vertices are free, boundary vertices go where `boundary_projection` puts them. A valid cell never becomes
/// invalid; cells that are invalid at the start stay or become valid. With `Reconnection::allowed` tetrahedra and
/// pyramids are reconnected too: cells are then renumbered, new vertices may follow the old ones, and vertices that no
/// cell uses any longer stay in `points`, so that numbers hold; without, only `points` changes.
///
/// @param mesh  conforming, well-formed; changed in place.
/// @return least qualities before and after.
/// @throws invalid_option  for a number outside its range.
/// @par Complexity   O(n) to find the bad cells; then by their number.
/// @par Source       The energy is a one-sided fourth power in the scaled Jacobian, minimised by damped Gauss-Newton
///                   steps one vertex at a time.
OptimizationResult optimize(MixedMesh& mesh, const OptimizationOptions& options = {});

}  // namespace framehex

#ifndef FRAMEHEX_COMPILED
#include "framehex/assembly/detail/optimization_impl.hpp"
#endif
