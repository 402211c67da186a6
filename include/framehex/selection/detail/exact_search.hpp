// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/selection/detail/relaxation_search.hpp"

namespace framehex::detail {

/// A selection and a bound, in units.
struct Draft {
  std::vector<index_t> members;
  std::int64_t weight = 0, bound = 0;
  std::size_t iterations = 0;
};

/// Brings selection and bound of one connected graph together, until they meet or a budget is spent: by a tree search
/// for up to some hundred candidates; else by local search and the relaxation over cliques that hold every conflict,
/// drawn together in rounds, and branch and bound on what remains.
///
/// @par Determinism  Does not depend on the executor.
template <Executor E>
class ExactSearch {
public:
  struct Limits {
    std::size_t max_rounds, max_nodes;
    double max_work;  ///< of the branch and bound, see `RelaxationSearch::Limits`
    std::uint64_t seed;
  };

  /// @param graph  in canonical order, for a result that does not depend on the caller's numbers.
  ExactSearch(const IncompatibilityGraph& graph, const Limits& limits, const E& executor, Deadline& deadline)
      : graph_(graph), limits_(limits), executor_(executor), deadline_(deadline) {}

  /// @param draft  a maximal selection of `graph`, its weight and a bound.
  void improve(Draft& draft) {
    if (graph_.size() <= n_at_once && solve_at_once(draft)) return;
    IteratedSearch search(graph_, draft.members, limits_.seed);
    draft.bound = std::min(draft.bound, tighten(search));
    draft.members = search.members();
    draft.weight = search.weight_in_units();
    draft.iterations += n_iterations_ + search.iterations();
  }

private:
  static constexpr std::size_t n_at_once = 128, max_nodes_at_once = 1000;

  bool solve_at_once(Draft& draft) {
    BitsetSearch search;
    search.assign(graph_.weights_in_units());
    for (index_t v = 0; v < graph_.size(); ++v)
      for (const index_t u : graph_.neighbours(v))
        if (u < v) search.add_conflict(u, v);
    const auto outcome = search.solve(draft.weight, max_nodes_at_once, &deadline_);
    draft.iterations += search.n_nodes();
    if (!search.members().empty()) {
      draft.members.assign(search.members().begin(), search.members().end());
      draft.weight = search.weight();
      complete(graph_, draft.members);
    }
    if (outcome != BitsetSearch::Outcome::complete) return false;
    draft.bound = draft.weight;
    return true;
  }

  bool ends(const LpBound& relaxation, const IteratedSearch<IncompatibilityGraph>& search) {
    return relaxation.bound() <= search.weight_in_units() || deadline_.passed();
  }

  /// @return the bound.
  std::int64_t tighten(IteratedSearch<IncompatibilityGraph>& search) {
    const auto stop = [this] { return deadline_.passed(); };
    LpBound relaxation(cover_by_cliques(graph_, stop), graph_.weights_in_units());
    CliqueSeparator separator(graph_);
    for (std::size_t round = 0; round < limits_.max_rounds; ++round) {
      const std::int64_t before = relaxation.bound();
      for (int i = 0; i < 10 && !ends(relaxation, search); ++i) {
        relaxation.iterate(5, executor_);
        n_iterations_ += 5;
      }
      deadline_.set_fraction(static_cast<double>(round) / static_cast<double>(limits_.max_rounds));
      search.offer(round_relaxation(graph_, relaxation.primal()));
      if (ends(relaxation, search)) break;
      const std::vector<index_t> places = doubtful(search, relaxation.primal());
      search.perturb(places, places.size(), stop);
      if (ends(relaxation, search)) break;
      if (round < 3 || before - relaxation.bound() > (before - search.weight_in_units()) / 20) continue;
      const auto cliques =
          separator.separate(relaxation.primal(), relaxation.reduced_weights(), CliqueSeparator::Effort::thorough);
      if (cliques.empty()) break;
      relaxation.add_cliques(cliques);
    }
    const std::int64_t bound = relaxation.bound();
    if (ends(relaxation, search)) return bound;
    RelaxationSearch tree(graph_, search.members(), {.max_nodes = limits_.max_nodes, .max_work = limits_.max_work},
                          deadline_);
    const bool complete = tree.run(std::move(relaxation));
    n_iterations_ += tree.iterations();
    search.offer(tree.members());
    return complete ? search.weight_in_units() : std::min(bound, tree.bound_in_units());
  }

  const IncompatibilityGraph& graph_;
  const Limits limits_;
  const E& executor_;
  Deadline& deadline_;
  std::size_t n_iterations_ = 0;
};

}  // namespace framehex::detail
