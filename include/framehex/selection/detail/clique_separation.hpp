// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/selection/detail/bitset_search.hpp"
#include "framehex/selection/detail/clique_cover.hpp"

#include <set>

namespace framehex::detail {

/// Finds cliques that a relaxed selection overfills, and so lowers the bound of the relaxation.
///
/// Through each candidate in doubt a clique is grown over the candidates that the relaxation uses, largest share first;
/// when that is heavy enough it is extended to a maximal one by those that the prices hold back least, since the price
/// of the clique is to hold back as many as possible. `thorough` finds the heaviest clique at each candidate exactly,
/// as an independent set of the small complement.
class CliqueSeparator {
public:
  /// @param graph  must outlive this.
  explicit CliqueSeparator(const IncompatibilityGraph& graph)
      : graph_(graph), grower_(graph), local_(graph.size(), no_index) {}

  enum class Effort { quick, thorough };

  /// @param primal        relaxed selection, by candidate.
  /// @param reduced       weights less the prices of the cliques, by candidate.
  /// @param least_excess  a clique is worth adding when its sum is above 1 by this.
  /// @return maximal cliques, each once.
  /// @par Complexity  `quick` O(s d) for s shares in doubt and the mean degree d.
  Csr<index_t> separate(std::span<const float> primal, std::span<const float> reduced, Effort effort,
                        double least_excess = 0.01) {
    Csr<index_t> found;
    std::set<std::vector<index_t>> known;
    n_found_.assign(graph_.size(), 0);
    for (const index_t v : by_falling_share(primal, effort)) {
      if (effort == Effort::quick && n_found_[v] == enough) continue;
      collect_used(v, primal);
      const bool heavy =
          effort == Effort::quick ? grow(v, primal, least_excess) : find_heaviest(v, primal, least_excess);
      if (!heavy) continue;
      for (const index_t u : clique_) ++n_found_[u];
      grower_.extend(clique_, [&](index_t u) { return reduced[u]; });
      std::sort(clique_.begin(), clique_.end());
      if (!known.insert(clique_).second) continue;
      found.values.insert(found.values.end(), clique_.begin(), clique_.end());
      found.end_row();
    }
    return found;
  }

private:
  static constexpr double scale = 1e6;
  /// Cliques through one candidate in one quick pass.
  static constexpr index_t enough = 2;

  static bool larger_share(std::span<const float> primal, index_t u, index_t v) {
    return primal[u] != primal[v] ? primal[u] > primal[v] : u < v;
  }

  std::vector<index_t> by_falling_share(std::span<const float> primal, Effort effort) const {
    // A whole candidate overfills no clique by much, once the relaxation has settled.
    const float most = effort == Effort::quick ? 1.0F : 0.98F;
    std::vector<index_t> order;
    for (index_t v = 0; v < graph_.size(); ++v)
      if (primal[v] >= 0.02F && primal[v] <= most) order.push_back(v);
    std::sort(order.begin(), order.end(), [&](index_t u, index_t v) { return larger_share(primal, u, v); });
    return order;
  }

  void collect_used(index_t centre, std::span<const float> primal) {
    used_.clear();
    for (const index_t u : graph_.neighbours(centre))
      if (primal[u] > 0.002F) used_.push_back(u);
  }

  bool grow(index_t centre, std::span<const float> primal, double least_excess) {
    std::sort(used_.begin(), used_.end(), [&](index_t u, index_t v) { return larger_share(primal, u, v); });
    clique_.assign(1, centre);
    double sum = static_cast<double>(primal[centre]);
    for (const index_t u : used_) {
      if (!std::all_of(clique_.begin() + 1, clique_.end(), [&](index_t w) { return graph_.adjacent(w, u); })) continue;
      clique_.push_back(u);
      sum += static_cast<double>(primal[u]);
    }
    return sum > 1 + least_excess;
  }

  bool find_heaviest(index_t centre, std::span<const float> primal, double least_excess) {
    shares_.clear();
    for (std::size_t i = 0; i < used_.size(); ++i) {
      local_[used_[i]] = static_cast<index_t>(i);
      shares_.push_back(static_cast<std::int64_t>(scale * static_cast<double>(primal[used_[i]])));
    }
    search_.assign(shares_);
    for (std::size_t i = 0; i < used_.size(); ++i) {
      adjacent_.assign(used_.size(), 0);
      for (const index_t u : graph_.neighbours(used_[i]))
        if (local_[u] != no_index) adjacent_[local_[u]] = 1;
      for (std::size_t j = 0; j < i; ++j)
        if (!adjacent_[j]) search_.add_conflict(i, j);
    }
    for (const index_t u : used_) local_[u] = no_index;
    const double rest = 1.0 + least_excess - static_cast<double>(primal[centre]);
    search_.solve(static_cast<std::int64_t>(scale * rest), 2000);
    clique_.assign(1, centre);
    for (const index_t i : search_.members()) clique_.push_back(used_[i]);
    return clique_.size() > 1;
  }

  const IncompatibilityGraph& graph_;
  CliqueGrower grower_;
  BitsetSearch search_;
  std::vector<index_t> local_, used_, clique_, n_found_;
  std::vector<std::int64_t> shares_;
  std::vector<std::uint8_t> adjacent_;
};

}  // namespace framehex::detail
