// SPDX-License-Identifier: BSL-1.0
#include "framehex/adapters/lemon_matcher.hpp"
#include "framehex/io/outline_reader.hpp"
#include "framehex/pipeline/mesh_planar.hpp"

#include "support/outlines.hpp"
#include "support/quad_checks.hpp"

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

TEST_CASE("a hole is a hole, whatever joins it to the other loops") {
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
