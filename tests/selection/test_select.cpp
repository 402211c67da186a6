// SPDX-License-Identifier: BSL-1.0
#include "framehex/selection/select.hpp"
#include "framehex/verify/independence.hpp"
#include "support/random_graphs.hpp"

#include <boost/graph/adjacency_matrix.hpp>
#include <boost/graph/bron_kerbosch_all_cliques.hpp>
#include <catch2/catch.hpp>

using namespace framehex;
using test::random_disk_graph;
using test::random_graph;
using test::Weights;

namespace {

/// Heaviest independent set of at most 20 candidates, over all subsets.
std::int64_t brute_force(const IncompatibilityGraph& graph) {
  const auto n = static_cast<index_t>(graph.size());
  std::vector<std::uint32_t> conflicts(n, 0);
  for (index_t v = 0; v < n; ++v)
    for (const index_t u : graph.neighbours(v)) conflicts[v] |= 1U << u;
  std::int64_t best = 0;
  std::vector<std::int64_t> weight(std::size_t{1} << n, 0);
  std::vector<std::uint8_t> independent(std::size_t{1} << n, 1);
  for (std::uint32_t set = 1; set < (1U << n); ++set) {
    const auto v = static_cast<index_t>(std::countr_zero(set));
    const std::uint32_t rest = set & (set - 1);
    independent[set] = independent[rest] && (conflicts[v] & rest) == 0;
    weight[set] = weight[rest] + graph.weights_in_units()[v];
    if (independent[set]) best = std::max(best, weight[set]);
  }
  return best;
}

struct HeaviestClique {
  const IncompatibilityGraph* graph;
  std::int64_t* best;
  template <class Clique, class Graph>
  void clique(const Clique& members, const Graph&) {
    std::int64_t sum = 0;
    for (const auto v : members) sum += graph->weights_in_units()[v];
    *best = std::max(*best, sum);
  }
};

/// Heaviest clique of the complement, by Boost.
std::int64_t by_boost(const IncompatibilityGraph& graph) {
  boost::adjacency_matrix<boost::undirectedS> complement(graph.size());
  for (index_t u = 0; u < graph.size(); ++u)
    for (index_t v = 0; v < u; ++v)
      if (!graph.adjacent(u, v)) boost::add_edge(u, v, complement);
  std::int64_t best = 0;
  boost::bron_kerbosch_all_cliques(complement, HeaviestClique{&graph, &best}, 1);
  return best;
}

void check_sound(const IncompatibilityGraph& graph, const Selection& selection) {
  if (!verify::is_maximal(graph, selection.members)) FAIL("not maximal");
  double weight = 0;
  for (const index_t v : selection.members) weight += graph.weight(v);
  CHECK(weight == selection.weight);
  CHECK(selection.bound >= selection.weight);
  CHECK((selection.status == SelectionStatus::optimal) == (selection.bound == selection.weight));
  CHECK(std::is_sorted(selection.members.begin(), selection.members.end()));
}

/// The same graph, candidate `order[i]` being number i.
IncompatibilityGraph renumbered(const IncompatibilityGraph& graph, const std::vector<index_t>& order) {
  std::vector<double> weights;
  std::vector<index_t> number(graph.size());
  std::vector<std::array<index_t, 2>> conflicts;
  for (index_t v = 0; v < graph.size(); ++v) number[order[v]] = v, weights.push_back(graph.weight(order[v]));
  for (index_t v = 0; v < graph.size(); ++v)
    for (const index_t u : graph.neighbours(v)) conflicts.push_back({number[v], number[u]});
  return make_incompatibility_graph(weights, conflicts);
}

}  // namespace

