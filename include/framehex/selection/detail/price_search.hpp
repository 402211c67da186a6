// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/selection/detail/deadline.hpp"
#include "framehex/selection/detail/lp_bound.hpp"

namespace framehex::detail {

/// Exact search under the prices of a relaxation, for graphs whose proven gap is small.
///
/// Prices y on cliques that prove the bound B say what every selection loses against B: y_c for each clique of which it
/// holds no member, and |r_v| for each candidate that it takes although r_v = w_v - sum of its prices is negative, or
/// leaves although r_v is positive. A selection heavier than a known one loses less than the budget B - known. So a
/// candidate too dear for the rest of the budget is out, a clique too dear to be left empty must hold one of its
/// members, and what remains is a search with much propagation, as for exact covers.
class PriceSearch {
public:
  enum class Fate : std::uint8_t { open, in, out };

  /// @param known  weight in units; only heavier selections are looked for.
  PriceSearch(const IncompatibilityGraph& graph, const CliqueCover& cover, const LpBound::Prices& prices,
              std::int64_t known)
      : graph_(graph), cover_(cover), prices_(prices.of_clique), bits_(prices.bits), total_(prices.total) {
    const auto weights = graph.weights_in_units();
    rest_.resize(graph.size());
    for (index_t v = 0; v < graph.size(); ++v) {
      rest_[v] = weights[v] * (std::int64_t{1} << bits_);
      for (const index_t c : cover.cliques_of_vertex[v]) rest_[v] -= prices_[c];
    }
    fate_.assign(graph.size(), Fate::open);
    filled_.assign(cover.size(), 0);
    n_open_.resize(cover.size());
    for (std::size_t c = 0; c < cover.size(); ++c) n_open_[c] = static_cast<index_t>(cover.cliques[c].size());
    budget_ = total_ - known * (std::int64_t{1} << bits_);
  }

  enum class Effort { cheap, probing };

  /// Settles the candidates that the budget decides; `probing` also tries each of the open ones, in and out.
  /// @return false when no heavier selection exists.
  bool settle(Effort effort, Deadline& deadline) {
    for (index_t v = 0; v < graph_.size(); ++v) {
      if (fate_[v] != Fate::open) continue;
      if (-rest_[v] >= budget_ - loss_)
        discard(v);
      else if (rest_[v] >= budget_ - loss_)
        take(v);
    }
    if (!propagate()) return false;
    if (effort == Effort::probing)
      for (index_t v = 0; v < graph_.size() && !deadline.passed(); ++v)
        if (fate_[v] == Fate::open && !probe(v)) return false;
    trail_.clear();
    return true;
  }

  Fate fate(index_t v) const { return fate_[v]; }

  /// Completes the search. @return true when it ended before the limit: `members()` is then the heaviest selection
  /// that is heavier than the known one, or empty when there is none.
  bool run(std::size_t max_nodes, Deadline& deadline) {
    deadline_ = &deadline;
    n_nodes_ = 0;
    max_nodes_ = max_nodes;
    stopped_ = false;
    live_.clear();
    for (std::size_t c = 0; c < cover_.size(); ++c)
      if (!filled_[c] && n_open_[c] > 0) live_.push_back(static_cast<index_t>(c));
    if (loss_ < budget_) expand();
    return !stopped_;
  }

  bool found() const { return found_; }
  const std::vector<index_t>& members() const { return best_; }
  std::size_t n_nodes() const { return n_nodes_; }

private:
  void discard(index_t v) {
    fate_[v] = Fate::out;
    trail_.push_back(v);
    if (rest_[v] > 0) loss_ += rest_[v];
    for (const index_t c : cover_.cliques_of_vertex[v]) {
      --n_open_[c];
      if (filled_[c]) continue;
      if (n_open_[c] == 0) loss_ += prices_[c];
      if (n_open_[c] == 1) last_chance_.push_back(c);
    }
  }

  void take(index_t v) {
    fate_[v] = Fate::in;
    trail_.push_back(v);
    if (rest_[v] < 0) loss_ -= rest_[v];
    for (const index_t c : cover_.cliques_of_vertex[v]) filled_[c] = 1;
    for (const index_t u : graph_.neighbours(v))
      if (fate_[u] == Fate::open) discard(u);
  }

