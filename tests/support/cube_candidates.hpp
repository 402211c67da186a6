// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/recombination/candidates.hpp"
#include "support/kuhn_lattice.hpp"

namespace framehex::test {

/// The cubes of `kuhn_lattice(n)` as candidates: cube (i, j, k) is candidate i + n (j + n k), of six tetrahedra.
inline PotentialHexahedra cube_candidates(index_t n) {
  PotentialHexahedra c;
  const auto v = [n](index_t i, index_t j, index_t k) { return i + (n + 1) * (j + (n + 1) * k); };
  for (index_t k = 0; k < n; ++k)
    for (index_t j = 0; j < n; ++j)
      for (index_t i = 0; i < n; ++i) {
        c.vertices.push_back({v(i, j, k), v(i + 1, j, k), v(i + 1, j + 1, k), v(i, j + 1, k), v(i, j, k + 1),
                              v(i + 1, j, k + 1), v(i + 1, j + 1, k + 1), v(i, j + 1, k + 1)});
        const auto id = static_cast<index_t>(c.size() - 1);
        for (index_t t = 6 * id; t < 6 * id + 6; ++t) c.tets.values.push_back(t);
        c.tets.end_row();
        c.face_slivers.end_row();
        c.quality.push_back(1);
        c.volume.push_back(1);
      }
  return c;
}

}  // namespace framehex::test
