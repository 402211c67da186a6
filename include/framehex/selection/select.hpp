// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/executor.hpp"
#include "framehex/observer.hpp"
#include "framehex/option_ranges.hpp"
#include "framehex/selection/conflict_source.hpp"
#include "framehex/selection/implicit_graph.hpp"
#include "framehex/selection/incompatibility_graph.hpp"
#include "framehex/selection/selection.hpp"

#include <limits>

namespace framehex {

/// How hard `select` tries.
enum class SelectMethod {
  greedy,  ///< the paper's: by falling weight; ends at once, with a rough bound
  best,    ///< until the gap asked for is proven (small components: until optimal) or the budget is spent
  exact    ///< until optimal or the budget is spent
};

/// Options of `select`.
struct SelectOptions {
  SelectMethod method = SelectMethod::best;
  /// Proven gap at which `best` ends, 0 to 1. 1: no proof is asked for, and the bound is that of a few iterations.
  double gap = 0.005;
  /// Wall time after which the best so far is returned; results then depend on the machine. Not negative.
  double seconds = std::numeric_limits<double>::infinity();
  /// Rounds of the bound, each of 15 to 50 iterations: the budget that repeats. 0: the first selection.
  std::size_t max_rounds = 60;
  /// Nodes of the tree search, in `best` and `exact`.
  std::size_t max_nodes = 2000;
  /// `best` goes on to the proven optimum of components up to this many candidates, where that takes no more than seconds.
  std::size_t exact_below = 10000;
  std::uint64_t seed = 1;
  /// Stage "selection".
  Observer observer = {};

  template <class Options, class Visit>
  static void each_number(Options& o, Visit&& visit) {
    visit("SelectOptions::gap", o.gap, 0, 1);
    visit("SelectOptions::seconds", o.seconds, 0, unbounded);
    visit("SelectOptions::max_rounds", o.max_rounds, 0, unbounded);
    visit("SelectOptions::max_nodes", o.max_nodes, 0, unbounded);
    visit("SelectOptions::exact_below", o.exact_below, 0, unbounded);
    visit("SelectOptions::seed", o.seed, 0, unbounded);
  }
};

namespace detail {

/// The whole of `select`, for any executor.
template <ConflictSource G>
Selection select_on(ExecutorRef executor, const G& graph, const SelectOptions& options);

#ifdef FRAMEHEX_COMPILED
extern template Selection select_on(ExecutorRef, const IncompatibilityGraph&, const SelectOptions&);
extern template Selection select_on(ExecutorRef, const ImplicitIncompatibilityGraph&, const SelectOptions&);
#endif

}  // namespace detail

/// Selects candidates that can stand in one mesh, of the largest weight that the budget allows, and proves how far from
/// the best the selection can be.
///
/// @param graph     n candidates and their conflicts: stored, or implicit in the candidates, which takes less time and a
///                  tenth of the memory.
/// @param options   see SelectOptions. A budget of 0 gives a maximal selection at once.
/// @param executor  runs the iterations of the bound.
/// @return members, ascending, independent and maximal whatever the status; weight, bound, gap, iterations.
/// @throws invalid_option  for a number outside its range.
/// @par Complexity   By an implicit graph: `greedy` O(n log n); `best` three microseconds a candidate for the first
///                   selection, then up to ten for a gap of half a percent, and some 100 bytes. By a stored one also its
///                   conflicts, some times over, and memory as the graph again.
/// @par Determinism  The same for any executor and run, unless the time or the observer ends it. Equal weights by
///                   number; of a stored graph, `best` and `exact` take them by surroundings instead, so that the
///                   candidates' numbers do not matter but where they look alike.
/// @par Source       Paper, section 2.2, for greedy. Departs: a relaxation bounds what greedy loses, and local search
///                   and branch and bound win it back.
template <ConflictSource G, Executor E = SerialExecutor>
Selection select(const G& graph, const SelectOptions& options = {}, const E& executor = {}) {
  return detail::select_on(ExecutorRef(executor), graph, options);
}

}  // namespace framehex

// Those who link framehex::compiled and have conflicts of their own include this themselves.
#ifndef FRAMEHEX_COMPILED
#include "framehex/selection/detail/select_impl.hpp"
#endif