  /// Takes the last open member of each clique that the budget cannot leave empty.
  bool propagate() {
    while (!last_chance_.empty() && loss_ < budget_) {
      const index_t c = last_chance_.back();
      last_chance_.pop_back();
      if (filled_[c] || n_open_[c] != 1 || loss_ + prices_[c] < budget_) continue;
      for (const index_t v : cover_.cliques[c])
        if (fate_[v] == Fate::open) {
          take(v);
          break;
        }
    }
    last_chance_.clear();
    return loss_ < budget_;
  }

  void undo(std::size_t mark, std::int64_t loss) {
    while (trail_.size() > mark) {
      const index_t v = trail_.back();
      trail_.pop_back();
      // A taken candidate was logged before those that it put out, so its cliques are emptied again after theirs.
      if (fate_[v] == Fate::out)
        for (const index_t c : cover_.cliques_of_vertex[v]) ++n_open_[c];
      else
        for (const index_t c : cover_.cliques_of_vertex[v]) filled_[c] = 0;
      fate_[v] = Fate::open;
    }
    loss_ = loss;
    last_chance_.clear();
  }

  bool probe(index_t v) {
    const std::size_t mark = trail_.size();
    const std::int64_t loss = loss_;
    take(v);
    const bool can_be_in = propagate();
    undo(mark, loss);
    if (!can_be_in) {
      discard(v);
      return propagate();
    }
    discard(v);
    const bool can_be_out = propagate();
    undo(mark, loss);
    if (can_be_out) return true;
    take(v);
    return propagate();
  }

  /// The clique that is dearest to leave empty for the number of its open members.
  index_t choose_clique() const {
    index_t best = no_index;
    double best_score = -1;
    for (const index_t c : live_) {
      if (filled_[c] || n_open_[c] == 0) continue;
      const double score = (static_cast<double>(prices_[c]) + 1e-3) / static_cast<double>(n_open_[c]);
      if (score > best_score) best_score = score, best = c;
    }
    return best;
  }

  void expand() {
    if (++n_nodes_ > max_nodes_ || deadline_->passed()) {
      stopped_ = true;
      return;
    }
    const index_t clique = choose_clique();
    if (clique == no_index) {
      // What is still open is in no clique, hence without conflicts, and counted as taken.
      budget_ = loss_;
      found_ = true;
      best_.clear();
      for (index_t v = 0; v < graph_.size(); ++v)
        if (fate_[v] != Fate::out) best_.push_back(v);
      return;
    }
    const std::size_t first = stack_.size();
    for (const index_t v : cover_.cliques[clique])
      if (fate_[v] == Fate::open) stack_.push_back(v);
    std::stable_sort(stack_.begin() + static_cast<std::ptrdiff_t>(first), stack_.end(),
                     [&](index_t u, index_t v) { return rest_[u] > rest_[v]; });
    const std::size_t last = stack_.size(), mark = trail_.size();
    const std::int64_t loss = loss_;
    for (std::size_t i = first; i < last && !stopped_ && loss_ < budget_; ++i) {
      const index_t v = stack_[i];
      if (fate_[v] != Fate::open) continue;
      const std::size_t inner_mark = trail_.size();
      const std::int64_t inner_loss = loss_;
      take(v);
      if (propagate()) expand();
      undo(inner_mark, inner_loss);
      discard(v);
    }
    if (!stopped_ && propagate()) expand();
    undo(mark, loss);
    stack_.resize(first);
  }

  const IncompatibilityGraph& graph_;
  const CliqueCover& cover_;
  std::span<const std::int64_t> prices_;
  int bits_;
  std::int64_t total_, budget_ = 0, loss_ = 0;
  std::vector<std::int64_t> rest_;
  std::vector<Fate> fate_;
  std::vector<std::uint8_t> filled_;
  std::vector<index_t> n_open_, live_, trail_, last_chance_, stack_, best_;
  Deadline* deadline_ = nullptr;
  std::size_t n_nodes_ = 0, max_nodes_ = 0;
  bool stopped_ = false, found_ = false;
};

}  // namespace framehex::detail
