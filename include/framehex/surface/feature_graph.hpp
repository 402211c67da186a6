// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/mesh/csr.hpp"

#include <cstdint>
#include <vector>

namespace framehex {

/// Corners, curves and patches of a triangulated surface.
struct FeatureGraph {
  std::vector<index_t> corners;         ///< vertices, ascending
  Csr<index_t> curves;                  ///< vertices along each curve; a closed curve repeats its first vertex
  std::vector<index_t> triangle_patch;  ///< n_triangles labels, 0 to n_patches-1
  index_t n_patches = 0;
  std::vector<std::uint8_t> is_feature;  ///< 3 n_triangles half edges (see TriangleAdjacency): 1 on a feature edge
};

}  // namespace framehex
