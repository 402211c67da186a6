// SPDX-License-Identifier: BSL-1.0
#include "framehex/mesh/boundary.hpp"
#include "framehex/mesh/validation.hpp"
#include "support/kuhn_lattice.hpp"
#include "support/small_delaunay.hpp"

#include <catch2/catch.hpp>

#include <set>

using namespace framehex;

namespace {

std::set<index_t> corner_set(const std::array<index_t, 4>& tet) {
  return {tet.begin(), tet.end()};
}

/// Everything that an adjacency says, from the list of tetrahedra by comparing each with each.
void check_adjacency(const IndexedTetMesh& mesh) {
  const TetAdjacency a = make_adjacency(mesh);
  REQUIRE(a.tets == mesh.tets);
  REQUIRE(a.n_vertices() == mesh.points.size());
  for (index_t t = 0; t < mesh.tets.size(); ++t)
    for (std::size_t i = 0; i < 4; ++i) {
      auto others = corner_set(mesh.tets[t]);
      others.erase(mesh.tets[t][i]);
      index_t expected = no_index;
      for (index_t s = 0; s < mesh.tets.size(); ++s) {
        const auto candidate = corner_set(mesh.tets[s]);
        if (s != t && std::includes(candidate.begin(), candidate.end(), others.begin(), others.end())) expected = s;
      }
      REQUIRE(a.neighbours[t][i] == expected);
    }
  for (index_t v = 0; v < mesh.points.size(); ++v) {
    std::set<index_t> tets, vertices;
    for (index_t t = 0; t < mesh.tets.size(); ++t)
      if (corner_set(mesh.tets[t]).count(v) == 1) {
        tets.insert(t);
        vertices.insert(mesh.tets[t].begin(), mesh.tets[t].end());
      }
    vertices.erase(v);
    REQUIRE(std::ranges::equal(a.tets_of_vertex[v], tets));
    REQUIRE(std::ranges::equal(a.vertices_of_vertex[v], vertices));
  }
}

}  // namespace

TEST_CASE("Adjacency of tetrahedra agrees with comparing each with each") {
  check_adjacency(test::kuhn_lattice(2, 3, 1));
  std::mt19937_64 engine(1);
  check_adjacency(test::small_delaunay(test::jittered_lattice(3, 3, 2, 0.4, engine)));
  check_adjacency(IndexedTetMesh{});
  auto isolated = test::kuhn_lattice(1);
  isolated.points.emplace_back(9, 9, 9);
  check_adjacency(isolated);
}

TEST_CASE("A facet of three tetrahedra is refused with its vertices") {
  IndexedTetMesh mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, -1}, {0, 0, 2}},
                      {{0, 1, 2, 3}, {0, 2, 1, 4}, {0, 1, 2, 5}}};
  try {
    make_adjacency(mesh);
    FAIL("accepted");
  } catch (const nonmanifold& e) {
    CHECK(e.entity() == Entity::vertex);
    CHECK(e.indices() == std::vector<std::size_t>{0, 1, 2});
  }
}

TEST_CASE("Facets are opposite their corner and look outward") {
  const std::array<Vector3, 4> p{Vector3(0, 0, 0), Vector3(1, 0, 0), Vector3(0, 1, 0), Vector3(0, 0, 1)};
  for (int i = 0; i < 4; ++i) {
    const auto f = facet({0, 1, 2, 3}, i);
    CHECK(std::ranges::find(f, static_cast<index_t>(i)) == f.end());
    CHECK(orientation(p[f[0]], p[f[1]], p[f[2]], p[static_cast<std::size_t>(i)]) < 0);
  }
}

TEST_CASE("The boundary of a lattice is closed, outward and complete") {
  const auto mesh = test::kuhn_lattice(3, 2, 2);
  const auto adjacency = make_adjacency(mesh);
  const BoundarySurface b = extract_boundary(mesh, adjacency);
  CHECK(b.surface.triangles.size() == 2 * 2 * (3 * 2 + 3 * 2 + 2 * 2));
  validate_closed(b.surface);
  double volume = 0;
  for (const auto& t : b.surface.triangles)
    volume += b.surface.points[t[0]].dot(b.surface.points[t[1]].cross(b.surface.points[t[2]])) / 6;
  CHECK(volume == Approx(12));
  CHECK(std::ranges::is_sorted(b.vertex_of));
  CHECK(std::ranges::is_sorted(b.tet_of));
  for (index_t s = 0; s < b.vertex_of.size(); ++s) {
    CHECK(b.surface_vertex[b.vertex_of[s]] == s);
    CHECK(b.surface.points[s] == mesh.points[b.vertex_of[s]]);
  }
  CHECK(std::ranges::count(b.surface_vertex, no_index) == 2);  // the two inside
  for (std::size_t t = 0; t < b.tet_of.size(); ++t)
    for (const index_t v : b.surface.triangles[t])
      CHECK(std::ranges::find(mesh.tets[b.tet_of[t]], b.vertex_of[v]) != mesh.tets[b.tet_of[t]].end());
}

TEST_CASE("Valid meshes pass, and the checked adjacency is the adjacency") {
  for (index_t n = 1; n < 4; ++n) {
    const auto mesh = test::kuhn_lattice(n);
    CHECK_NOTHROW(validate(mesh));
    CHECK(validated_adjacency(mesh).neighbours == make_adjacency(mesh).neighbours);
  }
  CHECK_NOTHROW(validate(IndexedTetMesh{}));
  auto tiny = test::kuhn_lattice(2);
  for (Vector3& p : tiny.points) p *= 0x1p-101;  // lies between 1e-31 and 1e-30
  CHECK_THROWS_AS(validate(tiny), invalid_coordinate);
}

TEST_CASE("Each fault of a mesh is a typed error with the first offender") {
  const auto good = test::kuhn_lattice(2);
  const auto check = [](const IndexedTetMesh& mesh, auto error, Entity entity, std::vector<std::size_t> indices) {
    try {
      validate(mesh);
      FAIL("accepted");
    } catch (const decltype(error)& e) {
      CHECK(e.entity() == entity);
      CHECK(e.indices() == indices);
      CHECK(std::string(e.what()).find(std::to_string(indices[0])) != std::string::npos);
    }
  };
  auto mesh = good;
  mesh.points[5].z() = std::numeric_limits<double>::infinity();
  check(mesh, invalid_coordinate(""), Entity::vertex, {5});
  mesh.points[5].z() = -1e31;
  check(mesh, invalid_coordinate(""), Entity::vertex, {5});
  mesh = good;
  mesh.tets[9][3] = 27;
  check(mesh, invalid_connectivity(""), Entity::cell, {9});
  mesh = good;
  mesh.tets[9][3] = mesh.tets[9][1];
  check(mesh, invalid_connectivity(""), Entity::cell, {9});
  mesh = good;
  std::swap(mesh.tets[11][0], mesh.tets[11][3]);
  check(mesh, inverted_cell(""), Entity::cell, {11});
  // Flat to the last bit, and one bit away from it.
  mesh = {{{0, 0, 0}, {3, 0, 0}, {0, 3, 0}, {1, 1, 0}}, {{0, 1, 2, 3}}};
  check(mesh, inverted_cell(""), Entity::cell, {0});
  mesh.points[3].z() = 1e-300;
  CHECK_NOTHROW(validate(mesh));
  // The same side of a facet twice.
  mesh = {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, 2}}, {{0, 1, 2, 3}, {0, 1, 2, 4}}};
  check(mesh, nonmanifold(""), Entity::cell, {0, 1});
}
