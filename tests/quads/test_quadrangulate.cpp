// SPDX-License-Identifier: BSL-1.0
#include "framehex/adapters/boost_matcher.hpp"
#include "framehex/adapters/lemon_matcher.hpp"
#include "framehex/quads/quadrangulate.hpp"

#include "support/flat_delaunay.hpp"
#include "support/quad_checks.hpp"
#include "support/surfaces.hpp"

#include <catch2/catch.hpp>

using namespace framehex;
using namespace framehex::test;

namespace {

/// Pairs and their total cost.
struct Value {
  std::size_t n_pairs = 0;
  std::int64_t cost = 0;

  bool better_than(const Value& other) const {
    return n_pairs != other.n_pairs ? n_pairs > other.n_pairs : cost < other.cost;
  }
  friend bool operator==(const Value&, const Value&) = default;
};

/// The best of all matchings, one after another.
class BruteForce {
public:
  BruteForce(std::size_t n, std::span<const MatchingEdge> edges) : taken_(n, 0), edges_(edges) {}

  Value run() {
    visit(0, {});
    return best_;
  }

private:
  void visit(std::size_t v, const Value& value) {
    while (v < taken_.size() && taken_[v]) ++v;
    if (v == taken_.size()) {
      if (value.better_than(best_)) best_ = value;
      return;
    }
    taken_[v] = 1;
    for (const MatchingEdge& e : edges_) {
      if (e.a != v && e.b != v) continue;
      const index_t other = e.a == v ? e.b : e.a;
      if (taken_[other]) continue;
      taken_[other] = 1;
      visit(v + 1, {value.n_pairs + 1, value.cost + e.cost});
      taken_[other] = 0;
    }
    visit(v + 1, value);
    taken_[v] = 0;
  }

  std::vector<char> taken_;
  std::span<const MatchingEdge> edges_;
  Value best_;
};

/// What a matcher has found, after a check that it is a matching along edges.
Value value_of(const std::vector<index_t>& mate, std::span<const MatchingEdge> edges) {
  Value value;
  for (const MatchingEdge& e : edges)
    if (mate[e.a] == e.b) {
      REQUIRE(mate[e.b] == e.a);
      ++value.n_pairs;
      value.cost += e.cost;
    }
  const auto n_joined = static_cast<std::size_t>(
      std::count_if(mate.begin(), mate.end(), [](index_t other) { return other != no_index; }));
  REQUIRE(n_joined == 2 * value.n_pairs);
  return value;
}

IndexedTriangleMesh random_mesh(std::size_t n_points, std::mt19937_64& engine) {
  return flat_delaunay(random_flat_points(n_points, engine));
}

enum class Openings { none, on_curves, everywhere };

std::vector<MatchingEdge> pairing_edges(const Surface& surface, Openings openings) {
  const detail::PatchSides sides(surface);
  detail::PairingGraph graph(surface, sides, {}, 0);
  if (openings != Openings::none) graph.add_openings_on_curves(2);
  if (openings == Openings::everywhere) graph.add_openings_everywhere(3);
  return graph.edges();
}

std::set<std::pair<index_t, index_t>> rim_sides(const Surface& surface) {
  std::set<std::pair<index_t, index_t>> rim;
  for (index_t h = 0; h < surface.adjacency.opposite.size(); ++h)
    if (surface.adjacency.opposite[h] == no_index) rim.emplace(surface.adjacency.from(h), surface.adjacency.to(h));
  return rim;
}

}  // namespace

TEST_CASE("LEMON finds the best of all matchings on 500 random meshes") {
  std::mt19937_64 engine(22);
  for (int i = 0; i < 500; ++i) {
    const Surface surface(random_mesh(5 + static_cast<std::size_t>(i) % 6, engine));
    REQUIRE(surface.triangles().size() <= 16);
    const auto edges = pairing_edges(surface, static_cast<Openings>(i % 3));
    const std::size_t n = surface.triangles().size();
    const Value best = BruteForce(n, edges).run();
    CAPTURE(i, n);
    CHECK(value_of(LemonMatcher{}(n, edges), edges) == best);
    CHECK(value_of(BoostMatcher{}(n, edges), edges).n_pairs == best.n_pairs);
    CHECK_FALSE(value_of(GreedyMatcher{}(n, edges), edges).better_than(best));
  }
}

TEST_CASE("an even number of triangles becomes quadrilaterals alone, an odd one leaves one triangle") {
  std::mt19937_64 engine(5);
  for (int i = 0; i < 200; ++i) {
    const Surface surface(random_mesh(4 + static_cast<std::size_t>(i) % 20, engine));
    const Quadrangulation result =
        i % 2 == 0 ? quadrangulate(surface, LemonMatcher{}) : quadrangulate(surface, BoostMatcher{});
    CAPTURE(i, surface.triangles().size());
    CHECK(result.mesh.n_triangles() == surface.triangles().size() % 2);
    CHECK(result.mesh.points.size() == surface.points.size() + result.copied.size());
    CHECK(topology_fault(result.mesh) == std::nullopt);
    CHECK(framehex::test::rim_sides(result.mesh) == rim_sides(surface));
    CHECK(euler_characteristic(result.mesh) == 1);
  }
}

