// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/selection/conflict_source.hpp"

#include <array>
#include <vector>

namespace framehex::verify {

/// What is wrong with a set of candidates.
struct IndependenceReport {
  std::vector<std::size_t> invalid;               ///< out of range, or named a second time
  std::vector<std::array<index_t, 2>> conflicts;  ///< pairs of members that exclude one another, smaller first
  std::vector<index_t> addable;                   ///< not members, in conflict with no member

  bool independent() const { return invalid.empty() && conflicts.empty(); }
  bool maximal() const { return independent() && addable.empty(); }
};

/// Checks that the members of a selection can stand together, and that none can be added.
///
/// @param members  candidates in any order.
/// @par Complexity  O(n + conflicts of the members).
template <ConflictSource G>
IndependenceReport check_independence(const G& graph, std::span<const index_t> members) {
  IndependenceReport report;
  std::vector<std::uint8_t> member(graph.size(), 0), blocked(graph.size(), 0);
  for (const index_t v : members) {
    if (v >= graph.size() || member[v])
      report.invalid.push_back(v);
    else
      member[v] = 1;
  }
  for (index_t v = 0; v < graph.size(); ++v) {
    if (!member[v]) continue;
    graph.for_each_conflict(v, [&](index_t u) {
      blocked[u] = 1;
      if (member[u] && v < u) report.conflicts.push_back({v, u});
    });
  }
  for (index_t v = 0; v < graph.size(); ++v)
    if (!member[v] && !blocked[v]) report.addable.push_back(v);
  return report;
}

/// Are all members in range, different and free of conflicts?
template <ConflictSource G>
bool is_independent(const G& graph, std::span<const index_t> members) {
  return check_independence(graph, members).independent();
}

/// Is the set independent, and can no candidate be added? (*Maximal*, which says nothing about *maximum*.)
template <ConflictSource G>
bool is_maximal(const G& graph, std::span<const index_t> members) {
  return check_independence(graph, members).maximal();
}

}  // namespace framehex::verify
