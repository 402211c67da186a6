// SPDX-License-Identifier: BSL-1.0
#include <catch2/catch.hpp>

#include "framehex/assembly/assemble.hpp"
#include "framehex/assembly/detail/cavity.hpp"
#include "framehex/assembly/detail/complex_builder.hpp"
#include "framehex/recombination/potential_hex_finder.hpp"
#include "framehex/verify/validity.hpp"
#include "support/cube_candidates.hpp"
#include "support/listener.hpp"

#include <boost/random/uniform_real_distribution.hpp>

#include <random>
#include <set>

using namespace framehex;

namespace {

struct Lattice {
  IndexedTetMesh mesh;
  TetAdjacency adjacency;
  PotentialHexahedra cubes;
};

Lattice jittered_lattice(index_t n, double jitter, std::uint64_t seed) {
  Lattice lattice{test::kuhn_lattice(n), {}, test::cube_candidates(n)};
  std::mt19937_64 engine(seed);
  boost::random::uniform_real_distribution<double> shift(-1, 1);
  for (Vector3& p : lattice.mesh.points)
    for (int i = 0; i < 3; ++i)
      if (p[i] > 0 && p[i] < n) p[i] += jitter * shift(engine);
  lattice.adjacency = make_adjacency(lattice.mesh);
  return lattice;
}

std::vector<index_t> random_subset(std::size_t n, double share, std::uint64_t seed) {
  std::mt19937_64 engine(seed);
  boost::random::uniform_real_distribution<double> uniform(0, 1);
  std::vector<index_t> subset;
  for (index_t i = 0; i < n; ++i)
    if (uniform(engine) < share) subset.push_back(i);
  return subset;
}

std::array<std::size_t, 4> count_kinds(const MixedMesh& mesh) {
  std::array<std::size_t, 4> count{};
  for (const CellKind kind : mesh.kinds) ++count[static_cast<std::size_t>(kind)];
  return count;
}

void check_mesh(const MixedMesh& mesh, double volume) {
  CHECK(verify::is_conforming(mesh));
  CHECK(verify::is_valid(mesh));
  const auto volumes = verify::volume(mesh);
  CHECK(volumes.relative_difference() < 1e-9);
  CHECK(volumes.cells == Approx(volume).epsilon(1e-9));
}

}  // namespace

TEST_CASE("an empty selection leaves the tetrahedra", "[assembly]") {
  const Lattice lattice = jittered_lattice(2, 0.1, 1);
  const Assembly result = assemble(lattice.mesh, lattice.adjacency, lattice.cubes, {}, {.prisms = PrismMode::none});
  CHECK(count_kinds(result.mesh) == std::array<std::size_t, 4>{48, 0, 0, 0});
  CHECK(result.mesh.faces.size() == 48);
  check_mesh(result.mesh, 8);
}

TEST_CASE("all cubes of a lattice give hexahedra only", "[assembly]") {
  const Lattice lattice = jittered_lattice(3, 0.1, 2);
  const auto all = random_subset(27, 2, 0);
  const Assembly result = assemble(lattice.mesh, lattice.adjacency, lattice.cubes, all);
  CHECK(count_kinds(result.mesh) == std::array<std::size_t, 4>{0, 0, 0, 27});
  CHECK(result.statistics.n_open_quadrilaterals == 0);
  CHECK(result.mesh.faces.size() == 54);
  CHECK(result.candidate_of == all);
  check_mesh(result.mesh, 27);
}

TEST_CASE("random cubes of a lattice are closed", "[assembly]") {
  for (const double jitter : {0.0, 0.15, 0.25})
    for (const double share : {0.1, 0.5, 0.9}) {
      const Lattice lattice = jittered_lattice(5, jitter, 3);
      const auto selected = random_subset(125, share, 4);
      CAPTURE(jitter, share);
      const Assembly open = assemble(lattice.mesh, lattice.adjacency, lattice.cubes, selected,
                                     {.interfaces = InterfaceMode::open, .prisms = PrismMode::none});
      const Assembly closed =
          assemble(lattice.mesh, lattice.adjacency, lattice.cubes, selected, {.prisms = PrismMode::none});
      CHECK(open.statistics.n_open_quadrilaterals == closed.statistics.n_open_quadrilaterals);
      CHECK(open.open.size() + open.statistics.n_merged == open.statistics.n_open_quadrilaterals);
      const auto report = verify::is_conforming(open.mesh);
      CHECK(report.open_quadrilaterals.size() == open.open.size());
      CHECK(report.open_triangles.size() == 2 * open.open.size());
      CHECK(report.closed());
      CHECK(verify::is_valid(open.mesh));
      CHECK(closed.open.empty());
      check_mesh(closed.mesh, 125);
      CHECK(count_kinds(closed.mesh)[3] == selected.size());
    }
}

