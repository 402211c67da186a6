// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/mesh/quad_mesh.hpp"

#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>

namespace framehex::test {

/// The directed sides of all cells, with how often each is used.
inline std::map<std::pair<index_t, index_t>, int> directed_sides(const QuadMesh& mesh) {
  std::map<std::pair<index_t, index_t>, int> sides;
  for (const auto& cell : mesh.cells) {
    const std::size_t n = QuadMesh::n_corners(cell);
    for (std::size_t i = 0; i < n; ++i) ++sides[{cell[i], cell[(i + 1) % n]}];
  }
  return sides;
}

/// Sides that no other cell has the other way.
inline std::set<std::pair<index_t, index_t>> rim_sides(const QuadMesh& mesh) {
  const auto sides = directed_sides(mesh);
  std::set<std::pair<index_t, index_t>> rim;
  for (const auto& [side, n] : sides)
    if (!sides.contains({side.second, side.first})) rim.insert(side);
  return rim;
}

/// Vertices in use minus edges plus cells.
inline int euler_characteristic(const QuadMesh& mesh) {
  std::set<index_t> vertices;
  std::set<std::pair<index_t, index_t>> edges;
  for (const auto& [side, n] : directed_sides(mesh)) {
    vertices.insert(side.first);
    edges.insert(std::minmax(side.first, side.second));
  }
  return static_cast<int>(vertices.size()) - static_cast<int>(edges.size()) + static_cast<int>(mesh.cells.size());
}

/// What is wrong with the topology of a mesh, if anything: a corner used twice, a side used twice in one direction.
inline std::optional<std::string> topology_fault(const QuadMesh& mesh) {
  for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
    const std::size_t n = QuadMesh::n_corners(mesh.cells[c]);
    if (std::set<index_t>(mesh.cells[c].begin(), mesh.cells[c].begin() + static_cast<std::ptrdiff_t>(n)).size() != n)
      return "cell " + std::to_string(c) + " has a corner twice";
  }
  for (const auto& [side, n] : directed_sides(mesh))
    if (n > 1) return "side " + std::to_string(side.first) + " " + std::to_string(side.second) + " is used twice";
  return std::nullopt;
}

}  // namespace framehex::test
