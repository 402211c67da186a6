// SPDX-License-Identifier: BSL-1.0
#include "framehex/field/compute_frame_field.hpp"
#include "support/kuhn_lattice.hpp"

#include <catch2/catch.hpp>

using namespace framehex;

namespace {

constexpr std::array<FieldMethod, 3> methods{FieldMethod::nearest, FieldMethod::smoothed, FieldMethod::best};

/// Every method gives unit frames on the mesh.
void check_all_methods(const IndexedTetMesh& mesh) {
  for (const FieldMethod method : methods) {
    const auto field = compute_frame_field(mesh, MeshFieldOptions{.field = {.method = method}});
    REQUIRE(field.frames().size() == mesh.points.size());
    for (const Quaternion& q : field.frames()) CHECK(std::abs(q.norm() - 1) < 1e-9);
    for (const double s : field.smoothness()) CHECK((s > -0.41 && s < 1 + 1e-12));
  }
}

/// A prism over the triangle (0,0) (1,0) (cos a, sin a): three tetrahedra.
IndexedTetMesh wedge(double angle) {
  IndexedTetMesh mesh;
  for (const double z : {0.0, 1.0})
    for (const Vector3& p : {Vector3(0, 0, 0), Vector3(1, 0, 0), Vector3(std::cos(angle), std::sin(angle), 0)})
      mesh.points.push_back(p + z * Vector3::UnitZ());
  mesh.tets = {{0, 1, 2, 5}, {0, 1, 5, 4}, {0, 4, 5, 3}};
  return mesh;
}

Surface without_features(const IndexedTriangleMesh& mesh) {
  return {mesh.points, make_adjacency(mesh), {}};
}

std::vector<Quaternion> upright(const IndexedTriangleMesh& surface) {
  std::vector<Quaternion> frames;
  for (const auto& t : surface.triangles)
    frames.push_back(Quaternion::FromTwoVectors(
        Vector3::UnitZ(),
        (surface.points[t[1]] - surface.points[t[0]]).cross(surface.points[t[2]] - surface.points[t[0]])));
  return frames;
}

}  // namespace

TEST_CASE("isolated vertices, several components, and a component without interior vertices") {
  IndexedTetMesh mesh = test::kuhn_lattice(3);
  mesh.points.emplace_back(50, 0, 0);  // isolated
  const auto first = static_cast<index_t>(mesh.points.size());
  const IndexedTetMesh other = wedge(1.2);
  for (const Vector3& p : other.points) mesh.points.push_back(p + Vector3(10, 0, 0));
  for (const auto& t : other.tets) mesh.tets.push_back({t[0] + first, t[1] + first, t[2] + first, t[3] + first});
  check_all_methods(mesh);
}

TEST_CASE("a single tetrahedron, and no mesh at all") {
  IndexedTetMesh mesh;
  mesh.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  mesh.tets = {{0, 1, 2, 3}};
  check_all_methods(mesh);
  const FrameField<IndexedTetMesh> nothing(IndexedTetMesh{});
  index_t hint = 0;
  CHECK(nothing.sample(Vector3::Zero(), hint).tet == no_index);
  CHECK(nothing.singular_graph().facets.empty());
}

TEST_CASE("features that meet at any angle, down to ten degrees and below") {
  for (const double degrees : {170.0, 120.0, 60.0, 45.0, 30.0, 10.0, 2.0})
    check_all_methods(wedge(degrees * std::numbers::pi / 180));
}

