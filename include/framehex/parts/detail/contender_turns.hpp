// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/executor.hpp"
#include "framehex/parts/detail/calling_thread.hpp"
#include "framehex/parts/detail/candidate_states.hpp"
#include "framehex/selection/detail/contender_search.hpp"

namespace framehex::detail {

/// A candidate on its way to the part that may exchange it.
struct ContenderRecord {
  CandidateRecord candidate;
  index_t leaf;
  std::uint32_t is_member;
};

/// The candidates of one leaf, in numbers that depend on places alone.
class ContenderPart {
public:
  struct Item {
    const ContenderRecord* record;
    std::span<const global_t> tets;
  };

  explicit ContenderPart(std::vector<Item> items) : items_(std::move(items)) {
    std::vector<VertexRecord> vertices;
    std::vector<global_t> tets;
    for (const Item& item : items_) {
      const CandidateRecord& c = item.record->candidate;
      for (std::size_t k = 0; k < 8; ++k) vertices.push_back({c.vertices[k], c.places[k]});
      tets.insert(tets.end(), item.tets.begin(), item.tets.end());
    }
    const auto before = [](const VertexRecord& a, const VertexRecord& b) { return lies_before(a, b); };
    std::sort(vertices.begin(), vertices.end(), before);
    vertices.erase(std::unique(vertices.begin(), vertices.end(),
                               [](const VertexRecord& a, const VertexRecord& b) { return a.number == b.number; }),
                   vertices.end());
    std::sort(tets.begin(), tets.end());
    tets.erase(std::unique(tets.begin(), tets.end()), tets.end());
    struct Corners {
      std::array<index_t, 8> vertices;
      std::size_t item;
    };
    std::vector<Corners> order;
    for (std::size_t i = 0; i < items_.size(); ++i) {
      const CandidateRecord& c = items_[i].record->candidate;
      auto& corners = order.emplace_back(Corners{{}, i}).vertices;
      for (std::size_t k = 0; k < 8; ++k)
        corners[k] = static_cast<index_t>(
            std::lower_bound(vertices.begin(), vertices.end(), VertexRecord{c.vertices[k], c.places[k]}, before) -
            vertices.begin());
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
  std::vector<const ContenderRecord*> improve(std::uint64_t seed, const Observer& observer) const {
    std::vector<index_t> members;
    for (index_t i = 0; i < items_.size(); ++i)
      if (items_[i].record->is_member) members.push_back(i);
    std::vector<const ContenderRecord*> changed;
    if (members.size() == items_.size()) return changed;
    const ImplicitIncompatibilityGraph graph(candidates_,
                                             [this](index_t i) { return items_[i].record->candidate.weight; });
    Deadline deadline(std::numeric_limits<double>::infinity(), observer);
    ContenderSearch search(graph, seed, deadline);
    const std::vector<index_t> better = search.improve(members, by_number);
    std::vector<std::uint8_t> chosen(items_.size(), 0);
    for (const index_t v : better) chosen[v] = 1;
    for (index_t i = 0; i < items_.size(); ++i)
      if (chosen[i] != items_[i].record->is_member) changed.push_back(items_[i].record);
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

  ContenderTurns(const Tr& transport, const CandidatePool& pool, const ImplicitIncompatibilityGraph& graph,
                 States& states, const E& executor, CallingThread& thread)
      : transport_(transport), pool_(pool), graph_(graph), states_(states), executor_(executor), thread_(thread) {}

  /// One turn. Collective.
  void run(const Partition& partition, std::uint64_t seed) {
    find_leaves(partition);
    gather(partition);
    note_borders();
    std::vector<std::vector<const ContenderRecord*>> changed(groups_.size());
    executor_(groups_.size(), [&](std::size_t i, std::size_t) {
      if (!thread_.stopped()) changed[i] = ContenderPart(group(i)).improve(seed, thread_.part("selection"));
    });
    Rows<index_t> rows = make_rows<index_t>(transport_);
    for (const auto& list : changed)
      for (const ContenderRecord* r : list)
        rows[static_cast<std::size_t>(r->candidate.rank)].push_back(r->candidate.index);
    for (const index_t v : send_joined(transport_, std::move(rows)))
      states_.set(v, states_[v] == States::taken ? States::refused : States::taken);
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
  bool contends(index_t v, const Occupancy<ImplicitIncompatibilityGraph>& occupied, std::vector<index_t>& seen) const {
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
           (at_border_.empty() ||
            std::ranges::any_of(pool_.candidates.vertices[v], [this](index_t w) { return at_border_[w] != 0; }));
  }

  void note_borders() {
    if (!at_border_.empty()) return;
    at_border_.assign(pool_.points.size(), 0);
    for (index_t v = 0; v < pool_.size(); ++v)
      if (leaf_[v] == no_index)
        for (const index_t w : pool_.candidates.vertices[v]) at_border_[w] = 1;
  }

  std::vector<std::uint8_t> find_contenders() const {
    Occupancy<ImplicitIncompatibilityGraph> occupied(graph_);
    for (index_t v = 0; v < pool_.size(); ++v)
      if (states_[v] == States::taken) occupied.add(v);
    std::vector<std::uint8_t> found(pool_.n_own, 0);
    for_blocks(executor_, pool_.n_own, 4096, [&](std::size_t first, std::size_t last) {
      std::vector<index_t> seen;
      for (auto v = static_cast<index_t>(first); v < last; ++v)
        if (states_[v] != States::taken && has_turn(v)) found[v] = contends(v, occupied, seen) ? 1 : 0;
    });
    return found;
  }

  void gather(const Partition& partition) {
    const std::vector<std::uint8_t> is_contender = find_contenders();
    Rows<ContenderRecord> records = make_rows<ContenderRecord>(transport_);
    Rows<global_t> tets = make_rows<global_t>(transport_);
    for (index_t v = 0; v < pool_.n_own; ++v) {
      const bool is_member = states_[v] == States::taken;
      if (leaf_[v] == no_index || !(is_member || is_contender[v])) continue;
      const auto to = static_cast<std::size_t>(partition.rank(leaf_[v]));
      records[to].push_back({pool_.record(v, transport_.rank()), leaf_[v], is_member ? 1U : 0U});
      for (const index_t tet : pool_.candidates.tets[v]) tets[to].push_back(pool_.tet_number[tet]);
    }
    records_ = send_joined(transport_, std::move(records));
    tets_ = send_joined(transport_, std::move(tets));
    first_tet_.clear();
    std::size_t next = 0;
    for (const ContenderRecord& r : records_) {
      first_tet_.push_back(next);
      next += r.candidate.n_tets;
    }
    order_.resize(records_.size());
    for (std::size_t i = 0; i < order_.size(); ++i) order_[i] = i;
    std::stable_sort(order_.begin(), order_.end(),
                     [this](std::size_t a, std::size_t b) { return records_[a].leaf < records_[b].leaf; });
    groups_.clear();
    for (std::size_t i = 0, end = 0; i < order_.size(); i = end) {
      while (end < order_.size() && records_[order_[end]].leaf == records_[order_[i]].leaf) ++end;
      groups_.push_back({i, end});
    }
  }

  std::vector<ContenderPart::Item> group(std::size_t i) const {
    std::vector<ContenderPart::Item> items;
    for (std::size_t n = groups_[i][0]; n < groups_[i][1]; ++n) {
      const ContenderRecord& r = records_[order_[n]];
      items.push_back({&r, {tets_.data() + first_tet_[order_[n]], r.candidate.n_tets}});
    }
    return items;
  }

  const Tr& transport_;
  const CandidatePool& pool_;
  const ImplicitIncompatibilityGraph& graph_;
  States& states_;
  const E& executor_;
  CallingThread& thread_;
  std::vector<index_t> leaf_;            ///< by candidate: the one that has all its vertices
  std::vector<std::uint8_t> at_border_;  ///< by vertex; empty before the first turn
  std::vector<ContenderRecord> records_;
  std::vector<global_t> tets_;
  std::vector<std::size_t> first_tet_, order_;  ///< of the records; the records by leaf
  std::vector<std::array<std::size_t, 2>> groups_;
};

}  // namespace framehex::detail
