// SPDX-License-Identifier: BSL-1.0
#include "framehex/recombination/compatibility.hpp"
#include "framehex/recombination/pattern_search.hpp"
#include "framehex/recombination/potential_hex_finder.hpp"
#include "framehex/recombination/potential_prism_finder.hpp"
#include "framehex/recombination/potential_pyramid_finder.hpp"
#include "support/delaunay_lattice.hpp"
#include "support/hexahedron_symmetry.hpp"
#include "support/kuhn_lattice.hpp"
#include "support/void_between.hpp"

#include <catch2/catch.hpp>

#include <boost/random/uniform_int_distribution.hpp>

#include <numeric>

using namespace framehex;

namespace {

/// Runs the blocks backwards, by two workers in turn.
struct BackwardExecutor {
  std::size_t workers() const { return 2; }
  template <class Body>
  void operator()(std::size_t n_blocks, Body&& body) const {
    for (std::size_t block = n_blocks; block-- > 0;) body(block, block % 2);
  }
};

template <int Corners>
void check_equal(const Candidates<Corners>& a, const Candidates<Corners>& b) {
  CHECK(a.vertices == b.vertices);
  CHECK(a.tets.offsets == b.tets.offsets);
  CHECK(a.tets.values == b.tets.values);
  CHECK(a.face_slivers.offsets == b.face_slivers.offsets);
  CHECK(a.face_slivers.values == b.face_slivers.values);
  CHECK(a.quality == b.quality);
  CHECK(a.volume == b.volume);
  CHECK(a.status == b.status);
}

IndexedTetMesh joined(IndexedTetMesh a, const IndexedTetMesh& b, const Vector3& shift) {
  const auto offset = static_cast<index_t>(a.points.size());
  for (const Vector3& p : b.points) a.points.push_back(p + shift);
  for (auto tet : b.tets) {
    for (index_t& v : tet) v += offset;
    a.tets.push_back(tet);
  }
  return a;
}

/// Replaces vertices by others.
IndexedTetMesh glued(IndexedTetMesh mesh, const std::vector<std::array<index_t, 2>>& pairs) {
  for (auto& tet : mesh.tets)
    for (index_t& v : tet)
      for (const auto& [from, to] : pairs)
        if (v == from) v = to;
  return mesh;
}

}  // namespace

TEST_CASE("The result does not depend on the executor", "[threads]") {
  const auto mesh = test::DelaunayLattice(9, 1, 0.5).mesh;
  const FinderOptions options{.quality_floor = 0.05};
  const auto serial = find_potential_hexahedra(mesh, options);
  REQUIRE(serial.size() > 1000);
  check_equal(serial, find_potential_hexahedra(mesh, options, ThreadExecutor(2)));
  check_equal(serial, find_potential_hexahedra(mesh, options, ThreadExecutor(5)));
  check_equal(serial, find_potential_hexahedra(mesh, options, BackwardExecutor{}));
  check_equal(find_potential_prisms(mesh, options), find_potential_prisms(mesh, options, ThreadExecutor(3)));
  check_equal(find_potential_pyramids(mesh, options), find_potential_pyramids(mesh, options, BackwardExecutor{}));
}

TEST_CASE("Vertex by vertex the finder gives the same, and the caller's adjacency as well") {
  const auto mesh = test::DelaunayLattice(3, 2, 1).mesh;
  const auto all = find_potential_hexahedra(mesh);
  const auto adjacency = make_adjacency(mesh);
  const PotentialHexFinder finder(mesh, {.input_check = InputCheck::skip, .adjacency = &adjacency});
  CHECK(&finder.adjacency() == &adjacency);
  std::size_t n = 0;
  for (index_t v = 0; v < mesh.points.size(); ++v) {
    const auto part = finder.find_at(v);
    for (std::size_t i = 0; i < part.size(); ++i, ++n) {
      REQUIRE(part.vertices[i] == all.vertices[n]);
      REQUIRE(std::ranges::equal(part.tets[i], all.tets[n]));
    }
  }
  CHECK(n == all.size());
  check_equal(all, finder.find());
}

