// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/surface/surface.hpp"

#include <vector>

namespace framehex::detail {

/// The triangles round a vertex that can be reached without crossing a feature, anticlockwise.
struct TriangleFan {
  std::vector<index_t> outgoing;  ///< half edge from the vertex in each triangle
  bool closed = false;            ///< all round, without a feature
};

/// Half edges between triangles of one patch.
class PatchSides {
public:
  explicit PatchSides(const Surface& surface) : adjacency_(surface.adjacency), features_(surface.features) {}

  bool is_wall(index_t half_edge) const {
    return features_.is_feature[half_edge] || adjacency_.opposite[half_edge] == no_index;
  }

  /// @param outgoing  any half edge of the fan from its vertex.
  void fan(index_t outgoing, TriangleFan& fan) const {
    fan.outgoing.clear();
    index_t first = outgoing;
    while (!is_wall(first)) {  // clockwise to the first triangle
      first = TriangleAdjacency::next(adjacency_.opposite[first]);
      if (first == outgoing) break;
    }
    fan.closed = !is_wall(first);
    for (index_t h = first;;) {
      fan.outgoing.push_back(h);
      const index_t in = TriangleAdjacency::previous(h);
      if (is_wall(in)) break;
      h = adjacency_.opposite[in];
      if (h == first) break;
    }
  }

private:
  const TriangleAdjacency& adjacency_;
  const FeatureGraph& features_;
};

}  // namespace framehex::detail
