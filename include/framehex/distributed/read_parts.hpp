// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/adapters/mesh_reader.hpp"
#include "framehex/distributed/detail/file_dealer.hpp"
#include "framehex/distributed/detail/part_numbering.hpp"
#include "framehex/distributed/run_collectively.hpp"
#include "framehex/io/detail/mapped_file.hpp"

namespace framehex::distributed {

/// A part of a mesh as it was read.
struct ReadPart {
  IndexedPart part;
  std::vector<index_t> regions;  ///< per cell; empty on all ranks when the mesh has one region
};

namespace detail {

/// The files that a mesh lies in: those that a .pvtu names, or NAME_1.msh, NAME_2.msh... where there is no NAME.msh.
/// @return empty: the file itself.
inline std::vector<std::filesystem::path> piece_files(const std::filesystem::path& path) {
  const std::string extension = framehex::detail::lower_text(path.extension().string());
  std::vector<std::filesystem::path> files;
  if (extension == ".pvtu") {
    pugi::xml_document document;
    const std::string bytes = read_file(path);
    if (!document.load_buffer(bytes.data(), bytes.size())) throw io_error(path.string() + ": not an XML file");
    const pugi::xml_node grid = document.child("VTKFile").child("PUnstructuredGrid");
    if (!grid) throw io_error(path.string() + ": holds no PUnstructuredGrid");
    for (const pugi::xml_node piece : grid.children("Piece"))
      files.push_back(path.parent_path() / piece.attribute("Source").value());
    if (files.empty()) throw io_error(path.string() + ": names no piece");
  }
  if (extension == ".msh" && !std::filesystem::exists(path)) {
    const auto numbered = [&](std::size_t i) {
      return path.parent_path() / (path.stem().string() + "_" + std::to_string(i) + path.extension().string());
    };
    for (std::size_t i = 1; std::filesystem::exists(numbered(i)); ++i) files.push_back(numbered(i));
  }
  return files;
}

/// A piece, without the cells that another has.
struct Piece {
  IndexedTetMesh mesh;
  VtuPieceArrays arrays;         ///< cells of the volume that stay
  std::vector<index_t> regions;  ///< per cell
};

/// The file of a partition of Gmsh's, its ghosts marked as in a .vtu.
inline MixedMesh read_msh_partition(const std::filesystem::path& path, std::int64_t partition, VtuPieceArrays& arrays) {
  MshPieceArrays read;
  MixedMesh mesh = read_msh_piece(path, read);
  std::vector<std::int64_t> ghosts;
  for (const MshPieceArrays::Ghost& ghost : read.ghosts)
    if (ghost.partition != partition) ghosts.push_back(ghost.element);
  std::sort(ghosts.begin(), ghosts.end());
  for (const std::int64_t cell : read.cell_numbers)
    arrays.ghosts.push_back(std::binary_search(ghosts.begin(), ghosts.end(), cell));
  arrays.point_numbers = std::move(read.point_numbers);
  return mesh;
}

/// @param number  of the file among the pieces, from 0.
inline Piece read_piece(const std::filesystem::path& path, std::size_t number) {
  Piece piece;
  const std::string extension = framehex::detail::lower_text(path.extension().string());
  MixedMesh mesh;
  if (extension == ".vtu")
    mesh = read_vtu_piece(path, piece.arrays);
  else if (extension == ".msh")
    mesh = read_msh_partition(path, static_cast<std::int64_t>(number) + 1, piece.arrays);
  else
    throw io_error(path.string() + ": pieces are .vtu or .msh");
  piece.mesh.points = mesh.points;
  std::vector<std::int64_t> numbers;
  for (std::size_t c = 0; c < mesh.n_cells(); ++c) {
    if (c < piece.arrays.ghosts.size() && piece.arrays.ghosts[c] != 0) continue;
    if (mesh.kinds[c] != CellKind::tetrahedron)
      throw invalid_connectivity(path.string() + ": cell " + std::to_string(c) + " is not a tetrahedron", Entity::cell,
                                 {c});
    const auto row = mesh.cells[c];
    piece.mesh.tets.push_back({row[0], row[1], row[2], row[3]});
    piece.regions.push_back(mesh.regions.empty() ? 0 : mesh.regions[c]);
    if (!piece.arrays.cell_numbers.empty()) numbers.push_back(piece.arrays.cell_numbers[c]);
  }
  piece.arrays.cell_numbers = std::move(numbers);
  return piece;
}

/// This rank's share of the files, in one part; numbers by the order of the files, where these tell none.
inline ReadPart read_pieces(const MpiTransport& transport, const std::vector<std::filesystem::path>& files) {
  const auto n = static_cast<std::size_t>(transport.n_ranks()), rank = static_cast<std::size_t>(transport.rank());
  const std::size_t first = rank * files.size() / n, last = (rank + 1) * files.size() / n;
  std::vector<Piece> pieces;
  std::vector<std::int64_t> counts(2 * files.size() + 2, 0);  // points and cells of each, files that tell their numbers
  for (std::size_t i = first; i < last; ++i) {
    const Piece& piece = pieces.emplace_back(read_piece(files[i], i));
    counts[2 * i] = static_cast<std::int64_t>(piece.mesh.points.size());
    counts[2 * i + 1] = static_cast<std::int64_t>(piece.mesh.tets.size());
    counts[2 * files.size()] += piece.arrays.point_numbers.size() == piece.mesh.points.size();
    counts[2 * files.size() + 1] += piece.arrays.cell_numbers.size() == piece.mesh.tets.size();
  }
  transport.sum(counts);
  const auto n_files = static_cast<std::int64_t>(files.size());
  const bool knows_points = counts[2 * files.size()] == n_files, knows_cells = counts[2 * files.size() + 1] == n_files;
  std::int64_t first_point = 0, first_cell = 0;
  ReadPart read;
  for (std::size_t i = 0; i < last; ++i) {
    if (i >= first) {
      const Piece& piece = pieces[i - first];
      const auto offset = static_cast<index_t>(read.part.mesh.points.size());
      for (std::size_t v = 0; v < piece.mesh.points.size(); ++v) {
        read.part.mesh.points.push_back(piece.mesh.points[v]);
        read.part.vertex_ids.push_back(knows_points ? piece.arrays.point_numbers[v]
                                                    : first_point + static_cast<std::int64_t>(v));
      }
      for (std::size_t c = 0; c < piece.mesh.tets.size(); ++c) {
        auto& tet = read.part.mesh.tets.emplace_back(piece.mesh.tets[c]);
        for (index_t& v : tet) v += offset;
        read.part.cell_ids.push_back(knows_cells ? piece.arrays.cell_numbers[c]
                                                 : first_cell + static_cast<std::int64_t>(c));
        read.regions.push_back(piece.regions[c]);
      }
    }
    first_point += counts[2 * i];
    first_cell += counts[2 * i + 1];
  }
  agree_on_vertices(transport, read.part, knows_points);
  join_vertices(read.part);
  // Owners again: some that had a vertex had it for cells of others only.
  agree_on_vertices(transport, read.part, true);
  return read;
}

/// What the first rank does to deal out a file: reads it from the beginning to the end, of which no more than a block is in
/// memory. Legacy .vtk, whose cells are told their types after all of them, is read whole.
inline void deal_file(const MpiTransport& transport, const std::filesystem::path& path, const MeshReadOptions& options,
                      DealtShare& own) {
  const MeshFormat format = framehex::detail::read_mesh_format(path);
  framehex::detail::check_has_arrays(path, format, options);
  const std::string name = path.string();
  if (format == MeshFormat::vtk) {
    const MixedMesh mesh = read_mesh(path, options);
    FileDealer<false> dealer(transport, name, own, {});
    for (const Vector3& p : mesh.points) dealer.add_point(p.x(), p.y(), p.z());
    for (std::size_t c = 0; c < mesh.n_cells(); ++c) {
      const std::vector<std::int64_t> corners(mesh.cells[c].begin(), mesh.cells[c].end());
      dealer.add(3, mesh.kinds[c], corners, mesh.regions.empty() ? 0 : mesh.regions[c], c);
    }
    return dealer.finish(options.volume);
  }
  const framehex::detail::MappedFile file(path);
  const auto release = [&] { file.release(); };
  if (format == MeshFormat::msh) {
    FileDealer<true> dealer(transport, name, own, release);
    return framehex::detail::MshReader(name, file.bytes(), dealer).read(options.volume);
  }
  FileDealer<false> dealer(transport, name, own, release);
  if (format != MeshFormat::vtu) return framehex::detail::read_medit_into(dealer, path, file.bytes(), options.volume);
  MeshReadNotes ignored;
  framehex::detail::VtuReader(name, file.bytes(), dealer, release).read(options, ignored);
}

/// A file that the first rank reads and deals out.
inline ReadPart deal_out(const MpiTransport& transport, const std::filesystem::path& path,
                         const std::string& region_array) {
  DealtShare share;
  if (transport.rank() == 0)
    deal_file(transport, path, {.volume = Volume::required, .regions = region_array}, share);
  else
    receive_dealt(transport, share);
  const std::string extension = framehex::detail::lower_text(path.extension().string());
  const std::int64_t first_label = extension == ".vtu" || extension == ".vtk" ? 0 : 1;
  ReadPart read;
  read.part = part_of_share(transport, path.string(), std::move(share), first_label, read.regions);
  return read;
}

}  // namespace detail

/// Reads a tetrahedral mesh into parts. Collective. Needs pugixml, zlib and liblzma.
///
/// The pieces of a .pvtu, or of NAME_1.msh, NAME_2.msh... (as Gmsh saves a partitioned NAME.msh, each partition in a file)
/// are read by the ranks one after the other; cells marked in the array vtkGhostType, or as Gmsh's ghosts, are left out.
/// Points of several pieces are one where their GlobalPointIds, or nodes' numbers, are, or, without these, where they lie
/// at one place to the last bit. Any other
/// file (`read_mesh`) is read by the first rank, which deals it out while it reads and holds a block of it at a time (a
/// legacy .vtk it holds whole).
///
/// @param region_array  array by cell that holds the labels, of a file that is dealt out; empty: one of the usual names.
/// @return vertices without a cell are left out.
/// @throws remote_error  what `read_mesh` throws on one rank; a cell that is no tetrahedron.
/// @par Determinism  Numbers depend on the files, not on the number of ranks.
inline ReadPart read_parts(const std::filesystem::path& path, const MpiTransport& transport,
                           const std::string& region_array = {}) {
  return run_collectively(transport, [&] {
    const std::vector<std::filesystem::path> files = detail::piece_files(path);
    ReadPart read =
        files.empty() ? detail::deal_out(transport, path, region_array) : detail::read_pieces(transport, files);
    const bool is_one = std::all_of(read.regions.begin(), read.regions.end(), [](index_t r) { return r == 0; });
    if (!detail::any_rank(transport, !is_one)) read.regions.clear();
    return read;
  });
}

}  // namespace framehex::distributed
