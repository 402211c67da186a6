// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/geometry/predicates.hpp"
#include "framehex/mesh/indexed_mesh.hpp"
#include "framehex/recombination/candidates.hpp"

namespace framehex::test {

/// Two cubes of six tetrahedra each, one on the other, and between them a void of the shape of a tetrahedron: the lower
/// face of the upper cube is folded upwards along one diagonal, the upper face of the lower one downwards along the
/// other. Both faces have the same four corners.
struct VoidBetween {
  IndexedTetMesh mesh;
  PotentialHexahedra cubes;  ///< the two, as a finder would give them that does not see the void

  VoidBetween() {
    mesh.points = {{0, 0, 0}, {1, 0, -.15}, {1, 1, 0},  {0, 1, -.15}, {0, 0, 1},  {1, 0, 1},
                   {1, 1, 1}, {0, 1, 1},    {0, 0, -1}, {1, 0, -1},   {1, 1, -1}, {0, 1, -1}};
    add_cube({0, 1, 2, 3, 4, 5, 6, 7});
    add_cube({9, 10, 11, 8, 1, 2, 3, 0});
  }

private:
  /// Its six tetrahedra lie round the diagonal from corner 0 to corner 6.
  void add_cube(const std::array<index_t, 8>& v) {
    constexpr std::array<std::array<std::size_t, 2>, 6> between{{{1, 2}, {1, 5}, {3, 2}, {3, 7}, {4, 5}, {4, 7}}};
    for (const auto& [i, j] : between) {
      std::array<index_t, 4> t{v[0], v[i], v[j], v[6]};
      const auto& p = mesh.points;
      if (orientation(p[t[0]], p[t[1]], p[t[2]], p[t[3]]) < 0) std::swap(t[2], t[3]);
      cubes.tets.values.push_back(static_cast<index_t>(mesh.tets.size()));
      mesh.tets.push_back(t);
    }
    cubes.tets.end_row();
    cubes.face_slivers.end_row();
    cubes.vertices.push_back(v);
    cubes.quality.push_back(0.9F);
    cubes.volume.push_back(1);
  }
};

}  // namespace framehex::test
