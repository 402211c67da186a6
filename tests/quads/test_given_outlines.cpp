// SPDX-License-Identifier: BSL-1.0
#include "framehex/adapters/lemon_matcher.hpp"
#include "framehex/io/outline_reader.hpp"
#include "framehex/io/triangle_soup.hpp"
#include "framehex/pipeline/mesh_planar.hpp"
#include "framehex/pipeline/mesh_shell.hpp"
#include "framehex/verify/quad_quality.hpp"

#include "support/outlines.hpp"
#include "support/quad_checks.hpp"
#include "support/surfaces.hpp"

#include <catch2/catch.hpp>

#include <set>

using namespace framehex;
using namespace framehex::test;

namespace {

PlanarOutline text(const std::string& lines) {
  return detail::read_text_outline("text", lines);
}

double area(const QuadMesh& mesh) {
  double sum = 0;
  for (const auto& c : mesh.cells)
    sum += (mesh.points[c[2]] - mesh.points[c[0]]).cross(mesh.points[c[3]] - mesh.points[c[1]]).z() / 2;
  return sum;
}

/// Of a mesh that has to have no triangle and no folded cell.
void check_domain(const PlanarOutline& outline, double size, double wanted, int characteristic, std::size_t n_regions) {
  const QuadMeshing result = mesh_planar(outline, ConstantSize{size}, LemonMatcher{});
  CHECK(result.mesh.n_triangles() == 0);
  CHECK(area(result.mesh) == Approx(wanted));
  CHECK(euler_characteristic(result.mesh) == characteristic);
  CHECK(std::set<index_t>(result.mesh.patches.begin(), result.mesh.patches.end()).size() == n_regions);
}

}  // namespace

TEST_CASE("a hole is a hole, whatever joins it to the other loops", "[regression]") {
  const std::string box = "0 0\n1 0\n2 0\n2 1\n1 1\n0 1\n\n", hole = ".9 .4\n1.1 .4\n1.1 .6\n.9 .6\n\n";
  // The characteristic counts vertices, edges and cells: a touched vertex once.
  check_domain(text(box + hole), 0.1, 1.96, 0, 1);
  check_domain(text(box + hole + "inner\n1.1 .6\n2 1\n"), 0.1, 1.96, 0, 1);
  check_domain(text(box + hole + "inner\n1.1 .6\n2 1\n\ninner\n.9 .4\n0 0\n"), 0.1, 1.96, 0, 2);
  check_domain(text(box + hole + "inner\n.9 .6\n.7 .6\n.7 .4\n.9 .4\n"), 0.1, 1.96, 0, 2);
  check_domain(text(box + "1 0\n1.2 .3\n.8 .3\n"), 0.1, 1.94, 0, 1);
  check_domain(text(box + "1 0\n1.3 .5\n1 1\n.7 .5\n"), 0.1, 1.7, 0, 2);
  check_domain(text("0 0\n1 0\n1 1\n0 1\n\n0 0\n.5 .2\n.2 .5\n"), 0.1, 0.895, 0, 1);
  check_domain(text(box + ".5 .2\n1.5 .2\n1.5 .8\n.5 .8\n\n.8 .4\n1.2 .4\n1.2 .6\n.8 .6\n\ninner\n1 0\n1.5 .2\n"), 0.1,
               1.48, 1, 2);
  // An island that touches the hole it lies in.
  check_domain(text(box + ".5 .2\n1.5 .2\n1.5 .8\n.5 .8\n\n.5 .2\n1.2 .4\n.8 .6\n"), 0.1, 2 - 0.6 + 0.11, 0, 2);
}

