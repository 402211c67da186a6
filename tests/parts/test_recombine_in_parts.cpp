// SPDX-License-Identifier: BSL-1.0
#include "framehex/parts/recombine_in_parts.hpp"
#include "framehex/pipeline/recombine.hpp"
#include "framehex/verify/conformity.hpp"
#include "framehex/verify/validity.hpp"
#include "parts/part_fixtures.hpp"

#include <catch2/catch.hpp>

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

Joined recombine_on_ranks(const IndexedTetMesh& mesh, int n_ranks, std::size_t part_size) {
  Joined joined;
  std::mutex mutex;
  std::map<global_t, index_t> vertex;
  std::map<global_t, int> owner, holders_said;
  std::map<global_t, std::set<int>> holders, said;
  std::set<global_t> cell_numbers;
  test::run_on_ranks(n_ranks, [&](const test::ThreadTransport& transport) {
    const auto brought = test::part_of(mesh, transport.rank(), [&](std::size_t cell) {
      return static_cast<int>(cell * 7919 / 1000 % static_cast<std::size_t>(n_ranks));
    });
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

double hex_share(const MixedMesh& mesh) {
  const auto volume = verify::volume(mesh);
  return volume.by_kind[static_cast<std::size_t>(CellKind::hexahedron)] / volume.cells;
}

void check_sound(const MixedMesh& mesh, double volume) {
  CHECK(verify::is_conforming(mesh));
  CHECK(verify::is_valid(mesh));
  CHECK(verify::volume(mesh).cells == Approx(volume).epsilon(1e-9));
  CHECK(verify::volume(mesh).relative_difference() < 1e-9);
}

}  // namespace

TEST_CASE("parts make the same sound mesh for any number of ranks and any numbering") {
  const IndexedTetMesh mesh = test::jittered_kuhn(12, 0.2);
  const double whole = hex_share(recombine(mesh).mesh);
  for (const std::size_t part_size : {300u, 2000u}) {
    CellSet first;
    for (const int n_ranks : {1, 2, 3, 5}) {
      CAPTURE(part_size, n_ranks, whole);
      const Joined joined =
          recombine_on_ranks(test::permuted(mesh, part_size + static_cast<std::size_t>(n_ranks)), n_ranks, part_size);
      check_sound(joined.mesh, 12 * 12 * 12);
      CHECK(joined.last.n_parts > 4);
      if (n_ranks == 1) first = joined.cells;
      CHECK(joined.cells == first);
      if (n_ranks == 1)
        WARN(hex_share(joined.mesh) << " against " << whole << ", turns " << joined.last.n_turns << ", kept "
                                    << joined.last.n_kept);
    }
  }
}