TEST_CASE("best equals brute force on 10,000 random graphs", "[selection][select]") {
  std::mt19937_64 engine(1);
  for (int i = 0; i < 10000; ++i) {
    const auto n = static_cast<index_t>(i < 9000 ? 1 + engine() % 13 : 14 + engine() % 7);
    const double density = static_cast<double>(engine() % 100) / 100.0;
    const auto graph = random_graph(engine, n, density, static_cast<Weights>(i % 4));
    const Selection selection = select(graph);
    const auto expected = brute_force(graph);
    if (selection.status != SelectionStatus::optimal || selection.weight != detail::from_units(graph, expected))
      FAIL("graph " << i << " of " << n << ": " << selection.weight << " of " << detail::from_units(graph, expected)
                    << ", bound " << selection.bound);
    if (!verify::is_maximal(graph, selection.members)) FAIL("graph " << i << ": not maximal");
  }
}

TEST_CASE("best equals Boost's cliques of the complement", "[selection][select]") {
  std::mt19937_64 engine(2);
  for (int i = 0; i < 60; ++i) {
    const auto n = static_cast<index_t>(20 + engine() % 41);
    const auto graph =
        i % 2 == 0 ? random_disk_graph(engine, n, 0.3) : random_graph(engine, n, 0.45, static_cast<Weights>(i / 2 % 4));
    const Selection selection = select(graph);
    check_sound(graph, selection);
    CHECK(selection.status == SelectionStatus::optimal);
    CHECK(selection.weight == detail::from_units(graph, by_boost(graph)));
  }
}

TEST_CASE("every method is sound, and exact is not below the others", "[selection][select][threads]") {
  std::mt19937_64 engine(3);
  const auto graph = random_disk_graph(engine, 700, 0.07);
  const Selection greedy = select(graph, {.method = SelectMethod::greedy});
  const Selection loose = select(graph, {.gap = 0.02, .exact_below = 0});
  const Selection exact = select(graph, {.method = SelectMethod::exact});
  for (const Selection* s : {&greedy, &loose, &exact}) check_sound(graph, *s);
  CHECK(exact.status == SelectionStatus::optimal);
  CHECK(loose.gap() <= 0.02);
  CHECK(loose.weight <= exact.weight);
  CHECK(greedy.weight < exact.weight);
  CHECK(loose.bound >= exact.weight);
  CHECK(greedy.bound >= exact.weight);
  const Selection threads = select(graph, {.gap = 0.02, .exact_below = 0}, ThreadExecutor(3));
  CHECK(threads.members == loose.members);
  CHECK(threads.bound == loose.bound);
}

TEST_CASE("the bound of a large graph's course holds on small ones", "[selection][select]") {
  std::mt19937_64 engine(7);
  std::size_t n_proven = 0;
  for (int round = 0; round < 2000; ++round) {
    const auto n = static_cast<index_t>(2 + engine() % 15);
    const auto graph =
        random_graph(engine, n, 0.1 + 0.08 * static_cast<double>(round % 10), static_cast<Weights>(round % 4));
    const Selection selection = select(graph, {.gap = 0, .max_rounds = 6, .exact_below = 0});
    check_sound(graph, selection);
    const auto best = static_cast<double>(brute_force(graph)) * graph.unit();
    REQUIRE(selection.bound >= best);
    REQUIRE(selection.weight <= best);
    n_proven += selection.status == SelectionStatus::optimal;
  }
  CHECK(n_proven > 1000);
}

TEST_CASE("graphs at the edges of what there is", "[selection][select]") {
  const Selection nothing = select(IncompatibilityGraph{});
  CHECK(nothing.members.empty());
  CHECK(nothing.status == SelectionStatus::optimal);
  CHECK(nothing.gap() == 0);

  const auto free_ones = make_incompatibility_graph(std::vector<double>{1, 0, 2}, {});
  for (const SelectMethod method : {SelectMethod::greedy, SelectMethod::best, SelectMethod::exact}) {
    const Selection all = select(free_ones, {.method = method});
    CHECK(all.members == std::vector<index_t>{0, 1, 2});
    CHECK(all.status == SelectionStatus::optimal);
  }
  const auto worthless =
      make_incompatibility_graph(std::vector<double>(3, 0.0), std::vector<std::array<index_t, 2>>{{0, 1}});
  const Selection none = select(worthless);
  CHECK(none.members.size() == 2);
  CHECK(none.status == SelectionStatus::optimal);
}