TEST_CASE("loops that are given segment by segment bound what they enclose") {
  const auto segments = [](const std::vector<Vector2>& points, const std::vector<std::array<index_t, 2>>& pairs) {
    PlanarOutline outline;
    outline.points = points;
    for (const auto& pair : pairs) {
      outline.loops.values.insert(outline.loops.values.end(), pair.begin(), pair.end());
      outline.loops.end_row();
    }
    return outline;
  };
  const std::vector<Vector2> box{{0, 0}, {2, 0}, {2, 1}, {0, 1}};
  const std::vector<std::array<index_t, 2>> sides{{0, 1}, {1, 2}, {2, 3}, {3, 0}};
  const auto with = [](auto list, std::initializer_list<typename decltype(list)::value_type> more) {
    list.insert(list.end(), more);
    return list;
  };
  check_domain(segments(box, sides), 0.2, 2, 1, 1);
  check_domain(segments(box, with(sides, {{0, 2}})), 0.2, 2, 1, 2);  // a diagonal
  const auto hole = with(box, {{0.9, 0.4}, {1.1, 0.4}, {1, 0.6}});
  const auto both = with(sides, {{4, 5}, {5, 6}, {6, 4}});
  check_domain(segments(hole, both), 0.1, 1.98, 0, 1);
  check_domain(segments(hole, with(both, {{0, 4}})), 0.1, 1.98, 0, 1);  // a segment joins both
}

TEST_CASE("text outlines: what a line may hold, and which line is refused", "[regression]") {
  const auto refused = [](const std::string& lines, std::size_t line) {
    CAPTURE(lines);
    try {
      text(lines);
      FAIL("was read");
    } catch (const io_error& e) {
      CHECK(e.entity() == Entity::line);
      CHECK(e.indices() == std::vector<std::size_t>{line});
      CHECK(std::string(e.what()).find("line " + std::to_string(line)) != std::string::npos);
    }
  };
  refused("0 0\n1\n1 1\n0 1\n", 2);
  refused("0 0\n1 0\n1\n1\n0 1\n", 3);
  refused("0 0\n1 0 0\n1 1\n", 2);
  refused("0 0\n1 0\n1 1 0 1", 3);
  refused("0 0\n1,0\n1 1\n", 2);
  refused("0 0\n1 zero\n1 1\n", 2);
  refused("0 0\n1 0\n1 1\n\ninner\n", 5);
  refused("0 0\n1 0\n1 1\n\ninner\n\n\n", 5);
  refused("0 0\n1 0\n1 1\ninner\n# none\ninner\n0 0\n1 1\n", 4);
  refused("0 0\n1 0\ninner 0\n", 3);
  for (const char* const lines :
       {"0 0\n1 0\n1 1\n0 1\n\ninner\n0 0\n1 1\n", "\xEF\xBB\xBF# a box\n0 0\n1 0\n1 1\n0 1\ninner\n0 0\n1 1",
        "0 0#first\n1 0\n  # a remark\n#\n1 1 # third\n0 1\n\n\n \t\nInner # across\n\n0 0\n# on the way\n1 1\n\n",
        "0 0\r\n1 0\r\n1 1\r\n0 1\r\n\r\ninner\r\n0 0\r\n1 1\r\n"}) {
    CAPTURE(lines);
    const PlanarOutline outline = text(lines);
    CHECK(outline.points.size() == 4);
    REQUIRE(outline.loops.size() == 1);
    CHECK(outline.loops[0].size() == 5);
    REQUIRE(outline.inner.size() == 1);
    CHECK(outline.inner[0].size() == 2);
  }
}

TEST_CASE("what is wrong in an OBJ outline or a loop is named where it stands", "[regression]") {
  const std::string square = "v 0 0\nv 1 0\nv 1 1\nv 0 1\nl 1 2 3 4 1\n";
  for (const char* const line : {"l 2 9", "l 2 -5", "l 2 x", "l 0 1"}) {
    CAPTURE(line);
    try {
      detail::read_obj_outline("obj", square + line + "\nv 5 5\n");
      FAIL("was read");
    } catch (const io_error& e) {
      CHECK(e.indices() == std::vector<std::size_t>{6});
    }
  }
  try {
    mesh_planar(text("0 0\n1 0\n1 1\n0 1\n\n.3 .3\n.4 .4\n"), ConstantSize{0.25}, LemonMatcher{});
    FAIL("was meshed");
  } catch (const error& e) {
    CHECK(std::string(e.what()).find("loop 1 goes to and fro") != std::string::npos);
  }
}