TEST_CASE("random cubes of a lattice are closed without pyramids", "[assembly]") {
  for (const double share : {0.5, 0.97}) {
    const Lattice lattice = jittered_lattice(6, 0.15, 10);
    const auto selected = random_subset(216, share, 11);
    CAPTURE(share);
    const Assembly closed =
        assemble(lattice.mesh, lattice.adjacency, lattice.cubes, selected, {.interfaces = InterfaceMode::no_pyramids});
    check_mesh(closed.mesh, 216);
    CHECK(count_kinds(closed.mesh)[1] == 0);
  }
}

TEST_CASE("one tetrahedral cube leaves rows of prisms in a mesh without pyramids", "[assembly]") {
  const Lattice lattice = jittered_lattice(5, 0.0, 12);
  auto selected = random_subset(125, 2, 0);
  selected.erase(selected.begin() + 62);  // the middle
  const Assembly closed =
      assemble(lattice.mesh, lattice.adjacency, lattice.cubes, selected, {.interfaces = InterfaceMode::no_pyramids});
  check_mesh(closed.mesh, 125);
  // Three rows of five cross in the middle; the four others of each are cut in two.
  CHECK(count_kinds(closed.mesh) == std::array<std::size_t, 4>{6, 0, 24, 112});
}

TEST_CASE("a selection that does not fit is refused with its candidates", "[assembly]") {
  Lattice lattice = jittered_lattice(3, 0.1, 5);
  const auto refused = [&](std::vector<index_t> selected) {
    try {
      assemble(lattice.mesh, lattice.adjacency, lattice.cubes, selected);
    } catch (const incompatible_selection& e) {
      CHECK(e.entity() == Entity::candidate);
      return e.indices();
    }
    return std::vector<std::size_t>{};
  };
  using Ids = std::vector<std::size_t>;
  CHECK(refused({0, 1, 0}) == Ids{0, 0});
  CHECK(refused({27}) == Ids{27});
  SECTION("a vertex twice") {
    lattice.cubes.vertices[4][1] = lattice.cubes.vertices[4][0];
    CHECK(refused({0, 4}) == Ids{4});
  }
  SECTION("a vertex that does not exist") {
    lattice.cubes.vertices[4][1] = 10000;
    CHECK(refused({4}) == Ids{4});
  }
  SECTION("tetrahedra of another cube") {
    lattice.cubes.tets[4][0] = 0;
    CHECK(refused({4}) == Ids{4});
  }
  SECTION("inside out") {
    auto& v = lattice.cubes.vertices[4];
    std::swap_ranges(v.begin(), v.begin() + 4, v.begin() + 4);
    CHECK(refused({4}) == Ids{4});
  }
}

TEST_CASE("labels are carried to quadrilaterals and tetrahedra", "[assembly]") {
  const Lattice lattice = jittered_lattice(4, 0.1, 6);
  std::vector<LabelledFace> faces;
  for (std::size_t tet = 0; tet < lattice.adjacency.tets.size(); ++tet)
    for (int f = 0; f < 4; ++f)
      if (lattice.adjacency.neighbours[tet][static_cast<std::size_t>(f)] == no_index) {
        const auto t = facet(lattice.adjacency.tets[tet], f);
        const auto& p = lattice.mesh.points;
        const Vector3 n = (p[t[1]] - p[t[0]]).cross(p[t[2]] - p[t[0]]);
        int axis = 0;
        n.cwiseAbs().maxCoeff(&axis);
        faces.push_back({{t[0], t[1], t[2], no_index}, static_cast<index_t>(10 + 2 * axis + (n[axis] > 0 ? 1 : 0))});
      }
  const auto selected = random_subset(64, 0.6, 7);
  const Assembly result = assemble(lattice.mesh, lattice.adjacency, lattice.cubes, selected, {.faces = faces});
  std::array<double, 6> area{};
  for (const LabelledFace& face : result.mesh.faces) {
    REQUIRE(face.label >= 10);
    REQUIRE(face.label < 16);
    const auto p = [&](std::size_t i) -> const Vector3& { return result.mesh.points[face.vertices[i]]; };
    const Vector3 n = face.size() == 4 ? Vector3((p(2) - p(0)).cross(p(3) - p(1)) / 2)
                                       : Vector3((p(1) - p(0)).cross(p(2) - p(0)) / 2);
    const int axis = static_cast<int>(face.label - 10) / 2;
    area[face.label - 10] += n[axis];
  }
  for (std::size_t side = 0; side < 6; ++side) CHECK(area[side] == Approx(side % 2 == 1 ? 16 : -16));
}

