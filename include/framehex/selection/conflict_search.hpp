// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/executor.hpp"
#include "framehex/recombination/candidates.hpp"
#include "framehex/selection/candidate_weights.hpp"
#include "framehex/selection/detail/candidate_checks.hpp"
#include "framehex/selection/detail/vertex_pairs.hpp"
#include "framehex/selection/incompatibility_graph.hpp"

#include <limits>

namespace framehex {

namespace detail {

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

inline VertexPair pair_of_slot(const PotentialHexahedra& candidates, std::size_t slot) {
  return pair_at(candidates.vertices[slot / n_pairs], slot % n_pairs);
}

/// Slots by the smaller vertex of their pairs, then by the larger, edges before diagonals.
template <Executor E>
std::vector<index_t> sort_slots(const PotentialHexahedra& candidates, std::size_t n_vertices, const E& executor) {
  Csr<index_t> rows = make_csr(n_vertices, [&](auto&& put) {
    for (std::size_t slot = 0; slot < n_pairs * candidates.size(); ++slot)
      put(pair_of_slot(candidates, slot).first, static_cast<index_t>(slot));
  });
  for_blocks(executor, n_vertices, 256, [&](std::size_t first, std::size_t last) {
    struct Entry {
      std::uint64_t key;
      index_t slot;
    };
    std::vector<Entry> entries;
    for (std::size_t v = first; v < last; ++v) {
      entries.clear();
      for (const index_t slot : rows[v]) {
        const std::uint64_t other = pair_of_slot(candidates, slot).second;
        entries.push_back({2 * other + (slot % n_pairs >= n_edge_pairs ? 1 : 0), slot});
      }
      std::sort(entries.begin(), entries.end(),
                [](const Entry& x, const Entry& y) { return x.key != y.key ? x.key < y.key : x.slot < y.slot; });
      for (std::size_t i = 0; i < entries.size(); ++i) rows[v][i] = entries[i].slot;
    }
  });
  return std::move(rows.values);
}

template <Executor E>
PairIndex make_pair_index(const PotentialHexahedra& candidates, std::size_t n_vertices, const E& executor) {
  PairIndex index;
  index.slots = sort_slots(candidates, n_vertices, executor);
  const std::size_t n_slots = index.slots.size();
  index.group_of_slot.resize(n_slots);
  VertexPair last{no_index, no_index};
  for (std::size_t place = 0; place < n_slots; ++place) {
    const index_t slot = index.slots[place];
    const VertexPair pair = pair_of_slot(candidates, slot);
    const bool is_diagonal = slot % n_pairs >= n_edge_pairs;
    const bool in_new_group = std::exchange(last, pair) != pair;
    // A group without diagonals ends where the next begins.
    if ((in_new_group || is_diagonal) && index.first_diagonal.size() < index.first_slot.size())
      index.first_diagonal.push_back(static_cast<index_t>(place));
    if (in_new_group) {
      index.first_slot.push_back(static_cast<index_t>(place));
      if (is_diagonal) index.first_diagonal.push_back(static_cast<index_t>(place));
    }
    index.group_of_slot[slot] = static_cast<index_t>(index.first_slot.size() - 1);
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

/// The rows of the graph in blocks of candidates. The indices needed on the way end here.
/// @param lengths  n + 1 zeros; entry i + 1 becomes the length of row i.
template <Executor E>
std::vector<std::vector<index_t>> find_conflict_rows(const PotentialHexahedra& candidates, std::size_t n_vertices,
                                                     std::size_t n_tets, const E& executor,
                                                     std::vector<offset_t>& lengths) {
  const std::size_t n = candidates.size();
  const PairIndex index = make_pair_index(candidates, n_vertices, executor);
  const Csr<index_t> candidates_of_tet = make_csr(n_tets, [&](auto&& put) {
    for (std::size_t i = 0; i < n; ++i)
      for (const index_t tet : candidates.tets[i]) put(tet, static_cast<index_t>(i));
  });
  constexpr std::size_t candidates_per_block = 1024;
  const std::size_t n_blocks = (n + candidates_per_block - 1) / candidates_per_block;
  std::vector<std::vector<index_t>> block_values(n_blocks);
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
  return block_values;
}

/// A row of conflicts for each candidate, ascending.
template <Executor E>
Csr<index_t> find_conflicts(const PotentialHexahedra& candidates, std::size_t n_vertices, std::size_t n_tets,
                            const E& executor) {
  Csr<index_t> rows;
  rows.offsets.assign(candidates.size() + 1, 0);
  auto block_values = find_conflict_rows(candidates, n_vertices, n_tets, executor, rows.offsets);
  for (std::size_t i = 0; i < candidates.size(); ++i) rows.offsets[i + 1] += rows.offsets[i];
  rows.values.reserve(rows.offsets.back());
  for (auto& values : block_values) {
    rows.values.insert(rows.values.end(), values.begin(), values.end());
    std::vector<index_t>().swap(values);
  }
  return rows;
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
  if (n > std::numeric_limits<index_t>::max() / detail::n_pairs)
    throw invalid_graph("more than " + std::to_string(std::numeric_limits<index_t>::max() / detail::n_pairs) +
                        " candidates; ImplicitIncompatibilityGraph has no such limit");
  const auto [n_vertices, n_tets] = detail::check_candidates(candidates);
  auto quantised = detail::quantise(detail::list_weights(n, weight));
  return detail::GraphAccess::unchecked(detail::find_conflicts(candidates, n_vertices, n_tets, executor),
                                        std::move(quantised));
}

/// The same with the default weight, volume times quality.
inline IncompatibilityGraph build_incompatibility_graph(const PotentialHexahedra& candidates) {
  return build_incompatibility_graph(candidates, volume_times_quality(candidates));
}

}  // namespace framehex
