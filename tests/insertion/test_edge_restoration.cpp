// SPDX-License-Identifier: BSL-1.0
#include "framehex/insertion/edge_restoration.hpp"
#include "framehex/mesh/validation.hpp"
#include "support/small_delaunay.hpp"

#include <catch2/catch.hpp>

#include <set>

using namespace framehex;

namespace {

double volume(const IndexedTetMesh& mesh) {
  double sum = 0;
  for (const auto& t : mesh.tets)
    sum += orientation_determinant(mesh.points[t[0]], mesh.points[t[1]], mesh.points[t[2]], mesh.points[t[3]]) / 6;
  return sum;
}

std::set<VertexPair> edges_of(const IndexedTetMesh& mesh) {
  std::set<VertexPair> edges;
  for (const auto& t : mesh.tets)
    for (const index_t a : t)
      for (const index_t b : t)
        if (a < b) edges.insert({a, b});
  return edges;
}

/// Facets that bound one tetrahedron, ascending corners.
std::set<std::array<index_t, 3>> boundary_of(const IndexedTetMesh& mesh) {
  std::set<std::array<index_t, 3>> open;
  for (const auto& t : mesh.tets)
    for (std::size_t i = 0; i < 4; ++i) {
      std::array<index_t, 3> f{t[(i + 1) % 4], t[(i + 2) % 4], t[(i + 3) % 4]};
      std::sort(f.begin(), f.end());
      if (open.erase(f) == 0) open.insert(f);
    }
  return open;
}

bool is_tet(const IndexedTetMesh& mesh, index_t a, index_t b, index_t c, index_t d) {
  return orientation(mesh.points[a], mesh.points[b], mesh.points[c], mesh.points[d]) > 0;
}

/// Is there a facet with p and q on its two sides whose three edges see pq pass inside? By all pairs of tetrahedra.
bool facet_between(const IndexedTetMesh& mesh, index_t p, index_t q) {
  for (const auto& t : mesh.tets)
    for (int i = 0; i < 4; ++i) {
      if (t[static_cast<std::size_t>(i)] != p) continue;
      const auto f = facet(t, i);
      for (const auto& u : mesh.tets) {
        const auto in_u = [&](index_t v) { return std::find(u.begin(), u.end(), v) != u.end(); };
        if (in_u(q) && std::all_of(f.begin(), f.end(), in_u) && is_tet(mesh, p, q, f[0], f[1]) &&
            is_tet(mesh, p, q, f[1], f[2]) && is_tet(mesh, p, q, f[2], f[0]))
          return true;
      }
    }
  return false;
}

/// Four tetrahedra round the axis of an octahedron: 0 to 3 round it, 4 below, 5 above.
IndexedTetMesh octahedron() {
  return {{{1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}, {0, 0, -1}, {0, 0, 1}},
          {{4, 5, 0, 1}, {4, 5, 1, 2}, {4, 5, 2, 3}, {4, 5, 3, 0}}};
}

}  // namespace

TEST_CASE("an edge that crosses one facet is put in by three tetrahedra for two") {
  IndexedTetMesh mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.3, 0.3, 1}, {0.3, 0.3, -1}}, {{0, 1, 2, 3}, {0, 2, 1, 4}}};
  const double before = volume(mesh);
  const std::vector<VertexPair> wanted{{3, 4}};
  const EdgeRestoration result = restore_edges(mesh, wanted);
  CHECK(result.n_missing == 1);
  CHECK(result.n_restored == 1);
  CHECK(mesh.tets.size() == 3);
  CHECK(volume(mesh) == Approx(before));
  CHECK_NOTHROW(validate(mesh));
}

TEST_CASE("an edge that leaves the two tetrahedra is not put in") {
  IndexedTetMesh mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.3, 0.3, 1}, {3, 0.3, -1}}, {{0, 1, 2, 3}, {0, 2, 1, 4}}};
  const IndexedTetMesh before = mesh;
  const std::vector<VertexPair> wanted{{3, 4}};
  CHECK(restore_edges(mesh, wanted).n_restored == 0);
  CHECK(mesh.tets == before.tets);
}