TEST_CASE("openings everywhere leave no triangle, whatever the matcher prefers") {
  // Costs that make openings cheap: many in one vertex, across one another, in closed fans.
  std::mt19937_64 engine(9);
  for (int i = 0; i < 200; ++i) {
    const Surface surface(random_mesh(6 + static_cast<std::size_t>(i) % 20, engine));
    const std::size_t n = surface.triangles().size();
    const detail::PatchSides sides(surface);
    detail::PairingGraph graph(surface, sides, {}, 0);
    graph.add_openings_everywhere(0);
    const auto mate = LemonMatcher{}(n, graph.edges());
    const QuadMesh mesh = detail::PairJoiner(surface, sides, graph, mate).run();
    CAPTURE(i, n);
    CHECK(mesh.n_triangles() == n % 2);
    CHECK(topology_fault(mesh) == std::nullopt);
    CHECK(framehex::test::rim_sides(mesh) == rim_sides(surface));
    CHECK(euler_characteristic(mesh) == 1);
  }
}

TEST_CASE("features and closed surfaces: the box keeps its edges, the torus its characteristic") {
  const Surface box(box_surface({1, 2, 3}, 3, 4, 5));
  const Quadrangulation boxed = quadrangulate(box, LemonMatcher{});
  CHECK(boxed.mesh.n_triangles() == 0);
  CHECK(boxed.cost == 0);
  CHECK(boxed.mesh.cells.size() == box.triangles().size() / 2);
  CHECK(euler_characteristic(boxed.mesh) == 2);
  const auto sides = directed_sides(boxed.mesh);
  for (index_t h = 0; h < box.features.is_feature.size(); ++h)
    if (box.features.is_feature[h]) CHECK(sides.contains({box.adjacency.from(h), box.adjacency.to(h)}));

  const Quadrangulation torus = quadrangulate(torus_surface(2, 0.7, 24, 9), LemonMatcher{});
  CHECK(torus.mesh.n_triangles() == 0);
  CHECK(euler_characteristic(torus.mesh) == 0);
  CHECK(torus.copied.empty());
}

TEST_CASE("a greedy matching of pairs leaves some triangles and no copies") {
  std::mt19937_64 engine(3);
  const Surface surface(random_mesh(40, engine));
  const Quadrangulation result = quadrangulate(surface, GreedyMatcher{}, {.goal = QuadGoal::pairs});
  CHECK(result.copied.empty());
  CHECK(2 * (result.mesh.cells.size() - result.mesh.n_triangles()) + result.mesh.n_triangles() ==
        surface.triangles().size());
  CHECK(topology_fault(result.mesh) == std::nullopt);
}

TEST_CASE("the cross field decides between pairs of equal shape") {
  // A ring of equilateral triangles falls into rhombi that lean forward, or backward, at one cost.
  IndexedTriangleMesh ring;
  const index_t n = 12;
  const double side = 2 * std::numbers::pi / n, chord = 2 * std::sin(side / 2);
  for (index_t i = 0; i < n; ++i)
    for (const double row : {0.0, 1.0}) {
      const double angle = side * (i + row / 2);
      ring.points.emplace_back(std::cos(angle), std::sin(angle), row * chord * std::sqrt(0.75));
    }
  for (index_t i = 0; i < n; ++i) {
    const index_t a = 2 * i, b = 2 * ((i + 1) % n), c = b + 1, d = a + 1;
    ring.triangles.push_back({a, b, d});
    ring.triangles.push_back({b, c, d});
  }
  const Surface surface(ring, {.corner_angle = std::numbers::pi});
  for (const bool forward : {true, false}) {
    std::vector<Quaternion> frames;
    for (const auto& t : ring.triangles) {
      const Vector3 normal =
          (ring.points[t[1]] - ring.points[t[0]]).cross(ring.points[t[2]] - ring.points[t[0]]).normalized();
      Eigen::Matrix3d axes;
      const Vector3 level = Vector3::UnitZ().cross(normal).normalized(), up = normal.cross(level);
      const double angle = (forward ? 60 : 120) * std::numbers::pi / 180;
      axes.col(0) = std::cos(angle) * level + std::sin(angle) * up;
      axes.col(1) = normal.cross(axes.col(0));
      axes.col(2) = normal;
      frames.emplace_back(axes);
    }
    const Quadrangulation result = quadrangulate(surface, LemonMatcher{}, {.frames = frames, .alignment = 0.5});
    REQUIRE(result.mesh.cells.size() == n);
    const auto sides = directed_sides(result.mesh);
    for (index_t i = 0; i < n; ++i) {
      const index_t a = 2 * i, b = 2 * ((i + 1) % n), d = a + 1;
      CHECK(sides.contains({a, d}) == forward);  // the side that leans forward
      CHECK(sides.contains({b, d}) != forward);
    }
  }
}

TEST_CASE("options and frames of a quadrangulation are checked") {
  const Surface surface(box_surface({1, 1, 1}));
  const std::vector<Quaternion> frames(2, Quaternion::Identity());
  CHECK_THROWS_AS(quadrangulate(surface, LemonMatcher{}, {.frames = frames}), invalid_option);
  CHECK_THROWS_AS(quadrangulate(surface, LemonMatcher{}, {.alignment = 2}), invalid_option);
  CHECK_THROWS_AS(quadrangulate(surface, LemonMatcher{}, {.opening_cost = -1}), invalid_option);
}
