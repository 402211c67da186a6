// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/executor.hpp"
#include "framehex/recombination/candidates.hpp"
#include "framehex/selection/candidate_weights.hpp"
#include "framehex/selection/incompatibility_graph.hpp"

#include <limits>

namespace framehex {

namespace detail {

/// The 24 pairs of corners that decide whether two hexahedra fit: 12 edges, then 12 face diagonals, those of one face
/// in consecutive places.
inline constexpr std::size_t n_pairs = 24;
inline constexpr std::size_t n_edge_pairs = 12;

inline constexpr std::array<cell_tables::LocalEdge, n_pairs> hexahedron_pairs = [] {
  std::array<cell_tables::LocalEdge, n_pairs> pairs{};
  std::size_t n = 0;
  for (const auto& edge : cell_tables::hexahedron_edges) pairs[n++] = edge;
  for (const auto& face : cell_tables::hexahedron_faces) {
    pairs[n++] = {face.corners[0], face.corners[2]};
    pairs[n++] = {face.corners[1], face.corners[3]};
  }
  return pairs;
}();

/// The other diagonal of the face of a diagonal.
constexpr std::size_t other_diagonal(std::size_t pair) {
  return n_edge_pairs + ((pair - n_edge_pairs) ^ 1U);
}

/// Who uses each pair of vertices, and how. A slot is 24 x candidate + place in `hexahedron_pairs`.
struct PairIndex {
  std::vector<index_t> group_of_slot;   ///< number of the pair of vertices of each slot
  std::vector<index_t> slots;           ///< by group: the slots that are edges, then those that are diagonals
  std::vector<index_t> first_slot;      ///< n_groups + 1
  std::vector<index_t> first_diagonal;  ///< n_groups

  std::vector<index_t> partners;  ///< by place in `slots`, for diagonals: group of the other diagonal of the face

