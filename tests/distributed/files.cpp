// SPDX-License-Identifier: BSL-1.0
#include "framehex/adapters/zlib_compression.hpp"
#include "framehex/distributed/read_parts.hpp"
#include "framehex/distributed/validation.hpp"
#include "framehex/distributed/write_pvtu.hpp"
#include "framehex/io/mesh_writer.hpp"

#include "distributed/parts.hpp"
#include "support/kuhn_lattice.hpp"
#include "support/temporary_folder.hpp"

#include <malloc.h>
#include <sys/resource.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <fstream>
#include <functional>
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

MixedMesh with_regions(const IndexedTetMesh& mesh) {
  MixedMesh whole;
  whole.points = mesh.points;
  for (const auto& tet : mesh.tets) whole.add(CellKind::tetrahedron, tet);
  for (std::size_t c = 0; c < mesh.tets.size(); ++c) whole.regions.push_back(static_cast<index_t>(c % 3));
  return whole;
}

/// While it lives the process gets no more memory than so many bytes beyond what it has. Mapped files do not count.
class MemoryLimit {
public:
  explicit MemoryLimit(std::size_t more) {
    ::malloc_trim(0);
    ::getrlimit(RLIMIT_DATA, &before_);
    std::ifstream statm("/proc/self/statm");
    std::array<std::size_t, 6> pages{};
    for (std::size_t& n : pages) statm >> n;
    rlimit limit = before_;
    limit.rlim_cur = pages[5] * static_cast<std::size_t>(::sysconf(_SC_PAGESIZE)) + more;
    ::setrlimit(RLIMIT_DATA, &limit);
  }
  MemoryLimit(const MemoryLimit&) = delete;
  MemoryLimit& operator=(const MemoryLimit&) = delete;
  ~MemoryLimit() { ::setrlimit(RLIMIT_DATA, &before_); }

private:
  rlimit before_{};
};

/// Text with some of it replaced wherever it stands; of the same length where there are offsets.
void replace_in(const std::filesystem::path& path, const std::string& what, const std::string& by) {
  std::string bytes = read_file(path);
  for (std::size_t at = bytes.find(what); at != bytes.npos; at = bytes.find(what, at + by.size()))
    bytes.replace(at, what.size(), by);
  std::ofstream(path, std::ios::binary) << bytes;
}

/// What a piece is before it is written: its mesh, arrays, and the cells of the whole that it has.
struct PieceToWrite {
  MixedMesh mesh;
  MeshData data;
  std::vector<std::size_t> cells;
};

/// NAME.pvtu and its pieces NAME0.vtu, NAME1.vtu..., each with so many cells of the mesh. `change` has the last word.
void write_pieces(const std::filesystem::path& path, const IndexedTetMesh& mesh, std::size_t n,
                  const std::function<void(std::size_t, PieceToWrite&)>& change) {
  std::string text = "<VTKFile type=\"PUnstructuredGrid\"><PUnstructuredGrid>";
  for (std::size_t i = 0; i < n; ++i) {
    PieceToWrite piece;
    for (std::size_t c = i * mesh.tets.size() / n; c < (i + 1) * mesh.tets.size() / n; ++c) piece.cells.push_back(c);
    for (const std::size_t c : piece.cells) piece.mesh.add(CellKind::tetrahedron, mesh.tets[c]);
    piece.mesh.points = mesh.points;
    change(i, piece);
    const std::string name = path.stem().string() + std::to_string(i) + ".vtu";
    write_vtu(path.parent_path() / name, piece.mesh, piece.data);
    text += "<Piece Source=\"" + name + "\"/>";
  }
  std::ofstream(path) << text + "</PUnstructuredGrid></VTKFile>";
}

/// All ranks' regions, by the number of the cell.
std::vector<index_t> all_regions(const MpiTransport& transport, const ReadPart& read) {
  std::vector<std::pair<std::int64_t, index_t>> cells;
  for (std::size_t c = 0; c < read.regions.size(); ++c) cells.emplace_back(read.part.cell_ids[c], read.regions[c]);
  cells = distributed::detail::gathered(transport, cells);
  std::sort(cells.begin(), cells.end());
  std::vector<index_t> regions;
  for (const auto& [id, region] : cells) regions.push_back(region);
  return regions;
}

