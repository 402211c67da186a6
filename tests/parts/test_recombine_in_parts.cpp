// SPDX-License-Identifier: BSL-1.0
#include "framehex/parts/detail/recombine_in_parts_impl.hpp"
#include "framehex/parts/recombine_in_parts.hpp"
#include "framehex/pipeline/recombine_by_parts.hpp"
#include "framehex/verify/conformity.hpp"
#include "framehex/verify/validity.hpp"
#include "parts/part_fixtures.hpp"
#include "support/jittered_delaunay.hpp"

#include <catch2/catch.hpp>

#include <atomic>
#include <map>
#include <mutex>
#include <set>

using namespace framehex;

namespace {

using Place = std::array<double, 3>;
Place place(const Vector3& p) {
  return {p.x(), p.y(), p.z()};
}

/// Cells as kinds with corners in order, by places.
using CellSet = std::multiset<std::vector<Place>>;

struct Joined {
  MixedMesh mesh;                 ///< of all ranks, vertices by their numbers
  std::vector<global_t> numbers;  ///< of the vertices
  CellSet cells;
  std::size_t n_empty_ranks = 0;
  PartRecombination last;
};

template <class RegionOf>
Joined recombine_on_ranks(const IndexedTetMesh& mesh, int n_ranks, std::size_t part_size, RegionOf&& region_of) {
  Joined joined;
  std::mutex mutex;
  std::map<global_t, index_t> vertex;
  std::map<global_t, int> owner;
  std::map<global_t, std::set<int>> holders, said;
  std::set<global_t> cell_numbers;
  test::run_on_ranks(n_ranks, [&](const test::ThreadTransport& transport) {
    auto brought = test::part_of(mesh, transport.rank(), [&](std::size_t cell) {
      return static_cast<int>(cell * 7919 / 1000 % static_cast<std::size_t>(n_ranks));
    });
    for (const global_t cell : brought.cell_numbers)
      brought.regions.push_back(region_of(static_cast<std::size_t>(cell)));
    PartsOptions options;
    options.part_size = part_size;
    PartRecombination part = recombine_in_parts(brought.input(), transport, options);
    const std::lock_guard lock(mutex);
    for (std::size_t v = 0; v < part.mesh.points.size(); ++v) {
      const global_t number = part.vertex_numbers[v];
      const auto [at, is_new] = vertex.try_emplace(number, static_cast<index_t>(vertex.size()));
      if (is_new) {
        joined.mesh.points.push_back(part.mesh.points[v]);
        joined.numbers.push_back(number);
      }
      if (place(joined.mesh.points[at->second]) != place(part.mesh.points[v]))
        throw std::runtime_error("a shared vertex lies at two places");
      if (!owner.try_emplace(number, part.owners[v]).second && owner[number] != part.owners[v])
        throw std::runtime_error("a vertex has two owners");
      holders[number].insert(transport.rank());
    }
    for (const auto& [v, rank] : part.shared) said[part.vertex_numbers[v]].insert(rank);
    for (std::size_t cell = 0; cell < part.mesh.n_cells(); ++cell) {
      std::vector<index_t> corners;
      std::vector<Place> places{{static_cast<double>(part.mesh.kinds[cell]), 0, 0}};
      for (const index_t v : part.mesh.cells[cell]) {
        corners.push_back(vertex.at(part.vertex_numbers[v]));
        places.push_back(place(part.mesh.points[v]));
      }
      joined.mesh.add(part.mesh.kinds[cell], corners);
      joined.mesh.regions.push_back(part.mesh.regions[cell]);
      joined.cells.insert(places);
      if (!cell_numbers.insert(part.cell_numbers[cell]).second) throw std::runtime_error("a cell number comes twice");
    }
    joined.n_empty_ranks += part.mesh.n_cells() == 0;
    joined.last = std::move(part);
  });
  for (const auto& [number, ranks] : holders) {
    if (owner[number] != *ranks.begin()) throw std::runtime_error("the owner is not the first that has the vertex");
    if (ranks.size() > 1 && said[number] != ranks)
      throw std::runtime_error("a vertex is shared with others than it is said");
    if (ranks.size() == 1 && said.contains(number))
      throw std::runtime_error("a vertex is said to be shared and is not");
  }
  if (!cell_numbers.empty() &&
      (*cell_numbers.begin() != 0 || *cell_numbers.rbegin() + 1 != static_cast<global_t>(cell_numbers.size())))
    throw std::runtime_error("cell numbers have gaps");
  return joined;
}

Joined recombine_on_ranks(const IndexedTetMesh& mesh, int n_ranks, std::size_t part_size) {
  return recombine_on_ranks(mesh, n_ranks, part_size, [](std::size_t) { return index_t{0}; });
}

double hex_share(const MixedMesh& mesh) {
  const auto volume = verify::volume(mesh);
  return volume.by_kind[static_cast<std::size_t>(CellKind::hexahedron)] / volume.cells;
}

void check_sound(const MixedMesh& mesh, double volume) {
  CHECK(verify::is_conforming(mesh));
  CHECK(verify::is_valid(mesh));
  // Lattices with face slivers do not have quite flat sides.
  CHECK(verify::volume(mesh).cells == Approx(volume).epsilon(1e-6));
  CHECK(verify::volume(mesh).relative_difference() < 1e-9);
}

}  // namespace

