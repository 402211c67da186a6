// SPDX-License-Identifier: BSL-1.0
#include "framehex/recombination/compatibility.hpp"
#include "framehex/recombination/pattern_search.hpp"
#include "framehex/recombination/potential_hex_finder.hpp"
#include "support/delaunay_lattice.hpp"
#include "support/hexahedron_symmetry.hpp"
#include "support/kuhn_lattice.hpp"

#include <catch2/catch.hpp>

using namespace framehex;

namespace {

/// Whether a hexahedron of at most seven tetrahedra has one of them at a corner, or all six round a body diagonal.
bool has_pattern(const IndexedTetMesh& mesh, const PotentialHexahedra& h, std::size_t i) {
  if (h.tets[i].size() > 7) return false;
  const auto n_with = [&](std::initializer_list<int> corners) {
    return std::ranges::count_if(h.tets[i], [&](index_t t) {
      return std::ranges::all_of(corners, [&](int c) {
        return std::ranges::find(mesh.tets[t], h.vertices[i][static_cast<std::size_t>(c)]) != mesh.tets[t].end();
      });
    });
  };
  for (const LocalCorner& c : corners_of(CellKind::hexahedron))
    if (n_with({c.corner, c.x, c.y, c.z}) == 1) return true;
  return h.tets[i].size() == 6 &&
         (n_with({0, 6}) == 6 || n_with({1, 7}) == 6 || n_with({2, 4}) == 6 || n_with({3, 5}) == 6);
}

double mean_degree(const PotentialHexahedra& h) {
  std::size_t conflicts = 0;
  for (std::size_t i = 0; i < h.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) conflicts += !compatible(h, i, j);
  return 2.0 * static_cast<double>(conflicts) / static_cast<double>(h.size());
}

}  // namespace

TEST_CASE("Patterns find what the complete search finds of their kind") {
  std::size_t n_beyond = 0;
  for (unsigned seed = 0; seed < 8; ++seed) {
    const auto mesh = seed == 0 ? test::kuhn_lattice(4) : test::DelaunayLattice(3, seed, 0.2 * seed).mesh;
    const FinderOptions options{.quality_floor = 0.01,
                                .boundary_rule = seed % 2 ? BoundaryRule::ignore : BoundaryRule::both_or_neither};
    const auto all = find_potential_hexahedra(mesh, options);
    std::set<std::array<index_t, 8>> expected, found;
    for (std::size_t i = 0; i < all.size(); ++i)
      if (has_pattern(mesh, all, i)) expected.insert(test::canonical_hexahedron(all.vertices[i]));
    const auto patterns = find_pattern_hexahedra(mesh, options);
    for (const auto& v : patterns.vertices) found.insert(test::canonical_hexahedron(v));
    CHECK(found.size() == patterns.size());
    CHECK(found == expected);
    n_beyond += all.size() - found.size();
  }
  CHECK(n_beyond > 0);
}

TEST_CASE("The paper's cubes lie between ties broken by chance and ties broken alike") {
  struct Row {
    index_t n;
    std::size_t n_tets, n_hexahedra;
    double degree;
  };
  for (const Row& paper : {Row{3, 162, 181, 68}, Row{4, 387, 469, 76}, Row{5, 756, 992, 86}}) {
    std::size_t fewest = 1u << 30, most = 0;
    for (unsigned seed = 0; seed < 20; ++seed) {
      const auto mesh = test::DelaunayLattice(paper.n, seed).mesh;
      const std::size_t n = find_pattern_hexahedra(mesh, {.quality_floor = 0.25}).size();
      fewest = std::min(fewest, n);
      most = std::max(most, n);
      CHECK(mesh.tets.size() > paper.n_tets);
    }
    CAPTURE(paper.n, fewest, most);
    CHECK(most < paper.n_hexahedra);
    const auto kuhn = test::kuhn_lattice(paper.n);
    const auto alike = find_pattern_hexahedra(kuhn, {.quality_floor = 0.25});
    CHECK(kuhn.tets.size() <= paper.n_tets);
    CHECK(alike.size() > paper.n_hexahedra);
    if (paper.n == 3) {
      CHECK(mean_degree(alike) > paper.degree);
      CHECK(mean_degree(find_pattern_hexahedra(test::DelaunayLattice(3, 0).mesh, {.quality_floor = 0.25})) <
            paper.degree);
    }
  }
}

TEST_CASE("Conflicts on the cube of two") {
  // Eight unit cubes: the aligned hexahedra are compatible with one another, and nothing else is with all of them.
  const auto mesh = test::kuhn_lattice(2);
  const auto found = find_potential_hexahedra(mesh, {.quality_floor = 1e-4});
  std::vector<std::size_t> cubes;
  for (std::size_t i = 0; i < found.size(); ++i)
    if (found.quality[i] > 0.999f) cubes.push_back(i);
  REQUIRE(cubes.size() == 8);
  for (const std::size_t i : cubes)
    for (const std::size_t j : cubes) CHECK(compatible(found, i, j) == (i != j));
  for (std::size_t i = 0; i < found.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) CHECK(compatible(found, i, j) == compatible(found, j, i));
}

TEST_CASE("Faces of two cells fit, or not") {
  using Vertices = std::vector<index_t>;
  const Vertices cube{0, 1, 2, 3, 4, 5, 6, 7};
  const auto hex = [&](const Vertices& v) { return faces_fit(CellKind::hexahedron, cube, CellKind::hexahedron, v); };
  CHECK(hex({8, 9, 10, 11, 12, 13, 14, 15}));
  CHECK(hex({6, 9, 10, 11, 12, 13, 14, 15}));        // a vertex
  CHECK(hex({6, 7, 10, 11, 12, 13, 14, 15}));        // an edge
  CHECK(hex({4, 5, 6, 7, 12, 13, 14, 15}));          // a face
  CHECK_FALSE(hex({4, 6, 5, 7, 12, 13, 14, 15}));    // its vertices in another order
  CHECK_FALSE(hex({4, 6, 10, 11, 12, 13, 14, 15}));  // a diagonal as an edge
  CHECK_FALSE(hex({4, 5, 6, 11, 12, 13, 14, 15}));   // three vertices of a face
  CHECK_FALSE(hex({4, 8, 6, 11, 12, 13, 14, 15}));   // the diagonal of another face
  const auto with = [&](CellKind kind, const Vertices& v) { return faces_fit(CellKind::hexahedron, cube, kind, v); };
  CHECK(with(CellKind::pyramid, {4, 5, 6, 7, 20}));
  CHECK(with(CellKind::prism, {20, 5, 6, 21, 4, 7}));
  CHECK_FALSE(with(CellKind::prism, {4, 5, 6, 20, 21, 22}));  // a triangle on a quadrilateral
  CHECK_FALSE(with(CellKind::pyramid, {4, 5, 20, 21, 6}));
}
