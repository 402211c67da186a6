// SPDX-License-Identifier: BSL-1.0
#include "framehex/field/compute_frame_field.hpp"
#include "support/mapped_lattices.hpp"

#include <catch2/catch.hpp>

#include <random>

using namespace framehex;
using Group = CubeRotationGroup<>;

namespace {

constexpr SerialExecutor serial{};

double worst_angle(const std::vector<Quaternion>& a, const std::vector<Quaternion>& b) {
  double worst = 0;
  for (std::size_t v = 0; v < a.size(); ++v) worst = std::max(worst, Group::angle(a[v], b[v]));
  return worst;
}

bool identical(const std::vector<Quaternion>& a, const std::vector<Quaternion>& b) {
  for (std::size_t v = 0; v < a.size(); ++v)
    if (a[v].coeffs() != b[v].coeffs()) return false;
  return a.size() == b.size();
}

bool all_unit(const std::vector<Quaternion>& frames) {
  return std::all_of(frames.begin(), frames.end(), [](const Quaternion& q) { return std::abs(q.norm() - 1) < 1e-9; });
}

/// An L-shaped bar: a concave domain with sharp edges.
IndexedTetMesh bracket(index_t n) {
  IndexedTetMesh mesh = test::kuhn_lattice(2 * n, 2 * n, n, 1.0 / n);
  std::erase_if(mesh.tets, [&](const auto& t) {
    Vector3 c = Vector3::Zero();
    for (const index_t v : t) c += mesh.points[v] / 4;
    return c.x() > 1 && c.y() > 1;
  });
  return mesh;
}

/// Deterministic frames without any order.
std::vector<Quaternion> random_frames(std::size_t n, std::uint64_t seed) {
  std::mt19937_64 engine(seed);
  const auto number = [&] { return static_cast<double>(engine() >> 11) * 0x1p-52 - 1; };
  std::vector<Quaternion> frames;
  while (frames.size() < n) {
    const Quaternion q(number(), number(), number(), number());
    if (q.norm() > 0.1 && q.norm() < 1) frames.push_back(q.normalized());
  }
  return frames;
}

/// The paper's smoothing, written from the paper: all 24 rotations tried, angles and axes by Eigen, one vertex at a
/// time in sorted order.
void reference_smoothing(const TetAdjacency& adjacency, std::vector<Quaternion>& frames,
                         const std::vector<FrameConstraint>& constraints, bool variable, int sweeps) {
  const std::size_t n = frames.size();
  const auto least = [&](const Quaternion& p, const Quaternion& r) {
    Eigen::AngleAxisd best(10, Vector3::UnitX());
    for (int g = 0; g < 24; ++g) {
      Eigen::AngleAxisd a(r * Group::element(g) * p.conjugate());
      if (a.angle() > std::numbers::pi) a = Eigen::AngleAxisd(2 * std::numbers::pi - a.angle(), -a.axis());
      if (a.angle() < best.angle()) best = a;
    }
    return best;
  };
  const auto smoothness = [&](std::size_t v) {
    double sum = 0;
    for (const index_t w : adjacency.vertices_of_vertex[v]) sum += least(frames[v], frames[w]).angle();
    return 1 - 4 / (std::numbers::pi * static_cast<double>(adjacency.vertices_of_vertex[v].size())) * sum;
  };
  std::vector<double> s(n), moved(n, 1);
  for (std::size_t v = 0; v < n; ++v) s[v] = smoothness(v);
  for (int sweep = 0; sweep < sweeps; ++sweep) {
    std::vector<std::size_t> order;
    for (std::size_t v = 0; v < n; ++v) {
      bool still = moved[v] == 0;
      for (const index_t w : adjacency.vertices_of_vertex[v]) still = still && moved[w] == 0;
      if (constraints[v] == FrameConstraint::none && !still) order.push_back(v);
    }
    std::stable_sort(order.begin(), order.end(), [&](auto v, auto w) { return moved[v] < moved[w]; });
    std::vector<double> now(n, 0);
    for (const std::size_t v : order) {
      const Quaternion before = frames[v];
      int iterations = 0;
      for (; iterations < 20; ++iterations) {
        Vector3 sum = Vector3::Zero();
        double total = 0;
        for (const index_t w : adjacency.vertices_of_vertex[v]) {
          const double c = variable && constraints[w] == FrameConstraint::none && s[w] < 0.85 ? 1e-3 : 1.0;
          const Eigen::AngleAxisd a = least(frames[v], frames[w]);
          sum += c * a.angle() * a.axis();
          total += c;
        }
        sum /= total;
        if (sum.norm() < 5e-3) break;
        frames[v] = Quaternion(Eigen::AngleAxisd(sum.norm(), sum.normalized())) * frames[v];
      }
      now[v] = iterations == 0 ? 0 : least(before, frames[v]).angle();
      s[v] = smoothness(v);
    }
    moved = now;
    if (*std::max_element(moved.begin(), moved.end()) < 3e-2) break;
  }
}

}  // namespace