TEST_CASE("parts make the same sound mesh for any number of ranks and any numbering") {
  const IndexedTetMesh lattice = test::jittered_kuhn(12, 0.2), rough = test::jittered_delaunay(10, 1, 0.35);
  for (const IndexedTetMesh* mesh : {&lattice, &rough}) {
    const MixedMesh whole = recombine(*mesh).mesh;
    for (const std::size_t part_size : {300u, 2000u}) {
      CellSet first;
      for (const int n_ranks : {1, 2, 3, 5}) {
        CAPTURE(part_size, n_ranks);
        const Joined joined = recombine_on_ranks(test::permuted(*mesh, part_size + static_cast<std::size_t>(n_ranks)),
                                                 n_ranks, part_size);
        check_sound(joined.mesh, verify::volume(whole).cells);
        CHECK(joined.last.n_parts > 3);
        if (n_ranks == 1) first = joined.cells;
        CHECK(joined.cells == first);
      }
    }
  }
}

TEST_CASE("parts of a sane size make as many hexahedra as the whole") {
  const IndexedTetMesh mesh = test::jittered_delaunay(16, 2, 0.3);
  const double whole = hex_share(recombine(mesh).mesh);
  const Joined joined = recombine_on_ranks(mesh, 2, 8000);
  CHECK(joined.last.n_parts >= 4);
  check_sound(joined.mesh, 16 * 16 * 16);
  CAPTURE(whole, hex_share(joined.mesh));
  CHECK(hex_share(joined.mesh) > whole - 0.003);
}

TEST_CASE("a mesh of one part is what recombine makes of it") {
  const IndexedTetMesh mesh = test::jittered_delaunay(5, 3, 0.35);
  const Joined joined = recombine_on_ranks(test::permuted(mesh, 4), 3, 1000000);
  CHECK(joined.n_empty_ranks == 2);
  CHECK(joined.last.n_parts == 1);
  check_sound(joined.mesh, 5 * 5 * 5);
  // In the order that parts give it: by rising coordinates.
  IndexedTetMesh ordered = test::in_order(mesh);
  for (auto& tet : ordered.tets) tet = detail::canonical_tet(tet);
  std::sort(ordered.tets.begin(), ordered.tets.end());
  const MixedMesh whole = recombine(ordered).mesh;
  CellSet cells;
  for (std::size_t cell = 0; cell < whole.n_cells(); ++cell) {
    CellSet::value_type places{{static_cast<double>(whole.kinds[cell]), 0, 0}};
    for (const index_t v : whole.cells[cell]) places.push_back(place(whole.points[v]));
    cells.insert(places);
  }
  CHECK(joined.cells == cells);
}

TEST_CASE("one tetrahedron, and more ranks than cells") {
  IndexedTetMesh mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 1, 2, 3}}};
  for (const int n_ranks : {1, 3})
    for (const std::size_t part_size : {1u, 10u}) {
      const Joined joined = recombine_on_ranks(mesh, n_ranks, part_size);
      CHECK(joined.mesh.n_cells() == 1);
      CHECK(joined.n_empty_ranks == static_cast<std::size_t>(n_ranks - 1));
    }
  const IndexedTetMesh cube = test::kuhn_lattice(1);
  const Joined joined = recombine_on_ranks(cube, 5, 1);
  check_sound(joined.mesh, 1);
}

