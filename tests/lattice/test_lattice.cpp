// SPDX-License-Identifier: BSL-1.0
#include "framehex/surface/refinement.hpp"
#include "lattice/body.hpp"

#include <catch2/catch.hpp>

#include <Eigen/SparseCholesky>

#include <map>
#include <random>

using namespace framehex;
using test::Body;

namespace {

IndexedTriangleMesh turned(IndexedTriangleMesh surface, const Quaternion& rotation) {
  for (Vector3& p : surface.points) p = rotation * p;
  return surface;
}

Quaternion odd_turn(double angle) {
  return Quaternion(Eigen::AngleAxisd(angle, Vector3(1, 2, -0.5).normalized()));
}

std::size_t n_set(const std::vector<std::uint8_t>& marks) {
  return static_cast<std::size_t>(std::count(marks.begin(), marks.end(), 1));
}

}  // namespace

TEST_CASE("matchings of axes are those of the group's rotations, and inverses undo each other") {
  for (int g = 0; g < 24; ++g) {
    const Vector3 x(1, 2, 3), there = CubeRotationGroup<>::element(g) * x;
    // Frame q and frame q g have the same axes; components along the second, told by the first.
    CHECK((axis_matching(g).to_first(x) - there).norm() < 1e-12);
    CHECK((axis_matching(g).to_second(axis_matching(g).to_first(x)) - x).norm() == 0);
    CHECK((axis_matching(CubeRotationGroup<>::inverse(g)).to_first(x) - axis_matching(g).to_second(x)).norm() == 0);
  }
}

TEST_CASE("a box whose sides the size divides gets exactly its lattice, however it is turned and meshed") {
  const double angle = GENERATE(0.0, 0.4, 2.1);
  const Quaternion turn = odd_turn(angle);
  Body body(test::filled(turned(test::box_surface({4, 3, 2}, 7, 5, 3), turn), 0.02));
  // Frames of any of their 24 forms.
  for (std::size_t v = 0; v < body.frames.size(); ++v)
    body.frames[v] = turn * CubeRotationGroup<>::element(static_cast<int>(v * 7 % 24));
  LatticeReport report;
  const LatticePoints lattice = body.lattice(0.5, &report);
  CHECK(lattice.n_singular_tets == 0);
  CHECK(lattice.n_defect_tets == 0);
  CHECK(lattice.complete_volume == Approx(1));
  CHECK(report.projection.closure_before < 1e-12);
  CHECK(report.projection.change < 1e-6);
  CHECK(lattice.interior.size() == 9 * 7 * 5);  // also on the boundary, where the stages after drop them
  for (const Vector3& p : lattice.interior) {
    const Vector3 u = turn.conjugate() * p / 0.5;
    CHECK((u.array() - u.array().round()).matrix().norm() < 1e-4);
  }
  CHECK(n_set(lattice.complete_triangles) == body.boundary.surface.triangles.size());
  CHECK(n_set(lattice.curves.is_usable) == 12);
  CHECK(lattice.curves.arcs.values.size() == 4 * (7 + 5 + 3));
}

TEST_CASE("sides between two multiples of the size get the nearest whole number of steps") {
  Body body(test::filled(test::box_surface({4.1, 2.85, 2.2}, 7, 5, 3), 0.02));
  const LatticePoints lattice = body.lattice(0.5);
  CHECK(lattice.n_defect_tets == 0);
  CHECK(lattice.interior.size() == 9 * 7 * 5);  // 8.2, 5.7 and 4.4 steps
}

TEST_CASE("the scale of the axes makes a polar grid integrable: a tube has as many points inside as outside") {
  const double inner = 0.25, outer = 0.55, size = 0.1;
  const Surface tube(test::tube_surface(inner, outer, 1, 48));
  const Surface fine = refine(tube, [=](const Vector3&) { return size; }).surface;
  Body body(test::filled({fine.points, fine.triangles()}, 1e-4));
  for (std::size_t v = 0; v < body.frames.size(); ++v) {
    const Vector3& p = body.mesh.points[v];
    body.frames[v] = Quaternion(Eigen::AngleAxisd(std::atan2(p.y(), p.x()), Vector3::UnitZ()));
  }
  LatticeOptions options;
  options.mapping = GENERATE(LatticeMapping::phases, LatticeMapping::seamless);
  LatticeReport report;
  const LatticePoints lattice = body.lattice(size, &report, SerialExecutor{}, options);
  CHECK(report.mapping == options.mapping);
  if (options.mapping == LatticeMapping::phases) CHECK(report.phases.n_pinned == 1);  // nothing holds the angle
  CHECK(lattice.n_defect_tets == 0);
  CHECK(lattice.complete_volume == Approx(1));
  const std::size_t layers = 11 * 4;  // by height and radius: 10 and 3 steps
  const double around = static_cast<double>(lattice.interior.size() / layers);
  CHECK(lattice.interior.size() % layers == 0);
  CHECK(around > 2 * std::numbers::pi * inner / size);
  CHECK(around < 2 * std::numbers::pi * outer / size);
}