  std::span<const index_t> edges(index_t group) const {
    return {slots.data() + first_slot[group], slots.data() + first_diagonal[group]};
  }
  std::span<const index_t> diagonals(index_t group) const {
    return {slots.data() + first_diagonal[group], slots.data() + first_slot[group + 1]};
  }
  std::span<const index_t> partners_of(index_t group) const {
    return {partners.data() + first_diagonal[group], partners.data() + first_slot[group + 1]};
  }
};

inline std::pair<index_t, index_t> pair_of_slot(const PotentialHexahedra& candidates, std::size_t slot) {
  const auto& corners = candidates.vertices[slot / n_pairs];
  const auto& local = hexahedron_pairs[slot % n_pairs];
  return std::minmax(corners[static_cast<std::size_t>(local[0])], corners[static_cast<std::size_t>(local[1])]);
}

/// Slots are gathered at the smaller vertex, then sorted by the larger: no hashing, local memory, 8 bytes a slot.
inline PairIndex make_pair_index(const PotentialHexahedra& candidates, std::size_t n_vertices) {
  const std::size_t n_slots = n_pairs * candidates.size();
  std::vector<offset_t> begin(n_vertices + 1, 0);
  for (std::size_t slot = 0; slot < n_slots; ++slot) ++begin[pair_of_slot(candidates, slot).first + 1];
  for (std::size_t v = 0; v < n_vertices; ++v) begin[v + 1] += begin[v];
  PairIndex index;
  index.slots.resize(n_slots);
  {
    std::vector<offset_t> next(begin.begin(), begin.end() - 1);
    for (std::size_t slot = 0; slot < n_slots; ++slot)
      index.slots[next[pair_of_slot(candidates, slot).first]++] = static_cast<index_t>(slot);
  }
  index.group_of_slot.resize(n_slots);
  struct Entry {
    std::uint64_t key;
    index_t slot;
  };
  std::vector<Entry> entries;
  for (std::size_t v = 0; v < n_vertices; ++v) {
    entries.clear();
    for (offset_t i = begin[v]; i < begin[v + 1]; ++i) {
      const index_t slot = index.slots[i];
      const std::uint64_t other = pair_of_slot(candidates, slot).second;
      entries.push_back({2 * other + (slot % n_pairs >= n_edge_pairs ? 1 : 0), slot});
    }
    std::sort(entries.begin(), entries.end(),
              [](const Entry& x, const Entry& y) { return x.key != y.key ? x.key < y.key : x.slot < y.slot; });
    for (std::size_t i = 0; i < entries.size(); ++i) {
      const auto position = static_cast<index_t>(begin[v] + i);
      if (i == 0 || entries[i].key / 2 != entries[i - 1].key / 2) {
        // A group without diagonals ends where the next begins, so its first diagonal is set when it is closed.
        if (index.first_diagonal.size() < index.first_slot.size()) index.first_diagonal.push_back(position);
        index.first_slot.push_back(position);
      }
      if (entries[i].key % 2 == 1 && index.first_diagonal.size() < index.first_slot.size())
        index.first_diagonal.push_back(position);
      index.slots[position] = entries[i].slot;
      index.group_of_slot[entries[i].slot] = static_cast<index_t>(index.first_slot.size() - 1);
    }
  }
  if (index.first_diagonal.size() < index.first_slot.size())
    index.first_diagonal.push_back(static_cast<index_t>(n_slots));
  index.first_slot.push_back(static_cast<index_t>(n_slots));
  index.partners.resize(n_slots, no_index);
  for (std::size_t place = 0; place < n_slots; ++place) {
    const std::size_t candidate = index.slots[place] / n_pairs, pair = index.slots[place] % n_pairs;
    if (pair >= n_edge_pairs) index.partners[place] = index.group_of_slot[n_pairs * candidate + other_diagonal(pair)];
  }
  return index;
}

/// Calls `found(j)` for everyone in conflict with candidate i, some more than once.
template <class Found>
void for_each_conflict(const PotentialHexahedra& candidates, const Csr<index_t>& candidates_of_tet,
                       const PairIndex& index, std::size_t i, Found&& found) {
  for (const index_t tet : candidates.tets[i])
    for (const index_t j : candidates_of_tet[tet]) found(j);
  const index_t* const groups = index.group_of_slot.data() + n_pairs * i;
  for (std::size_t pair = 0; pair < n_edge_pairs; ++pair)
    for (const index_t slot : index.diagonals(groups[pair])) found(slot / static_cast<index_t>(n_pairs));
  for (std::size_t pair = n_edge_pairs; pair < n_pairs; ++pair) {
    for (const index_t slot : index.edges(groups[pair])) found(slot / static_cast<index_t>(n_pairs));
    // Two quadrilaterals with one diagonal in common are the same exactly when they have the other in common, too.
    const auto slots = index.diagonals(groups[pair]);
    const auto partners = index.partners_of(groups[pair]);
    for (std::size_t k = 0; k < slots.size(); ++k)
      if (partners[k] != groups[other_diagonal(pair)]) found(slots[k] / static_cast<index_t>(n_pairs));
  }
}

/// The rows of the graph in blocks of candidates, and the length of each. The indices needed on the way end here.
template <Executor E>
std::pair<std::vector<offset_t>, std::vector<std::vector<index_t>>> find_conflict_rows(
    const PotentialHexahedra& candidates, std::size_t n_vertices, std::size_t n_tets, const E& executor) {
  const std::size_t n = candidates.size();
  const PairIndex index = make_pair_index(candidates, n_vertices);
  const Csr<index_t> candidates_of_tet = make_csr(n_tets, [&](auto&& put) {
    for (std::size_t i = 0; i < n; ++i)
      for (const index_t tet : candidates.tets[i]) put(tet, static_cast<index_t>(i));
  });
  constexpr std::size_t candidates_per_block = 2048;
  const std::size_t n_blocks = (n + candidates_per_block - 1) / candidates_per_block;
  std::vector<std::vector<index_t>> block_values(n_blocks);
  std::vector<offset_t> lengths(n + 1, 0);
  std::vector<std::vector<index_t>> seen(executor.workers());
  executor(n_blocks, [&](std::size_t block, std::size_t worker) {
    auto& last_seen = seen[worker];
    last_seen.resize(n, no_index);
    std::vector<index_t> values;
    for (std::size_t i = block * candidates_per_block; i < std::min(n, (block + 1) * candidates_per_block); ++i) {
      const std::size_t first = values.size();
      last_seen[i] = static_cast<index_t>(i);
      for_each_conflict(candidates, candidates_of_tet, index, i, [&](index_t j) {
        if (last_seen[j] == i) return;
        last_seen[j] = static_cast<index_t>(i);
        values.push_back(j);
      });
      std::sort(values.begin() + static_cast<std::ptrdiff_t>(first), values.end());
      lengths[i + 1] = values.size() - first;
    }
    block_values[block].assign(values.begin(), values.end());
  });
  return {std::move(lengths), std::move(block_values)};
}

/// Number of vertices and tetrahedra named, after checking that no candidate names a vertex twice.
inline std::array<std::size_t, 2> check_candidates(const PotentialHexahedra& candidates) {
  const std::size_t n = candidates.size();
  if (n > std::numeric_limits<index_t>::max() / n_pairs)
    throw invalid_graph("more than " + std::to_string(std::numeric_limits<index_t>::max() / n_pairs) + " candidates");
  if (candidates.tets.size() != n)
    throw invalid_graph("there are " + std::to_string(n) + " candidates, but tetrahedra of " +
                        std::to_string(candidates.tets.size()));
  std::size_t n_vertices = 0;
  for (std::size_t i = 0; i < n; ++i) {
    auto corners = candidates.vertices[i];
    std::sort(corners.begin(), corners.end());
    if (std::adjacent_find(corners.begin(), corners.end()) != corners.end())
      throw invalid_connectivity("candidate " + std::to_string(i) + " names a vertex twice", Entity::candidate, {i});
    n_vertices = std::max<std::size_t>(n_vertices, std::size_t{corners.back()} + 1);
  }
  std::size_t n_tets = 0;
  for (const index_t tet : candidates.tets.values) n_tets = std::max<std::size_t>(n_tets, std::size_t{tet} + 1);
  return {n_vertices, n_tets};
}

}  // namespace detail

/// Finds which potential hexahedra exclude one another.
///
/// Two are in conflict when they share a tetrahedron (face slivers do not count), or when a pair of vertices that is a
/// face diagonal of one is an edge, or the diagonal of a different quadrilateral, of the other. The second rule says in
/// one what a conforming mesh needs in several: no edge of one cell is a face diagonal of the other, no three corners
/// of a face are shared without the fourth, no two faces have the same corners in another cyclic order.
///
/// @param candidates  n potential hexahedra.
/// @param weight      `double weight(index_t candidate)`, finite, >= 0; see selection/candidate_weights.hpp.
/// @param executor    runs blocks of candidates.
/// @throws invalid_weight        with the candidate.
/// @throws invalid_connectivity  with the candidate, when it names a vertex twice.
/// @par Complexity   O(n + conflicts) for bounded valence; 8 bytes a conflict to stay, 200 bytes a candidate on the
/// way.
/// @par Determinism  Does not depend on the executor.
/// @par Source       Paper, section 2; the rule of pairs is ours.
template <class Weight, Executor E = SerialExecutor>
IncompatibilityGraph build_incompatibility_graph(const PotentialHexahedra& candidates, Weight&& weight,
                                                 const E& executor = {}) {
  const std::size_t n = candidates.size();
  const auto [n_vertices, n_tets] = detail::check_candidates(candidates);
  std::vector<double> weights(n);
  for (std::size_t i = 0; i < n; ++i) weights[i] = static_cast<double>(weight(static_cast<index_t>(i)));
  auto quantised = detail::quantise(weights);
  std::vector<double>().swap(weights);

  auto [offsets, block_values] = detail::find_conflict_rows(candidates, n_vertices, n_tets, executor);
  Csr<index_t> rows;
  for (std::size_t i = 0; i < n; ++i) offsets[i + 1] += offsets[i];
  rows.offsets = std::move(offsets);
  rows.values.reserve(rows.offsets.back());
  for (auto& values : block_values) {
    rows.values.insert(rows.values.end(), values.begin(), values.end());
    std::vector<index_t>().swap(values);
  }
  return detail::GraphAccess::unchecked(std::move(rows), std::move(quantised));
}

/// The same with the default weight, volume times quality.
inline IncompatibilityGraph build_incompatibility_graph(const PotentialHexahedra& candidates) {
  return build_incompatibility_graph(candidates, volume_times_quality(candidates));
}

}  // namespace framehex
