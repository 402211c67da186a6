// SPDX-License-Identifier: BSL-1.0
#include <catch2/catch.hpp>

#include "framehex/assembly/optimization.hpp"
#include "framehex/mesh/boundary.hpp"
#include "framehex/surface/boundary_slider.hpp"
#include "framehex/verify/validity.hpp"
#include "support/cube_candidates.hpp"

#include <numbers>

using namespace framehex;

namespace {

MixedMesh hexahedral_lattice(index_t n) {
  MixedMesh mesh;
  mesh.points = test::kuhn_lattice(n).points;
  for (const auto& cube : test::cube_candidates(n).vertices) mesh.add(CellKind::hexahedron, cube);
  return mesh;
}

}  // namespace

TEST_CASE("a vertex that was pushed aside comes back far enough", "[assembly]") {
  MixedMesh mesh = hexahedral_lattice(2);
  mesh.points[13] += Vector3(0.6, 0.5, 0.3);  // the only interior vertex
  const auto result = optimize(mesh, {.hexahedron_target = 0.6});
  CHECK(result.before[3] < 0.4);
  CHECK(result.after[3] >= 0.55);
  CHECK(result.n_moved == 1);
  CHECK(verify::is_valid(mesh));
}

TEST_CASE("good meshes stay as they are", "[assembly]") {
  MixedMesh mesh = hexahedral_lattice(3);
  const auto points = mesh.points;
  const auto result = optimize(mesh);
  CHECK(result.n_moved == 0);
  CHECK(mesh.points == points);
  CHECK(result.after[3] == Approx(1));
  CHECK(result.after[0] == 2);
}

TEST_CASE("boundary vertices slide on their side or edge of a cube and corners stay", "[assembly]") {
  const IndexedTetMesh lattice = test::kuhn_lattice(2);
  MixedMesh mesh = hexahedral_lattice(2);
  const IndexedTriangleMesh surface = extract_boundary(lattice, make_adjacency(lattice)).surface;
  // Patches by the direction of the normal; one curve for each edge of the cube.
  FeatureGraph features;
  features.n_patches = 6;
  for (const auto& t : surface.triangles) {
    const auto& p = surface.points;
    const Vector3 n = (p[t[1]] - p[t[0]]).cross(p[t[2]] - p[t[0]]);
    int axis = 0;
    n.cwiseAbs().maxCoeff(&axis);
    features.triangle_patch.push_back(static_cast<index_t>(2 * axis + (n[axis] > 0 ? 1 : 0)));
  }
  const auto find = [](const std::vector<Vector3>& points, const Vector3& p) {
    return static_cast<index_t>(std::find(points.begin(), points.end(), p) - points.begin());
  };
  std::vector<LabelledEdge> edges;
  index_t label = 0;
  for (int axis = 0; axis < 3; ++axis)
    for (const double u : {0.0, 2.0})
      for (const double v : {0.0, 2.0}) {
        std::array<index_t, 3> at{};
        for (int i = 0; i < 3; ++i) {
          Vector3 p;
          p[axis] = i;
          p[(axis + 1) % 3] = u;
          p[(axis + 2) % 3] = v;
          features.curves.values.push_back(find(surface.points, p));
          at[static_cast<std::size_t>(i)] = find(mesh.points, p);
        }
        features.curves.end_row();
        edges.push_back({{at[0], at[1]}, label});
        edges.push_back({{at[1], at[2]}, label++});
      }
  const index_t on_side = find(mesh.points, {1, 1, 0}), on_edge = find(mesh.points, {1, 0, 0});
  mesh.points[on_side] += Vector3(0.7, 0.6, 0);
  mesh.points[on_edge] += Vector3(0.8, 0, 0);
  const BoundarySlider slider({surface.points, make_adjacency(surface), features}, mesh.points, edges, 1e-9);
  Vector3 place(0.1, 0.2, 0.3);
  CHECK_FALSE(slider(find(mesh.points, {0, 0, 0}), place));
  CHECK(place == Vector3(0.1, 0.2, 0.3));
  CHECK(slider(on_edge, place));
  CHECK(place == Vector3(0.1, 0, 0));
  place = {0.4, 2.5, 0.3};
  CHECK(slider(on_side, place));
  CHECK((place - Vector3(0.4, 2, 0)).norm() < 1e-12);

  const auto result = optimize(mesh, {.hexahedron_target = 0.7, .boundary_projection = slider});
  CHECK(result.before[3] < 0.45);
  CHECK(result.after[3] >= 0.6);
  CHECK(mesh.points[on_side].z() == Approx(0).margin(1e-12));
  CHECK(mesh.points[on_edge].y() == Approx(0).margin(1e-12));
  CHECK(mesh.points[on_edge].z() == Approx(0).margin(1e-12));
  CHECK(verify::is_valid(mesh));
  CHECK(verify::volume(mesh).cells == Approx(8));
}

TEST_CASE("the only corner of a closed curve is fixed, as are vertices off the surface", "[assembly]") {
  const IndexedTriangleMesh surface{{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 3}}};
  FeatureGraph features;
  features.n_patches = 1;
  features.triangle_patch = {0, 0};
  features.corners = {2};
  for (const index_t v : {2u, 3u, 0u, 1u, 2u}) features.curves.values.push_back(v);
  features.curves.end_row();
  const std::vector<Vector3> points{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0.5, 0.5, 0}, {0.5, 0.5, 1e-3}};
  const std::vector<LabelledEdge> edges{{{0, 1}, 7}, {{1, 2}, 7}, {{2, 3}, 7}, {{3, 0}, 7}};
  const BoundarySlider slider({surface.points, make_adjacency(surface), features}, points, edges, 1e-6);
  const auto moves = [&](index_t v) {
    Vector3 place(0.3, 0.4, 0.2);
    return slider(v, place);
  };
  CHECK(moves(0));
  CHECK(moves(1));
  CHECK_FALSE(moves(2));
  CHECK(moves(3));
  CHECK(moves(4));
  CHECK_FALSE(moves(5));
  CHECK_FALSE(moves(6));
}

TEST_CASE("reconnection removes a flat tetrahedron and keeps the boundary", "[assembly]") {
  // Two tetrahedra pairs round a long, flat one: the square 0 1 2 3 almost in a plane, with apexes above and below.
  MixedMesh mesh;
  mesh.points = {{0, 0, 0}, {1, 0, 0.02}, {1, 1, 0}, {0, 1, 0.02}, {0.5, 0.5, 1}, {0.5, 0.5, -1}};
  const auto add = [&](std::array<index_t, 4> t) {
    const auto& p = mesh.points;
    if (orientation(p[t[0]], p[t[1]], p[t[2]], p[t[3]]) < 0) std::swap(t[0], t[1]);
    mesh.add(CellKind::tetrahedron, t);
  };
  add({0, 1, 2, 3});
  add({0, 2, 1, 5});
  add({0, 2, 3, 5});
  add({1, 3, 0, 4});
  add({1, 3, 2, 4});
  const double volume = verify::volume(mesh).cells;
  REQUIRE(verify::is_conforming(mesh));
  const auto result = optimize(mesh, {.reconnection = Reconnection::allowed});
  CHECK(result.before[0] < 0.05);
  CHECK(result.after[0] > 0.2);
  CHECK(mesh.n_cells() == 4);
  CHECK(verify::is_conforming(mesh));
  CHECK(verify::is_valid(mesh));
  CHECK(verify::volume(mesh).cells == Approx(volume));
}
