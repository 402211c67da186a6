// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/distributed/concepts.hpp"

#include <algorithm>
#include <functional>
#include <random>

namespace framehex::test {

using distributed::IndexedPart;

/// This rank's part of a mesh that all ranks have; a vertex belongs to the least rank that has it, or to the first one.
inline IndexedPart part_of(const IndexedTetMesh& mesh, const std::vector<int>& rank_of_cell, int rank) {
  std::vector<int> owner(mesh.points.size(), -1);
  for (std::size_t c = 0; c < mesh.tets.size(); ++c)
    for (const index_t v : mesh.tets[c])
      if (owner[v] < 0 || rank_of_cell[c] < owner[v]) owner[v] = rank_of_cell[c];
  std::vector<char> is_here(mesh.points.size(), 0);
  for (std::size_t c = 0; c < mesh.tets.size(); ++c)
    if (rank_of_cell[c] == rank)
      for (const index_t v : mesh.tets[c]) is_here[v] = 1;
  for (std::size_t v = 0; v < owner.size(); ++v)
    if (owner[v] < 0) {
      owner[v] = 0;
      is_here[v] = rank == 0;
    }
  // The order on a rank is its own affair.
  std::mt19937 engine(static_cast<unsigned>(rank));
  IndexedPart part;
  for (std::size_t v = 0; v < owner.size(); ++v)
    if (is_here[v]) part.vertex_ids.push_back(static_cast<std::int64_t>(v));
  std::shuffle(part.vertex_ids.begin(), part.vertex_ids.end(), engine);
  std::vector<index_t> number(owner.size(), no_index);
  for (index_t i = 0; i < part.vertex_ids.size(); ++i) {
    const auto v = static_cast<std::size_t>(part.vertex_ids[i]);
    number[v] = i;
    part.mesh.points.push_back(mesh.points[v]);
    part.owners.push_back(owner[v]);
  }
  for (std::size_t c = 0; c < mesh.tets.size(); ++c)
    if (rank_of_cell[c] == rank) part.cell_ids.push_back(static_cast<std::int64_t>(c));
  std::shuffle(part.cell_ids.begin(), part.cell_ids.end(), engine);
  for (const std::int64_t c : part.cell_ids) {
    auto& tet = part.mesh.tets.emplace_back(mesh.tets[static_cast<std::size_t>(c)]);
    for (index_t& v : tet) v = number[v];
  }
  return part;
}

/// Ways to deal out cells, by the rank of each.
struct Dealing {
  const char* name;
  std::function<int(const IndexedTetMesh&, std::size_t, int)> rank;  ///< of a cell, for so many ranks

  std::vector<int> ranks(const IndexedTetMesh& mesh, int n_ranks) const {
    std::vector<int> result;
    for (std::size_t c = 0; c < mesh.tets.size(); ++c) result.push_back(rank(mesh, c, n_ranks));
    return result;
  }
};

inline std::vector<Dealing> dealings() {
  return {
      {"slabs by number", [](const IndexedTetMesh& mesh, std::size_t c,
                             int n) { return static_cast<int>(c * static_cast<std::size_t>(n) / mesh.tets.size()); }},
      {"one after the other: parts that touch in edges and vertices",
       [](const IndexedTetMesh&, std::size_t c, int n) { return static_cast<int>(c % static_cast<std::size_t>(n)); }},
      {"all on the last rank", [](const IndexedTetMesh&, std::size_t, int n) { return n - 1; }},
      {"one cell on the first rank, the others on the second, none elsewhere",
       [](const IndexedTetMesh&, std::size_t c, int n) { return c == 7 || n == 1 ? 0 : 1; }}};
}

}  // namespace framehex::test