TEST_CASE("outlines with z lie in one plane z = const, and so does the mesh") {
  const auto obj = [](const std::string& lines) { return detail::read_obj_outline("obj", lines + "l 1 2 3 4 1\n"); };
  const QuadMeshing high =
      mesh_planar(obj("v 0 0 1.5\nv 1 0 1.5\nv 1 1 1.5\nv 0 1 1.5\n"), ConstantSize{0.25}, LemonMatcher{});
  CHECK(high.mesh.cells.size() == 16);
  for (const Vector3& p : high.mesh.points) CHECK(p.z() == 1.5);
  CHECK(obj("v 0 0\nv 1 0\nv 1 1\nv 0 1\n").z == 0);
  for (const char* const lines : {"v 0 0 0\nv 1 0 0\nv 1 1 .5\nv 0 1 .5\n", "v 0 0 2\nv 1 0 2\nv 1 1\nv 0 1 2\n"}) {
    try {
      obj(lines);
      FAIL("was read");
    } catch (const invalid_coordinate& e) {
      CHECK(e.indices() == std::vector<std::size_t>{2});
    }
  }
  MixedMesh upright;  // in the plane y = 0, points (0, z) twice
  upright.points = {{0, 0, 0}, {1, 0, 0}, {1, 0, 1}, {0, 0, 1}};
  for (index_t i = 0; i < 4; ++i) upright.edges.push_back({{i, (i + 1) % 4}, 0});
  CHECK_THROWS_AS(outline_of_edges("mesh", upright), invalid_coordinate);
}

TEST_CASE("shells: a triangle that is listed twice is refused, both named", "[regression]") {
  for (const bool turned : {false, true}) {
    IndexedTriangleMesh surface = sphere_surface(1, 2);
    const std::array<index_t, 3> t = surface.triangles[7];
    surface.triangles.push_back(turned ? std::array{t[1], t[0], t[2]} : std::array{t[1], t[2], t[0]});
    try {
      mesh_shell(surface, ConstantSize{0.4}, LemonMatcher{});
      FAIL("was meshed");
    } catch (const invalid_connectivity& e) {
      CHECK(e.entity() == Entity::triangle);
      CHECK(e.indices() == std::vector<std::size_t>{7, surface.triangles.size() - 1});
    }
  }
}

TEST_CASE("shells: of a one-sided surface two triangles are named that run the same way in the file", "[regression]") {
  const IndexedTriangleMesh strip = moebius_strip(12);
  for (std::size_t shift = 0; shift < strip.triangles.size(); shift += 5) {
    IndexedTriangleMesh file = strip;
    std::rotate(file.triangles.begin(), file.triangles.begin() + static_cast<std::ptrdiff_t>(shift),
                file.triangles.end());
    try {
      mesh_shell(surface_of_soup(file).surface, ConstantSize{0.3}, LemonMatcher{});
      FAIL("was meshed");
    } catch (const nonmanifold& e) {
      REQUIRE(e.indices().size() == 2);
      std::set<std::array<index_t, 2>> sides;
      for (const std::size_t t : e.indices())
        for (std::size_t i = 0; i < 3; ++i) sides.insert({file.triangles[t][i], file.triangles[t][(i + 1) % 3]});
      CHECK(sides.size() == 5);  // one of six is there twice
    }
  }
}

