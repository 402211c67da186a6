// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/config.hpp"
#include "support/hexahedron_subdivisions.hpp"

namespace framehex::test {

/// The least of the 24 ways to write a hexahedron's vertices: equal for equal hexahedra.
inline std::array<index_t, 8> canonical_hexahedron(const std::array<index_t, 8>& v) {
  static const auto rotations = [] {
    std::vector<std::array<int, 8>> maps;
    for (const auto& map : SubdivisionEnumerator::symmetries()) {
      // A rotation keeps the turn of the three edges at corner 0; those of the image are found by its corner table.
      const auto& c = cell_tables::hexahedron_corners[static_cast<std::size_t>(map[0])];
      std::array<int, 3> turn{c.x, c.y, c.z};
      while (turn[0] != map[1]) std::rotate(turn.begin(), turn.begin() + 1, turn.end());
      if (turn[1] == map[3]) maps.push_back(map);
    }
    return maps;
  }();
  std::array<index_t, 8> least;
  least.fill(no_index);
  for (const auto& map : rotations) {
    std::array<index_t, 8> w{};
    for (std::size_t i = 0; i < 8; ++i) w[i] = v[static_cast<std::size_t>(map[i])];
    least = std::min(least, w);
  }
  return least;
}

}  // namespace framehex::test
