// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/selection/detail/canonical_order.hpp"
#include "framehex/selection/detail/deadline.hpp"
#include "framehex/selection/detail/iterated_search.hpp"
#include "framehex/selection/detail/subgraph.hpp"
#include "framehex/selection/greedy.hpp"

namespace framehex::detail {

/// The members of a selection, and the candidates that can compete with it: those that weigh at least `share` of the
/// members that they would put out.
///
/// @return ascending.
/// @par Complexity  O(n + degrees of the members).
inline std::vector<index_t> contenders(const IncompatibilityGraph& graph, std::span<const index_t> members,
                                       double share) {
  const auto weights = graph.weights_in_units();
  std::vector<std::int64_t> blocking(graph.size(), 0);
  for (const index_t v : members)
    for (const index_t u : graph.neighbours(v)) blocking[u] += weights[v];
  std::vector<index_t> result;
  for (index_t v = 0; v < graph.size(); ++v)
    if (static_cast<double>(weights[v]) >= share * static_cast<double>(blocking[v])) result.push_back(v);
  return result;
}

/// Local search where it matters, without touching most of the graph.
///
/// On graphs of potential hexahedra the contenders of a greedy selection are 5 to 20 % of the candidates and hold 1 %
/// of the conflicts. On the graph of these alone, dynamic greedy, local search and exact windows win back most of what
/// greedy loses in a fraction of the time that one pass over all conflicts takes.
///
/// @par Determinism  Serial, from the seed; does not depend on the numbers of the candidates, unless signatures are
///                   equal.
class ContenderSearch {
public:
  /// @param signature  of each candidate, see `signatures`.
  ContenderSearch(const IncompatibilityGraph& graph, std::span<const std::uint64_t> signature, std::uint64_t seed,
                  Deadline& deadline)
      : graph_(graph), signature_(signature), seed_(seed), deadline_(deadline) {}

  /// @param members  independent.
  /// @return at least as heavy, maximal, ascending.
  std::vector<index_t> improve(std::vector<index_t> members) {
    constexpr int n_rounds = 3;
    for (int round = 0; round < n_rounds && !deadline_.passed(); ++round) {
      const std::int64_t before = weight_in_units(graph_, members);
      members = search_among(contenders(graph_, members, least_share), members);
      complete(graph_, members, [&](index_t v) { return signature_[v]; });
      if (weight_in_units(graph_, members) == before) break;
    }
    return members;
  }

  /// Steps of all searches.
  std::size_t iterations() const { return n_iterations_; }

private:
  /// Less brings more contenders than the search has time for, more leaves out those that pairs and triples are made
  /// of.
  static constexpr double least_share = 0.2;

  /// @param allowed  holds `members`; both ascending.
  std::vector<index_t> search_among(const std::vector<index_t>& allowed, const std::vector<index_t>& members) {
    const IncompatibilityGraph part = induced_subgraph(graph_, allowed);
    std::vector<std::uint64_t> signature;
    std::vector<index_t> number(part.size()), start;
    for (const index_t v : allowed) signature.push_back(signature_[v]);
    const std::vector<index_t> order = canonical_order(part, signature);
    for (std::size_t i = 0; i < order.size(); ++i) number[order[i]] = static_cast<index_t>(i);
    for (const index_t v : members)
      start.push_back(
          number[static_cast<std::size_t>(std::lower_bound(allowed.begin(), allowed.end(), v) - allowed.begin())]);
    const IncompatibilityGraph renumbered = renumber(part, order, [] { return false; });

    IteratedSearch search(renumbered, start, seed_);
    const auto stop = [this] { return deadline_.passed(); };
    search.offer(select_dynamically(renumbered, stop));
    std::vector<index_t> places(renumbered.size());
    std::iota(places.begin(), places.end(), index_t{0});
    search.perturb(places, places.size() / 2, stop);
    search.solve_windows(40, 500, stop);
    search.perturb(places, places.size() / 2, stop);
    n_iterations_ += search.iterations();
    std::vector<index_t> result;
    for (const index_t v : search.members()) result.push_back(allowed[order[v]]);
    return result;
  }

  const IncompatibilityGraph& graph_;
  std::span<const std::uint64_t> signature_;
  std::uint64_t seed_;
  Deadline& deadline_;
  std::size_t n_iterations_ = 0;
};

}  // namespace framehex::detail
