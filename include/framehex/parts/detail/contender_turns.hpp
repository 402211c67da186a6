// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/executor.hpp"
#include "framehex/parts/detail/calling_thread.hpp"
#include "framehex/parts/detail/candidate_states.hpp"
#include "framehex/selection/detail/contender_search.hpp"

namespace framehex::detail {

/// The candidates of one leaf, in numbers that depend on places alone.
class ContenderPart {
public:
  struct Item {
    const CandidateRecord* record;
    std::span<const global_t> tets;
  };

  /// @param held  vertices of the items, among others.
  ContenderPart(std::vector<Item> items, const HeldTets& held) : items_(std::move(items)) {
    std::vector<std::size_t> used;
    std::vector<global_t> tets;
    for (const Item& item : items_) {
      for (const global_t v : item.record->vertices) used.push_back(held.find(v));
      tets.insert(tets.end(), item.tets.begin(), item.tets.end());
    }
    const auto before = [&](std::size_t a, std::size_t b) { return lies_before(held.vertices[a], held.vertices[b]); };
    const std::vector<std::size_t> unsorted = used;
    std::sort(used.begin(), used.end(), before);
    used.erase(std::unique(used.begin(), used.end()), used.end());
    std::sort(tets.begin(), tets.end());
    tets.erase(std::unique(tets.begin(), tets.end()), tets.end());
    struct Corners {
      std::array<index_t, 8> vertices;
      std::size_t item;
    };
    std::vector<Corners> order;
    for (std::size_t i = 0; i < items_.size(); ++i) {
      auto& corners = order.emplace_back(Corners{{}, i}).vertices;
      for (std::size_t k = 0; k < 8; ++k)
        corners[k] = static_cast<index_t>(std::lower_bound(used.begin(), used.end(), unsorted[8 * i + k], before) -
                                          used.begin());
    }
    std::sort(order.begin(), order.end(), [](const Corners& a, const Corners& b) { return a.vertices < b.vertices; });
    std::vector<Item> sorted_items;
    for (const Corners& corners : order) {
      const Item& item = sorted_items.emplace_back(items_[corners.item]);
      candidates_.vertices.push_back(corners.vertices);
      candidates_.quality.push_back(0);
      candidates_.volume.push_back(0);
      for (const global_t tet : item.tets)
        candidates_.tets.values.push_back(
            static_cast<index_t>(std::lower_bound(tets.begin(), tets.end(), tet) - tets.begin()));
      std::sort(candidates_.tets.values.begin() + static_cast<std::ptrdiff_t>(candidates_.tets.offsets.back()),
                candidates_.tets.values.end());
      candidates_.tets.end_row();
      candidates_.face_slivers.end_row();
    }
    items_ = std::move(sorted_items);
  }

  /// @return the records of those that came or went.
  std::vector<const CandidateRecord*> improve(std::uint64_t seed, const Observer& observer) const {
    std::vector<index_t> members;
    for (index_t i = 0; i < items_.size(); ++i)
      if (items_[i].record->is_taken) members.push_back(i);
    std::vector<const CandidateRecord*> changed;
    if (members.size() == items_.size()) return changed;
    const ImplicitIncompatibilityGraph graph(candidates_, [this](index_t i) { return items_[i].record->weight; });
    Deadline deadline(std::numeric_limits<double>::infinity(), observer);
    ContenderSearch search(graph, seed, deadline);
    const std::vector<index_t> better = search.improve(members, by_number);
    std::vector<std::uint8_t> chosen(items_.size(), 0);
    for (const index_t v : better) chosen[v] = 1;
    for (index_t i = 0; i < items_.size(); ++i)
      if (chosen[i] != items_[i].record->is_taken) changed.push_back(items_[i].record);
    return changed;
  }

private:
  std::vector<Item> items_;
  PotentialHexahedra candidates_;
};

/// Improves a selection leaf by leaf of several octrees, each shifted against the others. In a turn a leaf may exchange
/// the candidates that have all their vertices in it; the others stay as they are. No two leaves share a vertex, so that
/// all work at the same time.
template <Transport Tr, Executor E>
class ContenderTurns {
public:
  using States = CandidateStates<Tr>;

  ContenderTurns(const Tr& transport, const CandidatePool& pool, BorderExchange<Tr>& border, States& states,
                 const E& executor, CallingThread& thread)
      : transport_(transport), pool_(pool), border_(border), states_(states), executor_(executor), thread_(thread) {}

  /// One turn. Collective.
  void run(const Partition& partition, std::uint64_t seed) {
    find_leaves(partition);
    gather(partition);
    note_borders();
    std::vector<std::vector<const CandidateRecord*>> changed(groups_.size());
    executor_(groups_.size(), [&](std::size_t i, std::size_t) {
      if (!thread_.stopped())
        changed[i] = ContenderPart(group(i), delivery_.held).improve(seed, thread_.part("selection"));
    });
    Rows<index_t> rows = make_rows<index_t>(transport_);
    for (const auto& list : changed)
      for (const CandidateRecord* r : list) rows[static_cast<std::size_t>(r->rank)].push_back(r->index);
    delivery_ = {};
    std::vector<index_t> come;
    for (const index_t v : send_joined(transport_, std::move(rows))) {
      const bool goes = states_[v] == States::taken;
      states_.set(v, goes ? States::refused : States::taken);
      if (!goes) come.push_back(v);
    }
    border_.tell(come);
    states_.grow();
    states_.exchange();
  }

private:
  /// Of the weight that a candidate must have over those that it would put out; as in ContenderSearch.
  static constexpr double least_share = 0.15;

