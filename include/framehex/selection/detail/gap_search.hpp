// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/selection/detail/clique_separation.hpp"
#include "framehex/selection/detail/deadline.hpp"
#include "framehex/selection/detail/iterated_search.hpp"
#include "framehex/selection/detail/lp_bound.hpp"
#include "framehex/selection/detail/subgraph.hpp"

namespace framehex::detail {

/// A relaxation over cliques to begin with, which hold most conflicts that bind: two random partitions of the candidates.
template <class Stop>
LpBound first_relaxation(const IncompatibilityGraph& graph, Stop&& stop) {
  return LpBound(cover_by_partitions(graph, 2, stop), graph.weights_in_units());
}

/// The same over the candidates of each tetrahedron, which the candidates' own lists are lent for.
template <class Stop>
LpBound first_relaxation(const ImplicitIncompatibilityGraph& graph, Stop&&) {
  const Csr<index_t>& tets = graph.candidates().tets;
  return LpBound({transpose(tets, graph.n_tets()), {}}, graph.weights_in_units(), {}, {}, &tets);
}

/// Lowers the bound of a large graph, and raises its selection where the two do not agree, until the gap asked for is
/// proven.
///
/// The relaxation starts with few cliques. The cliques that it overfills are looked for in the graph of those
/// candidates alone that its prices hold back by next to nothing: 5 to 15 % of the candidates of a mesh, which hold one
/// or two per cent of the conflicts. The same graph serves the local search.
///
/// @par Determinism  Does not depend on the executor.
template <ConflictSource G, Executor E>
class GapSearch {
public:
  GapSearch(const G& graph, const E& executor, std::uint64_t seed, Deadline& deadline)
      : graph_(graph),
        executor_(executor),
        seed_(seed),
        deadline_(deadline),
        relaxation_(first_relaxation(graph, [&] { return deadline.passed(); })) {}

  /// @param members  a maximal selection; becomes a heavier one.
  /// @param gap      share of the bound that may be missing.
  void run(std::vector<index_t>& members, double gap, std::size_t max_rounds) {
    std::int64_t weight = weight_in_units(graph_, members);
    const auto proven = [&] {
      return static_cast<double>(relaxation_.bound() - weight) <= gap * static_cast<double>(relaxation_.bound());
    };
    relax(n_first_iterations);
    for (std::size_t round = 0; round < max_rounds && !proven() && !deadline_.passed(); ++round) {
      deadline_.set_fraction(static_cast<double>(round) / static_cast<double>(max_rounds));
      const std::vector<float> reduced = relaxation_.reduced_weights();
      const std::vector<index_t> kept = nearly_free(reduced, members);
      const IncompatibilityGraph part = induced_subgraph(graph_, kept, executor_);
      if (deadline_.passed()) break;
      const auto primal = gather(relaxation_.primal(), kept);
      if (round % rounds_per_search == rounds_per_search - 1) {
        search(part, primal, kept, members);
        weight = weight_in_units(graph_, members);
      }
      add_cliques(part, primal, gather(std::span<const float>(reduced), kept), kept);
      relax(n_iterations_a_round);
    }
  }

  std::int64_t bound_in_units() const { return relaxation_.bound(); }
  std::size_t iterations() const { return n_iterations_ + relaxation_.iterations(); }

private:
  static constexpr std::size_t n_first_iterations = 20, n_iterations_a_round = 15, rounds_per_search = 4;
  /// Of the largest weight. More makes the graphs larger and the cliques in them hardly better.
  static constexpr float held_back = 0.02F;

  void relax(std::size_t n) { relaxation_.iterate(n, executor_); }

  /// The members, and whom the prices hold back by next to nothing; ascending.
  std::vector<index_t> nearly_free(std::span<const float> reduced, std::span<const index_t> members) const {
    std::vector<index_t> kept;
    auto member = members.begin();
    for (index_t v = 0; v < graph_.size(); ++v) {
      const bool is_member = member != members.end() && *member == v;
      member += is_member;
      if (is_member || reduced[v] > -held_back || relaxation_.primal()[v] > 0.002F) kept.push_back(v);
    }
    return kept;
  }

  static std::vector<float> gather(std::span<const float> values, std::span<const index_t> kept) {
    std::vector<float> result;
    result.reserve(kept.size());
    for (const index_t v : kept) result.push_back(values[v]);
    return result;
  }

  void add_cliques(const IncompatibilityGraph& part, std::span<const float> primal, std::span<const float> reduced,
                   std::span<const index_t> kept) {
    Csr<index_t> cliques = CliqueSeparator(part).separate(primal, reduced, CliqueSeparator::Effort::quick);
    for (index_t& v : cliques.values) v = kept[v];
    relaxation_.add_cliques(cliques);
  }

  /// Rounds the relaxation, and forces in and out what it has its doubts about.
  void search(const IncompatibilityGraph& part, std::span<const float> primal, std::span<const index_t> kept,
              std::vector<index_t>& members) {
    std::vector<index_t> start;
    for (const index_t v : members)
      start.push_back(static_cast<index_t>(std::lower_bound(kept.begin(), kept.end(), v) - kept.begin()));
    IteratedSearch<IncompatibilityGraph> search(part, start, seed_);
    search.offer(round_relaxation(part, primal));
    const std::vector<index_t> places = doubtful(search, primal);
    search.perturb(places, places.size(), [this] { return deadline_.passed(); });
    n_iterations_ += search.iterations();
    members.clear();
    for (const index_t v : search.members()) members.push_back(kept[v]);
    complete(graph_, members);
  }

  const G& graph_;
  const E& executor_;
  std::uint64_t seed_;
  Deadline& deadline_;
  LpBound relaxation_;
  std::size_t n_iterations_ = 0;
};

}  // namespace framehex::detail