TEST_CASE("What is reported of a candidate is true") {
  const auto mesh = test::DelaunayLattice(4, 3, 0.7).mesh;
  const auto found = find_potential_hexahedra(mesh, {.quality_floor = 0.01, .boundary_rule = BoundaryRule::ignore});
  REQUIRE(found.size() > 100);
  std::size_t n_slivers = 0;
  for (std::size_t i = 0; i < found.size(); ++i) {
    std::array<Vector3, 8> p;
    for (std::size_t k = 0; k < 8; ++k) p[k] = mesh.points[found.vertices[i][k]];
    CHECK(found.quality[i] == Approx(scaled_jacobian(CellKind::hexahedron, p)));
    CHECK(found.volume[i] == Approx(cell_volume(CellKind::hexahedron, p)));
    CHECK(is_valid(CellKind::hexahedron, p));
    double volume = 0;
    for (const index_t t : found.tets[i]) {
      const auto& v = mesh.tets[t];
      volume += orientation_determinant(mesh.points[v[0]], mesh.points[v[1]], mesh.points[v[2]], mesh.points[v[3]]) / 6;
    }
    // Each bent face, cut in two triangles, is off by half the tetrahedron of its corners, on one side or the other.
    double bend = 1e-9;
    for (const LocalFace& face : faces_of(CellKind::hexahedron)) {
      const auto at = [&](std::size_t c) { return p[static_cast<std::size_t>(face.corners[c])]; };
      bend += std::abs(orientation_determinant(at(0), at(1), at(2), at(3))) / 12;
    }
    CHECK(std::abs(volume - found.volume[i]) <= bend);
    CHECK(std::ranges::is_sorted(found.tets[i]));
    CHECK(are_disjoint(found.tets[i], found.face_slivers[i]));
    n_slivers += found.face_slivers[i].size();
  }
  CHECK(n_slivers > 0);
}

TEST_CASE("Renumbering and rotating the mesh renumbers the candidates") {
  const auto mesh = test::DelaunayLattice(3, 4, 0.7, 0.02).mesh;
  const FinderOptions options{.quality_floor = 1e-3};
  std::set<std::array<index_t, 8>> expected;
  for (const auto& v : find_potential_hexahedra(mesh, options).vertices) expected.insert(test::canonical_hexahedron(v));
  REQUIRE(expected.size() > 50);
  std::mt19937_64 engine(5);
  for (int sample = 0; sample < 20; ++sample) {
    const auto shuffle = [&engine](auto& values) {
      for (std::size_t i = values.size(); i > 1; --i)
        std::swap(values[i - 1], values[boost::random::uniform_int_distribution<std::size_t>(0, i - 1)(engine)]);
    };
    std::vector<index_t> number(mesh.points.size());
    std::iota(number.begin(), number.end(), 0u);
    shuffle(number);
    const Eigen::Matrix3d turn = Quaternion(1, 0.2 * sample, -0.7, 0.3).normalized().toRotationMatrix();
    IndexedTetMesh moved{std::vector<Vector3>(mesh.points.size()), mesh.tets};
    std::vector<index_t> original(number.size());
    for (std::size_t v = 0; v < number.size(); ++v) {
      moved.points[number[v]] = 10 * (turn * mesh.points[v]) + Vector3(1, 2, 3);
      original[number[v]] = static_cast<index_t>(v);
    }
    for (auto& tet : moved.tets) {
      for (index_t& v : tet) v = number[v];
      std::ranges::rotate(tet, tet.begin() + 1);
      std::swap(tet[0], tet[1]);
    }
    shuffle(moved.tets);
    std::set<std::array<index_t, 8>> found;
    const auto candidates = find_potential_hexahedra(moved, options);
    for (auto v : candidates.vertices) {
      for (index_t& w : v) w = original[w];
      found.insert(test::canonical_hexahedron(v));
    }
    CHECK(found.size() == candidates.size());
    CHECK(found == expected);
  }
}

TEST_CASE("Feature edges stay edges") {
  const auto cube = test::kuhn_lattice(1);
  const auto count = [&cube](std::array<index_t, 2> edge) {
    const std::vector<std::array<index_t, 2>> edges{edge};
    return find_potential_hexahedra(cube, {.feature_edges = edges}).size();
  };
  CHECK(count({0, 1}) == 1);
  CHECK(count({1, 0}) == 1);
  CHECK(count({0, 3}) == 0);  // diagonal of the bottom
  CHECK(count({7, 1}) == 0);  // diagonal of a side
  CHECK(count({7, 0}) == 0);  // body diagonal: it would be lost inside
  CHECK(count({2, 1}) == 0);  // the bottom's other diagonal

  const std::vector<std::array<index_t, 2>> edges{{0, 3}};
  for (const auto& v : find_potential_prisms(cube, {.feature_edges = edges}).vertices) {
    const bool both = std::ranges::find(v, 0u) != v.end() && std::ranges::find(v, 3u) != v.end();
    CHECK((!both || std::ranges::any_of(edges_of(CellKind::prism), [&](const auto& e) {
      const std::set<index_t> ends{v[static_cast<std::size_t>(e[0])], v[static_cast<std::size_t>(e[1])]};
      return ends == std::set<index_t>{0, 3};
    })));
  }
}

