// SPDX-License-Identifier: BSL-1.0
#include "framehex/field/compute_frame_field.hpp"
#include "framehex/field/vertex_size_field.hpp"
#include "support/mapped_lattices.hpp"

#include <catch2/catch.hpp>

#include <random>

using namespace framehex;
using Group = CubeRotationGroup<>;

namespace {

void rotate(IndexedTetMesh& mesh) {
  const Quaternion turn = Quaternion(0.3, 0.7, -0.2, 0.5).normalized();
  for (Vector3& p : mesh.points) p = turn * p;
}

/// The topology of interest: how many lines of which kind join which boundary triangles.
struct Lines {
  std::size_t boundary_to_boundary = 0, others = 0;
};

Lines count(const SingularGraph& graph) {
  Lines lines;
  for (std::size_t c = 0; c < graph.curves.size(); ++c) {
    const auto curve = graph.curves[c];
    const bool ends = graph.facets[curve.front()].tets[1] == no_index && graph.facets[curve.back()].tets[1] == no_index;
    (ends && graph.curve_index[c] == 0.25 ? lines.boundary_to_boundary : lines.others)++;
  }
  return lines;
}

void check_best_is_smoother(const IndexedTetMesh& mesh) {
  const auto best = compute_frame_field(mesh);
  const auto smoothed = compute_frame_field(mesh, MeshFieldOptions{.field = {.method = FieldMethod::smoothed}});
  CHECK(best.dirichlet_energy() <= smoothed.dirichlet_energy());
  CHECK(best.singular_graph().facets.size() <= smoothed.singular_graph().facets.size());
  CHECK(best.boundary_misalignment().largest < 1e-6);
  for (const Quaternion& q : best.frames()) REQUIRE(std::abs(q.norm() - 1) < 1e-9);
}

}  // namespace

TEST_CASE("a cylinder has four singular lines of a quarter from lid to lid, and no others") {
  IndexedTetMesh mesh = test::cylinder_mesh(10, 20, 0.5, 2);
  for (int pass = 0; pass < 2; ++pass) {
    const auto field = compute_frame_field(mesh);
    const SingularGraph graph = field.singular_graph();
    const Lines lines = count(graph);
    CHECK(lines.boundary_to_boundary == 4);
    CHECK(lines.others == 0);
    CHECK(graph.boundary_facets.size() == 8);
    check_best_is_smoother(mesh);
    rotate(mesh);
  }
}

TEST_CASE("a ball has eight singular points of a quarter on its boundary") {
  IndexedTetMesh mesh = test::ball_mesh(10);
  rotate(mesh);
  const auto field = compute_frame_field(mesh);
  const SingularGraph graph = field.singular_graph();
  CHECK(graph.boundary_facets.size() == 8);
  double sum = 0;
  for (const index_t f : graph.boundary_facets) {
    CHECK(graph.facets[f].index == Approx(0.25));
    sum += graph.facets[f].index;
  }
  CHECK(sum == Approx(2));  // the Euler characteristic of the sphere
  check_best_is_smoother(mesh);
}

TEST_CASE("a cube has no singular line, also with the lattice at a slant") {
  IndexedTetMesh mesh = test::kuhn_lattice(6);
  rotate(mesh);
  const auto field = compute_frame_field(mesh);
  CHECK(field.singular_graph().facets.empty());
  const Quaternion axes = field.frames().front();
  for (const Quaternion& q : field.frames()) CHECK(Group::angle(q, axes) < 0.01);
}

TEST_CASE("kept crosses stay, and free ones can be read back") {
  const IndexedTetMesh mesh = test::cylinder_mesh(8, 10, 0.5, 1);
  const BoundarySurface boundary = extract_boundary(mesh, make_adjacency(mesh));
  const Surface surface(boundary.surface);
  const SurfaceCrossField crosses = compute_cross_field(surface);
  const BoundaryFrames frames = make_boundary_frames(surface, crosses.frames);
  const auto kept = compute_frame_field(mesh, surface, crosses.frames,
                                        {.vertex_of = boundary.vertex_of, .surface_cross = SurfaceCross::kept});
  for (std::size_t s = 0; s < boundary.vertex_of.size(); ++s)
    CHECK(Group::angle(kept.frames()[boundary.vertex_of[s]], frames.frames[s]) < 1e-9);
  const auto field = compute_frame_field(mesh);
  const auto read = surface_crosses(field, surface, boundary.vertex_of);
  for (std::size_t t = 0; t < read.size(); ++t) {
    const Vector3 z = crosses.frames[t] * Vector3::UnitZ();
    CHECK((read[t] * Vector3::UnitZ() - z).norm() < 1e-9);
    CHECK(read[t].norm() == Approx(1));
  }
}

