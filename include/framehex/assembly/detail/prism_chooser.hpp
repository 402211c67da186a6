// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/assembly/detail/complex_builder.hpp"
#include "framehex/recombination/potential_prism_finder.hpp"

#include <numeric>

namespace framehex::detail {

/// Potential prisms among the tetrahedra that no chosen cell uses.
template <TetMesh M>
PotentialPrisms find_free_prisms(const M& mesh, const TetAdjacency& adjacency, const ComplexBuilder& builder,
                                 const AssemblyOptions& options) {
  std::vector<std::uint8_t> free(adjacency.tets.size());
  for (std::size_t tet = 0; tet < free.size(); ++tet) free[tet] = builder.is_free(static_cast<index_t>(tet)) ? 1 : 0;
  std::vector<std::array<index_t, 2>> feature_edges;
  for (const LabelledEdge& edge : options.edges) feature_edges.push_back(edge.vertices);
  return find_potential_prisms(mesh, {.quality_floor = options.prism_quality_floor,
                                      .regions = options.regions,
                                      .feature_edges = feature_edges,
                                      .free_tets = free,
                                      .input_check = InputCheck::skip,
                                      .adjacency = &adjacency});
}

/// Adds prisms, heaviest (volume times quality) first; in several rounds, because a prism beside another one finds a
/// quadrilateral matched.
/// @param max_opened  how many of the three quadrilaterals of a prism may face tetrahedra.
inline void choose_prisms(ComplexBuilder& builder, const PotentialPrisms& prisms, int max_opened) {
  std::vector<index_t> order(prisms.size());
  std::iota(order.begin(), order.end(), index_t{0});
  const auto weight = [&](index_t i) { return prisms.volume[i] * static_cast<double>(prisms.quality[i]); };
  std::stable_sort(order.begin(), order.end(), [&](index_t x, index_t y) { return weight(x) > weight(y); });
  for (int allowed = 0; allowed <= max_opened; ++allowed)
    for (bool added = true; added;) {
      added = false;
      std::vector<index_t> later;
      for (const index_t i : order) {
        if (builder.check(CellKind::prism, prisms.vertices[i], prisms.tets[i]).reason) continue;  // it never will fit
        if (builder.last_fit().n_opened > allowed) {
          later.push_back(i);
          continue;
        }
        builder.add(CellKind::prism, prisms.vertices[i], prisms.tets[i], i);
        added = true;
      }
      order = std::move(later);
    }
}

}  // namespace framehex::detail
