// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/selection/incompatibility_graph.hpp"

#include <limits>

namespace framehex {

struct ReductionOptions {
  /// Neighbours looked at, in all; when they are spent, what remains is kept.
  std::size_t max_work = std::numeric_limits<std::size_t>::max();
};

/// What cheap rules leave of a graph: some heaviest selection consists of `taken` and of a heaviest one of `kept`.
struct Reduction {
  std::vector<index_t> taken;  ///< ascending
  std::vector<index_t> kept;   ///< ascending; none is a neighbour of a taken one
};

namespace detail {

/// Applies the rules round by round of what was touched.
class Reducer {
public:
  Reducer(const IncompatibilityGraph& graph, std::size_t max_work)
      : graph_(graph),
        work_left_(max_work),
        alive_(graph.size(), 1),
        queued_(graph.size(), 1),
        mark_(graph.size(), 0) {}

  Reduction run() {
    Reduction result;
    std::vector<std::uint8_t> taken(graph_.size(), 0);
    for (auto v = static_cast<index_t>(graph_.size()); v-- > 0;) queue_.push_back(v);
    while (!queue_.empty() && work_left_ > 0) {
      const index_t v = queue_.back();
      queue_.pop_back();
      queued_[v] = 0;
      if (!alive_[v]) continue;
      gather(v);
      if (outweighs_neighbours(v) || (is_heaviest(v) && is_simplicial())) {
        taken[v] = 1;
        remove(v);
        const std::vector<index_t> gone = open_;
        for (const index_t u : gone) remove(u);
      } else {
        remove_dominated(v);
      }
    }
    for (index_t v = 0; v < graph_.size(); ++v) {
      if (taken[v]) result.taken.push_back(v);
      if (alive_[v]) result.kept.push_back(v);
    }
    return result;
  }

private:
  std::int64_t weight(index_t v) const { return graph_.weights_in_units()[v]; }

  void spend(std::size_t n) { work_left_ -= std::min(work_left_, n); }

  /// The neighbours left, in `open_`.
  void gather(index_t v) {
    open_.clear();
    for (const index_t u : graph_.neighbours(v))
      if (alive_[u]) open_.push_back(u);
    spend(graph_.degree(v));
  }

  bool outweighs_neighbours(index_t v) const {
    std::int64_t sum = 0;
    for (const index_t u : open_) sum += weight(u);
    return weight(v) >= sum;
  }

  bool is_heaviest(index_t v) const {
    return std::all_of(open_.begin(), open_.end(), [&](index_t u) { return weight(u) <= weight(v); });
  }

  /// Are the neighbours left a clique?
  bool is_simplicial() {
    for (const index_t u : open_) {
      if (graph_.degree(u) + 1 < open_.size()) return false;
      ++stamp_;
      for (const index_t x : graph_.neighbours(u)) mark_[x] = stamp_;
      mark_[u] = stamp_;
      spend(graph_.degree(u));
      if (!std::all_of(open_.begin(), open_.end(), [&](index_t x) { return mark_[x] == stamp_; })) return false;
    }
    return true;
  }

  /// A neighbour u that weighs no more than v, and excludes all that v excludes, is never needed.
  void remove_dominated(index_t v) {
    const std::vector<index_t> neighbours = open_;
    for (const index_t u : neighbours) {
      if (weight(u) > weight(v) || graph_.degree(u) < neighbours.size() || work_left_ == 0) continue;
      ++stamp_;
      for (const index_t x : graph_.neighbours(u)) mark_[x] = stamp_;
      mark_[u] = stamp_;
      spend(graph_.degree(u));
      if (std::all_of(neighbours.begin(), neighbours.end(),
                      [&](index_t x) { return mark_[x] == stamp_ || !alive_[x]; }))
        remove(u);
    }
  }

  void remove(index_t v) {
    alive_[v] = 0;
    for (const index_t u : graph_.neighbours(v))
      if (alive_[u] && !queued_[u]) {
        queued_[u] = 1;
        queue_.push_back(u);
      }
  }

  const IncompatibilityGraph& graph_;
  std::size_t work_left_;
  std::vector<std::uint8_t> alive_, queued_;
  std::vector<std::uint32_t> mark_;
  std::vector<index_t> queue_, open_;
  std::uint32_t stamp_ = 0;
};

}  // namespace detail

/// Settles candidates by rules that keep one heaviest selection possible: one that outweighs its neighbours together is
/// taken; one whose neighbours exclude one another and weigh no more is taken; one that weighs no more than a neighbour
/// and excludes all that this excludes is left out.
///
/// On graphs of potential hexahedra, dense and clustered, they settle a few percent: hence the budget.
/// @par Complexity   O(budget); the exhaustive use is O(n d^2) for the mean degree d.
/// @par Determinism  Serial, by number.
/// @par Source       Lamm, Schulz, Strash, Williger, Zhang, Exactly solving the maximum weight independent set problem
///                   on large real-world graphs, ALENEX 2019: three of the rules.
inline Reduction reduce(const IncompatibilityGraph& graph, const ReductionOptions& options = {}) {
  return detail::Reducer(graph, options.max_work).run();
}

}  // namespace framehex
