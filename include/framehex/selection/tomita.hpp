// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/option_ranges.hpp"
#include "framehex/selection/detail/bitset_search.hpp"
#include "framehex/selection/detail/reductions.hpp"
#include "framehex/selection/detail/subgraph.hpp"
#include "framehex/selection/greedy.hpp"

namespace framehex {

/// Options of `for_each_maximal_independent_set`.
struct EnumerationOptions {
  std::size_t max_sets = std::numeric_limits<std::size_t>::max();
  /// Stage "enumeration".
  Observer observer = {};

  template <class Options, class Visit>
  static void each_number(Options& o, Visit&& visit) {
    visit("EnumerationOptions::max_sets", o.max_sets, 0, unbounded);
  }
};

/// How far the enumeration came.
struct EnumerationResult {
  std::size_t n_sets = 0;
  Status status = Status::complete;
};

namespace detail {

/// Tomita's enumeration of the maximal cliques of the complement, on bit rows.
template <class Visit>
class Enumeration {
public:
  Enumeration(const IncompatibilityGraph& graph, const EnumerationOptions& options, Visit& visit)
      : n_(graph.size()),
        n_words_((graph.size() + 63) / 64),
        closed_(graph.size() * n_words_, 0),
        visit_(visit),
        options_(options),
        deadline_(std::numeric_limits<double>::infinity(), options.observer) {
    for (index_t v = 0; v < n_; ++v) {
      set(row(v), v);
      for (const index_t u : graph.neighbours(v)) set(row(v), u);
    }
  }

  EnumerationResult run() {
    if (n_ == 0) return result_;
    levels_.resize(1);
    levels_[0].open.assign(n_words_, 0);
    levels_[0].done.assign(n_words_, 0);
    for (std::size_t v = 0; v < n_; ++v) set(levels_[0].open.data(), v);
    expand(0);
    return result_;
  }

private:
  using Bits = std::vector<std::uint64_t>;
  struct Level {
    Bits open;    ///< can still join
    Bits done;    ///< could join, but all sets with them have been listed
    Bits branch;  ///< to be tried
  };

  std::uint64_t* row(std::size_t v) { return closed_.data() + v * n_words_; }
  static void set(std::uint64_t* bits, std::size_t i) { bits[i / 64] |= std::uint64_t{1} << (i % 64); }

  static bool any(const Bits& bits) {
    return std::any_of(bits.begin(), bits.end(), [](std::uint64_t word) { return word != 0; });
  }

  /// The one, open or done, that leaves the fewest branches: itself and those it excludes.
  void choose_branches(Level& level) {
    std::size_t best = n_ + 1, pivot = 0;
    for (std::size_t word = 0; word < n_words_; ++word)
      for (std::uint64_t rest = level.open[word] | level.done[word]; rest != 0; rest &= rest - 1) {
        const std::size_t v = 64 * word + static_cast<std::size_t>(std::countr_zero(rest));
        std::size_t n = 0;
        for (std::size_t w = 0; w < n_words_; ++w)
          n += static_cast<std::size_t>(std::popcount(level.open[w] & row(v)[w]));
        if (n < best) best = n, pivot = v;
      }
    level.branch.resize(n_words_);
    for (std::size_t w = 0; w < n_words_; ++w) level.branch[w] = level.open[w] & row(pivot)[w];
  }

  void expand(std::size_t depth) {
    if (deadline_.passed()) {
      result_.status = Status::cancelled;
      return;
    }
    if (levels_.size() < depth + 2) levels_.resize(depth + 2);
    if (!any(levels_[depth].open)) {
      if (!any(levels_[depth].done)) report();
      return;
    }
    choose_branches(levels_[depth]);
    for (std::size_t word = 0; word < n_words_; ++word)
      while (levels_[depth].branch[word] != 0 && result_.status == Status::complete) {
        Level &here = levels_[depth], &next = levels_[depth + 1];
        const auto bit = here.branch[word] & (~here.branch[word] + 1);
        const std::size_t v = 64 * word + static_cast<std::size_t>(std::countr_zero(bit));
        here.branch[word] ^= bit;
        next.open.resize(n_words_);
        next.done.resize(n_words_);
        for (std::size_t w = 0; w < n_words_; ++w) {
          next.open[w] = here.open[w] & ~row(v)[w];
          next.done[w] = here.done[w] & ~row(v)[w];
        }
        here.open[word] ^= bit;
        here.done[word] |= bit;
        chosen_.push_back(static_cast<index_t>(v));
        expand(depth + 1);
        chosen_.pop_back();
      }
  }

  void report() {
    if (result_.n_sets == options_.max_sets) {
      result_.status = Status::budget_exhausted;
      return;
    }
    ++result_.n_sets;
    members_ = chosen_;
    std::sort(members_.begin(), members_.end());
    visit_(std::span<const index_t>(members_));
  }

