// SPDX-License-Identifier: BSL-1.0
#include "framehex/selection/tomita.hpp"
#include "framehex/verify/independence.hpp"
#include "support/random_graphs.hpp"

#include <catch2/catch.hpp>

#include <set>

using namespace framehex;
using test::random_disk_graph;
using test::random_graph;
using test::Weights;

namespace {

std::set<std::vector<index_t>> listed(const IncompatibilityGraph& graph) {
  std::set<std::vector<index_t>> sets;
  const auto result = for_each_maximal_independent_set(graph, [&](std::span<const index_t> members) {
    if (!sets.emplace(members.begin(), members.end()).second) FAIL("a set was listed twice");
  });
  CHECK(result.n_sets == sets.size());
  CHECK(result.status == Status::complete);
  return sets;
}

/// All subsets, asked one by one.
std::set<std::vector<index_t>> by_definition(const IncompatibilityGraph& graph) {
  std::set<std::vector<index_t>> sets;
  for (std::uint32_t bits = 1; bits < (1U << graph.size()); ++bits) {
    std::vector<index_t> members;
    for (index_t v = 0; v < graph.size(); ++v)
      if ((bits >> v) & 1U) members.push_back(v);
    if (verify::is_maximal(graph, members)) sets.insert(members);
  }
  return sets;
}

}  // namespace

TEST_CASE("the enumeration lists exactly the maximal sets", "[selection][tomita]") {
  std::mt19937_64 engine(5);
  for (int i = 0; i < 40; ++i) {
    const auto graph = random_graph(engine, static_cast<index_t>(1 + engine() % 10),
                                    static_cast<double>(engine() % 10) / 10.0, Weights::ones);
    CHECK(listed(graph) == by_definition(graph));
  }
  CHECK(listed(IncompatibilityGraph{}).empty());
}

TEST_CASE("Moon and Moser's graphs have 3^(n/3) maximal sets", "[selection][tomita]") {
  for (index_t k = 1; k <= 6; ++k) {
    std::vector<std::array<index_t, 2>> conflicts;
    for (index_t t = 0; t < k; ++t)
      for (index_t i = 0; i < 3; ++i) conflicts.push_back({3 * t + i, 3 * t + (i + 1) % 3});
    const auto graph = make_incompatibility_graph(std::vector<double>(3 * k, 1.0), conflicts);
    CHECK(listed(graph).size() == static_cast<std::size_t>(std::lround(std::pow(3, k))));
  }
}

TEST_CASE("an enumeration ends when it is told to", "[selection][tomita]") {
  std::mt19937_64 engine(6);
  const auto graph = random_disk_graph(engine, 60, 0.2);
  std::size_t n = 0;
  const auto limited = for_each_maximal_independent_set(graph, [&](auto) { ++n; }, {.max_sets = 5});
  CHECK(n == 5);
  CHECK(limited.n_sets == 5);
  CHECK(limited.status == Status::budget_exhausted);
  const auto cancelled =
      for_each_maximal_independent_set(graph, [](auto) {}, {.observer = [](const Progress&) { return false; }});
  CHECK(cancelled.status == Status::cancelled);
}

TEST_CASE("branch and bound finds the heaviest of the listed sets", "[selection][tomita]") {
  std::mt19937_64 engine(7);
  for (int i = 0; i < 60; ++i) {
    const auto graph = i % 2 == 0 ? random_disk_graph(engine, 40, 0.25)
                                  : random_graph(engine, 40, 0.3, static_cast<Weights>(i / 2 % 4));
    std::int64_t heaviest = 0;
    for_each_maximal_independent_set(graph, [&](std::span<const index_t> members) {
      heaviest = std::max(heaviest, detail::weight_in_units(graph, members));
    });
    const Selection selection = select_by_branch_and_bound(graph);
    CHECK(selection.status == SelectionStatus::optimal);
    CHECK(selection.weight == detail::from_units(graph, heaviest));
    CHECK(verify::is_maximal(graph, selection.members));
    const Selection at_once = select_by_branch_and_bound(graph, {.max_nodes = 0});
    CHECK(verify::is_maximal(graph, at_once.members));
    CHECK(at_once.bound >= selection.weight);
    CHECK(at_once.weight <= selection.weight);
  }
}

TEST_CASE("the rules of reduction keep a heaviest selection", "[selection][tomita]") {
  std::mt19937_64 engine(8);
  std::size_t n_settled = 0;
  for (int i = 0; i < 400; ++i) {
    const auto graph =
        random_graph(engine, 14, 0.05 + 0.04 * static_cast<double>(engine() % 20), static_cast<Weights>(i % 4));
    const auto heaviest = [](const IncompatibilityGraph& g) {
      std::int64_t best = 0;
      for_each_maximal_independent_set(
          g, [&](std::span<const index_t> members) { best = std::max(best, detail::weight_in_units(g, members)); });
      return best;
    };
    for (const std::size_t max_work : {std::size_t{0}, std::size_t{40}, std::size_t{1000000}}) {
      const Reduction reduction = reduce(graph, {.max_work = max_work});
      n_settled += graph.size() - reduction.kept.size();
      CHECK(verify::is_independent(graph, reduction.taken));
      const auto rest = detail::induced_subgraph(graph, reduction.kept);
      CHECK(detail::weight_in_units(graph, reduction.taken) + heaviest(rest) == heaviest(graph));
      if (max_work == 0) CHECK(reduction.kept.size() == graph.size());
    }
  }
  CHECK(n_settled > 1000);
}
