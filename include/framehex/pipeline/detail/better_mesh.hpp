// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/pipeline/detail/poor_cells.hpp"
#include "framehex/pipeline/meshing_result.hpp"
#include "framehex/verify/validity.hpp"

namespace framehex::detail {

inline double share_of_hexahedra(const MixedMesh& mesh) {
  const verify::VolumeReport volume = verify::volume(mesh);
  return volume.by_kind[static_cast<std::size_t>(CellKind::hexahedron)] / volume.cells;
}

/// Has mesh a fewer poor cells than b, or else more hexahedra by volume?
inline bool is_better(const MeshingResult& a, const MeshingResult& b, double least_quality) {
  const double of_a = poverty(a.poor_cells, least_quality), of_b = poverty(b.poor_cells, least_quality);
  if (of_a != of_b) return of_a < of_b;
  return share_of_hexahedra(a.recombination.mesh) > share_of_hexahedra(b.recombination.mesh);
}

}  // namespace framehex::detail
