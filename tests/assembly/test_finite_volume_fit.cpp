// SPDX-License-Identifier: BSL-1.0
#include "framehex/mesh/indexed_mesh.hpp"
#include "framehex/pipeline/recombine.hpp"
#include "framehex/verify/conformity.hpp"
#include "framehex/verify/solver_quality.hpp"
#include "framehex/verify/validity.hpp"
#include "support/jittered_delaunay.hpp"
#include "support/kuhn_lattice.hpp"

#include <catch2/catch.hpp>

using namespace framehex;

namespace {

RecombineOptions for_finite_volumes() {
  RecombineOptions options;
  options.assembly.fit = CellFit::finite_volume;
  return options;
}

void check_fit(const Recombination& result, double volume) {
  CHECK(verify::is_valid(result.mesh));
  CHECK(verify::is_conforming(result.mesh));
  CHECK(verify::volume(result.mesh).cells == Approx(volume));
  const verify::SolverQuality quality = verify::solver_quality(result.mesh);
  CHECK(quality.small_determinant.empty());
  CHECK(quality.bad_decomposition.empty());
  CHECK(quality.small_weight.empty());
  CHECK(result.assembly.n_unfit == 0);
}

}  // namespace

TEST_CASE("no cell is left whose inner faces leave a direction out", "[assembly][finite volume]") {
  SECTION("one tetrahedron, all of whose faces are outside") {
    IndexedTetMesh mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 1, 2, 3}}};
    check_fit(recombine(mesh, for_finite_volumes()), 1.0 / 6);
  }
  SECTION("tetrahedra at the edges of a box") {
    RecombineOptions options = for_finite_volumes();
    options.finder.quality_floor = 1;  // none is so good after the jitter: tetrahedra only
    options.assembly.prisms = PrismMode::none;
    const IndexedTetMesh mesh = test::jittered_delaunay(3, 5, 0.1);
    const Recombination without = recombine(mesh, {.finder = options.finder});
    REQUIRE_FALSE(verify::solver_quality(without.mesh).small_determinant.empty());
    check_fit(recombine(mesh, options), 27);
  }
  SECTION("a plate of one hexahedron") {
    const IndexedTetMesh mesh = test::kuhn_lattice(4, 3, 1);
    REQUIRE(verify::solver_quality(recombine(mesh).mesh).small_determinant.size() == 12);
    check_fit(recombine(mesh, for_finite_volumes()), 12);
  }
}

TEST_CASE("distorted lattices fit finite volumes when asked to", "[assembly][finite volume]") {
  const unsigned seed = GENERATE(range(1u, 9u));
  const IndexedTetMesh mesh = test::jittered_delaunay(4, seed, 0.2);
  CAPTURE(seed);
  check_fit(recombine(mesh, for_finite_volumes()), 64);
}

TEST_CASE("a new vertex goes where its cells fit, which need not be where their shapes are best",
          "[assembly][finite volume]") {
  check_fit(recombine(test::jittered_delaunay(7, 3, 0.35), for_finite_volumes()), 343);
}