/// Two tetrahedra on both sides of a triangle, each in a partition and with the other as a ghost, which is in an entity of
/// ghosts, without groups: as Gmsh saves it.
std::string partition_with_ghost(int partition) {
  const bool first = partition == 1;
  return "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$PhysicalNames\n2\n3 7 \"steel part\"\n3 9 \"air\"\n"
         "$EndPhysicalNames\n$Entities\n0 0 0 2\n1 0 0 0 1 1 1 1 7 0\n"
         "2 0 0 -1 1 1 0 1 9 0\n$EndEntities\n$PartitionedEntities\n2\n1\n" +
         std::string(first ? "8 1" : "9 2") + "\n0 0 0 1\n" +
         (first ? "5 3 1 1 1 0 0 0 1 1 1 1 7 0\n" : "6 3 2 1 2 0 0 -1 1 1 0 1 9 0\n") +
         "$EndPartitionedEntities\n$Nodes\n1 5 1 5\n3 5 0 5\n1\n2\n3\n4\n5\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n"
         "0 0 -1\n$EndNodes\n$Elements\n2 2 11 12\n3 " +
         (first ? "5 4 1\n11 1 2 3 4\n3 8 4 1\n12 1 3 2 5\n" : "6 4 1\n12 1 3 2 5\n3 9 4 1\n11 1 2 3 4\n") +
         "$EndElements\n$GhostElements\n1\n" + (first ? "12 2 1 1" : "11 1 1 2") + "\n$EndGhostElements\n";
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
    // Which rank has which cells is as before only where each has a piece.
    auto ids = distributed::detail::gathered(transport, read.part.cell_ids);
    auto expected = distributed::detail::gathered(transport, part.cell_ids);
    std::sort(ids.begin(), ids.end());
    std::sort(expected.begin(), expected.end());
    CHECK((ids == expected));
    // A piece has its own cells and those that touch them, marked; there is none of nothing, of an older mesh neither.
    const auto path = folder / ("mesh_" + std::to_string(transport.rank()) + ".vtu");
    REQUIRE(std::filesystem::exists(path) == !part.cell_ids.empty());
    if (part.cell_ids.empty()) continue;
    VtuPieceArrays arrays;
    const MixedMesh piece = read_vtu_piece(path, arrays);
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
  const IndexedTetMesh mesh = test::kuhn_lattice(14);  // more than one block's worth of cells for a rank
  const std::array<std::string, 5> names{"mesh.vtu", "zlib.vtu", "mesh.msh", "old.msh", "mesh.mesh"};
  if (transport.rank() == 0) {
    const MixedMesh whole = with_regions(mesh);
    write_vtu(folder / names[0], whole);
    write_vtu(folder / names[1], whole, {}, zlib_compression());
    write_msh(folder / names[2], whole);
    write_msh2(folder / names[3], whole);
    write_medit(folder / names[4], whole);
  }
  transport.agree();
  for (const std::string& name : names) {
    INFO(name);
    const ReadPart read = read_parts(folder / name, transport);
    distributed::validate(read.part, transport);
    REQUIRE(read.regions.size() == read.part.cell_ids.size());
    std::vector<std::int64_t> ids = distributed::detail::gathered(transport, read.part.cell_ids);
    std::sort(ids.begin(), ids.end());
    REQUIRE(ids.size() == mesh.tets.size());
    CHECK((ids.front() == 0 && std::adjacent_find(ids.begin(), ids.end()) == ids.end()));
    std::size_t n_wrong = 0;
    // Gmsh's files have cells in the order of their regions.
    if (!name.ends_with(".msh"))
      for (std::size_t c = 0; c < read.regions.size(); ++c) {
        const auto id = static_cast<std::size_t>(read.part.cell_ids[c]);
        n_wrong += read.regions[c] != id % 3;
        for (std::size_t i = 0; i < 4; ++i)
          n_wrong += read.part.vertex_ids[read.part.mesh.tets[c][i]] != mesh.tets[id][i];
      }
    CHECK(n_wrong == 0);
    CHECK((all_cells(transport, read.part.mesh) ==
           all_cells(transport, transport.rank() == 0 ? mesh : IndexedTetMesh{})));
    std::vector<index_t> regions = distributed::detail::gathered(transport, read.regions);
    CHECK(std::count(regions.begin(), regions.end(), 2) == static_cast<std::ptrdiff_t>(mesh.tets.size() / 3));
  }
  CHECK_THROWS_AS(read_parts(folder / "none.vtu", transport), remote_error);
  CHECK_THROWS_AS(read_parts(folder / "none.pvtu", transport), remote_error);
  CHECK_THROWS_AS(read_parts(folder / "none.msh", transport), remote_error);
}