TEST_CASE("Cells keep to one region, and take its border for boundary") {
  const auto mesh = test::kuhn_lattice(4, 2, 2);
  std::vector<index_t> regions;
  for (std::size_t t = 0; t < mesh.tets.size(); ++t) regions.push_back(t / 6 % 4 < 2 ? 7 : 9);
  const auto found = find_potential_hexahedra(mesh, {.quality_floor = 1e-4, .regions = regions});
  CHECK(found.size() == 2 * 68);  // two lattices of two cubes a side
  for (std::size_t i = 0; i < found.size(); ++i)
    for (const index_t t : found.tets[i]) CHECK(regions[t] == regions[found.tets[i][0]]);
}

TEST_CASE("Both boundary triangles of a quadrilateral lie on one patch") {
  const auto mesh = test::kuhn_lattice(1);
  const auto adjacency = make_adjacency(mesh);
  std::vector<index_t> labels(12, 3);
  auto patches = facet_patches(adjacency, labels);
  CHECK(find_potential_hexahedra(mesh, {.facet_patches = patches}).size() == 1);
  labels[5] = 4;
  patches = facet_patches(adjacency, labels);
  CHECK(find_potential_hexahedra(mesh, {.facet_patches = patches}).empty());
  CHECK(find_potential_hexahedra(mesh, {.boundary_rule = BoundaryRule::ignore, .facet_patches = patches}).empty());
  labels.pop_back();
  CHECK_THROWS_AS(facet_patches(adjacency, labels), invalid_option);
}

TEST_CASE("Only free tetrahedra are used") {
  const auto mesh = test::kuhn_lattice(3);
  std::vector<std::uint8_t> is_free(mesh.tets.size());
  for (std::size_t t = 0; t < is_free.size(); ++t) is_free[t] = t % 18 < 12;
  for (const auto& rule : {BoundaryRule::ignore, BoundaryRule::both_or_neither}) {
    const auto all = find_potential_prisms(mesh, {.boundary_rule = rule});
    const auto some = find_potential_prisms(mesh, {.boundary_rule = rule, .free_tets = is_free});
    std::size_t expected = 0;
    for (std::size_t i = 0; i < all.size(); ++i)
      expected += std::ranges::all_of(all.tets[i], [&](index_t t) { return is_free[t] != 0; });
    CHECK(some.size() == expected);
    CHECK(expected > 10);
  }
}

TEST_CASE("A cell may swallow interior vertices when asked to") {
  // A cube of twelve tetrahedra round its centre.
  const auto cube = test::kuhn_lattice(1);
  const auto adjacency = make_adjacency(cube);
  IndexedTetMesh mesh{cube.points, {}};
  mesh.points.emplace_back(0.5, 0.5, 0.5);
  for (std::size_t t = 0; t < cube.tets.size(); ++t)
    for (int i = 0; i < 4; ++i)
      if (adjacency.neighbours[t][static_cast<std::size_t>(i)] == no_index) {
        const auto f = facet(cube.tets[t], i);
        mesh.tets.push_back({8, f[0], f[1], f[2]});
      }
  CHECK(find_potential_hexahedra(mesh, {.quality_floor = 0.9}).empty());
  const auto found = find_potential_hexahedra(mesh, {.quality_floor = 0.9, .max_interior_vertices = 1});
  REQUIRE(found.size() == 1);
  CHECK(found.tets[0].size() == 12);
  CHECK(std::ranges::find(found.vertices[0], 8u) == found.vertices[0].end());
}

TEST_CASE("Meshes of nothing, of one tetrahedron, in parts and touching parts") {
  CHECK(find_potential_hexahedra(IndexedTetMesh{}).empty());
  CHECK(find_potential_prisms(IndexedTetMesh{}).empty());
  CHECK(find_potential_pyramids(IndexedTetMesh{}).empty());
  CHECK(find_pattern_hexahedra(IndexedTetMesh{}).empty());
  const IndexedTetMesh one{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 1, 2, 3}}};
  CHECK(find_potential_hexahedra(one).empty());
  CHECK(find_potential_prisms(one).empty());
  CHECK(find_potential_pyramids(one).empty());

  const auto cube = test::kuhn_lattice(2);
  const FinderOptions options{.quality_floor = 1e-4};
  CHECK(find_potential_hexahedra(joined(cube, cube, {5, 0, 0}), options).size() == 2 * 68);
  // In a vertex: the last of the first is the first of the second; in an edge: along the last edge.
  const auto touching = joined(cube, cube, {2, 2, 2});
  CHECK(find_potential_hexahedra(glued(touching, {{27, 26}}), options).size() == 2 * 68);
  const auto along = joined(cube, cube, {2, 2, 0});
  CHECK(find_potential_hexahedra(glued(along, {{27, 8}, {36, 17}, {45, 26}}), options).size() == 2 * 68);
  auto isolated = cube;
  isolated.points.emplace_back(9, 9, 9);
  CHECK(find_potential_hexahedra(isolated, options).size() == 68);
}

