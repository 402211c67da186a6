// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/adapters/mesh_reader.hpp"
#include "framehex/distributed/detail/file_dealer.hpp"
#include "framehex/distributed/detail/piece_files.hpp"
#include "framehex/distributed/run_collectively.hpp"
#include "framehex/io/detail/mapped_file.hpp"

namespace framehex::distributed {

namespace detail {

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
inline LabelledPart deal_out(const MpiTransport& transport, const std::filesystem::path& path,
                             const std::string& region_array) {
  DealtShare share;
  if (transport.rank() == 0)
    deal_file(transport, path, {.volume = Volume::required, .regions = region_array}, share);
  else
    receive_dealt(transport, share);
  return part_of_share(transport, path.string(), std::move(share));
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
/// @param region_array  array by cell that holds the labels, of .vtu (and the pieces of .pvtu) and .vtk; empty: one of the
///                      usual names.
/// @return vertices without a cell are left out. Regions are numbered as `read_mesh` numbers those of one file: over all
///         pieces together.
/// @throws remote_error  what `read_mesh` throws on one rank; a cell that is no tetrahedron; no cell at all; pieces whose
///         labels lie in different arrays; a partition of Gmsh's that has no file; a ghost that no piece has as its own.
/// @par Determinism  Numbers depend on the files, not on the number of ranks.
inline ReadPart read_parts(const std::filesystem::path& path, const MpiTransport& transport,
                           const std::string& region_array = {}) {
  return run_collectively(transport, [&] {
    const std::vector<std::filesystem::path> files = detail::piece_files(path);
    detail::LabelledPart read = files.empty() ? detail::deal_out(transport, path, region_array)
                                              : detail::read_pieces(transport, files, region_array);
    if (!detail::any_rank(transport, !read.part.mesh.tets.empty()))
      throw io_error(path.string() + ": holds no tetrahedron");
    return detail::with_regions(transport, std::move(read), detail::first_label(path));
  });
}

}  // namespace framehex::distributed