  void find_leaves(const Partition& partition) {
    std::vector<index_t> leaf_of_vertex;
    leaf_of_vertex.reserve(pool_.points.size());
    for (const Vector3& p : pool_.points) leaf_of_vertex.push_back(partition.leaf_at(p));
    leaf_.assign(pool_.size(), no_index);
    for (index_t v = 0; v < pool_.size(); ++v) {
      const auto& corners = pool_.candidates.vertices[v];
      const index_t leaf = leaf_of_vertex[corners[0]];
      if (std::ranges::all_of(corners, [&](index_t w) { return leaf_of_vertex[w] == leaf; })) leaf_[v] = leaf;
    }
  }

  /// Whether an own candidate can compete with members that may go.
  bool contends(index_t v, const CandidateOccupancy& occupied, std::vector<index_t>& seen) const {
    seen.clear();
    double so_far = 0;
    const bool cannot = occupied.any_blocker(v, [&](index_t member) {
      if (leaf_[member] != leaf_[v]) return true;
      if (std::find(seen.begin(), seen.end(), member) != seen.end()) return false;
      seen.push_back(member);
      so_far += pool_.weights[member];
      // Clearly too light, in whatever order the rest is added up.
      return pool_.weights[v] < 0.999999 * least_share * so_far;
    });
    if (cannot) return false;
    // In order, so that the sum does not depend on who adds it up.
    std::sort(seen.begin(), seen.end(), [this](index_t a, index_t b) { return pool_.is_before(a, b); });
    double blocking = 0;
    for (const index_t member : seen) blocking += pool_.weights[member];
    return pool_.weights[v] >= least_share * blocking;
  }

  /// Whether a candidate is looked at in this turn: after the first those that were near a border.
  bool has_turn(index_t v) const {
    return leaf_[v] != no_index &&
           (is_first_turn_ ||
            std::ranges::any_of(pool_.candidates.vertices[v], [this](index_t w) { return at_border_[w] != 0; }));
  }

  void note_borders() {
    if (!std::exchange(is_first_turn_, false)) return;
    at_border_.assign(pool_.points.size(), 0);
    for (index_t v = 0; v < pool_.n_own; ++v)
      if (leaf_[v] == no_index)
        for (const index_t w : pool_.candidates.vertices[v]) at_border_[w] = 1;
    border_.join_flags(at_border_);
  }

  /// Own candidates that contend, and members that they would put out: all that a turn is about.
  std::vector<std::uint8_t> find_competitors() const {
    CandidateOccupancy occupied(pool_.candidates, pool_.patch->mesh.tets.size());
    for (index_t v = 0; v < pool_.size(); ++v)
      if (states_[v] == States::taken) occupied.add(v);
    std::vector<std::uint8_t> found(pool_.size(), 0);
    for_blocks(executor_, pool_.n_own, 4096, [&](std::size_t first, std::size_t last) {
      std::vector<index_t> seen;
      for (auto v = static_cast<index_t>(first); v < last; ++v)
        if (states_[v] != States::taken && has_turn(v)) found[v] = contends(v, occupied, seen) ? 1 : 0;
    });
    Rows<index_t> of_others = make_rows<index_t>(transport_);
    for (index_t v = 0; v < pool_.n_own; ++v)
      if (found[v] && states_[v] != States::taken)
        occupied.any_blocker(v, [&](index_t member) {
          found[member] = 1;
          return false;
        });
    for (const CandidatePool::Copy& copy : pool_.copies)
      if (found[copy.index]) of_others[static_cast<std::size_t>(copy.rank)].push_back(copy.home);
    for (const index_t v : send_joined(transport_, std::move(of_others))) found[v] = 1;
    return found;
  }

  void gather(const Partition& partition) {
    const std::vector<std::uint8_t> competes = find_competitors();
    CandidateMail mail(transport_.n_ranks(), pool_);
    for (index_t v = 0; v < pool_.n_own; ++v)
      if (competes[v]) mail.put(v, states_[v] == States::taken, transport_.rank(), partition.rank(leaf_[v]));
    delivery_ = mail.deliver(transport_);
    std::vector<index_t> leaf;
    for (const CandidateRecord& r : delivery_.records)
      leaf.push_back(partition.leaf_at(point_at(delivery_.held.vertices[delivery_.held.find(r.vertices[0])].place)));
    order_.resize(leaf.size());
    for (std::size_t i = 0; i < order_.size(); ++i) order_[i] = i;
    std::stable_sort(order_.begin(), order_.end(), [&](std::size_t a, std::size_t b) { return leaf[a] < leaf[b]; });
    groups_.clear();
    for (std::size_t i = 0, end = 0; i < order_.size(); i = end) {
      while (end < order_.size() && leaf[order_[end]] == leaf[order_[i]]) ++end;
      groups_.push_back({i, end});
    }
  }

  std::vector<ContenderPart::Item> group(std::size_t i) const {
    std::vector<ContenderPart::Item> items;
    for (std::size_t n = groups_[i][0]; n < groups_[i][1]; ++n)
      items.push_back({&delivery_.records[order_[n]], delivery_.tets_of(order_[n])});
    return items;
  }

  const Tr& transport_;
  const CandidatePool& pool_;
  BorderExchange<Tr>& border_;
  States& states_;
  const E& executor_;
  CallingThread& thread_;
  std::vector<index_t> leaf_;  ///< by candidate: the one that has all its vertices
  bool is_first_turn_ = true;
  std::vector<std::uint8_t> at_border_;  ///< by vertex, after the first turn
  CandidateMail::Delivery delivery_;     ///< contenders, and members that they compete with
  std::vector<std::size_t> order_;       ///< the records by leaf
  std::vector<std::array<std::size_t, 2>> groups_;
};

}  // namespace framehex::detail
