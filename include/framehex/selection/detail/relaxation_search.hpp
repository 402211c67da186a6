// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/selection/detail/clique_separation.hpp"
#include "framehex/selection/detail/deadline.hpp"
#include "framehex/selection/detail/iterated_search.hpp"
#include "framehex/selection/detail/price_search.hpp"
#include "framehex/selection/detail/subgraph.hpp"

namespace framehex::detail {

/// Runs a relaxation until its bound settles, with cliques added where it overfills them.
///
/// @param goal  stops as soon as the bound is this low, in units.
/// @return iterations.
inline void settle_relaxation(const IncompatibilityGraph& graph, LpBound& relaxation, std::int64_t goal,
                              Deadline& deadline) {
  CliqueSeparator separator(graph);
  for (int n_cuts = 0;;) {
    const std::int64_t before = relaxation.bound();
    relaxation.iterate(100);
    if (relaxation.bound() <= goal || deadline.passed()) return;
    if (before - relaxation.bound() > (before - goal) / 50) continue;
    if (n_cuts++ == 12) return;
    const auto cliques =
        separator.separate(relaxation.primal(), relaxation.reduced_weights(), CliqueSeparator::Effort::thorough);
    if (cliques.empty()) return;
    relaxation.add_cliques(cliques);
    relaxation.iterate(100);
  }
}

/// Branch and bound on the relaxation, for graphs of some thousand candidates.
///
/// At each node the relaxation is solved, the candidates that its prices decide are settled and left out of the graph,
/// and what remains is given to `PriceSearch`; a candidate is branched on, in or out, only when that does not end soon.
class RelaxationSearch {
public:
  struct Limits {
    std::size_t max_nodes = 1000;         ///< of relaxations
    std::size_t max_price_nodes = 20000;  ///< of each search under prices
    /// Iterations and nodes of all kinds, times the candidates of the whole graph: a node alone may take thousands.
    double max_work = std::numeric_limits<double>::infinity();
  };

  /// @param members  the best selection known.
  RelaxationSearch(const IncompatibilityGraph& graph, std::vector<index_t> members, const Limits& limits,
                   Deadline& deadline)
      : graph_(graph), limits_(limits), deadline_(deadline), best_(std::move(members)) {
    best_weight_ = weight_in_units(graph, best_);
  }

  /// @param relaxation  of the graph, as far as it has been solved; taken over.
  /// @return true when `members()` is proven to be the heaviest.
  bool run(LpBound relaxation) {
    std::vector<index_t> all(graph_.size());
    std::iota(all.begin(), all.end(), index_t{0});
    solve(graph_, relaxation, all, {});
    bound_ = complete_ ? best_weight_ : relaxation.bound();
    return complete_;
  }

  const std::vector<index_t>& members() const { return best_; }
  /// Of the whole graph, after `run`.
  std::int64_t bound_in_units() const { return bound_; }
  std::size_t n_nodes() const { return n_nodes_; }
  std::size_t iterations() const { return n_iterations_; }

private:
  /// A part of the graph on its own; `ids` are the numbers in the whole graph, `taken` are settled in.
  void solve(const IncompatibilityGraph& graph, LpBound& relaxation, const std::vector<index_t>& ids,
             const std::vector<index_t>& taken) {
    const double work = static_cast<double>(n_iterations_) * static_cast<double>(graph_.size());
    if (++n_nodes_ > limits_.max_nodes || work > limits_.max_work || deadline_.passed()) {
      complete_ = false;
      return;
    }
    const std::int64_t known = best_weight_ - weight_in_units(graph_, taken);
    const std::size_t before = relaxation.iterations();
    settle_relaxation(graph, relaxation, known, deadline_);
    n_iterations_ += relaxation.iterations() - before;
    if (relaxation.bound() <= known) return;
    if (deadline_.passed()) {
      complete_ = false;
      return;
    }
    improve(graph, relaxation.primal(), ids, taken);
    const auto prices = relaxation.prices();
    PriceSearch search(graph, relaxation.cover(), prices, best_weight_ - weight_in_units(graph_, taken));
    if (!search.settle(PriceSearch::Effort::probing, deadline_)) return;
    const bool ended = search.run(limits_.max_price_nodes, deadline_);
    n_iterations_ += search.n_nodes();
    if (search.found()) accept(search.members(), ids, taken);
    if (ended) return;
    branch(graph, relaxation, search, ids, taken);
  }

  void accept(const std::vector<index_t>& local, const std::vector<index_t>& ids, std::vector<index_t> taken) {
    for (const index_t v : local) taken.push_back(ids[v]);
    const std::int64_t weight = weight_in_units(graph_, taken);
    if (weight <= best_weight_) return;
    best_weight_ = weight;
    best_ = std::move(taken);
  }

  void improve(const IncompatibilityGraph& graph, std::span<const float> primal, const std::vector<index_t>& ids,
               const std::vector<index_t>& taken) {
    LocalSearch search(graph);
    search.assign(round_relaxation(graph, primal));
    search.improve();
    accept(search.members(), ids, taken);
  }

  /// The open candidate nearest to one half, among equals the one that decides the most.
  static index_t choose(const IncompatibilityGraph& graph, std::span<const float> primal, const PriceSearch& search) {
    index_t best = no_index;
    double best_score = -1;
    for (index_t v = 0; v < graph.size(); ++v) {
      if (search.fate(v) != PriceSearch::Fate::open) continue;
      const double x = static_cast<double>(primal[v]);
      const double score = std::min(x, 1 - x) + 1e-9 * static_cast<double>(graph.degree(v));
      if (score > best_score) best_score = score, best = v;
    }
    return best;
  }

  void branch(const IncompatibilityGraph& graph, const LpBound& relaxation, const PriceSearch& search,
              const std::vector<index_t>& ids, const std::vector<index_t>& taken) {
    const index_t v = choose(graph, relaxation.primal(), search);
    for (const bool in : {true, false}) {
      std::vector<index_t> kept, kept_ids, taken_here = taken;
      for (index_t u = 0; u < graph.size(); ++u) {
        if (search.fate(u) == PriceSearch::Fate::in || (in && u == v))
          taken_here.push_back(ids[u]);
        else if (search.fate(u) == PriceSearch::Fate::open && u != v && !(in && graph.adjacent(v, u)))
          kept.push_back(u), kept_ids.push_back(ids[u]);
      }
      const IncompatibilityGraph part = induced_subgraph(graph, kept);
      auto cover = restrict_cover(relaxation.cover(), relaxation.primal(), relaxation.dual(), kept);
      // Relative to the largest weight, which may have been settled.
      rescale(cover.dual, graph, part);
      LpBound child(std::move(cover.cover), part.weights_in_units(), std::move(cover.primal), std::move(cover.dual));
      solve(part, child, kept_ids, taken_here);
    }
  }

  static void rescale(std::vector<float>& dual, const IncompatibilityGraph& from, const IncompatibilityGraph& to) {
    const auto largest = [](const IncompatibilityGraph& graph) {
      std::int64_t most = 1;
      for (const std::int64_t w : graph.weights_in_units()) most = std::max(most, w);
      return static_cast<double>(most);
    };
    const auto factor = static_cast<float>(largest(from) / largest(to));
    for (float& y : dual) y *= factor;
  }

  const IncompatibilityGraph& graph_;
  Limits limits_;
  Deadline& deadline_;
  std::vector<index_t> best_;
  std::int64_t best_weight_ = 0, bound_ = 0;
  std::size_t n_nodes_ = 0, n_iterations_ = 0;
  bool complete_ = true;
};

}  // namespace framehex::detail
