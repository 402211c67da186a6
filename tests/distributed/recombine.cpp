// SPDX-License-Identifier: BSL-1.0
#include "framehex/distributed/recombine.hpp"

#include "distributed/parts.hpp"
#include "framehex/verify/conformity.hpp"
#include "framehex/verify/validity.hpp"
#include "support/kuhn_lattice.hpp"
#include "support/mapped_lattices.hpp"

#include <catch2/catch.hpp>
#include <map>

using namespace framehex;
using namespace framehex::distributed;

namespace {

struct Corners {
  CellKind kind;
  std::array<std::array<double, 3>, 8> places;
  auto operator<=>(const Corners&) const = default;
};

/// Cells of all ranks by the places of their corners, in the order in which they stand; sorted.
std::vector<Corners> all_cells(const MpiTransport& transport, const MixedMesh& mesh) {
  std::vector<Corners> cells;
  for (std::size_t c = 0; c < mesh.n_cells(); ++c) {
    Corners& cell = cells.emplace_back(Corners{mesh.kinds[c], {}});
    for (std::size_t i = 0; i < mesh.cells[c].size(); ++i) {
      const Vector3& p = mesh.points[mesh.cells[c][i]];
      cell.places[i] = {p.x(), p.y(), p.z()};
    }
  }
  cells = distributed::detail::gathered(transport, cells);
  std::sort(cells.begin(), cells.end());
  return cells;
}

/// The mesh that all ranks' parts make, joined by the numbers of vertices.
MixedMesh joined(const MpiTransport& transport, const PartRecombination& part) {
  const auto ids = distributed::detail::gathered(transport, part.vertex_numbers);
  const auto points = distributed::detail::gathered(transport, part.mesh.points);
  std::map<global_t, index_t> number;
  MixedMesh mesh;
  for (std::size_t i = 0; i < ids.size(); ++i)
    if (number.emplace(ids[i], static_cast<index_t>(mesh.points.size())).second)
      mesh.points.push_back(points[i]);
    else
      REQUIRE((mesh.points[number[ids[i]]] == points[i]));
  struct Cell {
    CellKind kind;
    std::array<global_t, 8> corners;
  };
  std::vector<Cell> cells;
  for (std::size_t c = 0; c < part.mesh.n_cells(); ++c) {
    Cell& cell = cells.emplace_back(Cell{part.mesh.kinds[c], {}});
    for (std::size_t i = 0; i < part.mesh.cells[c].size(); ++i)
      cell.corners[i] = part.vertex_numbers[part.mesh.cells[c][i]];
  }
  for (const Cell& cell : distributed::detail::gathered(transport, cells)) {
    std::array<index_t, 8> corners{};
    const auto n = static_cast<std::size_t>(n_corners(cell.kind));
    for (std::size_t i = 0; i < n; ++i) corners[i] = number.at(cell.corners[i]);
    mesh.add(cell.kind, std::span(corners).first(n));
  }
  return mesh;
}

/// Inside; its quadrilaterals on the boundary stay flat, so that all cells have the volume of the tetrahedra.
IndexedTetMesh perturbed(IndexedTetMesh mesh, double by) {
  std::mt19937_64 engine(3);
  const auto uniform = [&] { return 2 * (static_cast<double>(engine() >> 11) * 0x1p-53) - 1; };
  const double side = mesh.points.back().x();
  for (Vector3& p : mesh.points)
    if (p.minCoeff() > 0 && p.maxCoeff() < side)
      for (int i = 0; i < 3; ++i) p[i] += by * uniform();
  return mesh;
}

double volume_of(const IndexedTetMesh& mesh) {
  double volume = 0;
  for (const auto& t : mesh.tets) {
    const Vector3& a = mesh.points[t[0]];
    volume += (mesh.points[t[1]] - a).cross(mesh.points[t[2]] - a).dot(mesh.points[t[3]] - a) / 6;
  }
  return volume;
}

/// Who shares what follows from who has what; owners are the first of them.
void check_shared(const MpiTransport& transport, const PartRecombination& part) {
  struct Has {
    global_t id;
    int rank;
    auto operator<=>(const Has&) const = default;
  };
  std::vector<Has> mine;
  for (const global_t id : part.vertex_numbers) mine.push_back({id, transport.rank()});
  auto all = distributed::detail::gathered(transport, mine);
  std::sort(all.begin(), all.end());
  std::vector<std::pair<index_t, int>> expected, found;
  for (index_t v = 0; v < part.vertex_numbers.size(); ++v) {
    const global_t id = part.vertex_numbers[v];
    auto at = std::lower_bound(all.begin(), all.end(), Has{id, 0});
    CHECK(part.owners[v] == at->rank);
    for (; at != all.end() && at->id == id; ++at)
      if (at->rank != transport.rank()) expected.emplace_back(v, at->rank);
  }
  for (const auto& s : part.shared) found.emplace_back(s.vertex, s.rank);
  CHECK((found == expected));
}

}  // namespace