TEST_CASE("a box has the frames of its faces everywhere, whatever the method") {
  const IndexedTetMesh mesh = test::kuhn_lattice(4, 3, 5, 0.25);
  for (const FieldMethod method : {FieldMethod::nearest, FieldMethod::smoothed, FieldMethod::best}) {
    const auto field = compute_frame_field(mesh, MeshFieldOptions{.field = {.method = method}});
    for (const Quaternion& q : field.frames()) CHECK(Group::angle(q, Quaternion::Identity()) < 1e-6);
    for (const double s : field.smoothness()) CHECK(s == Approx(1));
    CHECK(field.dirichlet_energy() < 1e-9);
    CHECK(field.singular_graph().facets.empty());
    CHECK(field.boundary_misalignment().largest < 1e-6);
    CHECK(field.boundary_misalignment().mean < 1e-6);
  }
}

TEST_CASE("the nearest start takes the frame of the nearest boundary point, found by brute force") {
  const IndexedTetMesh mesh = test::ball_mesh(6);
  const TetAdjacency adjacency = make_adjacency(mesh);
  const BoundarySurface boundary = extract_boundary(mesh, adjacency);
  const Surface surface(boundary.surface);
  const SurfaceCrossField crosses = compute_cross_field(surface);
  const BoundaryFrames frames = make_boundary_frames(surface, crosses.frames);
  const auto field = compute_frame_field(mesh, surface, crosses.frames,
                                         {.method = FieldMethod::nearest, .vertex_of = boundary.vertex_of});
  REQUIRE(all_unit(field.frames()));
  for (index_t v = 0; v < mesh.points.size(); ++v) {
    if (boundary.surface_vertex[v] != no_index) {
      CHECK(Group::angle(field.frames()[v], frames.frames[boundary.surface_vertex[v]]) < 1e-7);
      continue;
    }
    // Nearest points by dense sampling of the triangles; several triangles may be as near.
    double nearest = 1e9;
    for (const auto& t : boundary.surface.triangles)
      for (int i = 0; i <= 40; ++i)
        for (int j = 0; i + j <= 40; ++j) {
          const Vector3 q = (i * boundary.surface.points[t[0]] + j * boundary.surface.points[t[1]] +
                             (40 - i - j) * boundary.surface.points[t[2]]) /
                            40;
          nearest = std::min(nearest, (q - mesh.points[v]).norm());
        }
    double best = 10;
    for (const auto& t : boundary.surface.triangles) {
      double distance = 1e9;
      for (int i = 0; i <= 40; ++i)
        for (int j = 0; i + j <= 40; ++j) {
          const Vector3 q = (i * boundary.surface.points[t[0]] + j * boundary.surface.points[t[1]] +
                             (40 - i - j) * boundary.surface.points[t[2]]) /
                            40;
          distance = std::min(distance, (q - mesh.points[v]).norm());
        }
      if (distance < nearest + 1e-2)
        for (const index_t corner : t) best = std::min(best, Group::angle(field.frames()[v], frames.frames[corner]));
    }
    CHECK(best < 0.5);
  }
}

TEST_CASE("smoothness of a known twist") {
  // Frames turn about z by 0.1 rad per step in x: over a column of neighbours the mean angle is known.
  const IndexedTetMesh mesh = test::kuhn_lattice(4);
  FrameField<IndexedTetMesh> field(mesh);
  std::vector<Quaternion> frames;
  for (const Vector3& p : mesh.points) frames.emplace_back(Eigen::AngleAxisd(0.1 * p.x(), Vector3::UnitZ()));
  field.set_frames(frames);
  for (std::size_t v = 0; v < frames.size(); ++v) {
    double sum = 0;
    const auto ring = field.adjacency().vertices_of_vertex[v];
    for (const index_t w : ring) sum += 0.1 * std::abs(mesh.points[w].x() - mesh.points[v].x());
    CHECK(field.smoothness()[v] ==
          Approx(1 - 4 / (std::numbers::pi * static_cast<double>(ring.size())) * sum).epsilon(1e-12));
  }
  // The field is linear in x with slope 0.1 on a volume of 64; finite elements are exact but for the least weights.
  CHECK(field.dirichlet_energy() == Approx(0.5 * 0.01 * 64).epsilon(2e-3));
}

