// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/selection/detail/contender_search.hpp"
#include "framehex/selection/detail/relaxation_search.hpp"

namespace framehex {

enum class SelectMethod {
  greedy,  ///< the paper's: by falling weight; ends at once, with a rough bound
  best,    ///< until the gap asked for is proven (small graphs: until optimal) or the budget is spent
  exact    ///< until optimal or the budget is spent
};

struct SelectOptions {
  SelectMethod method = SelectMethod::best;
  /// Proven gap at which `best` ends, 0 to 1.
  double gap = 0.005;
  /// Wall time after which the best so far is returned; results then depend on the machine. Not negative.
  double seconds = std::numeric_limits<double>::infinity();
  /// Rounds of 50 iterations of the bound, each with a share of local search: the budget that repeats.
  std::size_t max_rounds = 60;
  /// How often the bound may pass over a member of a clique, for each conflict of the graph and a million at least: a
  /// budget that repeats too, and follows the size of the job. Not for what is to be proven optimal.
  double max_passes = std::numeric_limits<double>::infinity();
  /// Nodes of the tree search, in `best` and `exact`.
  std::size_t max_nodes = 2000;
  /// `best` goes on to the proven optimum up to this many candidates.
  std::size_t exact_below = 10000;
  std::uint64_t seed = 1;
  /// Stage "selection".
  Observer observer = {};
};

namespace detail {

/// A selection and a bound, in units.
struct Draft {
  std::vector<index_t> members;
  std::int64_t weight = 0, bound = 0;
  std::size_t iterations = 0;
};

/// Bound and selection drawn together, on a graph in canonical order.
template <Executor E>
class Selector {
public:
  Selector(const IncompatibilityGraph& graph, const SelectOptions& options, const E& executor, Deadline& deadline)
      : graph_(graph), options_(options), executor_(executor), deadline_(deadline) {}

  void improve(Draft& draft) {
    IteratedSearch search(graph_, draft.members, options_.seed);
    draft.bound = std::min(draft.bound, tighten(search));
    draft.members = search.members();
    draft.weight = search.weight_in_units();
    draft.iterations += n_iterations_ + search.iterations();
  }

private:
  bool proof_wanted() const { return options_.method == SelectMethod::exact || graph_.size() <= options_.exact_below; }

  /// Bound at which to end, in units.
  std::int64_t goal(std::int64_t weight) const {
    if (proof_wanted()) return weight;
    return static_cast<std::int64_t>(std::floor(static_cast<double>(weight) / (1 - std::min(options_.gap, 0.999999))));
  }

  /// 50 iterations of the bound, fewer when the goal is reached.
  void relax(LpBound& relaxation, CliqueSeparator& separator, std::int64_t goal) {
    for (int i = 0; i < 2; ++i) {
      for (int j = 0; j < 5; ++j) {
        if (relaxation.bound() <= goal || deadline_.passed()) return;
        relaxation.iterate(5, executor_);
        n_iterations_ += 5;
        n_passes_ += 5 * static_cast<double>(relaxation.cover().cliques.values.size());
      }
      if (!proof_wanted() && relaxation.bound() > goal)
        relaxation.add_cliques(separator.separate(relaxation, CliqueSeparator::Effort::quick));
    }
  }

  /// @return the bound.
  std::int64_t tighten(IteratedSearch& search) {
    // The tree search needs every conflict in a clique; a large graph is better off with those that matter.
    const auto stop = [this] { return deadline_.passed(); };
    LpBound relaxation(proof_wanted() ? cover_by_cliques(graph_, stop) : cover_by_partitions(graph_, 6, stop),
                       graph_.weights_in_units());
    CliqueSeparator separator(graph_);
    const double max_passes = options_.max_passes * std::max(1e6, static_cast<double>(graph_.n_conflicts()));
    const auto work_left = [&] { return proof_wanted() || n_passes_ < max_passes; };
    for (std::size_t round = 0; round < options_.max_rounds && work_left(); ++round) {
      const std::int64_t before = relaxation.bound();
      relax(relaxation, separator, goal(search.weight_in_units()));
      deadline_.set_fraction(static_cast<double>(round) / static_cast<double>(options_.max_rounds));
      search.offer(round_relaxation(graph_, relaxation.primal()));
      if (relaxation.bound() <= goal(search.weight_in_units()) || deadline_.passed()) break;
      const std::vector<index_t> places = doubtful(search, relaxation.primal());
      search.perturb(places, places.size(), stop);
      if (relaxation.bound() <= goal(search.weight_in_units()) || deadline_.passed()) break;
      if (round < 3 || before - relaxation.bound() > (before - search.weight_in_units()) / 20) continue;
      const auto cliques = separator.separate(relaxation, CliqueSeparator::Effort::thorough);
      if (!cliques.empty())
        relaxation.add_cliques(cliques);
      else if (proof_wanted())
        break;
    }
    std::int64_t bound = relaxation.bound();
    if (!proof_wanted() || bound <= search.weight_in_units() || deadline_.passed()) return bound;
    RelaxationSearch tree(graph_, search.members(), {.max_nodes = options_.max_nodes}, deadline_);
    const bool complete = tree.run(std::move(relaxation));
    n_iterations_ += tree.iterations();
    search.offer(tree.members());
    return complete ? search.weight_in_units() : std::min(bound, tree.bound_in_units());
  }