TEST_CASE("tetrahedra that touch in a vertex or along an edge") {
  IndexedTetMesh mesh;
  mesh.points = {{9, 9, 9}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {-1, 0, 0}, {0, -1, 0}, {0, 0, -1}};
  mesh.tets = {{1, 2, 3, 4}, {1, 6, 5, 7}};
  REQUIRE_NOTHROW(validate(mesh));
  check_all_methods(mesh);

  mesh.points = {{9, 9, 9}, {0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {0.5, 1, 0}, {-1, 0, 0}, {-0.5, -1, 0}};
  mesh.tets = {{1, 3, 4, 2}, {1, 5, 6, 2}};
  REQUIRE_NOTHROW(validate(mesh));
  check_all_methods(mesh);
}

TEST_CASE("the field follows what lies between regions as it follows the boundary") {
  // A cube whose upper half is another material, the interface between them tilted by 0.3.
  const IndexedTetMesh straight = test::kuhn_lattice(6);
  IndexedTetMesh mesh = straight;
  for (Vector3& p : mesh.points) p.z() += 0.3 * (p.x() - 3) * std::min(p.z(), 6 - p.z()) / 3;
  std::vector<index_t> regions;
  for (const auto& t : mesh.tets)
    regions.push_back(std::ranges::any_of(t, [&](index_t v) { return straight.points[v].z() > 3.5; }));
  const TetAdjacency adjacency = make_adjacency(mesh);
  const BoundarySurface outer = extract_boundary(mesh, adjacency), all = extract_boundary(mesh, adjacency, regions);
  CHECK(all.surface.triangles.size() == outer.surface.triangles.size() + 72);
  const auto misalignment = [&](const FrameField<IndexedTetMesh>& field) {
    const Vector3 normal = Vector3(-0.3, 0, 1).normalized();
    double worst = 0;
    for (std::size_t v = 0; v < mesh.points.size(); ++v) {
      if (all.surface_vertex[v] == no_index || outer.surface_vertex[v] != no_index) continue;
      const Vector3 local = field.frames()[v].conjugate() * normal;
      worst = std::max(worst, std::acos(std::min(1.0, local.cwiseAbs().maxCoeff())));
    }
    return worst;
  };
  CHECK(misalignment(compute_frame_field(mesh, MeshFieldOptions{.regions = regions})) < 1e-6);
  CHECK(misalignment(compute_frame_field(mesh)) > 0.1);
  regions.pop_back();
  CHECK_THROWS_AS(compute_frame_field(mesh, MeshFieldOptions{.regions = regions}), invalid_option);
}

TEST_CASE("a vertex whose normals cancel still has a frame along each of them") {
  // Two cones tip to tip: the mean normal at the tip is zero.
  IndexedTriangleMesh surface;
  surface.points = {{0, 0, 0}};
  for (const double z : {1.0, -1.0})
    for (int i = 0; i < 4; ++i) {
      const double a = std::numbers::pi / 2 * i;
      surface.points.emplace_back(std::cos(a), std::sin(a), z);
    }
  for (index_t i = 0; i < 4; ++i) {
    surface.triangles.push_back({0, 1 + i, 1 + (i + 1) % 4});
    surface.triangles.push_back({0, 5 + (i + 1) % 4, 5 + i});
  }
  const auto frames = make_boundary_frames(without_features(surface), upright(surface));
  for (const Quaternion& q : frames.frames) CHECK(std::abs(q.norm() - 1) < 1e-9);
  CHECK(frames.constraints[0] == FrameConstraint::fixed);
}

TEST_CASE("a vertex without any usable normal, and a frame that is none, are named") {
  IndexedTriangleMesh surface;
  surface.points = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}};
  surface.triangles = {{0, 1, 2}, {0, 2, 3}};
  std::vector<Quaternion> frames(2, Quaternion::Identity());
  try {
    make_boundary_frames(without_features(surface), frames);
    FAIL("triangles without area were accepted");
  } catch (const invalid_field& e) {
    CHECK(e.entity() == Entity::vertex);
    CHECK(e.indices() == std::vector<std::size_t>{0});
  }
  surface.points[2] = {1, 1, 0};
  surface.points[3] = {0, 1, 0};
  for (const Quaternion& bad : {Quaternion(0, 0, 0, 0), Quaternion(std::nan(""), 0, 0, 1), Quaternion(2, 0, 0, 0)}) {
    frames[1] = bad;
    try {
      make_boundary_frames(without_features(surface), frames);
      FAIL("a frame that is no rotation was accepted");
    } catch (const invalid_field& e) {
      CHECK(e.entity() == Entity::triangle);
      CHECK(e.indices() == std::vector<std::size_t>{1});
    }
  }
  frames.resize(1);
  CHECK_THROWS_AS(make_boundary_frames(without_features(surface), frames), invalid_option);
}

TEST_CASE("boundary frames of a box: normals on faces, all axes on edges and corners") {
  const IndexedTetMesh mesh = test::kuhn_lattice(3);
  const BoundarySurface boundary = extract_boundary(mesh, make_adjacency(mesh));
  const auto frames = make_boundary_frames(boundary.surface, upright(boundary.surface));
  for (std::size_t v = 0; v < frames.frames.size(); ++v) {
    const Vector3& p = boundary.surface.points[v];
    const auto sides = ((p.array() == 0) || (p.array() == 3)).count();
    CHECK(CubeRotationGroup<>::angle(frames.frames[v], Quaternion::Identity()) < 1e-6);
    CHECK(frames.constraints[v] == (sides == 1 ? FrameConstraint::axis : FrameConstraint::fixed));
    if (sides == 1)
      CHECK((p - Vector3::Constant(1.5)).cwiseAbs().maxCoeff() ==
            Approx((p - Vector3::Constant(1.5)).dot(frames.axes[v])));
  }
}

TEST_CASE("normals at an angle are met half way") {
  for (const double degrees : {90.0, 75.0, 60.0, 50.0}) {
    const double angle = degrees * std::numbers::pi / 180, half = std::numbers::pi / 4 - angle / 2;
    const detail::WeightedDirection directions[]{
        {-Vector3::UnitY(), 1}, {Vector3(-std::sin(angle), std::cos(angle), 0), 1}, {Vector3::UnitZ(), 1}};
    const auto fit = detail::fit_frame(Quaternion(Eigen::AngleAxisd(0.05, Vector3(1, 2, 3).normalized())), directions);
    CHECK(detail::rotation_onto(fit.frame, directions[0].direction).norm() == Approx(half).margin(1e-6));
    CHECK(detail::rotation_onto(fit.frame, directions[1].direction).norm() == Approx(half).margin(1e-6));
    CHECK(detail::rotation_onto(fit.frame, directions[2].direction).norm() < 1e-6);
  }
}

