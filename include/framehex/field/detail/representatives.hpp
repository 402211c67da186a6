// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/field/cube_rotation_group.hpp"
#include "framehex/mesh/adjacency.hpp"

#include <span>
#include <vector>

namespace framehex {

/// Gives each vertex the representative of its frame that is nearest to that of the neighbour it is first reached
/// from, breadth first. No frame changes; but frames of neighbours then seldom have to be matched before they are
/// averaged.
///
/// @param frames  n_vertices unit quaternions; changed in place.
/// @par Complexity   O(edges).
inline void align_representatives(const TetAdjacency& adjacency, std::span<Quaternion> frames) {
  std::vector<std::uint8_t> reached(frames.size(), 0);
  std::vector<index_t> queue;
  queue.reserve(frames.size());
  for (index_t seed = 0; seed < frames.size(); ++seed) {
    if (reached[seed]) continue;
    reached[seed] = 1;
    queue.assign(1, seed);
    for (std::size_t i = 0; i < queue.size(); ++i) {
      const index_t v = queue[i];
      for (const index_t w : adjacency.vertices_of_vertex[v]) {
        if (reached[w]) continue;
        reached[w] = 1;
        frames[w] = CubeRotationGroup<>::aligned(frames[v], frames[w]);
        queue.push_back(w);
      }
    }
  }
}

}  // namespace framehex
