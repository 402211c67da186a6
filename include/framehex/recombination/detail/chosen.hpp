// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/recombination/candidates.hpp"

#include <span>
#include <utility>

namespace framehex::detail {

/// Some candidates on their own, in the order given.
inline PotentialHexahedra chosen(const PotentialHexahedra& candidates, std::span<const index_t> members) {
  PotentialHexahedra result;
  for (const index_t v : members) {
    result.vertices.push_back(candidates.vertices[v]);
    result.quality.push_back(candidates.quality[v]);
    result.volume.push_back(candidates.volume[v]);
    for (const auto& [from, to] :
         {std::pair(&candidates.tets, &result.tets), std::pair(&candidates.face_slivers, &result.face_slivers)}) {
      const auto row = (*from)[v];
      to->values.insert(to->values.end(), row.begin(), row.end());
      to->end_row();
    }
  }
  return result;
}

}  // namespace framehex::detail
