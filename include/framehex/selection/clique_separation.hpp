// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/selection/bitset_search.hpp"
#include "framehex/selection/clique_cover.hpp"

#include <set>

namespace framehex::detail {

/// Finds cliques that a relaxed selection overfills, and so lowers the bound of the relaxation.
///
/// At each candidate in doubt, the heaviest clique among its neighbours that are used at all is found exactly, as an
/// independent set of the small complement, then extended to a maximal clique.
class CliqueSeparator {
public:
  explicit CliqueSeparator(const IncompatibilityGraph& graph) : graph_(graph), local_(graph.size(), no_index) {}

  /// @param primal       relaxed selection.
  /// @param least_excess a clique is worth adding when its sum is above 1 by this.
  /// @return maximal cliques, each once.
  Csr<index_t> separate(std::span<const float> primal, double least_excess = 0.01) {
    Csr<index_t> found;
    std::set<std::vector<index_t>> known;
    for (index_t v = 0; v < graph_.size(); ++v) {
      if (primal[v] < 0.02F || primal[v] > 0.98F) continue;
      if (!find_heaviest(v, primal, least_excess)) continue;
      extend();
      std::sort(clique_.begin(), clique_.end());
      if (!known.insert(clique_).second) continue;
      found.values.insert(found.values.end(), clique_.begin(), clique_.end());
      found.end_row();
    }
    return found;
  }

private:
  static constexpr double scale = 1e6;

  bool find_heaviest(index_t centre, std::span<const float> primal, double least_excess) {
    used_.clear();
    shares_.clear();
    for (const index_t u : graph_.neighbours(centre))
      if (primal[u] > 0.002F) {
        local_[u] = static_cast<index_t>(used_.size());
        used_.push_back(u);
        shares_.push_back(static_cast<std::int64_t>(scale * static_cast<double>(primal[u])));
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

  /// Adds common neighbours, those first that keep the most others possible.
  void extend() {
    const auto first = graph_.neighbours(clique_[0]);
    common_.assign(first.begin(), first.end());
    for (std::size_t i = 1; i < clique_.size(); ++i) keep_neighbours_of(clique_[i]);
    while (!common_.empty()) {
      index_t best = no_index;
      std::size_t best_count = 0;
      for (const index_t u : common_) {
        const std::size_t n = count_common(u);
        if (best == no_index || n > best_count) best = u, best_count = n;
      }
      clique_.push_back(best);
      keep_neighbours_of(best);
    }
  }

  void keep_neighbours_of(index_t v) {
    std::erase_if(common_, [&](index_t u) { return !graph_.adjacent(v, u); });
  }
  std::size_t count_common(index_t v) const {
    return static_cast<std::size_t>(
        std::count_if(common_.begin(), common_.end(), [&](index_t u) { return graph_.adjacent(v, u); }));
  }

  const IncompatibilityGraph& graph_;
  BitsetSearch search_;
  std::vector<index_t> local_, used_, clique_, common_;
  std::vector<std::int64_t> shares_;
  std::vector<std::uint8_t> adjacent_;
};

}  // namespace framehex::detail
