// SPDX-License-Identifier: BSL-1.0
#include "framehex/selection/detail/contender_search.hpp"
#include "framehex/selection/detail/iterated_search.hpp"
#include "framehex/selection/select.hpp"
#include "framehex/selection/tomita.hpp"
#include "framehex/verify/independence.hpp"
#include "support/random_graphs.hpp"

#include <catch2/catch.hpp>

using namespace framehex;
using test::random_disk_graph;
using test::random_graph;
using test::Weights;

namespace {

std::int64_t heaviest(const IncompatibilityGraph& graph) {
  std::int64_t best = 0;
  for_each_maximal_independent_set(
      graph, [&](std::span<const index_t> members) { best = std::max(best, detail::weight_in_units(graph, members)); });
  return best;
}

constexpr auto never = [] { return false; };

}  // namespace

TEST_CASE("contenders are the members and those worth a share of what they put out", "[selection][contenders]") {
  // A star: the middle, 3, against leaves of 5, 4, 2 and 1, and one that stands alone.
  const auto star = make_incompatibility_graph(std::vector<double>{10, 5, 4, 2, 1, 7},
                                               std::vector<std::array<index_t, 2>>{{0, 1}, {0, 2}, {0, 3}, {0, 4}});
  CHECK(detail::contenders(star, std::vector<index_t>{0, 5}, 0.4, detail::never) == std::vector<index_t>{0, 1, 2, 5});
  CHECK(detail::contenders(star, std::vector<index_t>{1, 2, 3, 4, 5}, 0.9, detail::never) ==
        std::vector<index_t>{1, 2, 3, 4, 5});
  CHECK(detail::contenders(star, std::vector<index_t>{1, 2, 3, 4, 5}, 0.8, detail::never).size() == 6);
  CHECK(detail::contenders(star, std::vector<index_t>{}, 0.5, detail::never).size() == 6);
}

TEST_CASE("a window over a whole component is solved exactly", "[selection][contenders]") {
  std::mt19937_64 engine(21);
  int n_connected = 0, n_gained = 0;
  for (int i = 0; i < 300; ++i) {
    const auto graph = i % 2 == 0 ? random_graph(engine, 24, 0.25, static_cast<Weights>(i / 2 % 4))
                                  : random_disk_graph(engine, 30, 0.35);
    if (statistics(graph).n_components != 1) continue;
    ++n_connected;
    IteratedSearch search(graph, select_greedily(graph));
    const std::int64_t before = search.weight_in_units();
    search.solve_window(static_cast<index_t>(engine() % graph.size()), graph.size(), 100000);
    CHECK(search.weight_in_units() == heaviest(graph));
    CHECK(verify::is_maximal(graph, search.members()));
    n_gained += search.weight_in_units() > before;
  }
  CHECK(n_connected > 100);
  CHECK(n_gained > 30);
}

TEST_CASE("windows and perturbations lose nothing", "[selection][contenders]") {
  std::mt19937_64 engine(22);
  const auto graph = random_disk_graph(engine, 3000, 0.03);
  IteratedSearch search(graph, select_greedily(graph));
  const std::int64_t swapped = search.weight_in_units();
  search.solve_windows(40, 500, never);
  const std::int64_t windowed = search.weight_in_units();
  CHECK(windowed > swapped);
  CHECK(verify::is_maximal(graph, search.members()));
  std::vector<index_t> places(graph.size());
  for (index_t v = 0; v < graph.size(); ++v) places[v] = v;
  search.perturb(places, 3000, never);
  CHECK(search.weight_in_units() > windowed);
  CHECK(verify::is_maximal(graph, search.members()));
}

TEST_CASE("the search among contenders wins most of what greedy loses", "[selection][contenders]") {
  std::mt19937_64 engine(23);
  for (const double radius : {0.02, 0.03, 0.05}) {
    const auto graph = random_disk_graph(engine, 3000, radius);
    const Selection greedy = select(graph, {.method = SelectMethod::greedy});
    const Selection first = select(graph, {.max_rounds = 0});
    CHECK(verify::is_maximal(graph, first.members));
    const Selection bounded = select(graph, {.gap = 0.005, .exact_below = 0});
    CHECK(first.weight - greedy.weight >= 2.0 / 3.0 * (bounded.bound - greedy.weight));
  }
}
