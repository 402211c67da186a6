// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/selection/detail/scramble.hpp"
#include "framehex/selection/implicit_graph.hpp"

namespace framehex::detail {

/// An independent set that grows, and whom it blocks: its members, and those in conflict with one.
template <ConflictSource G>
class Occupancy {
public:
  explicit Occupancy(const G& graph) : graph_(graph), blocked_(graph.size(), 0) {}

  /// @pre not blocked.
  void add(index_t v) {
    blocked_[v] = 1;
    graph_.for_each_conflict(v, [this](index_t u) { blocked_[u] = 1; });
  }
  bool blocks(index_t v) const { return blocked_[v] != 0; }

private:
  const G& graph_;
  std::vector<std::uint8_t> blocked_;
};

/// Pairs of vertices and the places at which members have them: chains in a table with open addressing.
class PairTable {
public:
  /// A member's pair: 24 x number of the member + place.
  using Slot = std::uint64_t;

  /// @param slots  `n_pairs` a member, in the order of the members.
  void add(VertexPair pair) {
    if (2 * ++n_used_ > heads_.size()) grow();
    Head& head = heads_[find(pair)];
    if (head.first != none) --n_used_;
    head.pair = pair;
    next_.push_back(std::exchange(head.first, static_cast<Slot>(next_.size())));
  }

  /// Calls `f(slot)` until it says true. @return whether it did.
  template <class F>
  bool any_of(VertexPair pair, F&& f) const {
    if (heads_.empty()) return false;
    for (Slot slot = heads_[find(pair)].first; slot != none; slot = next_[slot])
      if (f(slot)) return true;
    return false;
  }

private:
  static constexpr Slot none = ~Slot{0};
  struct Head {
    VertexPair pair;
    Slot first = none;
  };

  std::size_t find(VertexPair pair) const {
    const std::size_t mask = heads_.size() - 1;
    std::size_t at = scramble((std::uint64_t{pair.first} << 32) | pair.second) & mask;
    while (heads_[at].first != none && heads_[at].pair != pair) at = (at + 1) & mask;
    return at;
  }

  void grow() {
    const std::vector<Head> old =
        std::exchange(heads_, std::vector<Head>(std::max<std::size_t>(2 * heads_.size(), 64)));
    for (const Head& head : old)
      if (head.first != none) heads_[find(head.pair)] = head;
  }

  std::vector<Head> heads_;  ///< a power of two of them, half used at most
  std::vector<Slot> next_;
  std::size_t n_used_ = 0;
};

/// The members' tetrahedra and pairs of vertices say who is blocked: nothing is kept for the others.
///
/// @par Complexity  4 bytes a tetrahedron, 500 bytes a member. `add` and `blocks` O(1).
class CandidateOccupancy {
public:
  /// @param candidates  must outlive this; may be added to. @param n_tets  above all tetrahedra that they name.
  CandidateOccupancy(const PotentialHexahedra& candidates, std::size_t n_tets)
      : candidates_(candidates), owner_(n_tets, no_index) {}

  void add(index_t v) {
    for (const index_t tet : candidates_.tets[v]) owner_[tet] = v;
    for (std::size_t place = 0; place < n_pairs; ++place) pairs_.add(pair_at(candidates_.vertices[v], place));
    members_.push_back(v);
  }

  bool blocks(index_t v) const {
    return any_blocker(v, [](index_t) { return true; });
  }

  /// Calls `f(member)` for each member that is v or in conflict with it, some more than once, until it says true.
  /// @return whether it did.
  template <class F>
  bool any_blocker(index_t v, F&& f) const {
    for (const index_t tet : candidates_.tets[v])
      if (owner_[tet] != no_index && f(owner_[tet])) return true;
    const auto& mine = candidates_.vertices[v];
    for (std::size_t place = 0; place < n_pairs; ++place)
      if (pairs_.any_of(pair_at(mine, place), [&](PairTable::Slot slot) {
            const index_t member = members_[slot / n_pairs];
            return pair_clashes(mine, place, candidates_.vertices[member], slot % n_pairs) && f(member);
          }))
        return true;
    return false;
  }

private:
  const PotentialHexahedra& candidates_;
  std::vector<index_t> owner_, members_;
  PairTable pairs_;
};

template <>
class Occupancy<ImplicitIncompatibilityGraph> : public CandidateOccupancy {
public:
  explicit Occupancy(const ImplicitIncompatibilityGraph& graph)
      : CandidateOccupancy(graph.candidates(), graph.n_tets()) {}
};

}  // namespace framehex::detail
