// SPDX-License-Identifier: BSL-1.0
#include "framehex/selection/conflict_search.hpp"
#include "framehex/selection/select.hpp"
#include "framehex/verify/independence.hpp"

#include "support/random_candidates.hpp"

#include <catch2/catch.hpp>

#include <random>
#include <set>

using namespace framehex;
using test::random_candidates;

namespace {

using Pair = std::array<index_t, 2>;

bool is_edge(const std::array<index_t, 8>& cell, index_t u, index_t v) {
  for (const auto& [a, b] : cell_tables::hexahedron_edges)
    if ((cell[static_cast<std::size_t>(a)] == u && cell[static_cast<std::size_t>(b)] == v) ||
        (cell[static_cast<std::size_t>(a)] == v && cell[static_cast<std::size_t>(b)] == u))
      return true;
  return false;
}

std::vector<std::array<index_t, 4>> faces(const std::array<index_t, 8>& cell) {
  std::vector<std::array<index_t, 4>> result;
  for (const auto& face : cell_tables::hexahedron_faces) {
    std::array<index_t, 4> corners{};
    for (std::size_t k = 0; k < 4; ++k) corners[k] = cell[static_cast<std::size_t>(face.corners[k])];
    result.push_back(corners);
  }
  return result;
}

bool same_face(const std::array<index_t, 4>& x, const std::array<index_t, 4>& y) {
  for (std::size_t shift = 0; shift < 4; ++shift) {
    bool forward = true, backward = true;
    for (std::size_t k = 0; k < 4; ++k) {
      forward = forward && x[k] == y[(k + shift) % 4];
      backward = backward && x[k] == y[(shift + 4 - k) % 4];
    }
    if (forward || backward) return true;
  }
  return false;
}

/// The rules one by one, as a conforming mesh needs them.
bool clash(const PotentialHexahedra& candidates, index_t i, index_t j) {
  for (const index_t s : candidates.tets[i])
    for (const index_t t : candidates.tets[j])
      if (s == t) return true;
  const std::array<std::array<index_t, 8>, 2> cells{candidates.vertices[i], candidates.vertices[j]};
  for (int side = 0; side < 2; ++side) {
    const auto& mine = cells[static_cast<std::size_t>(side)];
    const auto& other = cells[static_cast<std::size_t>(1 - side)];
    const std::set<index_t> theirs(other.begin(), other.end());
    for (const auto& face : faces(mine)) {
      std::size_t shared = 0;
      for (const index_t v : face) shared += theirs.count(v);
      bool is_theirs = false;
      for (const auto& their_face : faces(other)) is_theirs = is_theirs || same_face(face, their_face);
      if (shared >= 3 && !is_theirs) return true;
      for (std::size_t k = 0; k < 2; ++k) {
        if (is_edge(other, face[k], face[k + 2])) return true;
        if (is_theirs) continue;
        for (const auto& their_face : faces(other))
          for (std::size_t l = 0; l < 2; ++l)
            if (std::set<index_t>{face[k], face[k + 2]} == std::set<index_t>{their_face[l], their_face[l + 2]})
              return true;
      }
    }
  }
  return false;
}

}  // namespace

TEST_CASE("conflicts are those of the rules, one by one", "[selection][graph][threads]") {
  for (std::uint64_t seed = 0; seed < 12; ++seed) {
    const auto candidates = random_candidates(seed, 120, seed < 4 ? 11 : seed < 8 ? 18 : 40, 400);
    const auto graph = build_incompatibility_graph(candidates);
    REQUIRE(graph.size() == 120);
    std::size_t n = 0;
    for (index_t i = 0; i < 120; ++i)
      for (index_t j = 0; j < 120; ++j) {
        if (i == j) continue;
        const bool expected = clash(candidates, i, j);
        n += expected;
        if (graph.adjacent(i, j) != expected) FAIL("seed " << seed << ": candidates " << i << " and " << j);
      }
    CHECK(graph.n_conflicts() == n / 2);
    CHECK(n > 0);
    const auto threads = build_incompatibility_graph(candidates, volume_times_quality(candidates), ThreadExecutor(3));
    CHECK(threads.rows().values == graph.rows().values);
  }
}

TEST_CASE("two hexahedra with a common face, edge or vertex fit", "[selection][graph]") {
  PotentialHexahedra candidates;
  candidates.vertices = {{0, 1, 2, 3, 4, 5, 6, 7},       // the first
                         {4, 5, 6, 7, 8, 9, 10, 11},     // on its top face
                         {6, 5, 9, 12, 13, 14, 15, 16},  // at the edge 5 6, but across the edge 5 9 of the second
                         {0, 20, 21, 22, 23, 24, 25, 26},
                         {4, 6, 5, 7, 30, 31, 32, 33}};  // the corners of the top face in another order
  for (index_t i = 0; i < 5; ++i) {
    candidates.tets.values.push_back(i);
    candidates.tets.end_row();
    candidates.face_slivers.end_row();
    candidates.quality.push_back(1);
    candidates.volume.push_back(1);
  }
  const auto graph = build_incompatibility_graph(candidates);
  CHECK_FALSE(graph.adjacent(0, 1));
  CHECK_FALSE(graph.adjacent(0, 2));
  CHECK(graph.adjacent(1, 2));  // three corners 5 6 9 of a face of the second without the fourth
  CHECK_FALSE(graph.adjacent(0, 3));
  CHECK(graph.adjacent(0, 4));
  CHECK(graph.adjacent(1, 4));
}