TEST_CASE("recombined parts are those of one process, whoever holds which cells, and make one sound mesh") {
  const MpiTransport transport(MPI_COMM_WORLD);
  struct Case {
    const char* name;
    IndexedTetMesh mesh;
    std::size_t part_size;
    bool is_flat;
  };
  const std::vector<Case> cases{
      {"perturbed lattice", perturbed(test::kuhn_lattice(8), 0.1), 500, true},
      {"ball", test::ball_mesh(6), 200, false},
      {"one part", test::kuhn_lattice(4), 10000, true},
      {"one tetrahedron", {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 1, 2, 3}}}, 1, true}};
  for (const Case& c : cases) {
    const IndexedPart whole = test::part_of(c.mesh, std::vector<int>(c.mesh.tets.size(), 0), 0);
    PartsOptions options;
    options.part_size = c.part_size;
    const PartRecombination serial =
        recombine_in_parts({whole.mesh.points, whole.mesh.tets, whole.vertex_ids, whole.cell_ids, {}}, options);
    const auto expected = all_cells(transport, transport.rank() == 0 ? serial.mesh : MixedMesh{});
    for (const test::Dealing& dealing : test::dealings()) {
      INFO(c.name << ", " << dealing.name);
      const auto ranks = dealing.ranks(c.mesh, transport.n_ranks());
      const IndexedPart part = test::part_of(c.mesh, ranks, transport.rank());
      const PartRecombination result = distributed::recombine(part, transport, {options, {}});
      CHECK((all_cells(transport, result.mesh) == expected));
      CHECK(result.n_chosen == serial.n_chosen);
      CHECK(result.weight == serial.weight);
      CHECK(result.bound == serial.bound);
      check_shared(transport, result);
      const MixedMesh mesh = joined(transport, result);
      CHECK(bool(verify::is_conforming(mesh)));
      CHECK(bool(verify::is_valid(mesh)));
      const verify::VolumeReport volume = verify::volume(mesh);
      CHECK(volume.relative_difference() < 1e-12);
      if (c.is_flat) CHECK(volume.cells == Approx(volume_of(c.mesh)).epsilon(1e-12));
    }
  }
}

TEST_CASE("new vertices have the numbers after the greatest, however great that is", "[regression]") {
  const MpiTransport transport(MPI_COMM_WORLD);
  const IndexedTetMesh mesh = test::ball_mesh(4);
  const auto n = static_cast<std::int64_t>(mesh.points.size());
  for (const int bits : {0, 55, 61}) {  // a double holds 53
    IndexedPart part = test::part_of(mesh, test::dealings()[0].ranks(mesh, transport.n_ranks()), transport.rank());
    const std::int64_t first = (std::int64_t{1} << bits) - 1;
    for (std::int64_t& id : part.vertex_ids) id += first;
    const PartRecombination result = distributed::recombine(part, transport, {{.part_size = 200}, {}});
    std::vector<std::int64_t> added;
    for (index_t v = 0; v < result.vertex_numbers.size(); ++v)
      if (result.owners[v] == transport.rank() && result.vertex_numbers[v] >= first + n)
        added.push_back(result.vertex_numbers[v]);
    added = distributed::detail::gathered(transport, added);
    std::sort(added.begin(), added.end());
    REQUIRE_FALSE(added.empty());
    for (std::size_t i = 0; i < added.size(); ++i) CHECK(added[i] == first + n + static_cast<std::int64_t>(i));
    check_shared(transport, result);
  }
}

TEST_CASE("values find the vertices that have their numbers") {
  const MpiTransport transport(MPI_COMM_WORLD);
  std::vector<std::int64_t> known, wanted;
  std::vector<double> values;
  for (std::int64_t id = 0; id < 5000; ++id) {
    if (id % transport.n_ranks() == transport.rank()) {
      known.push_back(id);
      values.push_back(0.5 * static_cast<double>(id));
    }
    if (id % 7 == transport.rank()) wanted.push_back(id + 100);
  }
  const auto found = values_by_number<double>(transport, known, values, wanted, -1);
  for (std::size_t i = 0; i < wanted.size(); ++i)
    CHECK(found[i] == (wanted[i] < 5000 ? 0.5 * static_cast<double>(wanted[i]) : -1));
}

TEST_CASE("a recombination that an observer ends or breaks on one rank ends on all") {
  const MpiTransport transport(MPI_COMM_WORLD);
  const IndexedTetMesh mesh = test::kuhn_lattice(8);
  const IndexedPart part = test::part_of(mesh, test::dealings()[0].ranks(mesh, transport.n_ranks()), transport.rank());
  for (const int heard : {0, transport.n_ranks() - 1}) {
    distributed::RecombineOptions options;
    options.parts.part_size = 300;
    int left = 3;
    if (transport.rank() == heard) options.parts.observer = [&](const Progress&) { return --left > 0; };
    const PartRecombination result = distributed::recombine(part, transport, options);
    CHECK((result.status == Status::cancelled));
    CHECK(result.mesh.n_cells() == 0);
    if (transport.rank() == heard)
      options.parts.observer = [](const Progress&) -> bool { throw std::runtime_error("the host has had enough"); };
    CHECK_THROWS_WITH(distributed::recombine(part, transport, options),
                      "rank " + std::to_string(heard) + ": the host has had enough");
  }
}