TEST_CASE("the projection of steps minimises what it says: against a factorised matrix") {
  Body body(test::filled(test::box_surface({1, 1, 1}, 2, 2, 2), 0.01));
  const LatticeGraph graph(body.adjacency, body.mesh.points, body.frames);
  std::mt19937_64 engine(7);
  const auto number = [&] { return static_cast<double>(engine() >> 11) * 0x1p-52 - 1; };
  std::vector<Vector3> steps;
  for (std::size_t e = 0; e < graph.n_edges(); ++e) steps.emplace_back(number(), number(), number());
  std::vector<AxisMask> fixed(graph.n_edges(), 0);
  for (std::size_t e = 0; e < fixed.size(); e += 5) fixed[e] = static_cast<AxisMask>(e % 8);

  // All matchings are the identity, so the three axes are three problems.
  std::map<std::array<index_t, 3>, int> facets;
  for (const auto& t : body.mesh.tets)
    for (int face = 0; face < 4; ++face) facets[detail::sorted(facet(t, face))] = 0;
  double mean = 0;
  for (const double w : graph.weights()) mean += w / static_cast<double>(graph.n_edges());
  const double stiffness = 300;
  const auto n = static_cast<Eigen::Index>(graph.n_edges());
  std::vector<Eigen::Triplet<double>> entries;
  int row = 0;
  for (const auto& [v, unused] : facets) {
    entries.emplace_back(row, static_cast<int>(graph.edge(v[0], v[1])), 1);
    entries.emplace_back(row, static_cast<int>(graph.edge(v[1], v[2])), 1);
    entries.emplace_back(row++, static_cast<int>(graph.edge(v[0], v[2])), -1);
  }
  Eigen::SparseMatrix<double> d(row, n);
  d.setFromTriplets(entries.begin(), entries.end());
  Eigen::VectorXd inertia(n);
  for (Eigen::Index e = 0; e < n; ++e) inertia[e] = graph.weights()[static_cast<std::size_t>(e)] / mean;
  const auto component = [&](const std::vector<Vector3>& values, int axis) {
    Eigen::VectorXd result(n);
    for (Eigen::Index e = 0; e < n; ++e) result[e] = values[static_cast<std::size_t>(e)][axis];
    return result;
  };
  const std::vector<Vector3> asked = steps;
  const StepProjectionReport report = project_steps(graph, steps, fixed, {.stiffness = stiffness, .tolerance = 1e-5});
  for (int axis = 0; axis < 3; ++axis) {
    const auto is_fixed = [&](Eigen::Index e) { return (fixed[static_cast<std::size_t>(e)] >> axis & 1) != 0; };
    Eigen::VectorXd start = component(asked, axis);
    for (Eigen::Index e = 0; e < n; ++e)
      if (is_fixed(e)) start[e] = 0;
    Eigen::SparseMatrix<double> matrix = stiffness * (d.transpose() * d);
    Eigen::VectorXd right = -stiffness * (d.transpose() * (d * start));
    for (Eigen::Index e = 0; e < n; ++e) {
      matrix.coeffRef(e, e) += inertia[e];
      if (!is_fixed(e)) continue;
      matrix.coeffRef(e, e) += 1e12;  // a penalty far beyond all else
      right[e] = 0;
    }
    const Eigen::VectorXd best = Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>(matrix).solve(right);
    const auto functional = [&](const Eigen::VectorXd& change) {
      return change.dot(inertia.cwiseProduct(change)) + stiffness * (d * (start + change)).squaredNorm();
    };
    const Eigen::VectorXd found = component(steps, axis) - start;
    for (Eigen::Index e = 0; e < n; ++e)
      if (is_fixed(e)) CHECK(found[e] == 0);
    // What is above the least value falls with the square of the residual, and that to 1e-10; single precision of the
    // steps, of which `functional` makes differences, leaves 1e-7 of the square at the start.
    const double least = functional(best), excess = functional(found) - least;
    CHECK(excess >= -1e-9 * least);
    CHECK(excess < 1e-6 * (functional(Eigen::VectorXd::Zero(n)) - least));
  }
  CHECK(report.closure_after < 0.1 * report.closure_before);
}

TEST_CASE("lines of a cylinder's field are put on whole coordinates, and the points do not depend on the threads") {
  Body body(test::filled(test::ringed_cylinder_surface(0.5, 1, 5), 2e-4));
  body.frames = compute_frame_field(body.mesh).frames();
  LatticeOptions options;
  options.mapping = GENERATE(LatticeMapping::phases, LatticeMapping::seamless);
  LatticeReport report;
  const LatticePoints once = body.lattice(0.1, &report, SerialExecutor{}, options);
  CHECK(report.mapping == options.mapping);
  if (options.mapping == LatticeMapping::phases) CHECK(report.singular.n_lines == 4);
  CHECK(once.n_singular_tets > 0);
  CHECK(once.complete_volume > 0.9);
  for (const std::size_t threads : {std::size_t{2}, std::size_t{3}}) {
    const LatticePoints again = body.lattice(0.1, nullptr, ThreadExecutor(threads), options);
    CHECK(again.interior == once.interior);
    CHECK(again.curves.arcs.values == once.curves.arcs.values);
    CHECK(again.complete_tets == once.complete_tets);
  }
}