TEST_CASE("faults of a file that is dealt out are found, wherever they come to light") {
  const MpiTransport transport(MPI_COMM_WORLD);
  const SharedFolder folder(transport);
  const std::string msh = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n5\n";
  const std::string nodes = "1 0 0 0\n2 1 0 0\n3 0 1 0\n";
  const std::string medit = "MeshVersionFormatted 2\nDimension 3\nVertices 4\n0 0 0 1\n1 0 0 1\n0 1 0 1\n";
  struct Fault {
    std::string name, bytes, message;
  };
  const std::vector<Fault> faults{
      {"twice.msh", msh + nodes + "3 0 0 1\n7 0 0 1\n$EndNodes\n$Elements\n1\n1 4 2 1 1 1 2 3 7\n$EndElements\n",
       "node 3 stands twice"},
      {"missing.msh", msh + nodes + "6 0 0 1\n7 0 0 1\n$EndNodes\n$Elements\n1\n1 4 2 1 1 1 2 3 5000\n$EndElements\n",
       "refers to node 5000, which does not exist"},
      {"infinite.msh", msh + nodes + "6 0 inf 1\n7 0 0 1\n$EndNodes\n$Elements\n1\n1 4 2 1 1 1 2 3 6\n$EndElements\n",
       "vertex 3 has a coordinate that is not finite"},
      {"beyond.mesh", medit + "0 0 1 1\nTetrahedra 1\n1 2 3 5 1\nEnd\n", "cell 0 refers to vertex 4 of 4"},
      {"prism.mesh", medit + "0 0 1 1\nPyramids 1\n1 2 3 4 4 1\nEnd\n", "cell 0 is not a tetrahedron"},
      {"count.mesh", "MeshVersionFormatted 2\nDimension 3\nVertices 1000000000\n0 0 0 1\n",
       "is 1000000000, more than the file can hold"},
      {"none.mesh", medit + "0 0 1 1\nTriangles 1\n1 2 3 1\nEnd\n", "holds no tetrahedron"}};
  if (transport.rank() == 0)
    for (const Fault& fault : faults) std::ofstream(folder / fault.name) << fault.bytes;
  transport.agree();
  for (const Fault& fault : faults) {
    INFO(fault.name);
    CHECK_THROWS_WITH(read_parts(folder / fault.name, transport), Catch::Contains(fault.message));
  }
}