TEST_CASE("smoothing is the paper's, sweep by sweep") {
  const IndexedTetMesh mesh = test::ball_mesh(4);
  const TetAdjacency adjacency = make_adjacency(mesh);
  const BoundarySurface boundary = extract_boundary(mesh, adjacency);
  std::vector<FrameConstraint> constraints(mesh.points.size(), FrameConstraint::none);
  for (const index_t v : boundary.vertex_of) constraints[v] = FrameConstraint::fixed;
  const std::vector<Vector3> axes(mesh.points.size(), Vector3::Zero());
  for (const bool variable : {false, true})
    for (const int sweeps : {1, 2, 5}) {
      std::vector<Quaternion> expected = random_frames(mesh.points.size(), 7), frames = expected;
      std::vector<double> smoothness(frames.size());
      reference_smoothing(adjacency, expected, constraints, variable, sweeps);
      const auto report = smooth_frames(
          adjacency, frames, smoothness, constraints, axes,
          {.diffusivity = variable ? Diffusivity::variable : Diffusivity::constant, .max_sweeps = sweeps});
      CHECK(worst_angle(frames, expected) < 1e-9);
      CHECK(report.sweeps.size() <= static_cast<std::size_t>(sweeps));
      CHECK(all_unit(frames));
      CHECK(smoothness == frame_smoothness(adjacency, frames));
    }
}

TEST_CASE("smoothing converges, reports its sweeps and raises the smoothness") {
  const IndexedTetMesh mesh = test::ball_mesh(8);
  FieldReport report;
  const auto mean = [](const auto& field) {
    return std::accumulate(field.smoothness().begin(), field.smoothness().end(), 0.0) /
           static_cast<double>(field.n_vertices());
  };
  const auto nearest = compute_frame_field(mesh, MeshFieldOptions{.field = {.method = FieldMethod::nearest}});
  const auto constant = compute_frame_field(
      mesh,
      MeshFieldOptions{.field = {.method = FieldMethod::smoothed, .smoothing = {.diffusivity = Diffusivity::constant}}},
      serial, &report);
  CHECK(mean(constant) > mean(nearest));
  CHECK(constant.dirichlet_energy() < nearest.dirichlet_energy());
  REQUIRE(report.smoothing.converged);
  REQUIRE(report.smoothing.status == Status::complete);
  CHECK(report.smoothing.sweeps.front().skipped == 0);
  CHECK(report.smoothing.sweeps.back().largest_rotation < 3e-2);
  CHECK(report.smoothing.mean_local_iterations() >= 1);
  CHECK(report.smoothing.mean_local_iterations() < 4);
  const std::vector<Quaternion> once = constant.frames();
  auto again = constant;
  again.smooth({.diffusivity = Diffusivity::constant});
  CHECK(worst_angle(once, again.frames()) < 3e-2);
}

TEST_CASE("on the dome smoothness rises from nearest to constant to variable diffusivity") {
  // What the paper's figure 7 shows: the mean, and the share of smooth vertices.
  const IndexedTetMesh mesh = test::dome_mesh(12);
  double mean = -1, smooth = -1;
  for (const FieldOptions& options :
       {FieldOptions{.method = FieldMethod::nearest},
        FieldOptions{.method = FieldMethod::smoothed, .smoothing = {.diffusivity = Diffusivity::constant}},
        FieldOptions{.method = FieldMethod::smoothed}}) {
    const auto field = compute_frame_field(mesh, MeshFieldOptions{.field = options});
    const double n = static_cast<double>(field.n_vertices());
    const double now = std::accumulate(field.smoothness().begin(), field.smoothness().end(), 0.0) / n;
    const double share = static_cast<double>(std::count_if(field.smoothness().begin(), field.smoothness().end(),
                                                           [](double s) { return s >= 0.85; })) /
                         n;
    CHECK(now > mean);
    CHECK(share > smooth);
    mean = now;
    smooth = share;
  }
  CHECK(smooth > 0.8);
}

