// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/recombination/candidates.hpp"

#include <algorithm>
#include <random>
#include <set>

namespace framehex::test {

/// Hexahedra of random vertices and tetrahedra: far more ways to clash than any mesh has.
inline PotentialHexahedra random_candidates(std::uint64_t seed, index_t n, index_t n_vertices, index_t n_tets) {
  std::mt19937_64 engine(seed);
  PotentialHexahedra candidates;
  std::vector<index_t> all(n_vertices);
  for (index_t v = 0; v < n_vertices; ++v) all[v] = v;
  for (index_t i = 0; i < n; ++i) {
    for (index_t k = 0; k < 8; ++k) std::swap(all[k], all[k + engine() % (n_vertices - k)]);
    std::array<index_t, 8> corners{};
    std::copy_n(all.begin(), 8, corners.begin());
    candidates.vertices.push_back(corners);
    std::set<index_t> tets;
    while (tets.size() < 2) tets.insert(static_cast<index_t>(engine() % n_tets));
    candidates.tets.values.insert(candidates.tets.values.end(), tets.begin(), tets.end());
    candidates.tets.end_row();
    candidates.face_slivers.end_row();
    candidates.quality.push_back(static_cast<float>(engine() % 1000) / 1000.0F);
    candidates.volume.push_back(1.0);
  }
  return candidates;
}

}  // namespace framehex::test
