// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/geometry/cell_kinds.hpp"
#include "framehex/mesh/csr.hpp"
#include "framehex/observer.hpp"

#include <array>
#include <vector>

namespace framehex {

/// Potential cells of one kind in flat arrays; candidate i is row i of each.
///
/// A face sliver is a tetrahedron with its four corners on one quadrilateral of the cell: it lies in the face, belongs
/// to whichever cells meet there, and does not make two candidates incompatible.
template <int Corners>
struct Candidates {
  std::vector<std::array<index_t, static_cast<std::size_t>(Corners)>> vertices;  ///< order of geometry/cell_kinds.hpp
  Csr<index_t> tets;           ///< tetrahedra inside, without face slivers, ascending
  Csr<index_t> face_slivers;   ///< n rows, ascending
  std::vector<float> quality;  ///< least scaled Jacobian of the corners, -1 to 1
  std::vector<double> volume;  ///< of the trilinear (or its kind's) map
  Status status = Status::complete;

  std::size_t size() const { return vertices.size(); }
  bool empty() const { return vertices.empty(); }
};

/// The kind of cell with that many corners.
template <int Corners>
inline constexpr CellKind kind_with = Corners == 4   ? CellKind::tetrahedron
                                      : Corners == 5 ? CellKind::pyramid
                                      : Corners == 6 ? CellKind::prism
                                                     : CellKind::hexahedron;

/// What `find_potential_hexahedra` returns.
using PotentialHexahedra = Candidates<8>;
/// What `find_potential_prisms` returns.
using PotentialPrisms = Candidates<6>;
/// What `find_potential_pyramids` returns.
using PotentialPyramids = Candidates<5>;

}  // namespace framehex
