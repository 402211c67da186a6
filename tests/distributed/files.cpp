// SPDX-License-Identifier: BSL-1.0
#include "framehex/distributed/read_parts.hpp"
#include "framehex/distributed/validation.hpp"
#include "framehex/distributed/write_pvtu.hpp"

#include "distributed/parts.hpp"
#include "support/kuhn_lattice.hpp"
#include "support/temporary_folder.hpp"

#include <catch2/catch.hpp>
#include <fstream>
#include <optional>

using namespace framehex;
using namespace framehex::distributed;

namespace {

/// A folder that all ranks know.
class SharedFolder {
public:
  explicit SharedFolder(const MpiTransport& transport) : transport_(transport) {
    std::vector<char> name;
    if (transport.rank() == 0) {
      const std::string& path = made_.emplace().path().native();
      name.assign(path.begin(), path.end());
    }
    name = distributed::detail::gathered(transport, name);
    path_ = std::string(name.begin(), name.end());
  }
  ~SharedFolder() { transport_.agree(); }  // nobody is at work in it any more
  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
  std::size_t n_files() const {
    return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(path_), {}));
  }

private:
  const MpiTransport& transport_;
  std::optional<test::TemporaryFolder> made_;
  std::filesystem::path path_;
};

/// A part of tetrahedra as one of any cells.
struct Whole {
  MixedMesh mesh;
  std::vector<SharedWith> shared;

  Whole(const IndexedPart& part, const IndexedTetMesh& all, const std::vector<int>& rank_of_cell, int rank) {
    mesh.points = part.mesh.points;
    for (const auto& tet : part.mesh.tets) mesh.add(CellKind::tetrahedron, tet);
    std::vector<std::vector<int>> ranks(all.points.size());
    for (std::size_t c = 0; c < all.tets.size(); ++c)
      for (const index_t v : all.tets[c]) ranks[v].push_back(rank_of_cell[c]);
    for (index_t v = 0; v < part.vertex_ids.size(); ++v) {
      auto& having = ranks[static_cast<std::size_t>(part.vertex_ids[v])];
      std::sort(having.begin(), having.end());
      having.erase(std::unique(having.begin(), having.end()), having.end());
      for (const int r : having)
        if (r != rank) shared.push_back({v, r});
    }
  }
};

/// Cells of all ranks as places of their corners, sorted.
std::vector<std::array<double, 12>> all_cells(const MpiTransport& transport, const IndexedTetMesh& mesh) {
  std::vector<std::array<double, 12>> cells;
  for (const auto& tet : mesh.tets) {
    auto& row = cells.emplace_back();
    for (std::size_t i = 0; i < 12; ++i) row[i] = mesh.points[tet[i / 3]][static_cast<int>(i % 3)];
  }
  cells = distributed::detail::gathered(transport, cells);
  std::sort(cells.begin(), cells.end());
  return cells;
}

}  // namespace

TEST_CASE("pieces are read back as the mesh they were, with and without numbers, and by the program's serial reader") {
  const MpiTransport transport(MPI_COMM_WORLD);
  const SharedFolder folder(transport);
  const IndexedTetMesh mesh = test::kuhn_lattice(5);
  for (const test::Dealing& dealing : test::dealings()) {
    INFO(dealing.name);
    const auto ranks = dealing.ranks(mesh, transport.n_ranks());
    const IndexedPart part = test::part_of(mesh, ranks, transport.rank());
    const Whole whole(part, mesh, ranks, transport.rank());
    write_pvtu(folder / "mesh.pvtu", transport,
               {whole.mesh, part.vertex_ids, part.cell_ids, part.owners, whole.shared});
    const ReadPart read = read_parts(folder / "mesh.pvtu", transport);
    distributed::validate(read.part, transport);
    CHECK(read.regions.empty());
    CHECK((all_cells(transport, read.part.mesh) == all_cells(transport, part.mesh)));
    auto ids = read.part.cell_ids, expected = part.cell_ids;
    std::sort(ids.begin(), ids.end());
    std::sort(expected.begin(), expected.end());
    CHECK((ids == expected));
    // A piece has its own cells and those that touch them, marked.
    VtuPieceArrays arrays;
    const MixedMesh piece = read_vtu_piece(folder / ("mesh_" + std::to_string(transport.rank()) + ".vtu"), arrays);
    std::vector<char> is_here(mesh.points.size(), 0);
    for (const std::int64_t v : part.vertex_ids) is_here[static_cast<std::size_t>(v)] = 1;
    std::ptrdiff_t n_ghosts = 0;
    for (std::size_t c = 0; c < mesh.tets.size(); ++c)
      n_ghosts += ranks[c] != transport.rank() &&
                  std::any_of(mesh.tets[c].begin(), mesh.tets[c].end(), [&](index_t v) { return is_here[v]; });
    CHECK(std::count(arrays.ghosts.begin(), arrays.ghosts.end(), 1) == n_ghosts);
    CHECK(piece.n_cells() == part.cell_ids.size() + static_cast<std::size_t>(n_ghosts));
  }
}

