// SPDX-License-Identifier: BSL-1.0
#include "framehex/adapters/tetgen_process.hpp"
#include "framehex/tetrahedralization/repeated.hpp"
#include "support/kuhn_lattice.hpp"
#include "support/temporary_folder.hpp"

#include <catch2/catch.hpp>

#include <clocale>
#include <cstdlib>
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

TEST_CASE("tetgen is understood by a host whose decimal point is a comma", "[regression]") {
  const test::TemporaryFolder folder;
  // A locale of our own making, so that none has to be there.
  const std::string command =
      "localedef -c -i de_DE -f UTF-8 " + (folder / "de_DE.UTF-8").string() + " >/dev/null 2>&1";
  REQUIRE(std::system(command.c_str()) == 0);
  ::setenv("LOCPATH", folder.path().c_str(), 1);
  const bool set = std::setlocale(LC_NUMERIC, "de_DE.UTF-8") != nullptr;
  Cube cube;
  for (Vector3& p : cube.surface.points) p /= 7;
  for (Vector3& p : cube.interior) p /= 7;
  CHECK(std::to_string(0.5) == "0,500000");
  CHECK_NOTHROW(tetrahedralize(TetgenProcess{}, cube.surface, cube.interior));
  std::setlocale(LC_NUMERIC, "C");
  ::unsetenv("LOCPATH");
  CHECK(set);
}

TEST_CASE("points that come back in another order are refused, however small the mesh", "[regression]") {
  const test::TemporaryFolder folder;
  // TetGen, and then the first two points of its answer swapped.
  const auto program =
      folder.write("tetgen",
                   "#!/bin/sh\ntetgen \"$@\" || exit\nnode=\"${2%.smesh}.1.node\"\n"
                   "awk 'NR == 2 { $1 = 1; held = $0; next } NR == 3 { $1 = 0; print; print held; next } "
                   "{ print }' \"$node\" >\"$node.new\" && mv \"$node.new\" \"$node\"\n");
  std::filesystem::permissions(program, std::filesystem::perms::owner_all);
  Cube cube;
  for (const double scale : {1.0, 1e-13}) {
    for (Vector3& p : cube.surface.points) p *= scale;
    CHECK_NOTHROW(tetrahedralize(TetgenProcess{}, cube.surface, {}));
    CHECK_THROWS_WITH(tetrahedralize(TetgenProcess{.program = program.string()}, cube.surface, {}),
                      Catch::Contains("renumbered its input at point 0"));
  }
}

TEST_CASE("a tetgen that fails though nothing crosses is asked to take the points in another order", "[regression]") {
  const Cube cube;
  const test::TemporaryFolder folder;
  const auto program = folder.write("lost-tetgen",
                                    "#!/bin/sh\necho \"$1\" >> \"$0.asked\"\n"
                                    "case \"$1\" in *b0) exec tetgen \"$@\";; *) kill -ABRT $$;; esac\n");
  std::filesystem::permissions(program, std::filesystem::perms::owner_all);
  const auto asked = tetrahedralize(TetgenProcess{.program = program.string()}, cube.surface, cube.interior);
  CHECK(asked.mesh.tets.size() >= 5 * 27);
  CHECK(detail::read_text(folder / "lost-tetgen.asked") ==
        TetgenProcess{}.switches + "\n-dBF\n" + TetgenProcess{}.switches + "b0\n");
}

TEST_CASE("points that a tetrahedraliser added and does not use are forgotten, those that it uses are counted",
          "[regression]") {
  const Cube cube;
  const auto answer = [&](const TetrahedralizationRequest& request) {
    // The first tetrahedron is cut from a point inside; points 64 and 66 of the answer stay unused.
    TetrahedralizationResult result{.tets = cube.tets, .extra_points = std::vector<Vector3>(3, Vector3::Zero())};
    const auto t = result.tets.front();
    for (const index_t v : t) result.extra_points[1] += request.points[v] / 4;
    for (std::size_t i = 0; i < 4; ++i) {
      auto part = t;
      part[i] = 65;
      if (i == 0)
        result.tets.front() = part;
      else
        result.tets.push_back(part);
    }
    return result;
  };
  const Tetrahedralization result = tetrahedralize(answer, cube.surface, cube.interior);
  CHECK(result.n_extra_points == 1);
  CHECK(result.mesh.points.size() == 65);
  CHECK(result.mesh.tets.size() == cube.tets.size() + 3);
  CHECK_NOTHROW(validate(result.mesh));
}

TEST_CASE("surface points nearer to each other than a hundred-millionth of the box are kept", "[regression]") {
  Cube cube;
  // An edge is cut next to its end: two points a billionth apart.
  const auto [a, b, c] = cube.surface.triangles.front();
  const auto n = static_cast<index_t>(cube.surface.points.size());
  cube.surface.points.push_back(cube.surface.points[a] + 1e-9 * (cube.surface.points[b] - cube.surface.points[a]));
  for (std::size_t i = 0, end = cube.surface.triangles.size(); i < end; ++i)
    for (std::size_t k = 0; k < 3; ++k) {
      auto& t = cube.surface.triangles[i];
      const index_t from = t[k], to = t[(k + 1) % 3], apex = t[(k + 2) % 3];
      if (!(from == a && to == b) && !(from == b && to == a)) continue;
      t = {from, n, apex};
      cube.surface.triangles.push_back({n, to, apex});
      break;
    }
  const Tetrahedralization result = tetrahedralize(TetgenProcess{}, cube.surface, cube.interior);
  CHECK(result.n_extra_points == 0);
  CHECK(result.mesh.points.size() == 65);
}

TEST_CASE("a tetrahedraliser that loses inner points is asked again without them", "[regression]") {
  Cube cube;
  SECTION("those that it names") {
    cube.interior.push_back(cube.interior.front());
    cube.interior.emplace_back(5, 5, 5);
    const auto result = tetrahedralize_repeatedly(TetgenProcess{}, cube.surface, cube.interior);
    CHECK(result.result.mesh.points.size() == 64);
    REQUIRE(result.dropped.size() == 2);
    CHECK((result.dropped[0] == 0 || result.dropped[0] == 8));
    CHECK(result.dropped[1] == 9);
  }
  SECTION("those round a triangle that is lost while they are there") {
    const Vector3 corner = cube.surface.points[cube.surface.triangles[0][0]];
    const auto sensitive = [&](const TetrahedralizationRequest& request) {
      TetrahedralizationResult result = TetgenProcess{}(request);
      for (std::size_t v = request.n_surface_points; v < request.points.size(); ++v)
        if ((request.points[v] - corner).norm() < 2) {
          result.tets.clear();  // every triangle is lost
          break;
        }
      return result;
    };
    const auto result = tetrahedralize_repeatedly(sensitive, cube.surface, cube.interior);
    CHECK_FALSE(result.dropped.empty());
    CHECK(result.result.mesh.points.size() + result.dropped.size() == 64);
  }
  SECTION("and not for ever") {
    int n_asked = 0;
    const auto failing = [&](const TetrahedralizationRequest&) -> TetrahedralizationResult {
      ++n_asked;
      throw tetrahedralization_error("no");
    };
    CHECK_THROWS_AS(tetrahedralize_repeatedly(failing, cube.surface, cube.interior), tetrahedralization_error);
    CHECK(n_asked == 2);  // with the points and without
  }
}