TEST_CASE("an edge that crosses the axis of four tetrahedra replaces it, unless the axis is wanted too") {
  IndexedTetMesh mesh = octahedron();
  const double before = volume(mesh);
  const std::vector<VertexPair> wanted{{0, 2}}, both{{0, 2}, {4, 5}};
  CHECK(restore_edges(mesh, wanted).n_restored == 1);
  CHECK(mesh.tets.size() == 4);
  CHECK(volume(mesh) == Approx(before));
  CHECK(edges_of(mesh).contains({0, 2}));
  CHECK_FALSE(edges_of(mesh).contains({4, 5}));
  CHECK_NOTHROW(validate(mesh));
  mesh = octahedron();
  CHECK(restore_edges(mesh, both).n_restored == 0);
  CHECK(edges_of(mesh).contains({4, 5}));
}

TEST_CASE("the boundary stays: an edge in its plane is not flipped") {
  IndexedTetMesh mesh{{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0.5, 0.5, 1}}, {{0, 1, 2, 4}, {0, 2, 3, 4}}};
  const IndexedTetMesh before = mesh;
  const std::vector<VertexPair> wanted{{1, 3}};
  CHECK(restore_edges(mesh, wanted).n_restored == 0);
  CHECK(mesh.tets == before.tets);
}

TEST_CASE("edges and diagonals of a shaken lattice come where a flip can bring them, and nothing else changes") {
  std::mt19937_64 engine(11);
  std::size_t n_restored = 0;
  for (int trial = 0; trial < 40; ++trial) {
    IndexedTetMesh mesh = test::small_delaunay(test::jittered_lattice(3, 3, 3, 0.3, engine));
    std::vector<VertexPair> wanted;
    for (index_t v = 0; v < 27; ++v) {
      if (v % 3 < 2) wanted.push_back({v, v + 1});
      if (v / 3 % 3 < 2) wanted.push_back({v, v + 3});
      if (v < 18) wanted.push_back({v, v + 9});
      if (v % 3 < 2 && v / 3 % 3 < 2) wanted.push_back({v, v + 4});  // and one diagonal of each horizontal face
    }
    std::sort(wanted.begin(), wanted.end());
    const auto edges_before = edges_of(mesh);
    const auto boundary_before = boundary_of(mesh);
    const double before = volume(mesh);
    const EdgeRestoration result = restore_edges(mesh, wanted);
    CAPTURE(trial);
    REQUIRE_NOTHROW(validate(mesh));
    CHECK(volume(mesh) == Approx(before).epsilon(1e-12));
    CHECK(boundary_of(mesh) == boundary_before);
    const auto edges = edges_of(mesh);
    std::size_t n_missing_before = 0, n_missing = 0;
    for (const VertexPair& e : wanted) {
      n_missing_before += !edges_before.contains(e);
      n_missing += !edges.contains(e);
      if (edges_before.contains(e)) CHECK(edges.contains(e));
      if (!edges.contains(e)) CHECK_FALSE(facet_between(mesh, e[0], e[1]));
    }
    CHECK(result.n_missing == n_missing_before);
    CHECK(result.n_restored == n_missing_before - n_missing);
    n_restored += result.n_restored;
  }
  CHECK(n_restored > 20);
}

TEST_CASE("a lattice point that is no vertex of the mesh is refused") {
  IndexedTetMesh mesh = octahedron();
  const LatticeLinks<6> links(3, {no_index, no_index, no_index, no_index, no_index, no_index});
  const auto n = static_cast<index_t>(mesh.points.size());
  CHECK_THROWS_WITH(restore_lattice(mesh, links, [n](index_t p) { return p == 2 ? n : p; }),
                    "lattice point 2 is not a vertex of the mesh");
}

TEST_CASE("a quadrilateral without a diagonal wants the shorter one") {
  // The quadrilateral 0 1 2 3 of a lattice, split by an edge from below to above through its middle.
  IndexedTetMesh mesh = octahedron();
  mesh.points[0].x() = 0.9;
  const std::array<index_t, 8> cell{0, 1, 2, 3, 0, 1, 2, 3};
  CHECK(missing_diagonals(mesh, std::span(&cell, 1)) == std::vector<VertexPair>{{0, 2}});
  mesh.points[0].x() = 1.1;
  CHECK(missing_diagonals(mesh, std::span(&cell, 1)) == std::vector<VertexPair>{{1, 3}});
  mesh.tets = {{0, 2, 1, 5}, {0, 2, 3, 4}};
  CHECK(missing_diagonals(mesh, std::span(&cell, 1)).empty());
}