  std::size_t n_, n_words_;
  Bits closed_;
  Visit& visit_;
  const EnumerationOptions& options_;
  Deadline deadline_;
  std::vector<Level> levels_;
  std::vector<index_t> chosen_, members_;
  EnumerationResult result_;
};

}  // namespace detail

/// Lists every maximal independent set of an incompatibility graph: every way to recombine that leaves no hexahedron
/// out. For up to about a hundred candidates.
///
/// @param graph    n candidates.
/// @param visit    called with each set once, `void(std::span<const index_t>)`, members ascending; the span is only
///                 valid during the call.
/// @param options  `.max_sets` ends the list early, with the status `budget_exhausted`.
/// @return the number of sets and the status. A graph without candidates has none.
/// @par Complexity   O(3^(n/3)), the largest possible number of sets; n^2/8 bytes.
/// @par Determinism  The order of the sets depends on nothing but the graph.
/// @par Source       Tomita, Tanaka, Takahashi, Theor. Comput. Sci. 363 (2006) 28-42, on the complement.
template <class Visit>
EnumerationResult for_each_maximal_independent_set(const IncompatibilityGraph& graph, Visit&& visit,
                                                   const EnumerationOptions& options = {}) {
  check_options(options);
  return detail::Enumeration<std::remove_reference_t<Visit>>(graph, options, visit).run();
}

/// Options of `select_by_branch_and_bound`.
struct TomitaOptions {
  std::size_t max_nodes = 10'000'000;  ///< of the search tree, a component; 0: none, the dynamic greedy selection
  /// Stage "selection".
  Observer observer = {};

  template <class Options, class Visit>
  static void each_number(Options& o, Visit&& visit) {
    visit("TomitaOptions::max_nodes", o.max_nodes, 0, unbounded);
  }
};

/// Heaviest selection, found exactly by branch and bound on bit sets, one connected component at a time.
///
/// For components of up to a few hundred candidates; `select` does better on larger ones.
///
/// @return the selection; `optimal`, or `budget_exhausted` or `cancelled` with a maximal set and a rough bound.
/// @par Complexity   Exponential in the largest component of k candidates at worst; k^2/8 bytes.
/// @par Determinism  Serial.
/// @par Source       Tomita, Tanaka, Takahashi, Theor. Comput. Sci. 363 (2006) 28-42. Departs: weighted, with a bound
///                   by cliques that share the weights, because one heaviest set is wanted and not all maximal ones.
inline Selection select_by_branch_and_bound(const IncompatibilityGraph& graph, const TomitaOptions& options = {}) {
  check_options(options);
  detail::Deadline deadline(std::numeric_limits<double>::infinity(), options.observer);
  Selection selection;
  const Reduction reduction = reduce(graph, {.max_work = 20 * (graph.rows().values.size() + graph.size())});
  selection.members = reduction.taken;
  std::int64_t bound = detail::weight_in_units(graph, reduction.taken);
  detail::BitsetSearch search;
  const auto parts = detail::components(graph, reduction.kept);
  std::vector<index_t> number(graph.size(), no_index);
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const auto ids = parts[i];
    const IncompatibilityGraph part = detail::induced_subgraph(graph, ids, std::span<index_t>(number));
    std::vector<index_t> members = select_dynamically(part);
    const std::int64_t known = detail::weight_in_units(part, members);
    std::int64_t part_bound = partition_bound(part);
    if (known < part_bound && options.max_nodes > 0 && !deadline.passed()) {
      search.assign(part.weights_in_units());
      for (index_t v = 0; v < part.size(); ++v)
        for (const index_t u : part.neighbours(v))
          if (u < v) search.add_conflict(u, v);
      const auto outcome = search.solve(known, options.max_nodes, &deadline);
      selection.iterations += search.n_nodes();
      if (!search.members().empty()) members.assign(search.members().begin(), search.members().end());
      if (outcome == detail::BitsetSearch::Outcome::complete) part_bound = search.weight();
    }
    bound += part_bound;
    for (const index_t v : members) selection.members.push_back(ids[v]);
  }
  // Candidates left out by the rules may fit again when they weigh nothing, or when a component was not finished.
  detail::complete(graph, selection.members);
  const std::int64_t weight = detail::weight_in_units(graph, selection.members);
  selection.weight = detail::from_units(graph, weight);
  selection.bound = detail::from_units(graph, std::max(bound, weight));
  if (weight >= bound)
    selection.status = SelectionStatus::optimal;
  else if (deadline.cancelled())
    selection.status = SelectionStatus::cancelled;
  return selection;
}

}  // namespace framehex
