// SPDX-License-Identifier: BSL-1.0
#include "framehex/lattice/periodic_parameterization.hpp"
#include "lattice/body.hpp"

#include <catch2/catch.hpp>

#include <random>

using namespace framehex;

namespace {

/// All that `solve_seamless_phases` asks for, and what it gives.
struct SeamlessMap {
  std::vector<double> sizes;
  LatticeGraph graph;
  BoundaryAxes boundary;
  std::vector<Vector3> scale, steps;
  std::vector<AxisMask> tangent;
  std::optional<SingularLines> lines;
  std::vector<Vector3> phases, differences;
  SeamlessReport report;

  template <class E = SerialExecutor>
  SeamlessMap(const test::Body& body, double size, const SeamlessOptions& options = {}, const E& executor = {})
      : sizes(body.frames.size(), size),
        graph(body.adjacency, body.mesh.points, body.frames),
        boundary(find_boundary_axes(graph, body.surface, body.boundary.vertex_of)) {
    REQUIRE(scale_axes(graph, sizes, scale));
    steps = lattice_steps(graph, scale, ConstantSize{size});
    tangent = tangent_edges(graph, body.surface, boundary, body.boundary.vertex_of);
    project_steps(graph, steps, tangent);
    lines.emplace(graph, scale, sizes);
    report =
        solve_seamless_phases(graph, steps, *lines, boundary, tangent, sizes, phases, differences, options, executor);
  }
};

test::Body cylinder() {
  test::Body body(test::filled(test::ringed_cylinder_surface(0.5, 1, 5), 2e-4));
  body.frames = compute_frame_field(body.mesh).frames();
  return body;
}

test::Body ball() {
  test::Body body(test::filled(test::sphere_surface(1, 3), 2e-3));
  body.frames = compute_frame_field(body.mesh).frames();
  return body;
}

double value(const Eigen::MatrixXd& a, const Eigen::VectorXd& b, const Eigen::VectorXd& x) {
  return x.dot(a * x) - 2 * b.dot(x);
}

}  // namespace

TEST_CASE("relations of whole numbers leave as many free as their rank says, and hold whatever these are") {
  std::mt19937 random(1);
  std::uniform_int_distribution<int> coefficient(-1, 1);
  for (int trial = 0; trial < 200; ++trial) {
    constexpr index_t n = 8;
    constexpr Eigen::Index n_relations = 5;
    detail::WholeUnknowns unknowns;
    for (index_t i = 0; i < n; ++i) unknowns.add();
    Eigen::MatrixXd relations = Eigen::MatrixXd::Zero(n_relations, n);
    std::vector<detail::WholeSum> sums;
    bool all_kept = true;
    for (Eigen::Index r = 0; r < n_relations; ++r) {
      detail::WholeSum sum;
      for (index_t i = 0; i < n; ++i)
        if (const int c = coefficient(random); c != 0) sum.push_back({i, c}), relations(r, i) = c;
      sums.push_back(sum);
      all_kept = unknowns.set_zero(sum) && all_kept;
    }
    if (!all_kept) continue;  // one like 2 x = 3 y, in which neither can be expressed
    for (const detail::WholeSum& sum : sums) CHECK(unknowns.reduced(sum).empty());
    std::size_t n_left = 0;
    for (index_t i = 0; i < n; ++i) n_left += unknowns.reduced({{i, 1}}) == detail::WholeSum{{i, 1}};
    CHECK(n_left == n - static_cast<std::size_t>(relations.fullPivLu().rank()));
  }
}

TEST_CASE("whole numbers near the minimum of a quadratic function: no neighbour is better, nor plain rounding") {
  std::mt19937 random(2);
  std::normal_distribution<double> normal;
  int n_best = 0;
  constexpr int n_trials = 100;
  for (int trial = 0; trial < n_trials; ++trial) {
    Eigen::Matrix3d half;
    Eigen::Vector3d minimum;
    for (double& x : half.reshaped()) x = normal(random);
    for (double& x : minimum.reshaped()) x = 3 * normal(random);
    const Eigen::MatrixXd a = half.transpose() * half + 0.05 * Eigen::Matrix3d::Identity();
    const Eigen::VectorXd b = a * minimum;
    const Eigen::VectorXd found = detail::nearest_whole(a, b);
    CHECK(found == Eigen::VectorXd(found.array().round()));
    CHECK(value(a, b, found) <= value(a, b, Eigen::VectorXd(minimum.array().round())) + 1e-9);
    double best = std::numeric_limits<double>::max(), best_beside = best;
    for (int i = 0; i < 21 * 21 * 21; ++i) {
      const Eigen::Vector3d step(i % 21 - 10, i / 21 % 21 - 10, i / 441 - 10);
      const double here = value(a, b, found + step);
      best = std::min(best, here);
      if (step.cwiseAbs().maxCoeff() <= 1 && (step.array() != 0).count() <= 2)
        best_beside = std::min(best_beside, here);
    }
    CHECK(value(a, b, found) <= best_beside + 1e-9);
    n_best += value(a, b, found) <= best + 1e-9;
  }
  CHECK(n_best > 0.9 * n_trials);
}

