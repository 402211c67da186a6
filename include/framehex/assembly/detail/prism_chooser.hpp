// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/assembly/detail/complex_builder.hpp"
#include "framehex/mesh/indexed_mesh.hpp"
#include "framehex/recombination/potential_prism_finder.hpp"

#include <numeric>

namespace framehex::detail {

/// Potential prisms among the tetrahedra that no chosen cell uses.
///
/// They are searched in a mesh of those alone. What that mesh has for a boundary is where a quadrilateral has to match
/// or to meet the true boundary with both triangles; `ComplexBuilder` refuses the others anyway.
inline PotentialPrisms find_free_prisms(const ComplexBuilder& builder, const TetAdjacency& adjacency,
                                        const AssemblyOptions& options, PrismFinderOptions finder) {
  IndexedTetMesh rest;
  std::vector<index_t> tet_of, vertex_of, regions, number(adjacency.n_vertices(), no_index);
  for (index_t tet = 0; tet < adjacency.tets.size(); ++tet)
    if (builder.is_free(tet)) {
      tet_of.push_back(tet);
      if (!options.regions.empty()) regions.push_back(options.regions[tet]);
      for (const index_t v : adjacency.tets[tet]) number[v] = 0;
    }
  for (index_t v = 0; v < number.size(); ++v)
    if (number[v] != no_index) {
      number[v] = static_cast<index_t>(vertex_of.size());
      vertex_of.push_back(v);
      rest.points.push_back(builder.complex.points[v]);
    }
  for (const index_t tet : tet_of) {
    auto& corners = rest.tets.emplace_back(adjacency.tets[tet]);
    for (index_t& v : corners) v = number[v];
  }
  std::vector<std::array<index_t, 2>> edges;
  for (const LabelledEdge& edge : options.edges) {
    const std::array<index_t, 2> ends{number[edge.vertices[0]], number[edge.vertices[1]]};
    if (ends[0] != no_index && ends[1] != no_index) edges.push_back(ends);
  }
  const TetAdjacency rest_adjacency = make_adjacency(rest);
  finder.regions = regions;
  finder.feature_edges = edges;
  finder.adjacency = &rest_adjacency;
  finder.input_check = InputCheck::skip;
  PotentialPrisms prisms = find_potential_prisms(rest, finder);
  for (auto& corners : prisms.vertices)
    for (index_t& v : corners) v = vertex_of[v];
  for (auto* lists : {&prisms.tets, &prisms.face_slivers})
    for (index_t& tet : lists->values) tet = tet_of[tet];
  return prisms;
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