TEST_CASE("shells: vertices of a curve next to the same point are refused as an outline's are, both named",
          "[regression]") {
  for (const double apart : {1e-9, 1e-10, 1e-13}) {
    CAPTURE(apart);
    const std::vector<Vector3> points{{0, 0, 0}, {1, 0, 0}, {1, apart, 0}, {1, 1, 0}, {0, 1, 0}};
    PlanarOutline outline;
    for (const Vector3& p : points) outline.points.emplace_back(p.x(), p.y());
    outline.loops.values = {0, 1, 2, 3, 4, 0};
    outline.loops.end_row();
    const IndexedTriangleMesh shell{points, {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}}};
    const auto refused = [](const auto& mesh) {
      try {
        mesh();
      } catch (const error& e) {
        CHECK(e.entity() == Entity::vertex);
        return e.indices();
      }
      FAIL("was meshed");
      return std::vector<std::size_t>{};
    };
    const auto named = refused([&] { mesh_planar(outline, ConstantSize{0.2}, LemonMatcher{}); });
    CHECK(std::set(named.begin(), named.end()) == std::set<std::size_t>{1, 2});
    CHECK(refused([&] { mesh_shell(shell, ConstantSize{0.2}, LemonMatcher{}); }) == std::vector<std::size_t>{1, 2});
  }
  // What both can do is not refused.
  const IndexedTriangleMesh near{{{0, 0, 0}, {1, 0, 0}, {1, 1e-6, 0}, {1, 1, 0}, {0, 1, 0}},
                                 {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}}};
  CHECK(mesh_shell(near, ConstantSize{0.2}, LemonMatcher{}).mesh.n_triangles() == 0);
}

TEST_CASE("shells: a triangle without area is refused by number on a rim, and does no harm elsewhere", "[regression]") {
  for (const double height : {0.0, 1e-12, 1e-9}) {
    CAPTURE(height);
    // Its corner 2 lies on the rim (0, 1).
    const IndexedTriangleMesh rim{{{0, 0, 0}, {1, 0, 0}, {0.5, height, 0}, {0, 1, 0}, {1, 1, 0}},
                                  {{3, 0, 2}, {0, 1, 2}, {2, 1, 4}, {2, 4, 3}}};
    try {
      mesh_shell(rim, ConstantSize{0.5}, LemonMatcher{});
      FAIL("was meshed");
    } catch (const invalid_surface& e) {
      CHECK(e.entity() == Entity::triangle);
      CHECK(e.indices() == std::vector<std::size_t>{1});
    }
    const IndexedTriangleMesh inside{{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0.5, 0.5 + height, 0}},
                                     {{0, 1, 2}, {0, 2, 4}, {0, 4, 3}, {4, 2, 3}}};
    const QuadMeshing meshed = mesh_shell(inside, ConstantSize{0.25}, LemonMatcher{});
    CHECK(meshed.mesh.n_triangles() == 0);
    CHECK(area(meshed.mesh) == Approx(1));
  }
}