TEST_CASE("a clique of 10,000", "[selection][select]") {
  constexpr index_t n = 10000;
  Csr<index_t> rows;
  rows.values.reserve(std::size_t{n} * (n - 1));
  std::vector<double> weights(n);
  for (index_t v = 0; v < n; ++v) {
    weights[v] = 1 + (v * 7919) % n;
    for (index_t u = 0; u < n; ++u)
      if (u != v) rows.values.push_back(u);
    rows.end_row();
  }
  const Selection selection = select(IncompatibilityGraph(std::move(rows), weights));
  CHECK(selection.members.size() == 1);
  CHECK(selection.weight == n);
  CHECK(selection.status == SelectionStatus::optimal);
}

TEST_CASE("budgets and cancellation leave a maximal set", "[selection][select]") {
  std::mt19937_64 engine(4);
  const auto graph = random_disk_graph(engine, 2000, 0.06);
  for (const SelectMethod method : {SelectMethod::best, SelectMethod::exact}) {
    const Selection at_once = select(graph, {.method = method, .seconds = 0});
    check_sound(graph, at_once);
    CHECK(at_once.status == SelectionStatus::budget_exhausted);
    const Selection no_rounds = select(graph, {.method = method, .max_rounds = 0, .max_nodes = 0});
    check_sound(graph, no_rounds);
    CHECK(no_rounds.status == SelectionStatus::budget_exhausted);
  }
  for (const int allowed : {0, 1, 2}) {
    int n_calls = 0;
    const Selection cancelled =
        select(graph, {.method = SelectMethod::exact, .observer = [&](const Progress& progress) {
                         CHECK(progress.stage == "selection");
                         return ++n_calls <= allowed;
                       }});
    check_sound(graph, cancelled);
    if (cancelled.status != SelectionStatus::optimal) CHECK(cancelled.status == SelectionStatus::cancelled);
    if (allowed == 0) CHECK(cancelled.status == SelectionStatus::cancelled);
  }
}

TEST_CASE("options out of range", "[selection][select]") {
  const auto graph = make_incompatibility_graph(std::vector<double>(2, 1.0), {});
  CHECK_THROWS_AS(select(graph, {.gap = -0.1}), invalid_option);
  CHECK_THROWS_AS(select(graph, {.gap = std::nan("")}), invalid_option);
  CHECK_THROWS_AS(select(graph, {.seconds = -1}), invalid_option);
}

TEST_CASE("a renumbered graph gives the same", "[selection][select]") {
  std::mt19937_64 engine(12);
  const auto fine = random_disk_graph(engine, 900, 0.07);
  std::vector<double> few_values;
  std::vector<std::array<index_t, 2>> all;
  for (index_t v = 0; v < fine.size(); ++v) {
    few_values.push_back(std::floor(fine.weight(v) / 1000));
    for (const index_t u : fine.neighbours(v)) all.push_back({u, v});
  }
  const auto tied = make_incompatibility_graph(few_values, all);
  for (const IncompatibilityGraph* graph : {&fine, &tied})
    for (const SelectOptions& options : {SelectOptions{.gap = 0.02, .exact_below = 0}, SelectOptions{.max_rounds = 0},
                                         SelectOptions{.max_rounds = 4, .max_nodes = 0}}) {
      const Selection first = select(*graph, options);
      std::vector<index_t> order(graph->size());
      for (index_t v = 0; v < order.size(); ++v) order[v] = v;
      for (int i = 0; i < 3; ++i) {
        std::shuffle(order.begin(), order.end(), engine);
        const Selection again = select(renumbered(*graph, order), options);
        CHECK(again.weight == first.weight);
        CHECK(again.bound == first.bound);
        std::vector<index_t> members;
        for (const index_t v : again.members) members.push_back(order[v]);
        std::sort(members.begin(), members.end());
        CHECK(members == first.members);
      }
    }
}