TEST_CASE("regions stay apart", "[assembly]") {
  const Lattice lattice = jittered_lattice(4, 0.1, 8);
  // Cube (1, 1, 1) is a region of one cell; the upper half is another.
  std::vector<index_t> regions(lattice.mesh.tets.size());
  for (index_t cube = 0; cube < 64; ++cube)
    for (index_t t = 6 * cube; t < 6 * cube + 6; ++t) regions[t] = cube == 21 ? 7 : cube >= 32 ? 3 : 1;
  std::array<double, 8> volume{}, expected{};
  for (std::size_t tet = 0; tet < lattice.mesh.tets.size(); ++tet) {
    std::array<Vector3, 4> p;
    for (std::size_t i = 0; i < 4; ++i) p[i] = lattice.mesh.points[lattice.mesh.tets[tet][i]];
    expected[regions[tet]] += cell_volume(CellKind::tetrahedron, p);
  }
  const auto selected = random_subset(64, 0.5, 9);
  const Assembly result = assemble(lattice.mesh, lattice.adjacency, lattice.cubes, selected, {.regions = regions});
  check_mesh(result.mesh, 64);
  REQUIRE(result.mesh.regions.size() == result.mesh.n_cells());
  for (index_t cell = 0; cell < result.mesh.n_cells(); ++cell) {
    std::array<Vector3, 8> p;
    const auto corners = result.mesh.cells[cell];
    for (std::size_t i = 0; i < corners.size(); ++i) p[i] = result.mesh.points[corners[i]];
    volume[result.mesh.regions[cell]] += cell_volume(result.mesh.kinds[cell], {p.data(), corners.size()});
  }
  // Quadrilaterals are bilinear patches now, so that jitter moves a little volume from region to region.
  for (const std::size_t region : {1u, 3u, 7u}) CHECK(volume[region] == Approx(expected[region]).epsilon(0.05));
}

TEST_CASE("assembly can be cancelled whenever it reports, and then leaves nothing", "[assembly]") {
  const Lattice lattice = jittered_lattice(10, 0.2, 21);
  const auto selected = random_subset(1000, 0.6, 22);
  const auto mode = GENERATE(InterfaceMode::conforming, InterfaceMode::no_pyramids, InterfaceMode::open);
  std::size_t n_calls = 0;
  double fraction = 0;
  test::Listener listener;
  AssemblyOptions options{.interfaces = mode};
  const Assembly silent = assemble(lattice.mesh, lattice.adjacency, lattice.cubes, selected, options);
  const Observer heard = listener.observer();
  options.observer = [&](const Progress& progress) {
    ++n_calls;
    CHECK(progress.fraction >= fraction);
    CHECK(progress.fraction <= 1);
    fraction = progress.fraction;
    return heard(progress);
  };
  const Assembly watched = assemble(lattice.mesh, lattice.adjacency, lattice.cubes, selected, options);
  CHECK(watched.status == Status::complete);
  CHECK(watched.mesh.points == silent.mesh.points);
  CHECK(watched.mesh.cells.values == silent.mesh.cells.values);
  CHECK(fraction == 1);
  listener.check_silences();
  // Begin and end, the search for prisms in 21 blocks of 64 vertices, whose batches double at most, and what follows.
  REQUIRE(n_calls >= 2 + 5 + 1);
  for (std::size_t stop = 1; stop <= n_calls; stop += 1 + n_calls / 10) {
    std::size_t n = 0;
    options.observer = [&](const Progress&) { return ++n < stop; };
    const Assembly result = assemble(lattice.mesh, lattice.adjacency, lattice.cubes, selected, options);
    if (n < stop) {  // how often the search for prisms reports depends on the clock
      CHECK(result.status == Status::complete);
      continue;
    }
    CHECK(n == stop);
    CHECK(result.status == Status::cancelled);
    CHECK(result.mesh.n_cells() == 0);
  }
}