TEST_CASE("graphs from outside are checked", "[selection][graph]") {
  const std::vector<double> one(3, 1.0);
  const auto graph = make_incompatibility_graph(one, std::vector<Pair>{{0, 1}, {1, 0}, {0, 1}, {2, 1}});
  CHECK(graph.n_conflicts() == 2);
  CHECK(graph.degree(1) == 2);
  CHECK_THROWS_AS(make_incompatibility_graph(one, std::vector<Pair>{{1, 1}}), invalid_graph);
  CHECK_THROWS_AS(make_incompatibility_graph(one, std::vector<Pair>{{0, 3}}), invalid_graph);
  for (const double bad : {-1.0, std::nan(""), std::numeric_limits<double>::infinity()}) {
    const std::vector<double> weights{1.0, bad, 1.0};
    try {
      make_incompatibility_graph(weights, {});
      FAIL("no error");
    } catch (const invalid_weight& e) {
      CHECK(e.entity() == Entity::candidate);
      CHECK(e.indices() == std::vector<std::size_t>{1});
    }
  }
  const auto from_rows = [&](std::vector<offset_t> offsets, std::vector<index_t> values) {
    return IncompatibilityGraph(Csr<index_t>{std::move(offsets), std::move(values)}, one);
  };
  CHECK(from_rows({0, 1, 3, 4}, {1, 0, 2, 1}).n_conflicts() == 2);
  CHECK_THROWS_AS(from_rows({0, 1, 1, 1}, {1}), invalid_graph);           // not mirrored
  CHECK_THROWS_AS(from_rows({0, 1, 1, 1}, {0}), invalid_graph);           // itself
  CHECK_THROWS_AS(from_rows({0, 1, 1, 1}, {7}), invalid_graph);           // out of range
  CHECK_THROWS_AS(from_rows({0, 2, 3, 4}, {2, 1, 0, 0}), invalid_graph);  // does not ascend
  CHECK_THROWS_AS(from_rows({0, 1, 3}, {1, 0, 2}), invalid_graph);        // sizes differ

  auto candidates = random_candidates(1, 3, 20, 10);
  candidates.vertices[2][5] = candidates.vertices[2][0];
  CHECK_THROWS_AS(build_incompatibility_graph(candidates), invalid_connectivity);
}

TEST_CASE("weights are exact multiples of a power of two", "[selection][graph]") {
  const auto whole = make_incompatibility_graph(std::vector<double>{3, 0, 12345678901.0}, {});
  CHECK(whole.unit() == 1.0);
  CHECK(whole.weight(2) == 12345678901.0);
  const std::vector<double> mixed{0.1, 1.0 / 3, 2.5e-3, 0};
  const auto graph = make_incompatibility_graph(mixed, {});
  for (index_t v = 0; v < 4; ++v) CHECK(graph.weight(v) == Approx(mixed[v]).epsilon(1e-11));
  const auto huge = make_incompatibility_graph(std::vector<double>{1e300, 1e-300, 1e300}, {});
  CHECK(huge.weight(0) == Approx(1e300));
  CHECK(huge.weight(1) == 0);
  const auto tiny = make_incompatibility_graph(std::vector<double>{1e-300, 2e-300}, {});
  CHECK(tiny.weight(1) > 0);
}

TEST_CASE("statistics of a graph", "[selection][graph]") {
  const auto graph = make_incompatibility_graph(std::vector<double>(6, 1.0), std::vector<Pair>{{0, 1}, {1, 2}, {4, 5}});
  const auto s = statistics(graph);
  CHECK(s.n_candidates == 6);
  CHECK(s.n_conflicts == 3);
  CHECK(s.mean_degree == Approx(1.0));
  CHECK(s.largest_degree == 2);
  CHECK(s.n_components == 3);
  CHECK(s.largest_component == 3);
  CHECK(statistics(IncompatibilityGraph{}).n_components == 0);
}

TEST_CASE("the verifier names what is wrong", "[selection][verify]") {
  const auto path = make_incompatibility_graph(std::vector<double>(4, 1.0), std::vector<Pair>{{0, 1}, {1, 2}, {2, 3}});
  CHECK(verify::is_maximal(path, std::vector<index_t>{0, 2}));
  CHECK(verify::is_maximal(path, std::vector<index_t>{3, 1}));
  CHECK(verify::is_independent(path, std::vector<index_t>{0}));
  CHECK_FALSE(verify::is_maximal(path, std::vector<index_t>{0}));
  const auto report = verify::check_independence(path, std::vector<index_t>{1, 2, 9, 1});
  CHECK(report.conflicts == std::vector<Pair>{{1, 2}});
  CHECK(report.invalid == std::vector<std::size_t>{9, 1});
  CHECK(verify::check_independence(path, std::vector<index_t>{0}).addable == std::vector<index_t>{2, 3});
}