TEST_CASE("a seamless map has no dislocation, is whole on the boundary and at singular lines, and balanced") {
  const bool round = GENERATE(false, true);
  const test::Body body = round ? ball() : cylinder();
  // Without wishes for lines the edges alone are in balance.
  const SeamlessMap map(body, round ? 0.25 : 0.1, {.line_weight = 0, .tolerance = 1e-5});
  REQUIRE(map.report.solved);
  CHECK(map.report.n_unknowns > 0);
  CHECK(map.report.rms_residual < 0.2);
  const LatticeGraph& graph = map.graph;

  for (const auto& t : graph.tets())
    for (int face = 0; face < 4; ++face) {
      const std::array<index_t, 3> f = facet(t, face);
      const auto along = [&](std::size_t i) { return graph.along(map.differences, f[i], f[(i + 1) % 3]); };
      const Vector3 sum =
          along(0) +
          graph.matching(f[0], f[1]).to_first(Vector3(along(1) + graph.matching(f[1], f[2]).to_first(along(2))));
      if (graph.is_regular(f)) CHECK(sum.cwiseAbs().maxCoeff() < 1e-9);
    }

  std::vector<Vector3> pull(graph.n_vertices(), Vector3::Zero());
  for (index_t e = 0; e < graph.n_edges(); ++e) {
    const auto [v, w] = graph.edges()[e];
    const Vector3 whole = graph.matching(e).to_first(map.phases[w]) - map.phases[v] - map.differences[e];
    CHECK((whole.array() - whole.array().round()).abs().maxCoeff() < 1e-9);
    Vector3 force = graph.weights()[e] * (map.differences[e] - map.steps[e]);
    for (int a = 0; a < 3; ++a)
      if (map.tangent[e] >> a & 1) force[a] = 0;  // stiffer ones, between vertices that are fixed
    pull[v] += force;
    pull[w] -= graph.matching(e).to_second(force);
  }
  double largest = 0;
  for (index_t v = 0; v < graph.n_vertices(); ++v)
    for (int a = 0; a < 3; ++a) {
      const double u = map.phases[v][a];
      if (map.boundary.whole[v] >> a & 1)
        CHECK(std::abs(u - std::round(u)) < 1e-9);
      else if (map.boundary.whole[v] == 0)
        largest = std::max(largest, std::abs(pull[v][a]) / map.sizes[v]);
    }
  CHECK(largest < 1e-2);
}

TEST_CASE("the wish for lines draws a seamless map's whole coordinates to them, and no half ones") {
  const test::Body body = cylinder();
  const SeamlessMap without(body, 0.1, {.line_weight = 0}), with(body, 0.1, {.line_weight = 100});
  REQUIRE(with.report.solved);
  REQUIRE(with.lines->lines().size() == 4);
  for (const auto& line : with.lines->lines()) {
    // What is left is the zigzag of the facets: a mean cosine of less than a tenth of a step.
    CHECK(with.lines->parity(line, with.phases) > 0.8);
    CHECK(with.lines->parity(line, with.phases) > without.lines->parity(line, without.phases));
  }
}

TEST_CASE("a seamless map does not depend on the threads") {
  const test::Body body = cylinder();
  const SeamlessMap once(body, 0.1);
  for (const std::size_t threads : {std::size_t{2}, std::size_t{3}}) {
    const SeamlessMap again(body, 0.1, {}, ThreadExecutor(threads));
    CHECK(again.phases == once.phases);
    CHECK(again.differences == once.differences);
  }
}

TEST_CASE("fields that leave more whole numbers free than asked for get the other map") {
  const test::Body body = cylinder();
  LatticeOptions options;
  options.seamless.most_unknowns = 3;
  LatticeReport report;
  const LatticePoints points = body.lattice(0.1, &report, SerialExecutor{}, options);
  CHECK(report.seamless.n_unknowns > 3);
  CHECK_FALSE(report.seamless.solved);
  CHECK(report.mapping == LatticeMapping::phases);
  options.mapping = LatticeMapping::phases;
  CHECK(points.interior == body.lattice(0.1, nullptr, SerialExecutor{}, options).interior);
}

TEST_CASE("a map that would have to be bent is not taken: a wedge has fewer layers at its edge than at its back") {
  // From 1 to 5 sizes thick, by three layers: 1.8 times too thin below 1.67 sizes, which is 7.4 % of the volume.
  std::vector<Eigen::Vector2d> outline{{0, 0}, {4, 0}, {4, 1.25}, {0, 0.25}};
  const test::Body body(test::filled(test::extruded_polygon(outline, 1), 2e-3));
  LatticeReport report;
  body.lattice(0.25, &report);
  CHECK(report.seamless.bent_volume == Approx(0.074).margin(0.03));
  CHECK_FALSE(report.seamless.solved);
  CHECK(report.mapping == LatticeMapping::phases);
  LatticeOptions options;
  options.seamless.most_bent = 1;
  body.lattice(0.25, &report, SerialExecutor{}, options);
  CHECK(report.mapping == LatticeMapping::seamless);
}