TEST_CASE("a singular line of known place and index is found") {
  // Frames turn about z by a quarter of the angle round the axis: index 1/4 (or -1/4) along it.
  IndexedTetMesh mesh = test::kuhn_lattice(7, 7, 3);
  const TetAdjacency adjacency = make_adjacency(mesh);
  for (const double sign : {1.0, -1.0}) {
    std::vector<Quaternion> frames;
    for (const Vector3& p : mesh.points)
      frames.emplace_back(Eigen::AngleAxisd(sign * std::atan2(p.y() - 3.4, p.x() - 3.3) / 4, Vector3::UnitZ()));
    const SingularGraph graph = singular_graph(adjacency, mesh.points, frames);
    REQUIRE(graph.curves.size() == 1);
    CHECK(graph.curve_index[0] == sign * 0.25);
    CHECK(graph.boundary_facets.size() == 2);
    for (const Vector3& p : graph.polylines.values) {
      CHECK(std::abs(p.x() - 3.3) < 1);
      CHECK(std::abs(p.y() - 3.4) < 1);
    }
  }
}

TEST_CASE("a line that closes round one edge is removed, and nothing else is touched") {
  const IndexedTetMesh mesh = test::kuhn_lattice(6);
  const TetAdjacency adjacency = make_adjacency(mesh);
  // Neighbours in the middle, each turned by a little more than a quarter of a right angle from all others: one
  // another's nearest forms are a quarter turn from those that lead over any third vertex.
  const index_t v = 3 + 7 * (3 + 7 * 3), w = v + 1;
  const auto z = [](double degrees) {
    return Quaternion(Eigen::AngleAxisd(degrees * std::numbers::pi / 180, Vector3::UnitZ()));
  };
  const std::vector<Vector3> axes(mesh.points.size(), Vector3::UnitZ());
  for (const FrameConstraint constraint : {FrameConstraint::none, FrameConstraint::axis, FrameConstraint::fixed}) {
    std::vector<Quaternion> frames(mesh.points.size(), Quaternion::Identity());
    std::vector<FrameConstraint> constraints(frames.size(), FrameConstraint::none);
    frames[v] = z(23);
    frames[w] = z(-23);
    constraints[w] = constraint;
    const std::vector<Quaternion> before = frames;
    REQUIRE_FALSE(singular_graph(adjacency, mesh.points, frames).facets.empty());
    CHECK(remove_small_loops(adjacency, frames, constraints, axes) == 1);
    CHECK(singular_graph(adjacency, mesh.points, frames).facets.empty());
    for (index_t u = 0; u < frames.size(); ++u) {
      const bool may_turn = u == v || (u == w && constraint != FrameConstraint::fixed);
      CHECK((Group::angle(frames[u], before[u]) > 1e-6) == may_turn);
    }
    CHECK(remove_small_loops(adjacency, frames, constraints, axes) == 0);
  }
}

TEST_CASE("singular facets of any field form lines without loose ends inside") {
  const IndexedTetMesh mesh = test::kuhn_lattice(4);
  const TetAdjacency adjacency = make_adjacency(mesh);
  std::mt19937_64 engine(3);
  std::vector<Quaternion> frames;
  for (std::size_t v = 0; v < mesh.points.size(); ++v) {
    const auto number = [&] { return static_cast<double>(engine() >> 11) * 0x1p-52 - 1; };
    frames.push_back(Quaternion(number(), number(), number(), number() + 2).normalized());
  }
  const SingularGraph graph = singular_graph(adjacency, mesh.points, frames);
  std::vector<int> facets_of(mesh.tets.size(), 0), used(graph.facets.size(), 0);
  for (const SingularFacet& f : graph.facets)
    for (const index_t tet : f.tets)
      if (tet != no_index) ++facets_of[tet];
  for (const int n : facets_of) CHECK(n != 1);
  for (std::size_t c = 0; c < graph.curves.size(); ++c) {
    const auto curve = graph.curves[c];
    const bool closed = curve.size() > 1 && curve.front() == curve.back();
    for (std::size_t i = 0; i + (closed ? 1 : 0) < curve.size(); ++i) ++used[curve[i]];
  }
  for (const int n : used) CHECK(n == 1);
}

