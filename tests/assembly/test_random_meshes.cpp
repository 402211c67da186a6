// SPDX-License-Identifier: BSL-1.0
#include <catch2/catch.hpp>

#include "framehex/assembly/assemble.hpp"
#include "framehex/assembly/detail/cavity.hpp"
#include "framehex/assembly/detail/cell_complex.hpp"
#include "framehex/mesh/validation.hpp"
#include "framehex/recombination/potential_hex_finder.hpp"
#include "framehex/selection/candidate_weights.hpp"
#include "framehex/selection/conflict_search.hpp"
#include "framehex/selection/greedy.hpp"
#include "framehex/verify/validity.hpp"
#include "support/jittered_delaunay.hpp"
#include "support/small_delaunay.hpp"

#include <boost/random/uniform_int_distribution.hpp>

#include <numeric>
#include <set>

using namespace framehex;

namespace {

void shuffle(std::vector<index_t>& v, std::mt19937_64& engine) {
  for (std::size_t i = v.size(); i > 1; --i)
    std::swap(v[i - 1], v[boost::random::uniform_int_distribution<std::size_t>(0, i - 1)(engine)]);
}

std::vector<index_t> random_permutation(std::size_t n, std::mt19937_64& engine) {
  std::vector<index_t> order(n);
  std::iota(order.begin(), order.end(), index_t{0});
  shuffle(order, engine);
  return order;
}

/// Candidates that can stand together, taken in random order; about a third of what would fit is left out.
std::vector<index_t> random_selection(const PotentialHexahedra& candidates, std::mt19937_64& engine) {
  const IncompatibilityGraph graph = build_incompatibility_graph(candidates);
  std::vector<std::uint8_t> blocked(candidates.size(), 0);
  std::vector<index_t> selected;
  for (const index_t i : random_permutation(candidates.size(), engine)) {
    if (blocked[i] || engine() % 3 == 0) continue;
    selected.push_back(i);
    for (const index_t j : graph.neighbours(i)) blocked[j] = 1;
  }
  return selected;
}

/// The same mesh with its vertices and cells in another order.
MixedMesh shuffled(const MixedMesh& mesh, std::mt19937_64& engine) {
  MixedMesh result;
  const auto number = random_permutation(mesh.points.size(), engine);
  result.points.resize(mesh.points.size());
  for (std::size_t v = 0; v < number.size(); ++v) result.points[number[v]] = mesh.points[v];
  for (const index_t cell : random_permutation(mesh.n_cells(), engine)) {
    std::vector<index_t> corners;
    for (const index_t v : mesh.cells[cell]) corners.push_back(number[v]);
    result.add(mesh.kinds[cell], corners);
  }
  return result;
}

void check(const MixedMesh& mesh, double volume) {
  const auto conformity = verify::is_conforming(mesh);
  CHECK(conformity.conforming());
  CHECK(conformity.closed());
  CHECK(verify::is_valid(mesh));
  const auto volumes = verify::volume(mesh);
  CHECK(volumes.relative_difference() < 1e-9);
  CHECK(volumes.cells == Approx(volume).epsilon(0.1));
  std::set<std::array<double, 3>> places;
  for (const Vector3& p : mesh.points) places.insert({p.x(), p.y(), p.z()});
  CHECK(places.size() == mesh.points.size());
}

/// Greedy selections of poor hexahedra in strongly jittered lattices: in both conforming modes the mesh is conforming and
/// valid, in the other the open quadrilaterals are those listed. @return how many chosen cells were withdrawn.
std::size_t check_strong_jitter(index_t n, unsigned seed, double jitter) {
  CAPTURE(n, seed, jitter);
  const IndexedTetMesh mesh = test::jittered_delaunay(n, seed, jitter);
  const TetAdjacency adjacency = validated_adjacency(mesh);
  const PotentialHexahedra candidates = find_potential_hexahedra(mesh, {.quality_floor = 0.02});
  const auto selected = select_greedily(build_incompatibility_graph(candidates, volume_times_quality(candidates)));
  const auto improvement = seed % 3 == 0 ? ImprovementMode::improve : ImprovementMode::none;
  std::size_t n_withdrawn = 0;
  for (const auto mode : {InterfaceMode::conforming, InterfaceMode::no_pyramids, InterfaceMode::open}) {
    CAPTURE(mode == InterfaceMode::conforming, mode == InterfaceMode::no_pyramids);
    const Assembly result =
        assemble(mesh, adjacency, candidates, selected, {.interfaces = mode, .improvement = improvement});
    n_withdrawn += result.statistics.n_withdrawn;
    CHECK(verify::is_valid(result.mesh));
    const auto conformity = verify::is_conforming(result.mesh);
    CHECK((conformity.used_over_twice.empty() && conformity.same_side.empty() && conformity.twisted.empty()));
    if (mode != InterfaceMode::open) {
      CHECK(conformity);
      CHECK(result.open.empty());
      CHECK(verify::volume(result.mesh).cells == Approx(n * n * n).epsilon(1e-4));
    }
  }
  return n_withdrawn;
}

}  // namespace