TEST_CASE("results do not depend on the number of threads") {
  for (const FieldMethod method : {FieldMethod::nearest, FieldMethod::smoothed, FieldMethod::best}) {
    const MeshFieldOptions options{.field = {.method = method}};
    const IndexedTetMesh mesh = bracket(4);
    const auto expected = compute_frame_field(mesh, options, serial);
    for (const std::size_t threads : {2U, 3U, 7U}) {
      const auto field = compute_frame_field(mesh, options, ThreadExecutor(threads));
      CHECK(identical(field.frames(), expected.frames()));
      CHECK(field.smoothness() == expected.smoothness());
    }
  }
}

TEST_CASE("the field turns with the input") {
  const IndexedTetMesh mesh = bracket(3);
  IndexedTetMesh moved = mesh;
  const Quaternion turn = Quaternion(0.7, 0.1, -0.5, 0.3).normalized();
  for (Vector3& p : moved.points) p = turn * p + Vector3(3, -2, 5);
  const MeshFieldOptions options{.field = {.method = FieldMethod::nearest}};
  const auto before = compute_frame_field(mesh, options), after = compute_frame_field(moved, options);
  for (std::size_t v = 0; v < mesh.points.size(); ++v) {
    CHECK(std::abs(before.smoothness()[v] - after.smoothness()[v]) < 1e-6);
    CHECK(Group::angle(turn * before.frames()[v], after.frames()[v]) < 1e-6);
  }
}

TEST_CASE("stages of a sweep keep neighbours apart and the order between them") {
  const TetAdjacency adjacency = make_adjacency(test::kuhn_lattice(4));
  std::vector<index_t> order(adjacency.n_vertices());
  std::iota(order.begin(), order.end(), 0);
  std::mt19937_64 engine(5);
  for (std::size_t i = order.size(); i > 1; --i) std::swap(order[i - 1], order[engine() % i]);
  detail::VisitSchedule schedule(adjacency.vertices_of_vertex, order, [](index_t) { return true; });
  Csr<index_t> stages;
  while (schedule.next_stage()) {
    stages.values.insert(stages.values.end(), schedule.stage().begin(), schedule.stage().end());
    stages.end_row();
  }
  std::vector<std::size_t> stage(order.size()), place(order.size());
  for (std::size_t s = 0; s < stages.size(); ++s)
    for (const index_t v : stages[s]) stage[v] = s;
  for (std::size_t i = 0; i < order.size(); ++i) place[order[i]] = i;
  CHECK(stages.values.size() == order.size());
  for (index_t v = 0; v < order.size(); ++v)
    for (const index_t w : adjacency.vertices_of_vertex[v]) {
      REQUIRE(stage[v] != stage[w]);
      REQUIRE((stage[v] < stage[w]) == (place[v] < place[w]));
    }
}

TEST_CASE("a cancelled stage leaves a valid field and says so") {
  const IndexedTetMesh mesh = bracket(4);
  for (const FieldMethod method : {FieldMethod::smoothed, FieldMethod::best})
    for (const int calls : {0, 1, 5}) {
      int left = calls;
      double last = 0;
      FieldReport report;
      const auto field = compute_frame_field(mesh,
                                             MeshFieldOptions{.field = {.method = method,
                                                                        .observer =
                                                                            [&](const Progress& p) {
                                                                              CHECK(p.fraction >= 0);
                                                                              CHECK(p.fraction <= 1);
                                                                              last = p.fraction;
                                                                              return left-- > 0;
                                                                            }}},
                                             serial, &report);
      CHECK(report.status == Status::cancelled);
      CHECK(all_unit(field.frames()));
    }
}

TEST_CASE("a field can be cancelled at any call, and is not asked again") {
  const IndexedTetMesh mesh = bracket(4);
  for (const FieldMethod method : {FieldMethod::nearest, FieldMethod::smoothed, FieldMethod::best}) {
    FieldReport report;
    report.status = Status::cancelled;
    for (int stop = 1; report.status == Status::cancelled; ++stop) {
      REQUIRE(stop < 10'000);
      int calls = 0;
      const Observer observer = [&](const Progress&) { return ++calls != stop; };
      const auto field = compute_frame_field(mesh, MeshFieldOptions{.field = {.method = method, .observer = observer}},
                                             serial, &report);
      CHECK(calls == (report.status == Status::cancelled ? stop : stop - 1));
      CHECK(all_unit(field.frames()));
    }
  }
}