TEST_CASE("the nearest frame of a quartic is the frame it came from, and stationary for any other") {
  std::mt19937_64 engine(9);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 2000; ++i) {
    const Quaternion frame = Quaternion(normal(engine), normal(engine), normal(engine), normal(engine)).normalized();
    const Quartic exact = frame_quartic(frame);
    REQUIRE(exact.norm() == Approx(1));
    REQUIRE(Group::angle(nearest_frame(exact), frame) < 1e-6);
    for (int g = 0; g < 24; ++g) REQUIRE((frame_quartic(frame * Group::element(g)) - exact).norm() < 1e-12);
    Quartic noisy = exact;
    for (int k = 0; k < 9; ++k) noisy[k] += 0.3 * normal(engine);
    const Quaternion found = nearest_frame(noisy);
    const double value = noisy.dot(frame_quartic(found));
    for (int k = 0; k < 6; ++k) {
      const Vector3 step = (k < 3 ? 1e-3 : -1e-3) * Vector3::Unit(k % 3);
      REQUIRE(noisy.dot(frame_quartic(Group::exponential(step) * found)) <= value + 1e-12);
    }
    const Vector3 axis = frame * Vector3::UnitX();
    const Quaternion on_axis = AxisQuartics(frame, axis).nearest(noisy, axis);
    REQUIRE(detail::rotation_onto(on_axis, axis).norm() < 1e-12);
    for (int k = 0; k < 90; ++k) {
      const Quaternion other = Quaternion(Eigen::AngleAxisd(k * std::numbers::pi / 180, axis)) * frame;
      REQUIRE(noisy.dot(frame_quartic(other)) <= noisy.dot(frame_quartic(on_axis)) + 1e-12);
    }
  }
  CHECK(nearest_frame(Quartic(Quartic::Zero())).norm() == Approx(1));
}

TEST_CASE("points are located and frames evaluated, from any hint") {
  const IndexedTetMesh mesh = test::ball_mesh(6);
  const auto field = compute_frame_field(mesh);
  std::mt19937_64 engine(11);
  index_t hint = no_index;
  for (int i = 0; i < 3000; ++i) {
    const auto number = [&] { return 1.2 * (static_cast<double>(engine() >> 11) * 0x1p-52 - 1); };
    const Vector3 p(number(), number(), number());
    if (i % 7 == 0) hint = static_cast<index_t>(engine() % (mesh.tets.size() + 10));
    const FrameSample sample = field.sample(p, hint);
    REQUIRE(sample.tet < mesh.tets.size());
    REQUIRE(hint == sample.tet);
    REQUIRE(sample.frame.norm() == Approx(1));
    bool inside = false;
    for (index_t tet = 0; tet < mesh.tets.size(); ++tet) {
      const auto b = field.locator()->barycentric(tet, p);
      inside = inside || *std::min_element(b.begin(), b.end()) >= 1e-9;
    }
    const TetLocation at = field.locator()->locate(p, no_index);
    if (inside) {
      REQUIRE(at.inside);
      REQUIRE((field.locator()->position(at) - p).norm() < 1e-9);
    } else if (p.norm() > 1) {
      REQUIRE_FALSE(at.inside);
    }
  }
  for (index_t v = 0; v < mesh.points.size(); ++v) {
    const FrameSample sample = field.sample(mesh.points[v], hint);
    REQUIRE(Group::angle(sample.frame, field.frames()[v]) < 1e-6);
    REQUIRE(sample.smoothness == Approx(field.smoothness()[v]).margin(1e-7));
  }
  index_t lost = 0;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  CHECK(field.sample(Vector3(1e30, -1e30, 0), lost).frame.norm() == Approx(1));
  CHECK(field.sample(Vector3(nan, nan, nan), lost).frame.norm() == Approx(1));
}

