// SPDX-License-Identifier: BSL-1.0
#include "framehex/field/tet_locator.hpp"
#include "framehex/field/vertex_size_field.hpp"
#include "framehex/geometry/predicates.hpp"
#include "framehex/insertion/estimate.hpp"
#include "support/kuhn_lattice.hpp"

#include <catch2/catch.hpp>

#include <random>

using namespace framehex;

namespace {

/// Two rows of cubes, one half as long as the other: its box is full of places that a walk does not reach.
IndexedTetMesh staircase(index_t length) {
  IndexedTetMesh mesh = test::kuhn_lattice(length, 2, 1);
  std::erase_if(mesh.tets, [&](const auto& t) {
    const Vector3 c = (mesh.points[t[0]] + mesh.points[t[1]] + mesh.points[t[2]] + mesh.points[t[3]]) / 4;
    return c.y() > 1 && c.x() < length / 2;
  });
  return mesh;
}

/// Squared distance of p from the mesh, from all tetrahedra and all their facets.
double squared_distance(const TetLocator& locator, const Vector3& p) {
  double least = std::numeric_limits<double>::infinity();
  for (index_t tet = 0; tet < locator.adjacency().tets.size(); ++tet) {
    const auto b = locator.barycentric(tet, p);
    if (*std::min_element(b.begin(), b.end()) >= 0) return 0;
    for (int i = 0; i < 4; ++i) {
      const auto v = facet(locator.adjacency().tets[tet], i);
      const auto& x = locator.points();
      least = std::min(least, nearest_on_triangle(p, x[v[0]], x[v[1]], x[v[2]]).squared_distance);
    }
  }
  return least;
}

}  // namespace

TEST_CASE("a point outside is located at the nearest point of the mesh, from any hint") {
  IndexedTetMesh mesh = staircase(12);
  std::mt19937_64 engine(2);
  const auto uniform = [&engine](double low, double high) {
    return low + (high - low) * static_cast<double>(engine() >> 11) * 0x1p-53;
  };
  for (Vector3& p : mesh.points) p += Vector3(uniform(-.1, .1), uniform(-.1, .1), uniform(-.1, .1));
  const TetLocator locator(make_adjacency(mesh), mesh.points);
  int n_inside = 0;
  for (int i = 0; i < 2000; ++i) {
    const Vector3 p(uniform(-2, 14), uniform(-2, 4), uniform(-2, 3));
    const auto hint = i % 3 == 0 ? no_index : static_cast<index_t>(engine() % (mesh.tets.size() + 5));
    const double expected = squared_distance(locator, p);
    const TetLocation at = locator.locate(p, hint);
    REQUIRE(at.tet < mesh.tets.size());
    CHECK(at.inside == (expected == 0));
    CHECK((locator.position(at) - p).squaredNorm() == Approx(expected).margin(1e-18));
    n_inside += at.inside;
  }
  CHECK(n_inside > 40);
  CHECK(n_inside < 1000);
}

TEST_CASE("a long domain with a step loses no point", "[regression]") {
  for (const index_t length : {40U, 400U, 4000U}) {
    const IndexedTetMesh mesh = staircase(length);
    const auto locator = std::make_shared<const TetLocator>(make_adjacency(mesh), mesh.points);
    // Outside, over the half that is missing: the nearest point is straight below.
    const TetLocation at = locator->locate(Vector3(5, 1.9, 0.5));
    REQUIRE(at.tet != no_index);
    CHECK_FALSE(at.inside);
    CHECK((locator->position(at) - Vector3(5, 1, 0.5)).norm() < 1e-12);
    std::vector<double> sizes;
    for (const Vector3& p : mesh.points) sizes.push_back(1 + p.x());
    CHECK(VertexSizeField(locator, sizes)(Vector3(5, 1.9, 0.5)) == Approx(6));
    // Inside, from the other end.
    CHECK(locator->locate(Vector3(length - 0.5, 1.5, 0.5), 0).inside);
  }
}

TEST_CASE("a point in a sliver is inside") {
  // A flat tetrahedron on another's facet, and three below it.
  IndexedTetMesh mesh;
  mesh.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.3, 0.3, 1}, {0.3, 0.3, -1e-15}, {0.3, 0.3, -1}};
  mesh.tets = {{0, 1, 2, 3}, {0, 2, 1, 4}, {0, 1, 4, 5}, {1, 2, 4, 5}, {2, 0, 4, 5}};
  for (auto& t : mesh.tets)
    if (orientation(mesh.points[t[0]], mesh.points[t[1]], mesh.points[t[2]], mesh.points[t[3]]) < 0)
      std::swap(t[0], t[1]);
  const TetLocator locator(make_adjacency(mesh), mesh.points);
  for (int i = 0; i <= 16; ++i) {
    const Vector3 p(0.25, 0.25, -i * 1e-16);
    const TetLocation at = locator.locate(p);
    CHECK(at.inside);
    CHECK((locator.position(at) - p).norm() < 1e-12);
  }
}

TEST_CASE("sizes are asked for with the place found before") {
  struct Counting {
    mutable index_t n_hinted = 0;
    double operator()(const Vector3&) const { return 0.25; }
    double sample(const Vector3&, index_t& hint) const {
      n_hinted += hint == 7;
      hint = 7;
      return 0.25;
    }
  };
  struct Everywhere {
    double clearance(const Vector3&, double) const { return 1; }
  };
  const Counting size;
  estimate_volume_points(Vector3::Zero(), Vector3::Ones(), Everywhere{}, size);
  CHECK(size.n_hinted == 16 * 16 * 16 - 1);
}
