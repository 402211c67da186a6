// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/errors.hpp"
#include "framehex/recombination/candidates.hpp"

#include <algorithm>
#include <string>

namespace framehex::detail {

/// Vertices and tetrahedra named by candidates are numbered below these.
struct CandidateExtent {
  std::size_t n_vertices = 0, n_tets = 0;
};

/// @throws invalid_connectivity  with the candidate that names a vertex twice.
inline CandidateExtent check_candidates(const PotentialHexahedra& candidates) {
  const std::size_t n = candidates.size();
  if (candidates.tets.size() != n)
    throw invalid_graph("there are " + std::to_string(n) + " candidates, but tetrahedra of " +
                        std::to_string(candidates.tets.size()));
  CandidateExtent extent;
  for (std::size_t i = 0; i < n; ++i) {
    auto corners = candidates.vertices[i];
    std::sort(corners.begin(), corners.end());
    if (std::adjacent_find(corners.begin(), corners.end()) != corners.end())
      throw invalid_connectivity("candidate " + std::to_string(i) + " names a vertex twice", Entity::candidate, {i});
    extent.n_vertices = std::max<std::size_t>(extent.n_vertices, std::size_t{corners.back()} + 1);
  }
  for (const index_t tet : candidates.tets.values)
    extent.n_tets = std::max<std::size_t>(extent.n_tets, std::size_t{tet} + 1);
  return extent;
}

template <class Weight>
std::vector<double> list_weights(std::size_t n, Weight&& weight) {
  std::vector<double> weights(n);
  for (std::size_t i = 0; i < n; ++i) weights[i] = static_cast<double>(weight(static_cast<index_t>(i)));
  return weights;
}

}  // namespace framehex::detail