TEST_CASE("a point across a gap is found although the walk cannot cross it") {
  IndexedTetMesh mesh = test::kuhn_lattice(8, 8, 1);
  std::erase_if(mesh.tets, [&](const auto& t) {
    Vector3 c = Vector3::Zero();
    for (const index_t v : t) c += mesh.points[v] / 4;
    return c.x() > 3 && c.x() < 5 && c.y() > 1;
  });
  const FrameField<IndexedTetMesh> field(mesh);
  for (index_t tet = 0; tet < mesh.tets.size(); tet += 7) {
    index_t hint = tet;
    const Vector3 p(6.3, 7.2, 0.4);
    const FrameSample sample = field.sample(p, hint);
    const auto b = field.locator()->barycentric(sample.tet, p);
    CHECK(*std::min_element(b.begin(), b.end()) > -1e-9);
  }
}

TEST_CASE("sizes are extended harmonically and limited") {
  const IndexedTetMesh mesh = test::kuhn_lattice(6, 2, 2);
  const auto locator = std::make_shared<const TetLocator>(make_adjacency(mesh), mesh.points);
  std::vector<double> sizes(mesh.points.size(), std::numeric_limits<double>::quiet_NaN());
  for (std::size_t v = 0; v < sizes.size(); ++v) {
    if (mesh.points[v].x() == 0) sizes[v] = 1;
    if (mesh.points[v].x() == 6) sizes[v] = 4;
  }
  const VertexSizeField linear = make_size_field(locator, sizes, 10);
  const VertexSizeField limited = make_size_field(locator, sizes, 0.25);
  for (const double x : {0.0, 1.3, 2.9, 5.5}) {
    CHECK(linear(Vector3(x, 0.7, 1.1)) == Approx(1 + x / 2).epsilon(1e-3));
    CHECK(limited(Vector3(x, 0.7, 1.1)) == Approx(1 + x / 4).epsilon(0.05));
  }
  const auto& ring = locator->adjacency().vertices_of_vertex;
  for (index_t v = 0; v < sizes.size(); ++v)
    for (const index_t w : ring[v])
      CHECK(limited.sizes()[w] <= limited.sizes()[v] + 0.25 * (mesh.points[v] - mesh.points[w]).norm() + 1e-12);
  sizes[3] = -1;
  try {
    make_size_field(locator, sizes, 0.2);
    FAIL("a negative size was accepted");
  } catch (const invalid_field& e) {
    CHECK(e.indices() == std::vector<std::size_t>{3});
  }
  CHECK_THROWS_AS(make_size_field(locator, std::vector<double>(sizes.size(), 1.0), -1), invalid_option);
  CHECK_THROWS_AS(make_size_field(locator, std::vector<double>(sizes.size(), std::nan("")), 1), invalid_field);
}

TEST_CASE("every edge that is mended leaves fewer singular facets, so that mending ends", "[regression]") {
  const IndexedTetMesh mesh = test::kuhn_lattice(3);
  const TetAdjacency adjacency = make_adjacency(mesh);
  const std::vector<FrameConstraint> constraints(mesh.points.size(), FrameConstraint::none);
  const std::vector<Vector3> axes(mesh.points.size(), Vector3::Zero());
  std::size_t n_mended = 0;
  for (const unsigned seed : {1u, 2u, 3u, 4u, 5u, 6u, 7u, 8u}) {
    std::mt19937_64 random(seed);
    const auto uniform = [&] { return 2 * static_cast<double>(random() >> 11) * 0x1p-53 - 1; };
    std::vector<Quaternion> frames;
    for (std::size_t v = 0; v < mesh.points.size(); ++v)
      frames.push_back(Quaternion(uniform(), uniform(), uniform(), uniform()).normalized());
    const auto n_singular = [&] { return singular_graph(adjacency, mesh.points, frames).facets.size(); };
    detail::LoopRemover remover(adjacency, frames, constraints, axes);
    for (const auto& edge : remover.candidates()) {
      const std::size_t before = n_singular();
      if (!remover.remove_at(edge)) continue;
      ++n_mended;
      CHECK(n_singular() < before);
    }
  }
  CHECK(n_mended > 50);
}