TEST_CASE("a mesh without cells") {
  const Joined joined = recombine_on_ranks(IndexedTetMesh{}, 2, 100);
  CHECK(joined.mesh.n_cells() == 0);
  CHECK(joined.last.status == Status::complete);
}

TEST_CASE("parts that touch in an edge or in a vertex only") {
  for (const bool in_edge : {true, false}) {
    const IndexedTetMesh all = test::jittered_kuhn(8, 0.15);
    IndexedTetMesh mesh{all.points, {}};
    for (const auto& t : all.tets) {
      Vector3 c = Vector3::Zero();
      for (const index_t v : t) c += all.points[v] / 4;
      const bool x = std::floor(c.x()) < 4, y = std::floor(c.y()) < 4, z = std::floor(c.z()) < 4;
      if (in_edge ? x == y : (x == y && y == z)) mesh.tets.push_back(t);
    }
    const Joined first = recombine_on_ranks(mesh, 1, 200);
    for (const int n_ranks : {2, 5}) {
      CAPTURE(in_edge, n_ranks);
      const Joined joined = recombine_on_ranks(test::permuted(mesh, 9), n_ranks, 200);
      CHECK(verify::is_conforming(joined.mesh).conforming());
      CHECK(verify::is_valid(joined.mesh));
      CHECK(joined.cells == first.cells);
    }
  }
}

TEST_CASE("regions keep their cells apart") {
  const IndexedTetMesh mesh = test::jittered_delaunay(8, 5, 0.2);
  std::vector<index_t> region;
  std::array<double, 2> before{}, after{};
  for (const auto& t : mesh.tets) {
    std::array<Vector3, 4> p;
    for (std::size_t i = 0; i < 4; ++i) p[i] = mesh.points[t[i]];
    region.push_back(p[0].x() + p[1].x() + p[2].x() + p[3].x() < 4 * 3.7 ? 0 : 1);
    before[region.back()] += cell_volume(CellKind::tetrahedron, p);
  }
  const Joined joined = recombine_on_ranks(mesh, 3, 500, [&](std::size_t cell) { return region[cell]; });
  check_sound(joined.mesh, 8 * 8 * 8);
  for (std::size_t cell = 0; cell < joined.mesh.n_cells(); ++cell) {
    std::array<Vector3, 8> p;
    const auto corners = joined.mesh.cells[cell];
    for (std::size_t i = 0; i < corners.size(); ++i) p[i] = joined.mesh.points[corners[i]];
    after[joined.mesh.regions[cell]] += cell_volume(joined.mesh.kinds[cell], {p.data(), corners.size()});
  }
  // Quadrilaterals on the interface are bilinear, its triangles were not.
  for (std::size_t r = 0; r < 2; ++r) CHECK(after[r] == Approx(before[r]).epsilon(1e-3));
}

TEST_CASE("an observer of one rank stops all") {
  const IndexedTetMesh mesh = test::jittered_delaunay(8, 6, 0.2);
  for (int n_calls = 0; n_calls < 60; n_calls += 7) {
    std::atomic<int> n_cancelled = 0;
    std::atomic<bool> asked_to_stop = false;
    test::run_on_ranks(3, [&](const test::ThreadTransport& transport) {
      const auto brought =
          test::part_of(mesh, transport.rank(), [](std::size_t cell) { return static_cast<int>(cell % 3); });
      PartsOptions options;
      options.part_size = 500;
      int n = 0;
      if (transport.rank() == 1)
        options.observer = [&](const Progress&) {
          if (n++ < n_calls) return true;
          asked_to_stop = true;
          return false;
        };
      const PartRecombination part = recombine_in_parts(brought.input(), transport, options);
      if (part.status != Status::cancelled) return;
      ++n_cancelled;
      if (part.mesh.n_cells() > 0) throw std::runtime_error("cells of a cancelled call");
    });
    CAPTURE(n_calls);
    CHECK(n_cancelled == (asked_to_stop ? 3 : 0));
  }
}

