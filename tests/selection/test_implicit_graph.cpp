// SPDX-License-Identifier: BSL-1.0
#include "framehex/recombination/potential_hex_finder.hpp"
#include "framehex/selection/conflict_search.hpp"
#include "framehex/selection/detail/contender_search.hpp"
#include "framehex/selection/detail/iterated_search.hpp"
#include "framehex/selection/greedy.hpp"
#include "framehex/selection/select.hpp"
#include "framehex/verify/independence.hpp"
#include "support/delaunay_lattice.hpp"
#include "support/kuhn_lattice.hpp"
#include "support/random_candidates.hpp"

#include <catch2/catch.hpp>

using namespace framehex;

namespace {

/// Every weight different, so that ties do not matter.
auto distinct_weight(const PotentialHexahedra& candidates) {
  return [&candidates](index_t i) { return std::round(1e4 * static_cast<double>(candidates.quality[i])) + 1e-5 * i; };
}

std::vector<PotentialHexahedra> meshes_and_random() {
  std::vector<PotentialHexahedra> all;
  for (std::uint64_t seed = 0; seed < 12; ++seed)
    all.push_back(test::random_candidates(seed, 120, seed < 4 ? 11 : seed < 8 ? 18 : 40, 400));
  all.push_back(find_potential_hexahedra(test::kuhn_lattice(3), {.quality_floor = 1e-4}));
  all.push_back(find_potential_hexahedra(test::DelaunayLattice(4, 3, 0.6).mesh, {.quality_floor = 0.05}));
  all.push_back(find_potential_hexahedra(test::DelaunayLattice(6, 2, 0.5).mesh, {.quality_floor = 0.05}));
  return all;
}

}  // namespace

TEST_CASE("a graph that stores no conflicts has those of the one that does", "[selection][implicit]") {
  for (const PotentialHexahedra& candidates : meshes_and_random()) {
    REQUIRE(candidates.size() > 100);
    const auto stored = build_incompatibility_graph(candidates);
    const ImplicitIncompatibilityGraph implicit(candidates, volume_times_quality(candidates));
    REQUIRE(implicit.size() == stored.size());
    CHECK(implicit.unit() == stored.unit());
    CHECK(std::ranges::equal(implicit.weights_in_units(), stored.weights_in_units()));
    std::mt19937_64 engine(5);
    for (index_t v = 0; v < stored.size(); ++v) {
      std::vector<index_t> found;
      implicit.for_each_conflict(v, [&](index_t u) { found.push_back(u); });
      if (!std::ranges::equal(found, stored.neighbours(v))) FAIL("candidate " << v);
      for (int i = 0; i < 20; ++i) {
        const auto u = static_cast<index_t>(engine() % stored.size());
        if (implicit.conflicts(u, v) != stored.adjacent(u, v)) FAIL("candidates " << u << " and " << v);
      }
    }
  }
}

TEST_CASE("parts of both graphs are the same", "[selection][implicit]") {
  std::mt19937_64 engine(6);
  for (const PotentialHexahedra& candidates : meshes_and_random()) {
    const auto stored = build_incompatibility_graph(candidates);
    const ImplicitIncompatibilityGraph implicit(candidates, volume_times_quality(candidates));
    std::vector<index_t> kept;
    for (index_t v = 0; v < stored.size(); ++v)
      if (engine() % 3 != 0) kept.push_back(v);
    const auto part = detail::induced_subgraph(stored, kept);
    const auto same = detail::induced_subgraph(implicit, kept);
    CHECK(part.n_conflicts() > 0);
    CHECK(part.rows().offsets == same.rows().offsets);
    CHECK(part.rows().values == same.rows().values);
    CHECK(std::ranges::equal(part.weights_in_units(), same.weights_in_units()));
  }
}

TEST_CASE("both graphs give the same selections", "[selection][implicit]") {
  const auto none = Observer{};
  for (const PotentialHexahedra& candidates : meshes_and_random()) {
    const auto weight = distinct_weight(candidates);
    const auto stored = build_incompatibility_graph(candidates, weight);
    const ImplicitIncompatibilityGraph implicit(candidates, weight);
    const auto greedy = select_greedily(stored);
    CHECK(select_greedily(implicit) == greedy);
    CHECK(verify::is_maximal(stored, greedy));
    CHECK(verify::is_maximal(implicit, greedy));
    if (stored.size() < 200) CHECK(select_dynamically(implicit) == select_dynamically(stored));
    CHECK(detail::contenders(implicit, greedy, 0.3, detail::never) ==
          detail::contenders(stored, greedy, 0.3, detail::never));

    detail::Deadline deadline(1e9, none);
    detail::ContenderSearch among_stored(stored, 1, deadline);
    detail::ContenderSearch among_implicit(implicit, 1, deadline);
    const auto improved = among_stored.improve(greedy, detail::by_number);
    CHECK(among_implicit.improve(greedy, detail::by_number) == improved);
    CHECK(verify::is_maximal(stored, improved));
    CHECK(select(implicit).members == select(stored).members);

    // Local search and windows straight on the implicit graph.
    if (stored.size() > 200) continue;
    IteratedSearch on_stored(stored, greedy);
    IteratedSearch on_implicit(implicit, greedy);
    on_stored.solve_windows(40, 500, detail::never);
    on_implicit.solve_windows(40, 500, detail::never);
    CHECK(on_implicit.members() == on_stored.members());
  }
}

TEST_CASE("the bound by tetrahedra holds, and cliques lower it", "[selection][implicit][threads]") {
  for (std::uint64_t seed = 0; seed < 6; ++seed) {
    const PotentialHexahedra candidates = test::random_candidates(seed, 150, 60, 100);
    const ImplicitIncompatibilityGraph graph(candidates, volume_times_quality(candidates));
    const Selection best = select(graph);
    REQUIRE(best.status == SelectionStatus::optimal);
    const Selection unproven = select(graph, {.gap = 1, .exact_below = 0});
    const Selection proven = select(graph, {.gap = 0.01, .exact_below = 0});
    for (const Selection* selection : {&unproven, &proven}) {
      CHECK(selection->bound >= best.weight);
      CHECK(selection->weight <= best.weight);
      CHECK(verify::is_maximal(graph, selection->members));
    }
    CHECK(unproven.status == SelectionStatus::budget_exhausted);
    CHECK(unproven.gap() > 0.05);
    CHECK(proven.gap() < unproven.gap() / 2);
    CHECK(select(graph, {.method = SelectMethod::greedy}).bound >= best.weight);
    const Selection threads = select(graph, {.gap = 0.01, .exact_below = 0}, ThreadExecutor(3));
    CHECK(threads.members == proven.members);
    CHECK(threads.bound == proven.bound);
  }
}

TEST_CASE("components are proven each for itself", "[selection][select][regression]") {
  // The relaxation of a cycle of five is half a member too large: only a tree proves it.
  constexpr index_t n_cycles = 2000;
  std::vector<double> weights(5 * n_cycles, 1.0);
  std::vector<std::array<index_t, 2>> conflicts;
  for (index_t v = 0; v < 5 * n_cycles; ++v) conflicts.push_back({v, v % 5 == 4 ? v - 4 : v + 1});
  const Selection selection = select(make_incompatibility_graph(weights, conflicts), {.exact_below = 100});
  CHECK(selection.status == SelectionStatus::optimal);
  CHECK(selection.weight == 2 * n_cycles);
}
