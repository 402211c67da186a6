// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/selection/detail/contender_search.hpp"
#include "framehex/selection/detail/exact_search.hpp"
#include "framehex/selection/detail/gap_search.hpp"
#include "framehex/selection/select.hpp"

namespace framehex::detail {

/// Selection and bound of a graph.
template <Executor E>
class Selector {
public:
  Selector(const SelectOptions& options, const E& executor, Deadline& deadline)
      : options_(options), executor_(executor), deadline_(deadline) {}

  /// A few candidates are worth the rows of their conflicts, for a proof by all means.
  Draft run(const ImplicitIncompatibilityGraph& graph) {
    if (options_.method != SelectMethod::greedy && proof_wanted(graph.size())) {
      std::vector<index_t> all(graph.size());
      std::iota(all.begin(), all.end(), index_t{0});
      const IncompatibilityGraph rows = induced_subgraph(graph, all, executor_);
      if (!deadline_.passed()) return run(rows);
    }
    Draft draft = take_greedily(graph, by_number);
    if (options_.method != SelectMethod::greedy) search_contenders(graph, draft, by_number);
    close_gap(graph, draft);
    return draft;
  }

  Draft run(const IncompatibilityGraph& graph) {
    if (options_.method == SelectMethod::greedy) {
      Draft draft = take_greedily(graph, by_number);
      draft.bound = partition_bound(graph);
      return draft;
    }
    // Ties are broken by what candidates look like, so that the caller's numbers do not matter.
    const std::vector<std::uint64_t> signature = signatures(graph, 3);
    const auto key = [&](index_t v) { return signature[v]; };
    Draft draft = take_greedily(graph, key);
    draft.bound = partition_bound(graph, key);
    // Where lattices do not meet, greedy is hard to beat.
    if (draft.weight >= draft.bound) return draft;
    search_contenders(graph, draft, key);
    if (draft.weight < draft.bound && options_.max_rounds > 0 && !deadline_.passed())
      improve_components(graph, canonical_components(graph, signature), draft);
    return draft;
  }

private:
  bool proof_wanted(std::size_t n) const { return options_.method == SelectMethod::exact || n <= options_.exact_below; }

  template <ConflictSource G, class Key>
  Draft take_greedily(const G& graph, Key&& key) {
    Draft draft;
    complete(graph, draft.members, key, [this] { return deadline_.passed(); });
    draft.weight = weight_in_units(graph, draft.members);
    return draft;
  }

  template <ConflictSource G, class Key>
  void search_contenders(const G& graph, Draft& draft, Key&& key) {
    ContenderSearch search(graph, options_.seed, deadline_, executor_);
    draft.members = search.improve(std::move(draft.members), key);
    draft.weight = weight_in_units(graph, draft.members);
    draft.iterations += search.iterations();
  }

  template <ConflictSource G>
  void close_gap(const G& graph, Draft& draft) {
    GapSearch search(graph, executor_, options_.seed, deadline_);
    search.run(draft.members, options_.gap, options_.method == SelectMethod::greedy ? 0 : options_.max_rounds);
    draft.weight = weight_in_units(graph, draft.members);
    draft.bound = search.bound_in_units();
    draft.iterations += search.iterations();
  }

  /// Each component on its own: the tree search of one does not pay for the others, and their bounds add up.
  void improve_components(const IncompatibilityGraph& graph, const Csr<index_t>& parts, Draft& draft) {
    const std::vector<index_t> number = places_in_rows(parts);
    std::vector<std::uint8_t> chosen(graph.size(), 0);
    for (const index_t v : draft.members) chosen[v] = 1;
    const std::int64_t rough_bound = std::exchange(draft.bound, 0);
    draft.members.clear();
    draft.weight = 0;
    for (std::size_t i = 0; i < parts.size(); ++i) {
      const Draft part = improve_component(graph, parts[i], number, chosen);
      for (const index_t v : part.members) draft.members.push_back(parts[i][v]);
      draft.weight += part.weight;
      draft.bound += part.bound;
      draft.iterations += part.iterations;
    }
    draft.bound = std::min(draft.bound, rough_bound);
    std::sort(draft.members.begin(), draft.members.end());
  }

  /// In the component's own numbers.
  Draft improve_component(const IncompatibilityGraph& whole, std::span<const index_t> ids,
                          std::span<const index_t> number, std::span<const std::uint8_t> chosen) {
    const auto stop = [this] { return deadline_.passed(); };
    const IncompatibilityGraph graph = renumber(whole, ids, number, stop);
    Draft draft;
    for (index_t v = 0; v < ids.size(); ++v)
      if (chosen[ids[v]]) draft.members.push_back(v);
    draft.weight = weight_in_units(graph, draft.members);
    for (const std::int64_t w : graph.weights_in_units()) draft.bound += w;
    if (stop()) return draft;
    draft.bound = partition_bound(graph);
    if (draft.weight >= draft.bound) return draft;
    if (proof_wanted(graph.size()))
      ExactSearch<E>(graph, {options_.max_rounds, options_.max_nodes, max_work(), options_.seed}, executor_, deadline_)
          .improve(draft);
    else
      close_gap(graph, draft);
    return draft;
  }

  /// Some seconds for `best`: random conflicts of 150 candidates take a third of it, and what takes more hardly ends.
  double max_work() const {
    return options_.method == SelectMethod::exact ? std::numeric_limits<double>::infinity() : 1e8;
  }

  const SelectOptions& options_;
  const E& executor_;  ///< stops with the deadline
  Deadline& deadline_;
};

template <ConflictSource G>
Selection select_on(ExecutorRef executor, const G& graph, const SelectOptions& options) {
  check_options(options);
  Deadline deadline(options.seconds, options.observer);
  const auto watched = deadline.watch(executor);
  Draft draft = Selector(options, watched, deadline).run(graph);
  // Where a budget or the observer ended the search, something may still fit: heard of, and not to be stopped.
  complete(graph, draft.members, by_number, [&] {
    deadline.passed();
    return false;
  });
  draft.weight = weight_in_units(graph, draft.members);
  Selection selection;
  selection.weight = from_units(graph, draft.weight);
  selection.bound = from_units(graph, std::max(draft.bound, draft.weight));
  selection.members = std::move(draft.members);
  selection.iterations = draft.iterations;
  if (draft.weight >= draft.bound)
    selection.status = SelectionStatus::optimal;
  else if (deadline.cancelled())
    selection.status = SelectionStatus::cancelled;
  else if (options.method == SelectMethod::best && options.gap < 1 && selection.gap() <= options.gap)
    selection.status = SelectionStatus::gap_reached;
  return selection;
}

}  // namespace framehex::detail
