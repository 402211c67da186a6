// SPDX-License-Identifier: BSL-1.0
#include "framehex/recombination/potential_hex_finder.hpp"
#include "framehex/recombination/potential_prism_finder.hpp"
#include "framehex/recombination/potential_pyramid_finder.hpp"
#include "support/reference_hexahedra.hpp"
#include "support/small_delaunay.hpp"

#include <catch2/catch.hpp>

using namespace framehex;

namespace {

template <int Corners>
std::set<test::ReferenceCell> as_reference(const Candidates<Corners>& found) {
  std::set<test::ReferenceCell> cells;
  for (std::size_t i = 0; i < found.size(); ++i)
    cells.insert({{found.vertices[i].begin(), found.vertices[i].end()}, {found.tets[i].begin(), found.tets[i].end()}});
  REQUIRE(cells.size() == found.size());
  return cells;
}

IndexedTetMesh random_mesh(unsigned seed) {
  std::mt19937_64 engine(seed);
  if (seed % 5 == 4) {  // no lattice at all
    std::vector<Vector3> points = test::jittered_lattice(11, 1, 1, 1, engine);
    for (Vector3& p : points) p.x() = std::fmod(p.x() + 20, 1.7);
    return test::small_delaunay(points);
  }
  auto points = test::jittered_lattice(3, 2, 2, 0.05 + 0.07 * (seed % 4), engine);
  if (seed % 2 == 0) points.erase(points.begin() + seed % 12);
  return test::small_delaunay(points);
}

}  // namespace

TEST_CASE("Equal to brute force over all sets of vertices on random Delaunay meshes") {
  std::size_t n_hexahedra = 0;
  for (unsigned seed = 0; seed < 50; ++seed) {
    const IndexedTetMesh mesh = random_mesh(seed);
    CAPTURE(seed, mesh.tets.size());
    const bool rule = seed % 2 == 1;
    const FinderOptions options{.quality_floor = seed % 3 == 0 ? 0.0 : 0.05,
                                .boundary_rule = rule ? BoundaryRule::both_or_neither : BoundaryRule::ignore};
    const test::ReferenceFinder reference(mesh, options.quality_floor, rule);
    const auto hexahedra = as_reference(find_potential_hexahedra(mesh, options));
    CHECK(hexahedra == reference.hexahedra());
    CHECK(as_reference(find_potential_prisms(mesh, options)) == reference.cells(CellKind::prism, 6));
    CHECK(as_reference(find_potential_pyramids(mesh, options)) == reference.cells(CellKind::pyramid, 5));
    n_hexahedra += hexahedra.size();
  }
  CHECK(n_hexahedra > 250);
}
