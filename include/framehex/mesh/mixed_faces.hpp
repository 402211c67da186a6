// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/mesh/mixed_mesh.hpp"

#include <algorithm>
#include <cstdint>
#include <vector>

namespace framehex {

/// A face of a cell of a mixed mesh.
struct CellFace {
  std::array<index_t, 4> vertices;  ///< anticlockwise seen from outside the cell; a triangle's fourth is `no_index`
  index_t cell;
  std::uint8_t local;  ///< position in `faces_of(kind)`
  std::size_t size() const { return vertices[3] == no_index ? 3 : 4; }
};

/// Faces of all cells, those with the same vertices next to one another.
struct FaceTable {
  std::vector<CellFace> faces;
  std::vector<std::size_t> groups;  ///< n_groups + 1 positions in `faces`: a group holds the uses of one face

  std::size_t n_groups() const { return groups.size() - 1; }
  std::span<const CellFace> group(std::size_t i) const { return {faces.data() + groups[i], groups[i + 1] - groups[i]}; }
};

/// Lists the faces of a mixed mesh and matches them by their vertices.
///
/// @pre corners in range and distinct within a cell.
/// @return groups in ascending order of their sorted vertices; within a group by cell.
/// @par Complexity   O(n log n); some 60 bytes a face.
inline FaceTable make_face_table(const MixedMesh& mesh) {
  struct Entry {
    std::array<index_t, 4> key;
    CellFace face;
  };
  std::vector<Entry> entries;
  for (index_t cell = 0; cell < mesh.n_cells(); ++cell) {
    const auto corners = mesh.cells[cell];
    std::uint8_t local = 0;
    for (const LocalFace& face : faces_of(mesh.kinds[cell])) {
      std::array<index_t, 4> v{};
      for (std::size_t i = 0; i < 4; ++i)
        v[i] = face.corners[i] < 0 ? no_index : corners[static_cast<std::size_t>(face.corners[i])];
      std::array<index_t, 4> key = v;
      std::sort(key.begin(), key.end());
      entries.push_back({key, {v, cell, local++}});
    }
  }
  // Stable, so that the cells of a face stay in ascending order.
  std::stable_sort(entries.begin(), entries.end(), [](const Entry& x, const Entry& y) { return x.key < y.key; });
  FaceTable table;
  table.faces.reserve(entries.size());
  for (std::size_t i = 0; i < entries.size(); ++i) {
    if (i == 0 || entries[i].key != entries[i - 1].key) table.groups.push_back(i);
    table.faces.push_back(entries[i].face);
  }
  table.groups.push_back(entries.size());
  return table;
}

/// The faces that only one cell has. In a conforming mesh: its boundary, closed and anticlockwise seen from outside.
///
/// @par Complexity   O(n log n).
inline std::vector<CellFace> faces_used_once(const MixedMesh& mesh) {
  const FaceTable table = make_face_table(mesh);
  std::vector<CellFace> once;
  for (std::size_t i = 0; i < table.n_groups(); ++i)
    if (table.group(i).size() == 1) once.push_back(table.group(i)[0]);
  return once;
}

}  // namespace framehex
