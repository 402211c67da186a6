// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/assembly/detail/cell_complex.hpp"
#include "framehex/mesh/adjacency.hpp"

namespace framehex::detail {

/// Finds the tetrahedra of the input that fill a cell of the result: one of the same corners, two under a pyramid, or
/// what a hexahedron or prism was chosen of.
class CellOrigins {
public:
  explicit CellOrigins(const TetAdjacency& adjacency) : adjacency_(adjacency) {}

  /// Appends a row to `rows`, ascending; an empty one for a cell that was made anew.
  /// @param chosen_of  the tetrahedra of a chosen cell.
  void append(const CellComplex::Cell& cell, std::span<const index_t> chosen_of, Csr<index_t>& rows) const {
    const auto& v = cell.corners;
    rows.values.insert(rows.values.end(), chosen_of.begin(), chosen_of.end());
    if (cell.kind == CellKind::tetrahedron) append_tets({find({v[0], v[1], v[2], v[3]})}, rows);
    if (cell.kind == CellKind::pyramid &&
        !append_tets({find({v[0], v[1], v[2], v[4]}), find({v[0], v[2], v[3], v[4]})}, rows))
      append_tets({find({v[1], v[2], v[3], v[4]}), find({v[1], v[3], v[0], v[4]})}, rows);
    rows.end_row();
  }

private:
  index_t find(const std::array<index_t, 4>& corners) const {
    const FaceKey key = face_key(corners);
    if (key[3] >= adjacency_.n_vertices()) return no_index;
    for (const index_t tet : adjacency_.tets_of_vertex[key[0]])
      if (face_key(adjacency_.tets[tet]) == key) return tet;
    return no_index;
  }

  static bool append_tets(std::initializer_list<index_t> tets, Csr<index_t>& rows) {
    if (std::ranges::find(tets, no_index) != tets.end()) return false;
    const auto row = rows.values.insert(rows.values.end(), tets.begin(), tets.end());
    std::sort(row, rows.values.end());
    return true;
  }

  const TetAdjacency& adjacency_;
};

}  // namespace framehex::detail
