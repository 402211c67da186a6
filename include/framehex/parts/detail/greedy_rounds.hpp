// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/parts/detail/border_candidates.hpp"
#include "framehex/selection/detail/occupancy.hpp"

namespace framehex::detail {

/// The greedy selection of all ranks' candidates together, by falling weight, found in rounds.
///
/// In a round a rank decides its candidates in order; one that a heavier undecided one keeps out waits, as do those that it
/// keeps out in turn. Then the states of those that others have copies of are exchanged. The heaviest undecided one of all
/// never waits, so this ends, and who is taken does not depend on who holds what.
template <Transport Tr>
class GreedyRounds {
public:
  enum class State : std::uint8_t { undecided, taken, refused };

  /// @param graph  of the pool's candidates.
  GreedyRounds(const Tr& transport, const CandidatePool& pool, const ImplicitIncompatibilityGraph& graph)
      : transport_(transport), pool_(pool), graph_(graph), taken_(graph), state_(pool.size(), State::undecided) {}

  /// Collective. @param stop  asked now and then on this rank; @return false when one of them said so.
  template <class Stop>
  bool run(Stop&& stop) {
    open_.resize(pool_.size());
    for (std::size_t i = 0; i < open_.size(); ++i) open_[i] = static_cast<index_t>(i);
    for (;; ++n_rounds_) {
      decide(stop);
      std::array<std::int64_t, 2> sums{0, stop() ? 1 : 0};
      for (const index_t v : open_) sums[0] += v < pool_.n_own ? 1 : 0;
      transport_.sum(std::span<std::int64_t>(sums));
      if (sums[1] > 0) return false;
      exchange();
      if (sums[0] == 0) return true;
    }
  }

  State state(index_t v) const { return state_[v]; }
  const std::vector<State>& states() const { return state_; }
  std::size_t n_rounds() const { return n_rounds_; }

private:
  template <class Stop>
  void decide(Stop&& stop) {
    constexpr std::size_t n_at_once = 4096;
    Occupancy<ImplicitIncompatibilityGraph> waiting(graph_);
    std::vector<index_t> left;
    const auto before = [this](index_t u, index_t v) { return pool_.is_before(u, v); };
    // Block by block: the heaviest block most others, which then need not be put in order.
    while (!open_.empty() && !stop()) {
      const auto end =
          open_.begin() + static_cast<std::ptrdiff_t>(std::min(open_.size(), std::max(open_.size() / 8, n_at_once)));
      if (end != open_.end()) std::nth_element(open_.begin(), end, open_.end(), before);
      std::sort(open_.begin(), end, before);
      for (auto at = open_.begin(); at != end; ++at) {
        const index_t v = *at;
        if (taken_.blocks(v)) {
          set(v, State::refused);
        } else if (v >= pool_.n_own || waiting.blocks(v)) {
          waiting.add(v);
          left.push_back(v);
        } else {
          take(v);
        }
      }
      open_.erase(open_.begin(), end);
      std::erase_if(open_, [this](index_t v) {
        const bool blocked = taken_.blocks(v);
        if (blocked) set(v, State::refused);
        return blocked;
      });
    }
    open_.insert(open_.end(), left.begin(), left.end());
  }

  void take(index_t v) {
    set(v, State::taken);
    taken_.add(v);
  }

  void set(index_t v, State state) {
    state_[v] = state;
    if (v < pool_.n_own) news_.push_back(v);
  }

  struct News {
    index_t index;
    State state;
  };

  void exchange() {
    if (transport_.n_ranks() == 1) return;
    Rows<News> rows = make_rows<News>(transport_);
    std::sort(news_.begin(), news_.end());
    auto holder = pool_.holders.begin();
    for (const index_t v : news_) {
      while (holder != pool_.holders.end() && holder->index < v) ++holder;
      for (auto h = holder; h != pool_.holders.end() && h->index == v; ++h)
        rows[static_cast<std::size_t>(h->rank)].push_back({v, state_[v]});
    }
    news_.clear();
    for (const Received<News>& received : send_typed(transport_, std::move(rows)))
      for (const News& news : received.items) hear(received.rank, news);
    std::erase_if(open_, [this](index_t v) { return state_[v] != State::undecided; });
  }

  void hear(int rank, const News& news) {
    const std::array<index_t, 2> home{static_cast<index_t>(rank), news.index};
    const auto at = std::lower_bound(pool_.home.begin(), pool_.home.end(), home);
    const auto v = static_cast<index_t>(pool_.n_own + static_cast<std::size_t>(at - pool_.home.begin()));
    if (state_[v] == State::undecided && news.state == State::taken) taken_.add(v);
    state_[v] = news.state;
  }

  const Tr& transport_;
  const CandidatePool& pool_;
  const ImplicitIncompatibilityGraph& graph_;
  Occupancy<ImplicitIncompatibilityGraph> taken_;
  std::vector<State> state_;
  std::vector<index_t> open_, news_;
  std::size_t n_rounds_ = 0;
};

}  // namespace framehex::detail
