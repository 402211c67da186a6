// SPDX-License-Identifier: BSL-1.0
#include "framehex/mesh/boundary.hpp"
#include "framehex/mesh/validation.hpp"
#include "support/kuhn_lattice.hpp"

#include <catch2/catch.hpp>

#include <map>
#include <set>

using namespace framehex;

namespace {

IndexedTriangleMesh box() {
  const auto mesh = test::kuhn_lattice(2);
  return extract_boundary(mesh, make_adjacency(mesh)).surface;
}

}  // namespace

TEST_CASE("Half edges of a closed surface pair up") {
  const auto surface = box();
  const TriangleAdjacency a = make_adjacency(surface);
  std::map<std::array<index_t, 2>, index_t> half_edges;
  for (index_t h = 0; h < a.opposite.size(); ++h) {
    half_edges[{a.from(h), a.to(h)}] = h;
    CHECK(a.next(a.previous(h)) == h);
    CHECK(a.previous(a.next(h)) == h);
    CHECK(a.to(h) == a.from(a.next(h)));
    CHECK(a.apex(h) == a.to(a.next(h)));
  }
  REQUIRE(half_edges.size() == a.opposite.size());
  for (const auto& [ends, h] : half_edges) CHECK(a.opposite[h] == half_edges.at({ends[1], ends[0]}));
  for (index_t v = 0; v < surface.points.size(); ++v) {
    std::set<index_t> triangles, vertices;
    for (index_t t = 0; t < surface.triangles.size(); ++t)
      if (std::ranges::find(surface.triangles[t], v) != surface.triangles[t].end()) {
        triangles.insert(t);
        vertices.insert(surface.triangles[t].begin(), surface.triangles[t].end());
      }
    vertices.erase(v);
    CHECK(std::ranges::equal(a.triangles_of_vertex[v], triangles));
    CHECK(std::ranges::equal(a.vertices_of_vertex[v], vertices));
  }
}

TEST_CASE("Rims, twisted and branching edges") {
  auto open = box();
  open.triangles.pop_back();
  const TriangleAdjacency a = make_adjacency(open);
  CHECK(std::ranges::count(a.opposite, no_index) == 3);
  CHECK_THROWS_AS(validate_closed(open), open_surface);
  CHECK_THROWS_AS(validate_closed(IndexedTriangleMesh{}), open_surface);

  auto twisted = box();
  std::swap(twisted.triangles[4][0], twisted.triangles[4][1]);
  CHECK_THROWS_AS(validate_closed(twisted), nonmanifold);

  auto branching = box();
  branching.points.emplace_back(5, 5, 5);
  const auto t = branching.triangles[0];
  branching.triangles.push_back({t[0], t[1], static_cast<index_t>(branching.points.size() - 1)});
  try {
    validate_closed(branching);
    FAIL("accepted");
  } catch (const nonmanifold& e) {
    CHECK(e.entity() == Entity::edge);
    CHECK(std::set<std::size_t>(e.indices().begin(), e.indices().end()) == std::set<std::size_t>{t[0], t[1]});
  }

  auto bad = box();
  bad.triangles[3][2] = 1000;
  CHECK_THROWS_AS(validate_closed(bad), invalid_connectivity);
  bad = box();
  bad.points[3].x() = std::nan("");
  CHECK_THROWS_AS(validate_closed(bad), invalid_coordinate);
}

TEST_CASE("Rows in compressed form") {
  const std::vector<std::array<index_t, 2>> pairs{{2, 7}, {0, 3}, {2, 5}, {0, 1}};
  const auto rows = make_csr(4, [&](auto&& put) {
    for (const auto& [row, value] : pairs) put(row, value);
  });
  REQUIRE(rows.size() == 4);
  CHECK(std::ranges::equal(rows[0], std::array{3u, 1u}));
  CHECK(rows[1].empty());
  CHECK(std::ranges::equal(rows[2], std::array{7u, 5u}));
  CHECK(rows[3].empty());
  Csr<index_t> grown;
  CHECK(grown.empty());
  grown.values = {4, 5};
  grown.end_row();
  grown.end_row();
  CHECK(grown.size() == 2);
  CHECK(grown[0].size() == 2);
  CHECK(grown[1].empty());
}