TEST_CASE("input of parts that is refused") {
  const IndexedTetMesh mesh = test::kuhn_lattice(2);
  auto brought = test::part_of(mesh, 0, [](std::size_t) { return 0; });
  PartsOptions options;
  options.part_size = 0;
  CHECK_THROWS_AS(recombine_in_parts(brought.input(), options), invalid_option);
  options = {};
  options.assembly.interfaces = InterfaceMode::no_pyramids;
  CHECK_THROWS_AS(recombine_in_parts(brought.input(), options), invalid_option);
  options = {};
  brought.cell_numbers.pop_back();
  CHECK_THROWS_AS(recombine_in_parts(brought.input(), options), invalid_option);
  brought = test::part_of(mesh, 0, [](std::size_t) { return 0; });
  std::swap(brought.tets[5][0], brought.tets[5][1]);
  try {
    recombine_in_parts(brought.input(), options);
    FAIL("an inverted cell was taken");
  } catch (const inverted_cell& e) {
    CHECK(e.indices() == std::vector<std::size_t>{5});
  }
}

TEST_CASE("a mesh in one place is recombined by parts, with the tables of recombine") {
  const IndexedTetMesh mesh = test::jittered_delaunay(10, 8, 0.35);
  RecombineOptions options;
  const Recombination serial = recombine_by_parts(mesh, options, 1500);
  check_sound(serial.mesh, 1000);
  CHECK(serial.selection.bound >= serial.selection.weight);
  CHECK(serial.selection.bound < 1.5 * serial.selection.weight);
  const auto same = [&](const Recombination& other) {
    return other.mesh.cells.values == serial.mesh.cells.values && other.mesh.kinds == serial.mesh.kinds &&
           other.mesh.points == serial.mesh.points;
  };
  for (const std::size_t n_threads : {2u, 3u})
    CHECK(same(recombine_by_parts(mesh, options, 1500, ThreadExecutor(n_threads))));

  // The tables of the result.
  REQUIRE(serial.vertex_of.size() == serial.mesh.points.size());
  REQUIRE(serial.cell_of.size() == serial.mesh.n_cells());
  std::set<index_t> moved(serial.moved.begin(), serial.moved.end());
  for (index_t v = 0; v < mesh.points.size(); ++v) {
    if (serial.result_of[v] == no_index) continue;
    CHECK(serial.vertex_of[serial.result_of[v]] == v);
    CHECK((serial.mesh.points[serial.result_of[v]] != mesh.points[v]) == moved.contains(v));
  }
  const PotentialHexahedra candidates = find_potential_hexahedra(mesh);
  CHECK(serial.n_candidates == candidates.size());
  std::size_t n_hexahedra = 0;
  for (std::size_t cell = 0; cell < serial.mesh.n_cells(); ++cell) {
    CHECK((serial.candidate_of[cell] != no_index) == (serial.mesh.kinds[cell] == CellKind::hexahedron));
    if (serial.mesh.kinds[cell] != CellKind::hexahedron) continue;
    ++n_hexahedra;
    std::array<index_t, 8> corners{};
    for (std::size_t k = 0; k < 8; ++k) corners[k] = serial.vertex_of[serial.mesh.cells[cell][k]];
    std::sort(corners.begin(), corners.end());
    std::vector<index_t> tets(serial.cell_of[cell].begin(), serial.cell_of[cell].end());
    bool found = false;
    for (std::size_t i = 0; i < candidates.size() && !found; ++i) {
      auto c = candidates.vertices[i];
      if (std::ranges::find(c, corners[0]) == c.end()) continue;
      std::sort(c.begin(), c.end());
      found = c == corners && std::ranges::equal(candidates.tets[i], tets);
    }
    CHECK(found);
  }
  CHECK(n_hexahedra > 100);
  CHECK(n_hexahedra <= serial.selection.members.size());

  options.assembly.vertex_numbers = VertexNumbers::compact;
  const Recombination compact = recombine_by_parts(mesh, options, 1500);
  std::vector<std::uint8_t> used(compact.mesh.points.size(), 0);
  for (const index_t v : compact.mesh.cells.values) used[v] = 1;
  CHECK(std::ranges::count(used, 0) == 0);
  check_sound(compact.mesh, 1000);
}