TEST_CASE("a line forced to whole coordinates has them") {
  Body body(test::filled(test::ringed_cylinder_surface(0.5, 1, 5), 2e-4));
  body.frames = compute_frame_field(body.mesh).frames();
  const std::vector<double> sizes(body.frames.size(), 0.1);
  const LatticeGraph graph(body.adjacency, body.mesh.points, body.frames);
  const BoundaryAxes boundary = find_boundary_axes(graph, body.surface, body.boundary.vertex_of);
  std::vector<Vector3> scale;
  REQUIRE(scale_axes(graph, sizes, scale));
  std::vector<Vector3> steps = lattice_steps(graph, scale, ConstantSize{0.1});
  const auto tangent = tangent_edges(graph, body.surface, boundary, body.boundary.vertex_of);
  project_steps(graph, steps, tangent);
  PhaseSolver solver(graph, steps, boundary.whole, tangent, sizes);
  const SingularLines lines(graph, scale, sizes);
  REQUIRE(lines.lines().size() == 4);
  std::vector<PhaseTarget> targets;
  for (const auto& line : lines.lines()) lines.add_targets(line, boundary.whole, targets);
  std::vector<Vector3> phases;
  solver.solve(phases, targets);
  for (const auto& line : lines.lines()) {
    // The mean cosine of a sixth of a step: nearer to whole than to half, and to no other whole number, all along.
    CHECK(lines.parity(line, phases) > 0.5);
    CHECK(line.length == Approx(10).epsilon(0.2));
    CHECK(line.index == 0.25);
  }
  for (index_t v = 0; v < phases.size(); ++v)
    for (int a = 0; a < 3; ++a)
      if (boundary.whole[v] >> a & 1) CHECK(std::abs(phases[v][a] - std::round(phases[v][a])) < 1e-9);
}

TEST_CASE("a size that grows tenfold is followed step by step, without a dislocation") {
  Body body(test::filled(test::box_surface({4, 1, 1}, 20, 5, 5), 2e-3));
  const auto size = [](const Vector3& p) { return 0.05 * std::pow(10, p.x() / 4); };
  LatticeReport report;
  const LatticePoints lattice = place_lattice(body.adjacency, body.mesh.points, body.frames, body.surface, size, {},
                                              SerialExecutor{}, &report, body.boundary.vertex_of);
  CHECK(lattice.interior.size() > 100);
  CHECK(lattice.complete_volume > 0.5);
  CHECK(report.projection.closure_after < report.projection.closure_before);
}

TEST_CASE("cancelling at any time leaves nothing, and progress does not fall") {
  Body body(test::filled(test::ringed_cylinder_surface(0.5, 1, 3), 2e-3));
  body.frames = compute_frame_field(body.mesh).frames();
  std::size_t n_calls = 0;
  LatticeOptions options;
  options.mapping = GENERATE(LatticeMapping::phases, LatticeMapping::seamless);
  double last = 0;
  bool falls = false;
  options.observer = [&](const Progress& progress) {
    falls = falls || progress.fraction < last;
    last = progress.fraction;
    ++n_calls;
    return true;
  };
  const LatticePoints whole = body.lattice(0.2, nullptr, SerialExecutor{}, options);
  CHECK(!whole.interior.empty());
  CHECK(!falls);
  for (std::size_t stop = 0; stop < n_calls; stop += 1 + n_calls / 10) {
    std::size_t call = 0;
    options.observer = [&](const Progress&) { return call++ < stop; };
    LatticeReport report;
    const LatticePoints nothing = body.lattice(0.2, &report, SerialExecutor{}, options);
    CHECK(nothing.interior.empty());
    CHECK(report.status == Status::cancelled);
  }
}

TEST_CASE("numbers that make no sense are refused before any work") {
  Body body(test::filled(test::box_surface({1, 1, 1}, 1, 1, 1), 0.1));
  LatticeOptions options;
  options.step_factor = 0;
  CHECK_THROWS_AS(body.lattice(0.5, nullptr, SerialExecutor{}, options), invalid_option);
  options = {};
  options.scale.longest = 0.5;
  CHECK_THROWS_AS(body.lattice(0.5, nullptr, SerialExecutor{}, options), invalid_option);
  options = {};
  options.projection.stiffness = -1;
  CHECK_THROWS_AS(body.lattice(0.5, nullptr, SerialExecutor{}, options), invalid_option);
  CHECK_THROWS_AS(body.lattice(std::numeric_limits<double>::quiet_NaN()), invalid_field);
  body.frames.pop_back();
  CHECK_THROWS_AS(body.lattice(0.5), invalid_option);
}