TEST_CASE("the rank that deals out a file never has all of it") {
  const MpiTransport transport(MPI_COMM_WORLD);
  if (transport.n_ranks() < 5) return;  // its own share is large then
  const SharedFolder folder(transport);
  const index_t n = 60;
  const std::array<std::string, 3> names{"mesh.vtu", "mesh.msh", "mesh.mesh"};
  if (transport.rank() == 0) {
    const MixedMesh whole = with_regions(test::kuhn_lattice(n));
    write_vtu(folder / names[0], whole);
    write_msh(folder / names[1], whole);
    write_medit(folder / names[2], whole);
  }
  transport.agree();
  for (const std::string& name : names) {
    INFO(name);
    distributed::detail::DealtShare share;
    if (transport.rank() == 0) {
      // What the process may have more than it has now: less than the file's mesh, as it turns out.
      const MemoryLimit limit(std::size_t{100} << 20);
      CHECK_THROWS_AS(read_mesh(folder / name), std::bad_alloc);
      distributed::detail::deal_file(transport, folder / name, {}, share);
    } else {
      distributed::detail::receive_dealt(transport, share);
    }
    CHECK(distributed::detail::sum_of(transport, static_cast<std::int64_t>(share.cells.size())) == 6 * n * n * n);
    CHECK(distributed::detail::sum_of(transport, static_cast<std::int64_t>(share.points.size())) ==
          (n + 1) * (n + 1) * (n + 1));
  }
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

TEST_CASE("an older index goes before pieces take their names", "[regression]") {
  const MpiTransport transport(MPI_COMM_WORLD);
  const SharedFolder folder(transport);
  const int n = transport.n_ranks(), rank = transport.rank();
  if (n == 1) return;
  const IndexedTetMesh mesh = test::kuhn_lattice(1);
  const std::vector<int> ranks(mesh.tets.size(), 0);  // the others have no piece, and remove an older one
  const IndexedPart part = test::part_of(mesh, ranks, rank);
  const Whole whole(part, mesh, ranks, rank);
  const MixedPart written{whole.mesh, part.vertex_ids, part.cell_ids, part.owners, whole.shared};
  write_pvtu(folder / "mesh.pvtu", transport, written);
  if (rank == 0) {
    CHECK(std::filesystem::exists(folder / "mesh.pvtu"));
    std::filesystem::create_directories(folder / "mesh_1.vtu" / "what cannot be removed");
  }
  transport.agree();
  CHECK_THROWS_AS(write_pvtu(folder / "mesh.pvtu", transport, written), remote_error);
  transport.agree();
  CHECK_FALSE(std::filesystem::exists(folder / "mesh.pvtu"));
}

TEST_CASE("what a label means does not depend on the piece that it stands in", "[regression]") {
  const MpiTransport transport(MPI_COMM_WORLD);
  const SharedFolder folder(transport);
  const IndexedTetMesh mesh = test::kuhn_lattice(2);
  // One of them is of no usual number, so that labels are told by their order; pieces have different ones.
  const std::array<std::int64_t, 4> labels{-1, 5, 9, 9};
  const auto label_of = [&](std::size_t cell) { return labels[cell * 4 / mesh.tets.size()]; };
  if (transport.rank() == 0)
    write_pieces(folder / "mesh.pvtu", mesh, 3, [&](std::size_t, PieceToWrite& piece) {
      std::vector<std::int64_t> values;
      for (const std::size_t c : piece.cells) values.push_back(label_of(c));
      piece.data.cells.push_back({"material", values});
    });
  transport.agree();
  const std::vector<index_t> regions = all_regions(transport, read_parts(folder / "mesh.pvtu", transport, "material"));
  REQUIRE(regions.size() == mesh.tets.size());
  for (std::size_t c = 0; c < regions.size(); ++c) {
    const std::int64_t label = label_of(c);
    CHECK(regions[c] == (label < 0 ? 0u : label == 5 ? 1u : 2u));
  }
  // As without a name for the array, which is another one then: a single region.
  CHECK(read_parts(folder / "mesh.pvtu", transport).regions.empty());
  CHECK_THROWS_WITH(read_parts(folder / "mesh.pvtu", transport, "matter"),
                    Catch::Contains("has no array by cell \"matter\""));
}

TEST_CASE("labels of pieces lie in one array, or the mesh is refused", "[regression]") {
  const MpiTransport transport(MPI_COMM_WORLD);
  const SharedFolder folder(transport);
  const IndexedTetMesh mesh = test::kuhn_lattice(2);
  const auto write = [&](bool second_is_empty) {
    write_pieces(folder / "mesh.pvtu", mesh, 2, [&](std::size_t i, PieceToWrite& piece) {
      piece.mesh.regions.assign(piece.cells.size(), static_cast<index_t>(i) + 3);
      if (i == 1 && second_is_empty) piece.mesh = MixedMesh{};
    });
  };
  for (const std::string other : {"zone\"  ", "whatx\""}) {  // another usual name, and none
    if (transport.rank() == 0) {
      write(false);
      replace_in(folder / "mesh1.vtu", "\"label\"", '"' + other.substr(0, 6));
    }
    transport.agree();
    CHECK_THROWS_WITH(read_parts(folder / "mesh.pvtu", transport),
                      Catch::Contains("mesh1.vtu: labels of regions lie elsewhere than in") &&
                          Catch::Contains(other[0] == 'z' ? "it has them in \"zone\"" : "it has no array of integers"));
    transport.agree();
  }
  // A piece without cells need not have labels.
  if (transport.rank() == 0) {
    write(true);
    replace_in(folder / "mesh1.vtu", "\"label\"", "\"xabel\"");
  }
  transport.agree();
  CHECK(read_parts(folder / "mesh.pvtu", transport, "label").part.owners.size() <= mesh.points.size());
}

TEST_CASE("ghosts of Gmsh's partitions have no say in what labels mean, and names of groups come along",
          "[regression]") {
  const MpiTransport transport(MPI_COMM_WORLD);
  const SharedFolder folder(transport);
  if (transport.rank() == 0)
    for (const int i : {1, 2}) std::ofstream(folder / ("two_" + std::to_string(i) + ".msh")) << partition_with_ghost(i);
  transport.agree();
  const ReadPart read = read_parts(folder / "two.msh", transport);
  CHECK((all_regions(transport, read) == std::vector<index_t>{6, 8}));
  REQUIRE(read.groups.size() == 2);
  CHECK(read.groups[0].name == "steel part");
  CHECK((read.groups[0].number == 6 && read.groups[0].labels == std::vector<index_t>{6}));
  CHECK(read.groups[1].name == "air");
  CHECK_THROWS_WITH(read_parts(folder / "two.msh", transport, "label"), Catch::Contains("has no arrays by cell"));
}

TEST_CASE("groups that Gmsh makes of partitions are those of the whole mesh", "[regression]") {
  const MpiTransport transport(MPI_COMM_WORLD);
  const SharedFolder folder(transport);
  const std::string names =
      "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n4\n3 7 \"steel\"\n3 10 \"_part{1}_physical{7}_dim{3}\"\n"
      "3 11 \"_part{2}_physical{7}_dim{3}\"\n3 12 \"_part{2}_physical{0}_dim{3}\"\n$EndPhysicalNames\n$Nodes\n";
  if (transport.rank() == 0) {
    std::ofstream(folder / "old_1.msh") << names +
                                               "4\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n$EndNodes\n$Elements\n1\n"
                                               "11 4 2 10 1 1 2 3 4\n$EndElements\n";
    std::ofstream(folder / "old_2.msh") << names +
                                               "5\n1 0 0 0\n2 1 0 0\n3 0 1 0\n5 0 0 -1\n6 -1 0 0\n$EndNodes\n"
                                               "$Elements\n2\n12 4 2 11 1 1 3 2 5\n13 4 2 12 1 1 5 6 3\n"
                                               "$EndElements\n";
  }
  transport.agree();
  const ReadPart read = read_parts(folder / "old.msh", transport);
  // Labels 7, 7 and none.
  CHECK((all_regions(transport, read) == std::vector<index_t>{1, 1, 0}));
  REQUIRE(read.groups.size() == 1);
  CHECK((read.groups[0].name == "steel" && read.groups[0].labels == std::vector<index_t>{1}));
}

TEST_CASE("a partition of Gmsh's that has no file is named", "[regression]") {
  const MpiTransport transport(MPI_COMM_WORLD);
  const SharedFolder folder(transport);
  const auto refuses = [&](const std::string& why) {
    transport.agree();
    CHECK_THROWS_WITH(read_parts(folder / "two.msh", transport), Catch::Contains(why));
    transport.agree();
  };
  const bool writes = transport.rank() == 0;
  if (writes) std::ofstream(folder / "two_1.msh") << partition_with_ghost(1);
  refuses("two_1.msh: is one of 2 partitions, but two_2.msh is missing");
  if (writes) std::ofstream(folder / "two_3.msh") << partition_with_ghost(2);
  refuses("two_2.msh: is missing: there is two_3.msh");
  if (writes) std::ofstream(folder / "two_2.msh") << partition_with_ghost(2);
  refuses("is one of 2 partitions, but two_3.msh is there, too");
  // Where there is no head, what elements tell.
  const std::string head =
      "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n4\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n"
      "$EndNodes\n$Elements\n1\n11 4 5 0 1 2 1 -2 1 2 3 4\n$EndElements\n";
  if (writes) {
    std::filesystem::remove(folder / "two_2.msh");
    std::filesystem::remove(folder / "two_3.msh");
    std::ofstream(folder / "two_1.msh") << head;
  }
  refuses("two_1.msh: is one of 2 partitions, but two_2.msh is missing");
}

TEST_CASE("names of regions are those of the files, however these are read", "[regression]") {
  const MpiTransport transport(MPI_COMM_WORLD);
  const SharedFolder folder(transport);
  const IndexedTetMesh mesh = test::kuhn_lattice(2);
  MixedMesh whole = with_regions(mesh);
  whole.groups = {{3, 0, "steel", {0, 2}}, {3, 1, "air & <water>", {1}}, {3, 2, "nowhere", {7}}};
  const std::array<std::string, 4> names{"mesh.vtu", "mesh.msh", "old.msh", "mesh.pvtu"};
  if (transport.rank() == 0) {
    write_vtu(folder / names[0], whole);
    write_msh(folder / names[1], whole);
    write_msh2(folder / names[2], whole);
    write_pieces(folder / names[3], mesh, 3, [&](std::size_t i, PieceToWrite& piece) {
      for (const std::size_t c : piece.cells) piece.mesh.regions.push_back(whole.regions[c]);
      piece.mesh.groups = whole.groups;
      if (i == 1) std::reverse(piece.mesh.groups.begin(), piece.mesh.groups.end());  // the order is the file's affair
    });
  }
  transport.agree();
  for (const std::string& name : names) {
    INFO(name);
    const ReadPart read = read_parts(folder / name, transport);
    // The serial reader is the judge.
    const MixedMesh expected = read_mesh(folder / (name == "mesh.pvtu" ? "mesh.vtu" : name));
    REQUIRE(read.groups.size() == expected.groups.size());
    for (std::size_t g = 0; g < read.groups.size(); ++g) {
      CHECK(read.groups[g].name == expected.groups[g].name);
      CHECK(read.groups[g].number == expected.groups[g].number);
      CHECK(read.groups[g].labels == expected.groups[g].labels);
    }
  }
}

TEST_CASE("a cell that every piece takes for another's, and a mesh without cells, are refused", "[regression]") {
  const MpiTransport transport(MPI_COMM_WORLD);
  const SharedFolder folder(transport);
  const IndexedTetMesh mesh = test::kuhn_lattice(2);
  const auto write = [&](std::size_t n_lost) {
    write_pieces(folder / "mesh.pvtu", mesh, 2, [&](std::size_t i, PieceToWrite& piece) {
      // Each has all cells; the first few are nobody's own.
      piece.mesh = with_regions(mesh);
      std::vector<std::uint8_t> ghosts(mesh.tets.size());
      for (std::size_t c = 0; c < ghosts.size(); ++c) ghosts[c] = c < n_lost || c % 2 != i;
      piece.data.cells.push_back({"vtkGhostType", ghosts});
    });
  };
  if (transport.rank() == 0) write(0);
  transport.agree();
  CHECK(all_regions(transport, read_parts(folder / "mesh.pvtu", transport)).size() == mesh.tets.size());
  if (transport.rank() == 0) write(3);
  transport.agree();
  CHECK_THROWS_WITH(read_parts(folder / "mesh.pvtu", transport),
                    Catch::Contains("cell 0 is marked as a ghost, but no piece has it as its own"));
  if (transport.rank() == 0)
    write_pieces(folder / "none.pvtu", mesh, 2, [](std::size_t, PieceToWrite& piece) { piece.mesh = MixedMesh{}; });
  transport.agree();
  CHECK_THROWS_WITH(read_parts(folder / "none.pvtu", transport), Catch::Contains("none.pvtu: holds no tetrahedron"));
}

TEST_CASE("global numbers are those that the attribute GlobalIds names, and are less than 2^62", "[regression]") {
  const MpiTransport transport(MPI_COMM_WORLD);
  const SharedFolder folder(transport);
  const IndexedTetMesh mesh = test::kuhn_lattice(2);
  const std::int64_t first = (std::int64_t{1} << 62) - static_cast<std::int64_t>(mesh.points.size());
  for (const std::int64_t offset : {0, 1}) {
    if (transport.rank() == 0) {
      write_pieces(folder / "mesh.pvtu", mesh, 3, [&](std::size_t, PieceToWrite& piece) {
        std::vector<std::int64_t> points, cells;
        for (std::size_t v = 0; v < mesh.points.size(); ++v)
          points.push_back(first + offset + static_cast<std::int64_t>(v));
        for (const std::size_t c : piece.cells) cells.push_back(100 + static_cast<std::int64_t>(c));
        piece.data = {.cells = {{"GlobalCellIds", cells}}, .points = {{"GlobalPointIds", points}}};
      });
      for (const std::string name : {"mesh0.vtu", "mesh1.vtu", "mesh2.vtu"}) {
        replace_in(folder / name, "GlobalCellIds", "element names");
        replace_in(folder / name, "GlobalPointIds", "names of nodes");
      }
    }
    transport.agree();
    const ReadPart read = read_parts(folder / "mesh.pvtu", transport);
    for (const std::int64_t id : read.part.vertex_ids) CHECK(id >= first);
    for (const std::int64_t id : read.part.cell_ids) CHECK(id >= 100);
    if (offset == 0)
      distributed::validate(read.part, transport);
    else
      CHECK_THROWS_WITH(distributed::validate(read.part, transport),
                        Catch::Contains("has the global number 4611686018427387904; they are from 0 to 2^62 - 1"));
    transport.agree();
  }
}

TEST_CASE("ghosts have the values of the rank that owns them", "[regression]") {
  const MpiTransport transport(MPI_COMM_WORLD);
  const SharedFolder folder(transport);
  const IndexedTetMesh mesh = test::kuhn_lattice(3);
  const auto ranks = test::dealings()[1].ranks(mesh, transport.n_ranks());
  const IndexedPart part = test::part_of(mesh, ranks, transport.rank());
  const Whole whole(part, mesh, ranks, transport.rank());
  std::vector<double> places;
  std::vector<index_t> numbers;
  for (const Vector3& p : part.mesh.points) places.insert(places.end(), p.data(), p.data() + 3);
  for (const std::int64_t id : part.cell_ids) numbers.push_back(static_cast<index_t>(id));
  write_pvtu(folder / "mesh.pvtu", transport, {whole.mesh, part.vertex_ids, part.cell_ids, part.owners, whole.shared},
             {.cells = {{"number", numbers}}, .points = {{"x", places, 3}}});
  MeshReadNotes notes;
  const MixedMesh piece =
      read_vtu(folder / ("mesh_" + std::to_string(transport.rank()) + ".vtu"), {.arrays = FileArrays::read}, &notes);
  const auto values = [&](const std::string& name) {
    const auto at = std::find_if(notes.data.cells.begin(), notes.data.cells.end(),
                                 [&](const DataArray& a) { return a.name == name; });
    REQUIRE(at != notes.data.cells.end());
    return std::get<std::vector<double>>(at->values);
  };
  CHECK(values("number") == values("GlobalCellIds"));
  CHECK(values("number").size() == piece.n_cells());
  // Places as values are the places.
  const std::string bytes = read_file(folder / ("mesh_" + std::to_string(transport.rank()) + ".vtu"));
  const std::string_view points(reinterpret_cast<const char*>(piece.points.data()), 24 * piece.points.size());
  const std::size_t once = bytes.find(points);
  REQUIRE(once != bytes.npos);
  CHECK(bytes.find(points, once + 1) != bytes.npos);
}

TEST_CASE("pieces of an older mesh of the name go, and no other files", "[regression]") {
  const MpiTransport transport(MPI_COMM_WORLD);
  const SharedFolder folder(transport);
  const IndexedTetMesh mesh = test::kuhn_lattice(2);
  const auto ranks = test::dealings()[0].ranks(mesh, transport.n_ranks());
  const IndexedPart part = test::part_of(mesh, ranks, transport.rank());
  const Whole whole(part, mesh, ranks, transport.rank());
  const std::array<std::string, 4> others{"mesh_8.vtu", "a_mesh_7.vtu", "mesh_7.vtu.old", "mesh_07.vtu"};
  if (transport.rank() == 0) {
    std::ofstream(folder / "mesh.pvtu") << R"(<Piece Source="mesh_7.vtu"/><Piece Source="mesh_0.vtu"/>)"
                                        << R"(<Piece Source="a_mesh_7.vtu"/><Piece Source="mesh_7.vtu.old"/>)"
                                        << R"(<Piece Source="../mesh_8.vtu"/><Piece Source="mesh_07.vtu"/>)";
    for (const std::string& name : others) std::ofstream(folder / name) << "mine";
    std::ofstream(folder / "mesh_7.vtu") << "of an older mesh";
  }
  transport.agree();
  write_pvtu(folder / "mesh.pvtu", transport, {whole.mesh, part.vertex_ids, part.cell_ids, part.owners, whole.shared});
  transport.agree();
  CHECK_FALSE(std::filesystem::exists(folder / "mesh_7.vtu"));
  for (const std::string& name : others) CHECK(std::filesystem::exists(folder / name));
  CHECK(folder.n_files() == static_cast<std::size_t>(transport.n_ranks()) + 1 + others.size());
}
