// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/parts/detail/candidate_states.hpp"
#include "framehex/selection/detail/occupancy.hpp"

namespace framehex::detail {

/// Takes what fits of all ranks' candidates together, by falling weight, in rounds.
///
/// In a round a rank decides its candidates in order; one that a heavier undecided one keeps out waits, as do those that it
/// keeps out in turn. Then the states of those that others have copies of are exchanged. The heaviest undecided one of all
/// never waits, so this ends, and who is taken does not depend on who holds what.
template <Transport Tr>
class GreedyRounds {
public:
  using States = CandidateStates<Tr>;

  /// @param graph   of the pool's candidates.
  /// @param states  what is taken stays, and so does what is refused.
  GreedyRounds(const Tr& transport, const CandidatePool& pool, const ImplicitIncompatibilityGraph& graph,
               States& states)
      : transport_(transport), pool_(pool), graph_(graph), states_(states), taken_(graph) {
    for (index_t v = 0; v < pool_.size(); ++v)
      if (states_[v] == States::taken)
        taken_.add(v);
      else if (states_[v] == States::undecided)
        open_.push_back(v);
  }

  /// Collective. @param stop  asked now and then on this rank; @return false when one of them said so.
  template <class Stop>
  bool run(Stop&& stop) {
    for (;; ++n_rounds_) {
      decide(stop);
      std::array<std::int64_t, 2> sums{0, stop() ? 1 : 0};
      for (const index_t v : open_) sums[0] += v < pool_.n_own ? 1 : 0;
      transport_.sum(std::span<std::int64_t>(sums));
      if (sums[1] > 0) return false;
      for (const index_t v : states_.exchange())
        if (states_[v] == States::taken) taken_.add(v);
      std::erase_if(open_, [this](index_t v) { return states_[v] != States::undecided; });
      if (sums[0] == 0) return true;
    }
  }

  std::size_t n_rounds() const { return n_rounds_; }

private:
  template <class Stop>
  void decide(Stop&& stop) {
    constexpr std::size_t n_at_once = 4096;
    Occupancy<ImplicitIncompatibilityGraph> waiting(graph_);
    std::vector<index_t> left;
    const auto before = [this](index_t u, index_t v) { return pool_.is_before(u, v); };
    drop_blocked();
    // Block by block: the heaviest block most others, which then need not be put in order.
    while (!open_.empty() && !stop()) {
      const auto end =
          open_.begin() + static_cast<std::ptrdiff_t>(std::min(open_.size(), std::max(open_.size() / 8, n_at_once)));
      if (end != open_.end()) std::nth_element(open_.begin(), end, open_.end(), before);
      std::sort(open_.begin(), end, before);
      for (auto v = open_.begin(); v != end; ++v) {
        if (taken_.blocks(*v)) {
          states_.set(*v, States::refused);
        } else if (*v >= pool_.n_own || waiting.blocks(*v)) {
          waiting.add(*v);
          left.push_back(*v);
        } else {
          states_.set(*v, States::taken);
          taken_.add(*v);
        }
      }
      open_.erase(open_.begin(), end);
      drop_blocked();
    }
    open_.insert(open_.end(), left.begin(), left.end());
  }

  void drop_blocked() {
    std::erase_if(open_, [this](index_t v) {
      const bool blocked = taken_.blocks(v);
      if (blocked) states_.set(v, States::refused);
      return blocked;
    });
  }

  const Tr& transport_;
  const CandidatePool& pool_;
  const ImplicitIncompatibilityGraph& graph_;
  States& states_;
  Occupancy<ImplicitIncompatibilityGraph> taken_;
  std::vector<index_t> open_;
  std::size_t n_rounds_ = 0;
};

}  // namespace framehex::detail
