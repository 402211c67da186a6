// SPDX-License-Identifier: BSL-1.0
#include "framehex/adapters/tetgen_process.hpp"
#include "framehex/tetrahedralization/tetrahedralizer.hpp"
#include "support/kuhn_lattice.hpp"

#include <catch2/catch.hpp>

#include <random>

using namespace framehex;

namespace {

/// A cube of 3^3 cells: its boundary, its interior points, and a tetrahedralisation known beforehand.
struct Cube {
  IndexedTriangleMesh surface;
  std::vector<Vector3> interior;
  std::vector<std::array<index_t, 4>> tets;  // in the numbering surface, interior

  Cube() {
    const IndexedTetMesh lattice = test::kuhn_lattice(3);
    const BoundarySurface boundary = extract_boundary(lattice, make_adjacency(lattice));
    surface = boundary.surface;
    std::vector<index_t> renumbered = boundary.surface_vertex;
    for (std::size_t v = 0; v < lattice.points.size(); ++v)
      if (renumbered[v] == no_index) {
        renumbered[v] = static_cast<index_t>(surface.points.size() + interior.size());
        interior.push_back(lattice.points[v]);
      }
    tets = lattice.tets;
    for (auto& t : tets)
      for (index_t& v : t) v = renumbered[v];
  }
};

/// Answers with what it was given.
struct Fake {
  std::vector<std::array<index_t, 4>> tets;
  TetrahedralizationResult operator()(const TetrahedralizationRequest&) const {
    return {.tets = tets, .extra_points = {}};
  }
};

}  // namespace

TEST_CASE("an honest tetrahedraliser passes the checks, in the numbering of the request") {
  const Cube cube;
  const Tetrahedralization result = tetrahedralize(Fake{cube.tets}, cube.surface, cube.interior);
  CHECK(result.mesh.tets == cube.tets);
  CHECK(result.mesh.points.size() == 64);
  CHECK(result.n_extra_points == 0);
}

TEST_CASE("every broken promise of a tetrahedraliser is found and named") {
  const Cube cube;
  SECTION("an inverted tetrahedron") {
    auto tets = cube.tets;
    std::swap(tets[5][0], tets[5][1]);
    try {
      tetrahedralize(Fake{tets}, cube.surface, cube.interior);
      FAIL("not found");
    } catch (const tetrahedralization_error& e) {
      CHECK(e.entity() == Entity::cell);
      CHECK(e.indices() == std::vector<std::size_t>{5});
    }
  }
  SECTION("an index out of range") {
    auto tets = cube.tets;
    tets[7][2] = 64;
    CHECK_THROWS_AS(tetrahedralize(Fake{tets}, cube.surface, cube.interior), tetrahedralization_error);
  }
  SECTION("a missing tetrahedron") {
    auto tets = cube.tets;
    tets.pop_back();
    CHECK_THROWS_AS(tetrahedralize(Fake{tets}, cube.surface, cube.interior), tetrahedralization_error);
  }
  SECTION("a point that is no vertex") {
    auto interior = cube.interior;
    interior.emplace_back(1.4, 1.4, 1.3);
    try {
      tetrahedralize(Fake{cube.tets}, cube.surface, interior);
      FAIL("not found");
    } catch (const tetrahedralization_error& e) {
      CHECK(e.entity() == Entity::vertex);
      CHECK(e.indices() == std::vector<std::size_t>{64});
    }
  }
}

TEST_CASE("a surface that cannot be filled is refused before any work") {
  Cube cube;
  SECTION("open") {
    cube.surface.triangles.pop_back();
    CHECK_THROWS_AS(tetrahedralize(Fake{}, cube.surface, {}), open_surface);
  }
  SECTION("inside out") {
    for (auto& t : cube.surface.triangles) std::swap(t[0], t[1]);
    CHECK_THROWS_AS(tetrahedralize(Fake{}, cube.surface, {}), invalid_surface);
  }
  SECTION("not finite") {
    cube.surface.points[3].y() = std::nan("");
    try {
      tetrahedralize(Fake{}, cube.surface, {});
      FAIL("not found");
    } catch (const invalid_coordinate& e) {
      CHECK(e.indices() == std::vector<std::size_t>{3});
    }
  }
}

TEST_CASE("tetgen fills a cube through its given points") {
  const Cube cube;
  SECTION("with the points of a lattice") {
    const Tetrahedralization result = tetrahedralize(TetgenProcess{}, cube.surface, cube.interior);
    CHECK(result.n_extra_points == 0);
    CHECK(result.mesh.points.size() == 64);
  }
  SECTION("with random points") {
    std::mt19937_64 random(1);
    const auto uniform = [&] { return 0.2 + 2.6 * static_cast<double>(random() >> 11) * 0x1p-53; };
    std::vector<Vector3> points;
    for (int i = 0; i < 300; ++i) points.emplace_back(uniform(), uniform(), uniform());
    const Tetrahedralization result = tetrahedralize(TetgenProcess{}, cube.surface, points);
    CHECK(result.mesh.points.size() == cube.surface.points.size() + 300);
  }
  SECTION("without any") {
    CHECK_FALSE(tetrahedralize(TetgenProcess{}, cube.surface, {}).mesh.tets.empty());
  }
}

TEST_CASE("what tetgen drops or refuses is a typed error") {
  Cube cube;
  SECTION("a duplicate point") {
    cube.interior.push_back(cube.interior.front());
    CHECK_THROWS_AS(tetrahedralize(TetgenProcess{}, cube.surface, cube.interior), tetrahedralization_error);
  }
  SECTION("a point outside") {
    cube.interior.emplace_back(5, 5, 5);
    CHECK_THROWS_AS(tetrahedralize(TetgenProcess{}, cube.surface, cube.interior), tetrahedralization_error);
  }
  SECTION("a surface that crosses itself, with two triangles that do") {
    cube.surface.points.front() = Vector3(2.2, 2.3, 5);
    try {
      tetrahedralize(TetgenProcess{}, cube.surface, {});
      FAIL("not found");
    } catch (const invalid_surface& e) {
      CHECK(e.entity() == Entity::triangle);
      REQUIRE(e.indices().size() == 2);
      CHECK(e.indices()[0] < cube.surface.triangles.size());
      CHECK(e.indices()[1] < cube.surface.triangles.size());
    }
  }
  SECTION("no such program") {
    try {
      tetrahedralize(TetgenProcess{.program = "no-such-tetgen"}, cube.surface, {});
      FAIL("not found");
    } catch (const tetrahedralization_error& e) {
      CHECK(std::string(e.what()).find("apt-get install tetgen") != std::string::npos);
    }
  }
  SECTION("cancelled") {
    const auto stop = [](const Progress&) { return false; };
    const Tetrahedralization result = tetrahedralize(TetgenProcess{}, cube.surface, cube.interior, stop);
    CHECK(result.status == Status::cancelled);
    CHECK(result.mesh.tets.empty());
  }
}