TEST_CASE("pieces without numbers join where their points lie at one place, and numbers do not depend on the ranks") {
  const MpiTransport transport(MPI_COMM_WORLD);
  const SharedFolder folder(transport);
  const IndexedTetMesh mesh = test::kuhn_lattice(4);
  std::vector<std::array<double, 3>> first;
  for (const std::string extension : {".pvtu", ".msh"}) {
    if (transport.rank() == 0) {
      // Seven pieces, whatever the number of ranks.
      std::string text = "<VTKFile type=\"PUnstructuredGrid\"><PUnstructuredGrid>";
      for (std::size_t i = 0; i < 7; ++i) {
        MixedMesh piece;
        piece.points = mesh.points;
        for (std::size_t c = i * mesh.tets.size() / 7; c < (i + 1) * mesh.tets.size() / 7; ++c)
          piece.add(CellKind::tetrahedron, mesh.tets[c]);
        if (extension == ".msh")
          write_msh(folder / ("mesh_" + std::to_string(i + 1) + ".msh"), piece);
        else
          write_vtu(folder / ("piece" + std::to_string(i) + ".vtu"), piece);
        text += "<Piece Source=\"piece" + std::to_string(i) + ".vtu\"/>";
      }
      std::ofstream(folder / "mesh.pvtu") << text + "</PUnstructuredGrid></VTKFile>";
    }
    transport.agree();
    const ReadPart read = read_parts(folder / ("mesh" + extension), transport);
    distributed::validate(read.part, transport);
    CHECK((all_cells(transport, read.part.mesh) ==
           all_cells(transport, transport.rank() == 0 ? mesh : IndexedTetMesh{})));
    std::vector<std::int64_t> owned;
    for (std::size_t v = 0; v < read.part.vertex_ids.size(); ++v)
      if (read.part.owners[v] == transport.rank()) owned.push_back(read.part.vertex_ids[v]);
    CHECK(distributed::detail::gathered(transport, owned).size() == mesh.points.size());
  }
}

TEST_CASE("partitions as Gmsh saves them: parts of entities have groups, ghosts are left out") {
  const MpiTransport transport(MPI_COMM_WORLD);
  const SharedFolder folder(transport);
  if (transport.rank() == 0) {
    // Two tetrahedra on both sides of a triangle, each in a partition and with the other as a ghost.
    const std::string head =
        "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Entities\n0 0 0 2\n1 0 0 0 1 1 1 1 7 0\n2 0 0 -1 1 1 0 1 9 0\n"
        "$EndEntities\n$PartitionedEntities\n2\n1\n9 1\n0 0 0 2\n5 3 1 1 1 0 0 0 1 1 1 1 7 0\n"
        "6 3 2 1 2 0 0 -1 1 1 0 1 9 0\n$EndPartitionedEntities\n$Nodes\n1 5 1 5\n3 5 0 5\n1\n2\n3\n4\n5\n"
        "0 0 0\n1 0 0\n0 1 0\n0 0 1\n0 0 -1\n$EndNodes\n$Elements\n2 2 1 2\n3 5 4 1\n11 1 2 3 4\n3 6 4 1\n"
        "12 1 3 2 5\n$EndElements\n$GhostElements\n2\n11 1 1 2\n12 2 1 1\n$EndGhostElements\n";
    std::ofstream(folder / "two_1.msh") << head;
    std::ofstream(folder / "two_2.msh") << head;
  }
  transport.agree();
  const ReadPart read = read_parts(folder / "two.msh", transport);
  distributed::validate(read.part, transport);
  CHECK(all_cells(transport, read.part.mesh).size() == 2);
  std::vector<index_t> regions = distributed::detail::gathered(transport, read.regions);
  std::sort(regions.begin(), regions.end());
  CHECK((regions == std::vector<index_t>{6, 8}));
}

TEST_CASE("a file is dealt out with its numbers, and what cannot be read is one error on all ranks") {
  const MpiTransport transport(MPI_COMM_WORLD);
  const SharedFolder folder(transport);
  const IndexedTetMesh mesh = test::kuhn_lattice(3);
  if (transport.rank() == 0) {
    MixedMesh whole;
    whole.points = mesh.points;
    for (const auto& tet : mesh.tets) whole.add(CellKind::tetrahedron, tet);
    for (std::size_t c = 0; c < mesh.tets.size(); ++c) whole.regions.push_back(static_cast<index_t>(c % 3));
    write_vtu(folder / "mesh.vtu", whole);
  }
  transport.agree();
  const ReadPart read = read_parts(folder / "mesh.vtu", transport);
  distributed::validate(read.part, transport);
  REQUIRE(read.regions.size() == read.part.cell_ids.size());
  for (std::size_t c = 0; c < read.regions.size(); ++c) {
    const auto id = static_cast<std::size_t>(read.part.cell_ids[c]);
    CHECK(read.regions[c] == id % 3);
    for (std::size_t i = 0; i < 4; ++i) CHECK(read.part.vertex_ids[read.part.mesh.tets[c][i]] == mesh.tets[id][i]);
  }
  CHECK_THROWS_AS(read_parts(folder / "none.vtu", transport), remote_error);
  CHECK_THROWS_AS(read_parts(folder / "none.pvtu", transport), remote_error);
  CHECK_THROWS_AS(read_parts(folder / "none.msh", transport), remote_error);
}

TEST_CASE("where a rank cannot write, no file is left") {
  const MpiTransport transport(MPI_COMM_WORLD);
  const SharedFolder folder(transport);
  const int n = transport.n_ranks(), rank = transport.rank();
  const IndexedTetMesh mesh = test::kuhn_lattice(3);
  const auto ranks = test::dealings()[0].ranks(mesh, n);
  const IndexedPart part = test::part_of(mesh, ranks, rank);
  const Whole whole(part, mesh, ranks, rank);
  const MixedPart written{whole.mesh, part.vertex_ids, part.cell_ids, part.owners, whole.shared};
  // Where the last rank's piece should stand there is a full disk.
  if (rank == 0) std::filesystem::create_symlink("/dev/full", folder / ("mesh_" + std::to_string(n - 1) + ".vtu"));
  transport.agree();
  try {
    write_pvtu(folder / "mesh.pvtu", transport, written);
    FAIL("written");
  } catch (const remote_error& e) {
    CHECK(e.rank() == n - 1);
    CHECK(std::string(e.what()).find("No space left on device") != std::string::npos);
  }
  transport.agree();
  CHECK(folder.n_files() == 1);
}
