// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/executor.hpp"
#include "framehex/selection/greedy.hpp"

namespace framehex {

enum class SelectMethod {
  greedy,  ///< the paper's: by falling weight; ends at once
  best,    ///< until the gap is proven or the budget is spent
  exact    ///< until optimal or the budget is spent
};

struct SelectOptions {
  SelectMethod method = SelectMethod::best;
  /// Proven gap at which `best` ends, 0 to 1.
  double gap = 0.005;
  /// Wall time in seconds after which the best so far is returned; results then depend on the machine. Not negative.
  double seconds = std::numeric_limits<double>::infinity();
  Observer observer = {};
};

/// Selection of the largest weight that the budget allows, with a proven bound.
template <Executor E = SerialExecutor>
Selection select(const IncompatibilityGraph& graph, const SelectOptions& options = {}, const E& = {}) {
  if (!(options.gap >= 0 && options.gap <= 1)) throw invalid_option("gap must lie in [0, 1]");
  if (!(options.seconds >= 0)) throw invalid_option("seconds must not be negative");
  Selection selection;
  selection.members = options.method == SelectMethod::greedy ? select_greedily(graph) : select_dynamically(graph);
  selection.weight = detail::from_units(graph, detail::weight_in_units(graph, selection.members));
  std::int64_t total = 0;
  for (const std::int64_t w : graph.weights_in_units()) total += w;
  selection.bound = detail::from_units(graph, total);
  if (selection.weight == selection.bound) selection.status = SelectionStatus::optimal;
  return selection;
}

}  // namespace framehex