TEST_CASE("random selections in random Delaunay meshes become conforming and valid", "[assembly]") {
  std::mt19937_64 engine(2016);
  std::size_t n_hexahedra = 0, n_open = 0;
  for (int trial = 0; trial < 200; ++trial) {
    CAPTURE(trial);
    const double jitter = 0.05 + 0.05 * (trial % 9);
    const index_t nx = trial % 4 == 0 ? 4 : 3;
    IndexedTetMesh mesh = test::small_delaunay(test::jittered_lattice(nx, 3, 3, jitter, engine));
    validate(mesh);
    const TetAdjacency adjacency = make_adjacency(mesh);
    const PotentialHexahedra candidates = find_potential_hexahedra(
        mesh, {.quality_floor = trial % 2 == 0 ? 0.01 : 0.2,
               .boundary_rule = trial % 3 == 0 ? BoundaryRule::ignore : BoundaryRule::both_or_neither});
    const auto selected = random_selection(candidates, engine);
    n_hexahedra += selected.size();
    double volume = 0;
    for (const auto& t : mesh.tets)
      volume += orientation_determinant(mesh.points[t[0]], mesh.points[t[1]], mesh.points[t[2]], mesh.points[t[3]]) / 6;
    for (const auto mode : {InterfaceMode::conforming, InterfaceMode::no_pyramids})
      for (const auto improvement : {ImprovementMode::none, ImprovementMode::improve}) {
        const Assembly result =
            assemble(mesh, adjacency, candidates, selected, {.interfaces = mode, .improvement = improvement});
        CAPTURE(mode == InterfaceMode::conforming, improvement == ImprovementMode::improve);
        CHECK(result.open.empty());
        n_open += result.statistics.n_open_quadrilaterals;
        check(result.mesh, volume);
        check(shuffled(result.mesh, engine), volume);
        const bool has_pyramids =
            std::find(result.mesh.kinds.begin(), result.mesh.kinds.end(), CellKind::pyramid) != result.mesh.kinds.end();
        if (mode == InterfaceMode::no_pyramids) CHECK_FALSE(has_pyramids);
        const AssemblyStatistics& statistics = result.statistics;
        CHECK(result.mesh.points.size() == mesh.points.size() + statistics.n_new_vertices);
        if (improvement == ImprovementMode::none) CHECK(statistics.n_removed_vertices == 0);
      }
    const Assembly open = assemble(mesh, adjacency, candidates, selected, {.interfaces = InterfaceMode::open});
    CHECK(verify::is_valid(open.mesh));
  }
  // The test would be worth nothing without them.
  CHECK(n_hexahedra > 400);
  CHECK(n_open > 2000);
}

TEST_CASE("strongly jittered lattices are closed in every mode", "[assembly][regression]") {
  std::size_t n_withdrawn = 0;
  for (unsigned seed = 1; seed <= 12; ++seed) n_withdrawn += check_strong_jitter(4, seed, seed % 2 == 0 ? 0.45 : 0.35);
  for (const auto& [seed, jitter] : {std::pair{16u, 0.35}, std::pair{5u, 0.45}})
    n_withdrawn += check_strong_jitter(6, seed, jitter);
  CHECK(n_withdrawn > 0);  // else the test would not see what it is for
}

TEST_CASE("one face has one open quadrilateral", "[assembly]") {
  detail::CellComplex complex;
  for (int i = 0; i < 6; ++i) complex.add_vertex(Vector3(i, i * i, i * i * i), false);
  complex.add_open_quad({{0, 1, 2, 3}, 7, 0, false, true});
  REQUIRE(complex.open_quads.size() == 1);
  complex.add_open_quad({{3, 2, 1, 0}, 8, 0, false, true});  // the same quadrilateral from the other side
  complex.add_open_quad({{0, 1, 2, 4}, 8, 0, false, true});  // with a triangle in common
  CHECK(complex.open_quads.size() == 1);
  CHECK(complex.refused_quads.size() == 2);
  CHECK(complex.open_quads[complex.open_quad_at({2, 1, 0, no_index})].cell == 7);
  complex.close_quad(0);
  complex.add_open_quad({{0, 1, 2, 4}, 8, 0, false, true});
  CHECK(complex.open_quad_at({2, 0, 4, no_index}) == 1);
}

TEST_CASE("more cells than corner slots can count are an error", "[assembly][regression]") {
  CHECK(detail::CellComplex::next_cell(536870910) == 536870910);
  CHECK_THROWS_AS(detail::CellComplex::next_cell(536870911), error);
}

TEST_CASE("a place for a new vertex that would be best at infinity is sought in vain, and not for long",
          "[assembly][regression]") {
  // Two triangles, each behind the other: no point sees both, and the farther away the less it sees them wrong.
  detail::CellComplex complex;
  complex.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {0, 1, 1}};
  detail::Cavity cavity;
  cavity.faces = {{0, 1, 2, no_index}, {3, 5, 4, no_index}};
  const detail::CavityFiller filler(complex);
  Vector3 place(0.3, 0.3, 0.5);
  const double start = filler.evaluate(cavity, place, no_index);
  REQUIRE(start < 0);
  const double found = filler.improve_point(cavity, place, 0.1, start);
  CHECK(found > start);
  CHECK(found < 0);
  CHECK(place.norm() < 100);
}

/// Run by name: `test_assembly [hundreds]`.
TEST_CASE("five hundred strongly jittered lattices are closed in every mode", "[.][hundreds]") {
  for (unsigned seed = 1; seed <= 500; ++seed) check_strong_jitter(3 + seed % 4, seed, 0.25 + 0.05 * (seed % 5));
}