TEST_CASE("a labelled patch inside stays, as quadrilaterals and triangles", "[assembly][regression]") {
  const auto improvement = GENERATE(ImprovementMode::none, ImprovementMode::improve);
  const auto mode = GENERATE(InterfaceMode::conforming, InterfaceMode::no_pyramids, InterfaceMode::open);
  for (std::uint64_t seed = 30; seed < 36; ++seed) {
    const Lattice lattice = jittered_lattice(4, 0.3, seed);
    std::vector<LabelledFace> faces;
    Vector3 area = Vector3::Zero();
    const auto in_plane = [](index_t v) { return v % 5 == 2; };
    for (std::size_t tet = 0; tet < lattice.adjacency.tets.size(); ++tet)
      for (int f = 0; f < 4; ++f) {
        const auto t = facet(lattice.adjacency.tets[tet], f);
        const auto& p = lattice.mesh.points;
        const Vector3 twice = (p[t[1]] - p[t[0]]).cross(p[t[2]] - p[t[0]]);
        if (!std::ranges::all_of(t, in_plane) || twice.x() < 0) continue;  // from one side
        faces.push_back({{t[0], t[1], t[2], no_index}, 5});
        area += twice / 2;
      }
    REQUIRE(faces.size() == 32);
    auto selected = random_subset(64, 0.8, seed);
    std::erase_if(selected, [&](index_t cube) {
      std::array<Vector3, 8> corners;
      for (std::size_t i = 0; i < 8; ++i) corners[i] = lattice.mesh.points[lattice.cubes.vertices[cube][i]];
      return !is_valid(CellKind::hexahedron, corners);
    });
    const Assembly result = assemble(lattice.mesh, lattice.adjacency, lattice.cubes, selected,
                                     {.interfaces = mode, .improvement = improvement, .faces = faces});
    Vector3 found = Vector3::Zero();
    for (const LabelledFace& face : result.mesh.faces) {
      const auto p = [&](std::size_t i) -> const Vector3& { return result.mesh.points[face.vertices[i]]; };
      const Vector3 n = face.size() == 4 ? Vector3((p(2) - p(0)).cross(p(3) - p(1)) / 2)
                                         : Vector3((p(1) - p(0)).cross(p(2) - p(0)) / 2);
      if (face.label == 5) found += n;
      CHECK((face.label == 5 || face.label == 6));  // 6: the boundary, which has no label
    }
    CAPTURE(seed, static_cast<int>(mode), static_cast<int>(improvement));
    CHECK((found - area).norm() < 1e-12 * area.norm());
    for (const index_t v : result.moved) CHECK(!in_plane(v));
  }
}

TEST_CASE("cells on either side of a labelled quadrilateral are never merged", "[assembly]") {
  const IndexedTetMesh mesh = test::kuhn_lattice(2, 1, 1);
  const TetAdjacency adjacency = make_adjacency(mesh);
  const auto cubes = find_potential_hexahedra(mesh, {.quality_floor = 0.9});
  REQUIRE(cubes.size() == 2);
  std::vector<LabelledFace> faces;
  for (const auto& tet : mesh.tets)
    for (int f = 0; f < 4; ++f) {
      const auto t = facet(tet, f);
      if (std::ranges::all_of(t, [](index_t v) { return v % 3 == 1; }))
        faces.push_back({{t[0], t[1], t[2], no_index}, 2});
    }
  REQUIRE(faces.size() == 4);  // each from both sides
  for (const bool labelled : {false, true}) {
    AssemblyOptions options;
    if (labelled) options.faces = faces;
    detail::ComplexBuilder builder(mesh.points, adjacency, options);
    for (index_t i = 0; i < 2; ++i)
      REQUIRE(!builder.add(CellKind::hexahedron, cubes.vertices[i], cubes.tets[i], i).reason);
    detail::CavityFiller filler(builder.complex);
    detail::Cavity cavity;
    cavity.cells = {0, 1};
    CHECK(filler.build(cavity) != labelled);
  }
}
