// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/selection/selection.hpp"

namespace framehex {

/// An independent set that is changed by local moves, each of which can be taken back.
///
/// Moves that gain weight: a candidate comes in for all its neighbours in the set, (w,1), which includes the free
/// candidates; two come in for one, (1,2). Only what a change has touched is looked at again.
///
/// @par Complexity   24 bytes a candidate; a change costs the degree of the candidate.
/// @par Determinism  Serial, in the order of the touches.
/// @par Source       Nogueira, Pinheiro, Subramanian, Optim. Lett. 12 (2018) 567-583; the undo log is ours.
template <ConflictSource G>
class LocalSearch {
public:
  explicit LocalSearch(const G& graph)
      : graph_(graph), states_(graph.size()), queued_(graph.size(), 0), mark_(graph.size(), 0) {}

  /// Starts from a set. @pre independent.
  void assign(std::span<const index_t> members) {
    states_.assign(graph_.size(), State{});
    weight_ = 0;
    for (const index_t v : members) add(v);
    queue_all();
    commit();
  }

  bool contains(index_t v) const { return states_[v].n_owners == selected; }
  std::int64_t weight_in_units() const { return weight_; }
  /// Number of neighbours in the set. @pre v is not in it.
  index_t n_owners(index_t v) const { return states_[v].n_owners; }

  std::vector<index_t> members() const {
    std::vector<index_t> result;
    for (index_t v = 0; v < graph_.size(); ++v)
      if (contains(v)) result.push_back(v);
    return result;
  }

  /// Brings v in and its neighbours out.
  void force(index_t v) {
    if (contains(v)) return;
    if (states_[v].n_owners > 0)
      graph_.for_each_conflict(v, [this](index_t u) {
        if (contains(u)) drop(u);
      });
    take(v);
  }

  /// Brings v in as `force`, and lets no single heavier candidate take its place before `unlock`.
  void force_and_lock(index_t v) {
    if (contains(v)) return;
    force(v);
    locked_.push_back(v);
  }

  /// Lets those that were kept out by locks be looked at again.
  void unlock() {
    const std::vector<index_t> locked = std::exchange(locked_, {});
    for (const index_t v : locked) graph_.for_each_conflict(v, [this](index_t u) { touch(u); });
  }

  /// Takes v out, leaving its place open.
  void drop(index_t v) {
    remove(v);
    log_.push_back({v, Change::removed});
    graph_.for_each_conflict(v, [this](index_t u) { touch(u); });
    touch(v);
  }

  /// Makes moves that gain weight until there is none near what was touched. No set of members returns, so this ends.
  void improve() {
    while (!queue_.empty()) {
      const index_t v = queue_.back();
      queue_.pop_back();
      queued_[v] = 0;
      if (contains(v))
        try_one_for_two(v);
      else if (gains(v))
        force(v);
    }
  }

  /// Lets everything be looked at again.
  void queue_all() {
    for (auto v = static_cast<index_t>(graph_.size()); v-- > 0;) enqueue(v);
  }

  /// Makes the changes since the last commit final.
  void commit() { log_.clear(); }

  /// Takes back the changes since the last commit.
  void roll_back() {
    locked_.clear();
    while (!queue_.empty()) {
      queued_[queue_.back()] = 0;
      queue_.pop_back();
    }
    while (!log_.empty()) {
      const auto [v, change] = log_.back();
      log_.pop_back();
      if (change == Change::added)
        remove(v);
      else
        add(v);
    }
  }

private:
  static constexpr index_t selected = no_index;
  enum class Change : std::uint8_t { added, removed };
  struct Logged {
    index_t v;
    Change change;
  };
  struct State {
    std::int64_t blocking = 0;  ///< weight of the neighbours in the set
    index_t n_owners = 0;       ///< their number, or `selected`
    index_t owner_sum = 0;      ///< sum of their numbers: the owner itself when there is one
  };

  bool gains(index_t v) const {
    const State& s = states_[v];
    if (s.n_owners == 0) return true;
    if (weights()[v] <= s.blocking) return false;
    return s.n_owners > 1 || std::find(locked_.begin(), locked_.end(), s.owner_sum) == locked_.end();
  }
  std::span<const std::int64_t> weights() const { return graph_.weights_in_units(); }

  void add(index_t v) {
    const std::int64_t w = weights()[v];
    states_[v].n_owners = selected;
    weight_ += w;
    graph_.for_each_conflict(v, [&](index_t u) {
      State& s = states_[u];
      s.blocking += w;
      ++s.n_owners;
      s.owner_sum += v;
    });
  }

  void remove(index_t v) {
    const std::int64_t w = weights()[v];
    states_[v].n_owners = 0;
    weight_ -= w;
    graph_.for_each_conflict(v, [&](index_t u) {
      State& s = states_[u];
      s.blocking -= w;
      --s.n_owners;
      s.owner_sum -= v;
    });
  }

  void take(index_t v) {
    add(v);
    log_.push_back({v, Change::added});
    enqueue(v);
  }

  void touch(index_t v) {
    if (contains(v)) return;
    if (gains(v)) enqueue(v);
    if (states_[v].n_owners == 1) enqueue(states_[v].owner_sum);
  }

  void enqueue(index_t v) {
    if (queued_[v]) return;
    queued_[v] = 1;
    queue_.push_back(v);
  }

  /// Looks for two candidates that v alone keeps out, that fit together and weigh more.
  void try_one_for_two(index_t v) {
    kept_out_.clear();
    std::int64_t heaviest = 0;
    graph_.for_each_conflict(v, [&](index_t u) {
      if (states_[u].n_owners != 1) return;
      kept_out_.push_back(u);
      heaviest = std::max(heaviest, weights()[u]);
    });
    if (kept_out_.size() < 2) return;
    std::int64_t best = weights()[v];
    index_t first = no_index, second = no_index;
    for (std::size_t i = 0; i + 1 < kept_out_.size(); ++i) {
      const index_t a = kept_out_[i];
      if (weights()[a] + heaviest <= best) continue;
      ++stamp_;
      graph_.for_each_conflict(a, [this](index_t u) { mark_[u] = stamp_; });
      for (std::size_t j = i + 1; j < kept_out_.size(); ++j) {
        const index_t b = kept_out_[j];
        const std::int64_t both = weights()[a] + weights()[b];
        if (both > best && mark_[b] != stamp_) best = both, first = a, second = b;
      }
    }
    if (first == no_index) return;
    drop(v);
    take(first);
    take(second);
  }

  const G& graph_;
  std::vector<State> states_;
  std::vector<std::uint8_t> queued_;
  std::vector<std::uint32_t> mark_;
  std::vector<index_t> queue_, kept_out_, locked_;
  std::vector<Logged> log_;
  std::int64_t weight_ = 0;
  std::uint32_t stamp_ = 0;
};

}  // namespace framehex
