// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/assembly/detail/complex_builder.hpp"
#include "framehex/mesh/indexed_mesh.hpp"
#include "framehex/recombination/potential_prism_finder.hpp"

#include <functional>
#include <numeric>
#include <queue>

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
/// quadrilateral matched. A round that adds none is the last.
/// @param max_opened  how many of the three quadrilaterals of a prism may face tetrahedra.
inline void choose_prisms(ComplexBuilder& builder, const PotentialPrisms& prisms, int max_opened) {
  const std::size_t n = prisms.size();
  std::vector<index_t> order(n);
  std::iota(order.begin(), order.end(), index_t{0});
  const auto weight = [&](index_t i) { return prisms.volume[i] * static_cast<double>(prisms.quality[i]); };
  std::stable_sort(order.begin(), order.end(), [&](index_t x, index_t y) { return weight(x) > weight(y); });
  const Csr<index_t> ranks_at_vertex = make_csr(builder.complex.points.size(), [&](auto&& put) {
    for (index_t rank = 0; rank < n; ++rank)
      for (const index_t v : prisms.vertices[order[rank]]) put(v, rank);
  });

  // (round, rank): a prism is looked at again, in this round or the next, only when one that touches it has come. Each
  // comes once, so this ends.
  using Turn = std::pair<std::size_t, index_t>;
  std::priority_queue<Turn, std::vector<Turn>, std::greater<>> queue;
  std::vector<std::uint8_t> waits(n, 0), gone(n, 0);
  const auto look_at = [&](std::size_t round, index_t rank) {
    if (waits[rank] || gone[rank]) return;
    waits[rank] = 1;
    queue.emplace(round, rank);
  };
  for (int allowed = 0; allowed <= max_opened; ++allowed) {
    for (index_t rank = 0; rank < n; ++rank) look_at(0, rank);
    while (!queue.empty()) {
      const auto [round, rank] = queue.top();
      queue.pop();
      waits[rank] = 0;
      const index_t i = order[rank];
      gone[rank] = builder.check(CellKind::prism, prisms.vertices[i], prisms.tets[i]).reason ? 1 : 0;  // for good
      if (gone[rank] || builder.last_fit().n_opened > allowed) continue;
      builder.add(CellKind::prism, prisms.vertices[i], prisms.tets[i], i);
      gone[rank] = 1;
      for (const index_t v : prisms.vertices[i])
        for (const index_t other : ranks_at_vertex[v]) look_at(other > rank ? round : round + 1, other);
    }
  }
}

}  // namespace framehex::detail
