// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/config.hpp"
#include "framehex/selection/detail/deadline.hpp"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <span>
#include <vector>

namespace framehex::detail {

/// Exact search for the heaviest independent set of a small dense graph, kept as a bit matrix.
///
/// Branch and bound. The bound splits the weights of the open vertices over greedily grown cliques; the vertices whose
/// weight is used up before the cliques cost more than what is missing to the best set need no branch. Where Tomita's
/// pivot (a vertex of which, or of whose neighbours, any maximal set holds one) leaves fewer branches, it is taken
/// instead. Reusable: `assign` keeps the memory.
class BitsetSearch {
public:
  enum class Outcome { complete, limit };

  /// @param n  number of vertices; conflicts are added after.
  void assign(std::span<const std::int64_t> weights) {
    n_ = weights.size();
    n_words_ = (n_ + 63) / 64;
    weights_.assign(weights.begin(), weights.end());
    adjacency_.assign(n_ * n_words_, 0);
    best_.clear();
    n_nodes_ = 0;
  }

  void add_conflict(std::size_t u, std::size_t v) {
    set(row(u), v);
    set(row(v), u);
  }

  /// Looks for a set heavier than `floor`.
  /// @return `limit` when the limit of nodes or the deadline came first: what `members` holds is then not proven.
  Outcome solve(std::int64_t floor, std::size_t max_nodes, Deadline* deadline = nullptr) {
    deadline_ = deadline;
    best_weight_ = floor;
    max_nodes_ = max_nodes;
    stopped_ = false;
    if (levels_.empty()) levels_.resize(1);
    levels_[0].open.assign(n_words_, 0);
    for (std::size_t v = 0; v < n_; ++v) set(levels_[0].open.data(), v);
    chosen_.clear();
    expand(0, 0);
    return stopped_ ? Outcome::limit : Outcome::complete;
  }

  /// Heaviest set found, of local numbers; empty when none is heavier than the floor.
  std::span<const index_t> members() const { return best_; }
  std::int64_t weight() const { return best_weight_; }
  std::size_t n_nodes() const { return n_nodes_; }

private:
  struct Level {
    std::vector<std::uint64_t> open, branch, rest;
    std::vector<std::int64_t> residual;
  };

  std::uint64_t* row(std::size_t v) { return adjacency_.data() + v * n_words_; }
  static void set(std::uint64_t* bits, std::size_t i) { bits[i / 64] |= std::uint64_t{1} << (i % 64); }
  static void clear(std::uint64_t* bits, std::size_t i) { bits[i / 64] &= ~(std::uint64_t{1} << (i % 64)); }

  template <class Body>
  void for_each(const std::vector<std::uint64_t>& bits, Body&& body) const {
    for (std::size_t word = 0; word < n_words_; ++word)
      for (std::uint64_t rest = bits[word]; rest != 0; rest &= rest - 1)
        body(64 * word + static_cast<std::size_t>(std::countr_zero(rest)));
  }

  std::size_t count(const std::vector<std::uint64_t>& bits) const {
    std::size_t n = 0;
    for (std::size_t word = 0; word < n_words_; ++word) n += static_cast<std::size_t>(std::popcount(bits[word]));
    return n;
  }

  /// Leaves in `level.branch` the vertices of which one must be taken to gain more than `missing`.
  void choose_branches(Level& level, std::int64_t missing) {
    level.branch = level.open;
    level.residual.resize(n_);
    for_each(level.open, [&](std::size_t v) { level.residual[v] = weights_[v]; });
    std::int64_t cost = 0;
    level.rest.resize(n_words_);
    for (std::size_t word = 0; word < n_words_; ++word)
      while (level.branch[word] != 0) {
        const std::size_t first = 64 * word + static_cast<std::size_t>(std::countr_zero(level.branch[word]));
        std::int64_t least = level.residual[first];
        clique_.assign(1, static_cast<index_t>(first));
        for (std::size_t w = 0; w < n_words_; ++w) level.rest[w] = level.branch[w] & row(first)[w];
        for (std::size_t w = word; w < n_words_; ++w)
          while (level.rest[w] != 0) {
            const std::size_t next = 64 * w + static_cast<std::size_t>(std::countr_zero(level.rest[w]));
            clique_.push_back(static_cast<index_t>(next));
            least = std::min(least, level.residual[next]);
            for (std::size_t x = w; x < n_words_; ++x) level.rest[x] &= row(next)[x];
          }
        if (cost + least > missing) return;
        cost += least;
        for (const index_t v : clique_)
          if ((level.residual[v] -= least) == 0) clear(level.branch.data(), v);
      }
  }

  /// The smallest closed neighbourhood among the open vertices.
  void choose_pivot(Level& level) {
    const std::size_t n_branches = count(level.branch);
    std::size_t best = n_branches, pivot = n_;
    for_each(level.open, [&](std::size_t v) {
      std::size_t n = 1;
      for (std::size_t w = 0; w < n_words_; ++w)
        n += static_cast<std::size_t>(std::popcount(level.open[w] & row(v)[w]));
      if (n < best) best = n, pivot = v;
    });
    if (pivot == n_) return;
    for (std::size_t w = 0; w < n_words_; ++w) level.branch[w] = level.open[w] & row(pivot)[w];
    set(level.branch.data(), pivot);
  }

  void expand(std::size_t depth, std::int64_t weight) {
    if (++n_nodes_ > max_nodes_ || (deadline_ && n_nodes_ % 64 == 0 && deadline_->passed())) {
      stopped_ = true;
      return;
    }
    if (levels_.size() < depth + 2) levels_.resize(depth + 2);
    if (count(levels_[depth].open) == 0) {
      if (weight > best_weight_) {
        best_weight_ = weight;
        best_ = chosen_;
      }
      return;
    }
    choose_branches(levels_[depth], best_weight_ - weight);
    if (count(levels_[depth].branch) > 2) choose_pivot(levels_[depth]);
    const std::size_t first = order_stack_.size();
    for_each(levels_[depth].branch, [&](std::size_t v) { order_stack_.push_back(static_cast<index_t>(v)); });
    const std::size_t last = order_stack_.size();
    std::stable_sort(order_stack_.begin() + static_cast<std::ptrdiff_t>(first), order_stack_.end(),
                     [&](index_t u, index_t v) { return weights_[u] > weights_[v]; });
    for (std::size_t i = first; i < last && !stopped_; ++i) {
      const index_t v = order_stack_[i];
      Level &here = levels_[depth], &next = levels_[depth + 1];
      clear(here.open.data(), v);
      next.open.resize(n_words_);
      for (std::size_t w = 0; w < n_words_; ++w) next.open[w] = here.open[w] & ~row(v)[w];
      chosen_.push_back(v);
      expand(depth + 1, weight + weights_[v]);
      chosen_.pop_back();
    }
    order_stack_.resize(first);
  }

  std::size_t n_ = 0, n_words_ = 0;
  std::vector<std::int64_t> weights_;
  std::vector<std::uint64_t> adjacency_;
  std::vector<Level> levels_;
  std::vector<index_t> chosen_, best_, clique_, order_stack_;
  std::int64_t best_weight_ = 0;
  std::size_t n_nodes_ = 0, max_nodes_ = 0;
  Deadline* deadline_ = nullptr;
  bool stopped_ = false;
};

}  // namespace framehex::detail
