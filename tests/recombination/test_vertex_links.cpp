// SPDX-License-Identifier: BSL-1.0
#include "framehex/recombination/potential_hex_finder.hpp"
#include "support/delaunay_lattice.hpp"
#include "support/heavy_meshes.hpp"
#include "support/reference_hexahedra.hpp"

#include <catch2/catch.hpp>

using namespace framehex;

namespace {

/// Tetrahedra from the centre of a sphere to the triangles of a twice-cut octahedron: 8 4^level of them.
IndexedTetMesh star(int level) {
  IndexedTetMesh mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {-1, 0, 0}, {0, -1, 0}, {0, 0, -1}}, {}};
  std::vector<std::array<index_t, 3>> triangles{{1, 2, 3}, {2, 4, 3}, {4, 5, 3}, {5, 1, 3},
                                                {2, 1, 6}, {4, 2, 6}, {5, 4, 6}, {1, 5, 6}};
  for (; level > 0; --level) {
    std::map<std::set<index_t>, index_t> middles;
    std::vector<std::array<index_t, 3>> finer;
    const auto middle = [&](index_t v, index_t w) {
      const auto [at, is_new] = middles.insert({{v, w}, static_cast<index_t>(mesh.points.size())});
      if (is_new) mesh.points.push_back((mesh.points[v] + mesh.points[w]).normalized());
      return at->second;
    };
    for (const auto& [a, b, c] : triangles) {
      const index_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      finer.insert(finer.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
    }
    triangles = finer;
  }
  for (const auto& [a, b, c] : triangles) mesh.tets.push_back({0, a, b, c});
  return mesh;
}

void check_links(const IndexedTetMesh& mesh) {
  const auto adjacency = make_adjacency(mesh);
  const detail::VertexLinks links(adjacency);
  std::set<std::array<index_t, 3>> facets;
  for (const auto& t : mesh.tets)
    for (int i = 0; i < 4; ++i) facets.insert(detail::sorted(facet(t, i)));
  const auto is_facet = [&](index_t u, index_t v, index_t w) { return facets.count(detail::sorted({u, v, w})) == 1; };
  std::size_t n_opposites = 0;
  for (index_t v = 0; v < mesh.points.size(); ++v) {
    const auto ring = links.neighbours(v);
    const bool heavy = ring.size() > 100;
    for (index_t i = 0; i < ring.size(); i += heavy ? 7 : 1) {
      REQUIRE(links.position(v, ring[i]) == i);
      for (index_t j = 0; j < ring.size(); j += heavy ? 3 : 1) {
        if (i == j) continue;
        REQUIRE(links.are_linked(v, i, j) == is_facet(v, ring[i], ring[j]));
        std::set<index_t> expected, found;
        for (index_t o = 0; o < mesh.points.size(); ++o)
          if (o != v && ((is_facet(v, ring[i], o) && is_facet(v, o, ring[j])) ||
                         (is_facet(v, ring[i], ring[j]) && is_facet(ring[i], ring[j], o))))
            expected.insert(o);
        links.for_each_opposite(v, i, j, [&](index_t o) {
          REQUIRE(found.insert(o).second);
          REQUIRE(links.is_opposite(v, i, j, o));
        });
        REQUIRE(found == expected);
        n_opposites += found.size();
      }
    }
    REQUIRE(links.position(v, v) == no_index);
    REQUIRE(links.position(v, 1000000) == no_index);
  }
  CHECK(n_opposites > 0);
}

}  // namespace

TEST_CASE("Links of vertices, light and heavy, agree with the set of facets") {
  check_links(test::DelaunayLattice(3, 1).mesh);
  check_links(star(2));  // 66 neighbours: just beyond one word
  check_links(star(3));
  check_links(test::fan(120));
  check_links(test::banded_star(7));
}

TEST_CASE("Hexahedra at a vertex with 512 tetrahedra and an edge with 500") {
  const auto round = star(3);
  REQUIRE(round.tets.size() == 512);
  const FinderOptions options{.quality_floor = 1e-3, .boundary_rule = BoundaryRule::ignore};
  const auto found = find_potential_hexahedra(round, options);
  CHECK(found.size() > 100);
  const test::ReferenceFinder reference(round, options.quality_floor, false);
  for (std::size_t i = 0; i < found.size(); i += 7) {
    test::ReferenceCell cell;
    CHECK(reference.is_potential(CellKind::hexahedron, {found.vertices[i].begin(), found.vertices[i].end()}, cell));
    CHECK(cell.tets == std::set<index_t>(found.tets[i].begin(), found.tets[i].end()));
  }
  // Round one edge every hexahedron would have to bend through it.
  CHECK(find_potential_hexahedra(test::fan(500), options).empty());
}

TEST_CASE("Edges with many tetrahedra hide no hexahedra") {
  // By the symmetry of the bands the number grows by one constant from each n to the next, below and above the
  // number of tetrahedra round an edge from which only triangles in reach of one another make quadrilaterals.
  const auto count = [](index_t n) {
    return find_potential_hexahedra(test::banded_star(n), {.quality_floor = 1e-4}).size();
  };
  const std::size_t step = count(9) - count(8);
  CHECK(step > 0);
  CHECK(count(12) == count(8) + 4 * step);
  CHECK(count(20) == count(8) + 12 * step);
}