TEST_CASE("options and maps out of range are refused") {
  const IndexedTetMesh mesh = test::kuhn_lattice(2);
  const BoundarySurface boundary = extract_boundary(mesh, make_adjacency(mesh));
  const auto crosses = upright(boundary.surface);
  CHECK_THROWS_AS(compute_frame_field(mesh, boundary.surface, crosses, {.vertex_of = {0, 1, 2}}), invalid_option);
  std::vector<index_t> beyond(boundary.vertex_of);
  beyond[4] = 1000;
  CHECK_THROWS_AS(compute_frame_field(mesh, boundary.surface, crosses, {.vertex_of = beyond}), invalid_option);
  FrameField<IndexedTetMesh> field(mesh);
  CHECK_THROWS_AS(field.smooth({.local_tolerance = 0}), invalid_option);
  CHECK_THROWS_AS(field.smooth({.max_sweeps = 0}), invalid_option);
  CHECK_THROWS_AS(field.smooth({.max_local_iterations = 300}), invalid_option);
  CHECK_THROWS_AS(field.smooth({.rough_weight = std::nan("")}), invalid_option);
  CHECK_THROWS_AS(field.diffuse({.time_factor = 0}), invalid_option);
  CHECK_THROWS_AS(field.set_frames({}), invalid_option);
  CHECK_THROWS_AS(field.set_frames(std::vector<Quaternion>(27, Quaternion(0, 0, 0, 0))), invalid_field);

  IndexedTetMesh bad = mesh;
  std::swap(bad.tets[5][0], bad.tets[5][1]);
  CHECK_THROWS_AS(compute_frame_field(bad), inverted_cell);
}

TEST_CASE("parts that touch in an edge or a vertex, and cracks, have fields", "[regression]") {
  for (const Vector3& shift : {Vector3(2, 2, 2), Vector3(2, 2, 0)}) {
    IndexedTetMesh mesh = test::kuhn_lattice(2);
    const IndexedTetMesh other = mesh;
    std::vector<index_t> number;
    for (const Vector3& p : other.points) {
      const auto same = std::find(other.points.begin(), other.points.end(), Vector3(p + shift));
      number.push_back(same != other.points.end() ? static_cast<index_t>(same - other.points.begin())
                                                  : static_cast<index_t>(mesh.points.size()));
      if (same == other.points.end()) mesh.points.push_back(p + shift);
    }
    for (const auto& t : other.tets) mesh.tets.push_back({number[t[0]], number[t[1]], number[t[2]], number[t[3]]});
    check_all_methods(mesh);
    const auto field = compute_frame_field(mesh);
    for (const Quaternion& q : field.frames()) CHECK(CubeRotationGroup<>::angle(q, Quaternion::Identity()) < 1e-3);
  }
  IndexedTetMesh mesh = test::kuhn_lattice(3);
  const auto copy = static_cast<index_t>(mesh.points.size());
  mesh.points.push_back(Vector3(mesh.points[21]));
  int n = 0;
  for (auto& t : mesh.tets)
    for (index_t& v : t)
      if (v == 21 && n++ < 6) v = copy;
  check_all_methods(mesh);
}

TEST_CASE("given feature edges of a mesh are in its own numbers", "[regression]") {
  IndexedTetMesh mesh = test::kuhn_lattice(2);
  mesh.points.insert(mesh.points.begin(), Vector3(9, 9, 9));  // isolated: the boundary counts from its second vertex
  for (auto& t : mesh.tets)
    for (index_t& v : t) ++v;
  MeshFieldOptions options;
  options.features.given_edges = {{5, 2}};  // (1,1,0) to (1,0,0)
  CHECK_NOTHROW(compute_frame_field(mesh, options));
  for (const std::array<index_t, 2>& edge : {std::array<index_t, 2>{14, 5}, std::array<index_t, 2>{0, 1}}) {
    options.features.given_edges = {edge};
    try {
      compute_frame_field(mesh, options);
      FAIL("accepted");
    } catch (const invalid_option& e) {
      CHECK(e.entity() == Entity::edge);
      CHECK(e.indices() == std::vector<std::size_t>{edge[0], edge[1]});
    }
  }
}

TEST_CASE("errors of the boundary come back in the numbers of the mesh", "[regression]") {
  BoundarySurface boundary;
  boundary.vertex_of = {4, 7, 9};
  boundary.tet_of = {3, 8};
  const auto vertex = detail::in_mesh_numbers(invalid_field("vertex 1", Entity::vertex, {1}), boundary);
  CHECK(vertex.entity() == Entity::vertex);
  CHECK(vertex.indices() == std::vector<std::size_t>{7});
  const auto cell = detail::in_mesh_numbers(invalid_field("triangle 1", Entity::triangle, {1}), boundary);
  CHECK(cell.entity() == Entity::cell);
  CHECK(cell.indices() == std::vector<std::size_t>{8});
}
