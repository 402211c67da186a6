// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/parts/detail/border_candidates.hpp"

namespace framehex::detail {

/// What is decided of the candidates of a pool; the copies follow what their ranks say.
template <Transport Tr>
class CandidateStates {
public:
  enum State : std::uint8_t { undecided, taken, refused };

  CandidateStates(const Tr& transport, const CandidatePool& pool)
      : transport_(transport), pool_(pool), state_(pool.size(), undecided) {}

  State operator[](index_t v) const { return state_[v]; }

  /// Copies have been added to the pool.
  void grow() { state_.resize(pool_.size(), undecided); }

  void set(index_t v, State state) {
    if (state_[v] == state) return;
    if (state_[v] == taken) gone_.push_back(v);
    state_[v] = state;
    if (v < pool_.n_own) news_.push_back(v);
  }

  /// Tells those who have copies what has changed of own candidates, and hears of others. Collective.
  /// @return the copies of which something was heard.
  std::vector<index_t> exchange() {
    std::vector<index_t> heard;
    if (transport_.n_ranks() == 1) {
      news_.clear();
      return heard;
    }
    std::sort(news_.begin(), news_.end());
    news_.erase(std::unique(news_.begin(), news_.end()), news_.end());
    Rows<News> rows = make_rows<News>(transport_);
    auto holder = pool_.holders.begin();
    for (const index_t v : news_) {
      while (holder != pool_.holders.end() && holder->index < v) ++holder;
      for (auto h = holder; h != pool_.holders.end() && h->index == v; ++h)
        rows[static_cast<std::size_t>(h->rank)].push_back({v, state_[v]});
    }
    news_.clear();
    for (const Received<News>& received : send_typed(transport_, std::move(rows)))
      for (const News& news : received.items) {
        const index_t v = pool_.copy_of(received.rank, news.index);
        if (state_[v] == taken && news.state != taken) gone_.push_back(v);
        state_[v] = news.state;
        heard.push_back(v);
      }
    return heard;
  }

  /// Makes those own candidates undecided that one may have kept out that was taken once and is no more.
  void reopen() {
    std::vector<std::uint8_t> freed(pool_.points.size(), 0);
    for (const index_t v : gone_)
      for (const index_t w : pool_.candidates.vertices[v]) freed[w] = 1;
    gone_.clear();
    for (index_t v = 0; v < pool_.n_own; ++v)
      if (state_[v] == refused &&
          std::ranges::any_of(pool_.candidates.vertices[v], [&](index_t w) { return freed[w] != 0; }))
        set(v, undecided);
  }

private:
  struct News {
    index_t index;
    State state;
  };

  const Tr& transport_;
  const CandidatePool& pool_;
  std::vector<State> state_;
  std::vector<index_t> news_, gone_;
};

}  // namespace framehex::detail