  /// Where the selection and its relaxation do not agree.
  std::vector<index_t> doubtful(const IteratedSearch& search, std::span<const float> primal) const {
    std::vector<index_t> places;
    for (index_t v = 0; v < graph_.size(); ++v)
      if (search.contains(v) ? primal[v] < 0.9F : primal[v] > 0.1F) places.push_back(v);
    return places;
  }

  const IncompatibilityGraph& graph_;
  const SelectOptions& options_;
  const E& executor_;
  Deadline& deadline_;
  std::size_t n_iterations_ = 0;
  double n_passes_ = 0;
};

/// The first selection and a rough bound, without a pass over all conflicts more often than must be.
inline Draft first_draft(const IncompatibilityGraph& graph, std::span<const std::uint64_t> signature,
                         std::uint64_t seed, Deadline& deadline) {
  const auto key = [&](index_t v) { return signature[v]; };
  Draft draft;
  complete(graph, draft.members, key);
  draft.bound = partition_bound(graph, key);
  draft.weight = weight_in_units(graph, draft.members);
  // Where lattices do not meet, greedy is hard to beat.
  if (draft.weight >= draft.bound) return draft;
  ContenderSearch search(graph, signature, seed, deadline);
  draft.members = search.improve(std::move(draft.members));
  draft.weight = weight_in_units(graph, draft.members);
  draft.iterations = search.iterations();
  return draft;
}

/// The course of `select` for `best` and `exact`.
template <Executor E>
Draft draft_selection(const IncompatibilityGraph& graph, const SelectOptions& options, const E& executor,
                      Deadline& deadline) {
  // Ties are broken by what candidates look like, so that the caller's numbers do not matter.
  const std::vector<std::uint64_t> signature = signatures(graph, 3);
  Draft draft = first_draft(graph, signature, options.seed, deadline);
  if (draft.weight >= draft.bound || options.max_rounds == 0 || deadline.passed()) return draft;
  const std::vector<index_t> order = canonical_order(graph, signature);
  const IncompatibilityGraph renumbered = renumber(graph, order, [&] { return deadline.passed(); });
  if (deadline.passed()) return draft;
  std::vector<index_t> number(order.size());
  for (std::size_t i = 0; i < order.size(); ++i) number[order[i]] = static_cast<index_t>(i);
  for (index_t& v : draft.members) v = number[v];
  Selector<E>(renumbered, options, executor, deadline).improve(draft);
  for (index_t& v : draft.members) v = order[v];
  std::sort(draft.members.begin(), draft.members.end());
  return draft;
}

}  // namespace detail

/// Selects candidates that can stand in one mesh, of the largest weight that the budget allows, and proves how far from
/// the best the selection can be.
///
/// @param graph     n candidates and their conflicts.
/// @param options   see SelectOptions. A budget of 0 gives a maximal selection at once.
/// @param executor  runs the iterations of the bound.
/// @return members, ascending, independent and maximal whatever the status; weight, bound, gap, iterations.
/// @throws invalid_option  when the gap is not in [0, 1] or the time is negative.
/// @par Complexity   `greedy` O(n log n + conflicts). `best` two to four microseconds a candidate for the first
///                   selection, then some fifty for a gap of half a percent; memory as the graph again.
/// @par Determinism  The same for any executor and run, unless the time or the observer ends it. `best` and `exact` do
///                   not depend on the numbers of the candidates either, but where candidates look alike (weight and
///                   surroundings); `greedy` takes equal weights by number.
/// @par Source       Paper, section 2.2, for greedy. Departs: a relaxation bounds what greedy loses, and local search
///                   and branch and bound win it back.
template <Executor E = SerialExecutor>
Selection select(const IncompatibilityGraph& graph, const SelectOptions& options = {}, const E& executor = {}) {
  if (!(options.gap >= 0 && options.gap <= 1)) throw invalid_option("the gap of a selection must lie in [0, 1]");
  if (!(options.seconds >= 0)) throw invalid_option("the seconds for a selection must not be negative");
  detail::Deadline deadline(options.seconds, options.observer);
  detail::Draft draft;
  draft.members = select_greedily(graph);
  draft.weight = detail::weight_in_units(graph, draft.members);
  if (options.method == SelectMethod::greedy) {
    draft.bound = partition_bound(graph);
  } else {
    detail::Draft searched = detail::draft_selection(graph, options, executor, deadline);
    // A search that its budget ends at once may be behind greedy where equal weights go by number.
    if (searched.weight < draft.weight) searched.members = std::move(draft.members), searched.weight = draft.weight;
    draft = std::move(searched);
  }
  Selection selection;
  selection.weight = detail::from_units(graph, draft.weight);
  selection.bound = detail::from_units(graph, std::max(draft.bound, draft.weight));
  selection.members = std::move(draft.members);
  selection.iterations = draft.iterations;
  if (draft.weight >= draft.bound)
    selection.status = SelectionStatus::optimal;
  else if (deadline.cancelled())
    selection.status = SelectionStatus::cancelled;
  else if (options.method == SelectMethod::best && selection.gap() <= options.gap)
    selection.status = SelectionStatus::gap_reached;
  return selection;
}

}  // namespace framehex
