// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/adapters/vtu_reader.hpp"
#include "framehex/io/legacy_vtk_reader.hpp"
#include "framehex/io/medit_reader.hpp"
#include "framehex/io/mesh_writer.hpp"
#include "framehex/io/msh_reader.hpp"

namespace framehex {

/// Reads a volume mesh in the format that the extension tells: .vtu .vtk .msh .mesh .meshb. Needs pugixml, zlib and
/// liblzma.
///
/// @param options  which array by cell holds the labels, for .vtu and .vtk only; whether there have to be volume cells.
/// @param notes    what else was found, when not null.
/// @throws io_error, invalid_connectivity, invalid_coordinate as the four readers do; io_error for another extension, and
///         for an array wanted of a format that has none.
inline MixedMesh read_mesh(const std::filesystem::path& path, const MeshReadOptions& options = {},
                           MeshReadNotes* notes = nullptr) {
  const MeshFormat format = mesh_format(path);
  if (format == MeshFormat::vtk) return read_legacy_vtk(path, options, notes);
  if (format == MeshFormat::inp || format == MeshFormat::polymesh || format == MeshFormat::html)
    throw io_error(path.string() + ": is written but not read");
  if (format == MeshFormat::vtu) return read_vtu(path, options, notes);
  if (!options.regions.empty())
    throw io_error(path.string() + ": has no arrays by cell; regions are its physical groups or references");
  return format == MeshFormat::msh ? read_msh(path, options.volume) : read_medit(path, options.volume);
}

}  // namespace framehex
