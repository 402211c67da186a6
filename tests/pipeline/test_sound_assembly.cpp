// SPDX-License-Identifier: BSL-1.0
#include "framehex/pipeline/recombine.hpp"
#include "framehex/verify/conformity.hpp"
#include "framehex/verify/validity.hpp"
#include "support/kuhn_lattice.hpp"

#include <catch2/catch.hpp>

using namespace framehex;

namespace {

/// A lattice of 4^3 cubes, all of which are chosen, and ways to spoil what is assembled from them.
struct Spoiled {
  IndexedTetMesh mesh = test::kuhn_lattice(4);
  TetAdjacency tets = make_adjacency(mesh);
  PotentialHexahedra candidates = find_potential_hexahedra(mesh);
  std::vector<index_t> chosen =
      select(ImplicitIncompatibilityGraph(candidates, volume_times_quality(candidates))).members;
  std::size_t n_attempts = 0;

  /// @param spoil  callable: assembly, chosen candidates -> void; changes the assembly.
  template <class Spoil>
  detail::SoundAssembly assemble_and(Spoil&& spoil) {
    const auto assemble_spoiled = [&](std::span<const index_t> selected, const AssemblyOptions& options) {
      ++n_attempts;
      Assembly assembly = assemble(mesh, tets, candidates, selected, options);
      spoil(assembly, selected);
      return assembly;
    };
    return detail::assemble_soundly(assemble_spoiled, tets, candidates, chosen, {});
  }

  void check_sound(const detail::SoundAssembly& sound) const {
    const MixedMesh& made = sound.assembly.mesh;
    CHECK(verify::is_conforming(made));
    CHECK(verify::is_valid(made));
    CHECK(verify::volume(made).cells == Approx(64));
    const auto n_hexahedra = static_cast<std::size_t>(std::ranges::count(made.kinds, CellKind::hexahedron));
    CHECK(n_hexahedra + sound.n_given_up == chosen.size());
  }
};

MixedMesh without_cell(const MixedMesh& mesh, index_t gone) {
  MixedMesh rest;
  rest.points = mesh.points;
  for (index_t cell = 0; cell < mesh.n_cells(); ++cell)
    if (cell != gone) rest.add(mesh.kinds[cell], mesh.cells[cell]);
  return rest;
}

const Vector3 middle(2, 2, 2);

}  // namespace

TEST_CASE("what is sound is handed out as it is") {
  Spoiled lattice;
  REQUIRE(lattice.chosen.size() == 64);
  const auto sound = lattice.assemble_and([](Assembly&, std::span<const index_t>) {});
  CHECK(lattice.n_attempts == 1);
  CHECK(sound.n_given_up == 0);
  lattice.check_sound(sound);
}

TEST_CASE("round a fault the chosen hexahedra are given up") {
  Spoiled lattice;
  const index_t victim = lattice.chosen[20];
  const auto is_there = [&](std::span<const index_t> selected) { return std::ranges::count(selected, victim) > 0; };
  const auto cell_of_victim = [&](const Assembly& assembly) {
    return static_cast<index_t>(std::ranges::find(assembly.candidate_of, victim) - assembly.candidate_of.begin());
  };
  SECTION("a cell is missing") {
    const auto sound = lattice.assemble_and([&](Assembly& assembly, auto selected) {
      if (is_there(selected)) assembly.mesh = without_cell(assembly.mesh, cell_of_victim(assembly));
    });
    CHECK(lattice.n_attempts == 2);
    lattice.check_sound(sound);
  }
  SECTION("a cell is turned over") {
    const auto sound = lattice.assemble_and([&](Assembly& assembly, auto selected) {
      if (!is_there(selected)) return;
      const auto corners = assembly.mesh.cells[cell_of_victim(assembly)];
      std::rotate(corners.begin(), corners.begin() + 4, corners.end());
    });
    CHECK(lattice.n_attempts == 2);
    lattice.check_sound(sound);
  }
  SECTION("a vertex is moved beyond its neighbours") {
    const auto sound = lattice.assemble_and([&](Assembly& assembly, auto) {
      if (lattice.n_attempts > 1) return;
      for (index_t v = 0; v < assembly.mesh.points.size(); ++v)
        if (assembly.vertex_of[v] != no_index && lattice.mesh.points[assembly.vertex_of[v]] == middle)
          assembly.mesh.points[v].x() += 1.5;
    });
    CHECK(lattice.n_attempts == 2);
    CHECK(sound.n_given_up >= 8);
    lattice.check_sound(sound);
  }
}

TEST_CASE("at last nothing but the tetrahedra is left; what does not pass even then is an error") {
  Spoiled lattice;
  const auto spoil = [](Assembly& assembly) {
    assembly.mesh = without_cell(assembly.mesh, static_cast<index_t>(assembly.mesh.n_cells() - 1));
  };
  const auto sound = lattice.assemble_and([&](Assembly& assembly, auto selected) {
    if (!selected.empty()) spoil(assembly);
  });
  CHECK(sound.n_given_up == 64);
  CHECK(sound.assembly.mesh.n_cells() == lattice.mesh.tets.size());
  CHECK(sound.assembly.moved.empty());
  CHECK_THROWS_AS(lattice.assemble_and([&](Assembly& assembly, auto) { spoil(assembly); }), unsound_mesh);
  CHECK(lattice.n_attempts < 30);
}