TEST_CASE("the indices add up to the characteristic where rims touch and where sheets meet", "[regression]") {
  const auto check = [](const QuadMesh& mesh, int characteristic) {
    const verify::QuadQuality quality = verify::quad_quality(mesh);
    CHECK(quality.n_triangles == 0);
    CHECK(quality.euler_characteristic == characteristic);
    CHECK(quality.index_sum == 4 * characteristic);
  };
  const auto planar = [](const std::string& lines) {
    return mesh_planar(text(lines), ConstantSize{0.1}, LemonMatcher{}).mesh;
  };
  const std::string box = "0 0\n1 0\n2 0\n2 1\n1 1\n0 1\n\n";
  // A closed disc has 1, and each open hole that is taken out of it, wherever it touches, one less.
  check(planar(box + "1 0\n1.2 .3\n.8 .3\n"), 0);                           // a hole that touches the rim
  check(planar(box + "1 0\n1.3 .5\n1 1\n.7 .5\n"), 0);                      // at both ends
  check(planar(box + ".5 .5\n.8 .3\n.8 .7\n\n.8 .3\n1.2 .5\n1 .2\n"), -1);  // two holes that touch
  check(planar("0 0\n1 0\n1 1\n0 1\n\n1 1\n2 1\n2 2\n1 2\n"), 1);           // two discs, less the point they share
  check(planar("0 0\n1 0\n1 1\n0 1\n\n2 0\n3 0\n3 1\n2 1\n"), 2);           // apart
  // Three sheets at an edge.
  const IndexedTriangleMesh fin{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}},
                                {{0, 1, 2}, {1, 0, 3}, {0, 1, 4}}};
  check(mesh_shell(fin, ConstantSize{0.25}, LemonMatcher{}).mesh, 1);
  const IndexedTriangleMesh bow{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}}, {{0, 1, 2}, {0, 3, 4}}};
  check(mesh_shell(bow, ConstantSize{0.25}, LemonMatcher{}).mesh, 1);
  // A closed body with a wall across.
  QuadMesh cells;
  cells.points = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {0, 1, 0}, {1, 1, 0}, {2, 1, 0},
                  {0, 0, 1}, {1, 0, 1}, {2, 0, 1}, {0, 1, 1}, {1, 1, 1}, {2, 1, 1}};
  cells.cells = {{0, 3, 4, 1},  {1, 4, 5, 2},   {6, 7, 10, 9}, {7, 8, 11, 10}, {0, 1, 7, 6}, {1, 2, 8, 7},
                 {3, 9, 10, 4}, {4, 10, 11, 5}, {0, 6, 9, 3},  {2, 5, 11, 8},  {1, 4, 10, 7}};
  check(cells, 3);  // of two spheres that share a disc: 2 + 2 - 1
}

TEST_CASE("regions given as loops with a side in common: the error tells how to give them", "[regression]") {
  try {
    triangulate_outline(text("0 0\n1 0\n1 1\n0 1\n\n1 0\n2 0\n2 1\n1 1\n"));
    FAIL("was taken");
  } catch (const invalid_outline& e) {
    CHECK(e.entity() == Entity::edge);
    const std::string what = e.what();
    for (const char* const words : {"(2, 1)", "loop 0", "loop 1", "twice", "`inner`"}) {
      CAPTURE(what, words);
      CHECK(what.find(words) != std::string::npos);
    }
  }
  // What it tells is right.
  check_domain(text("0 0\n1 0\n2 0\n2 1\n1 1\n0 1\n\ninner\n1 0\n1 1\n"), 0.2, 2, 1, 2);
}

TEST_CASE("errors about segments name the loops that have them", "[regression]") {
  const auto message = [](const std::string& lines) {
    try {
      triangulate_outline(text(lines));
    } catch (const invalid_outline& e) {
      return std::string(e.what());
    }
    return std::string("none");
  };
  const std::string box = "0 0\n4 0\n4 4\n0 4\n\n";
  CHECK(message(box + "1 1\n5 1\n1 2\n") == "segment (4, 5) of loop 1 and segment (1, 2) of loop 0 cross");
  CHECK(message(box + "1 0\n2 1\n1 1\n") == "vertex 4 of loop 1 lies on segment (0, 1) of loop 0");
  CHECK(message(box + "inner\n1 1\n5 1\n") == "segment (4, 5) of inner polyline 0 and segment (1, 2) of loop 0 cross");
}

TEST_CASE("thin rectangles are cut across, and no finer than the size", "[regression]") {
  for (const double width : {1e-3, 1e-4, 1e-5, 1e-6, 1e-7}) {
    CAPTURE(width);
    const QuadMeshing result = mesh_planar(one_loop(rectangle(1, width)), ConstantSize{0.2}, LemonMatcher{});
    CHECK(result.mesh.cells.size() == 5);
    const verify::QuadQuality quality = verify::quad_quality(result.mesh);
    CHECK(quality.n_triangles == 0);
    CHECK(quality.least == Approx(1));
  }
}
