// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/parts/detail/tet_patch.hpp"
#include "framehex/recombination/potential_hex_finder.hpp"

namespace framehex::detail {

/// Layers round a rank's tetrahedra that hold all tetrahedra at the corners of its candidates: those begin at a vertex of
/// one of them, and lead three edges away.
inline constexpr int n_halo_layers = 4;

/// The vertices from which a rank searches: those whose first leaf it holds.
inline std::vector<index_t> own_vertices(const TetPatch& patch, const std::array<index_t, 2>& leaves) {
  std::vector<index_t> own;
  for (index_t v = 0; v < patch.leaf_of_vertex.size(); ++v)
    if (patch.leaf_of_vertex[v] >= leaves[0] && patch.leaf_of_vertex[v] < leaves[1]) own.push_back(v);
  return own;
}

/// The candidates whose first corner, by coordinates, is one of some vertices; in the order of these.
template <Executor E>
PotentialHexahedra find_candidates_at(const TetPatch& patch, std::span<const index_t> vertices, FinderOptions options,
                                      const E& executor) {
  options.adjacency = &patch.adjacency;
  options.input_check = InputCheck::skip;
  options.regions = patch.regions;
  options.facet_patches = {};
  options.feature_edges = {};
  options.free_tets = {};
  const PotentialHexFinder<IndexedTetMesh> finder(patch.mesh, options);
  constexpr std::size_t vertices_a_block = 64, blocks_at_once = 256;
  PotentialHexahedra all;
  const std::size_t n_blocks = (vertices.size() + vertices_a_block - 1) / vertices_a_block;
  for (std::size_t first = 0; first < n_blocks; first += blocks_at_once) {
    std::vector<PotentialHexahedra> found(std::min(blocks_at_once, n_blocks - first));
    executor(found.size(), [&](std::size_t block, std::size_t) {
      const std::size_t begin = (first + block) * vertices_a_block;
      for (const index_t v : vertices.subspan(begin, std::min(vertices_a_block, vertices.size() - begin)))
        append(found[block], finder.find_at(v));
    });
    for (PotentialHexahedra& some : found) {
      append(all, some);
      some = {};
    }
    // Later ones are about as many, so that the result need not move; what is not needed is never touched.
    if (first == 0 && n_blocks > blocks_at_once) {
      const double scale = 1.3 * static_cast<double>(n_blocks) / static_cast<double>(blocks_at_once);
      const auto scaled = [scale](std::size_t n) { return static_cast<std::size_t>(scale * static_cast<double>(n)); };
      reserve(all, scaled(all.size()), scaled(all.tets.values.size()), scaled(all.face_slivers.values.size()));
    }
  }
  return all;
}

}  // namespace framehex::detail