TEST_CASE("Bad meshes and options are refused, with the entity") {
  const auto cube = test::kuhn_lattice(1);
  auto mesh = cube;
  mesh.tets.push_back(mesh.tets[2]);
  CHECK_THROWS_AS(find_potential_hexahedra(mesh), nonmanifold);
  mesh = cube;
  std::swap(mesh.tets[3][0], mesh.tets[3][1]);
  try {
    find_potential_hexahedra(mesh);
    FAIL("an inverted tetrahedron passed");
  } catch (const inverted_cell& e) {
    CHECK(e.entity() == Entity::cell);
    CHECK(e.indices() == std::vector<std::size_t>{3});
  }
  mesh = cube;
  mesh.points[7] = {0.5, 0.5, 0};
  CHECK_THROWS_AS(find_potential_hexahedra(mesh), inverted_cell);
  mesh = cube;
  mesh.points[2].y() = std::nan("");
  CHECK_THROWS_AS(find_potential_hexahedra(mesh), invalid_coordinate);
  mesh = cube;
  mesh.tets[1][2] = 8;
  CHECK_THROWS_AS(find_potential_hexahedra(mesh), invalid_connectivity);

  for (const double floor : {-0.1, 1.5, std::nan("")})
    CHECK_THROWS_AS(find_potential_hexahedra(cube, {.quality_floor = floor}), invalid_option);
  const std::vector<index_t> regions(5);
  CHECK_THROWS_AS(find_potential_hexahedra(cube, {.regions = regions}), invalid_option);
  const std::vector<std::uint8_t> is_free(7);
  CHECK_THROWS_AS(find_potential_prisms(cube, {.free_tets = is_free}), invalid_option);
  const std::vector<std::array<index_t, 2>> edges{{0, 8}};
  CHECK_THROWS_AS(find_potential_pyramids(cube, {.feature_edges = edges}), invalid_option);
  const auto other = make_adjacency(test::kuhn_lattice(2));
  CHECK_THROWS_AS(find_potential_hexahedra(cube, {.adjacency = &other}), invalid_option);
}

TEST_CASE("The observer hears of progress, and may stop the search") {
  const auto mesh = test::kuhn_lattice(8);
  const auto all = find_potential_hexahedra(mesh);
  double last = 0;
  std::size_t calls = 0;
  const auto watched = find_potential_hexahedra(mesh, {.observer = [&](const Progress& p) {
                                                  CHECK(p.stage == "recombination");
                                                  CHECK(p.fraction >= last);
                                                  last = p.fraction;
                                                  ++calls;
                                                  return true;
                                                }});
  CHECK(calls >= 4);  // 12 blocks of 64 vertices, in batches that double at most
  CHECK(last == 1);
  check_equal(all, watched);
  const auto stopped = find_potential_hexahedra(mesh, {.observer = [](const Progress& p) { return p.fraction < 0.5; }});
  CHECK(stopped.status == Status::cancelled);
  CHECK(stopped.size() < all.size());
  REQUIRE(stopped.size() > 0);
  CHECK(std::equal(stopped.vertices.begin(), stopped.vertices.end(), all.vertices.begin()));
}

TEST_CASE("Two faces with the same corners across a void are faces of no cell", "[regression]") {
  const test::VoidBetween twin;
  CHECK(find_potential_hexahedra(twin.mesh).empty());
  // Each cube alone is one.
  for (const std::size_t first : {std::size_t{0}, std::size_t{6}}) {
    IndexedTetMesh one{twin.mesh.points, {}};
    one.tets.assign(twin.mesh.tets.begin() + static_cast<std::ptrdiff_t>(first),
                    twin.mesh.tets.begin() + static_cast<std::ptrdiff_t>(first) + 6);
    CHECK(find_potential_hexahedra(one).size() == 1);
  }
}
