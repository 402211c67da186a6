// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/io/input_file.hpp"
#include "framehex/io/medit_writer.hpp"
#include "framehex/io/msh_writer.hpp"
#include "framehex/io/vtu_writer.hpp"

namespace framehex {

/// Formats of a volume mesh, told by a file's extension.
enum class MeshFormat { vtu, vtk, msh, medit };

/// @return the format that a file's extension (.vtu .vtk .msh .mesh .meshb, in any case) stands for.
/// @throws io_error  for any other.
inline MeshFormat mesh_format(const std::filesystem::path& path) {
  const std::string extension = detail::lower_text(path.extension().string());
  if (extension == ".vtu") return MeshFormat::vtu;
  if (extension == ".vtk") return MeshFormat::vtk;
  if (extension == ".msh") return MeshFormat::msh;
  if (extension == ".mesh" || extension == ".meshb") return MeshFormat::medit;
  throw io_error(path.string() + ": unknown extension of a mesh (known: .vtu .vtk .msh .mesh .meshb)");
}

/// Checks that a mesh can be written in the format that a file's extension asks for.
///
/// @throws io_error  for another extension than .vtu, .msh, .mesh.
inline MeshFormat written_mesh_format(const std::filesystem::path& path) {
  const MeshFormat format = mesh_format(path);
  if (format == MeshFormat::vtk) throw io_error(path.string() + ": .vtk is read but not written (write .vtu)");
  if (detail::lower_text(path.extension().string()) == ".meshb")
    throw io_error(path.string() + ": .meshb is read but not written (write .mesh)");
  return format;
}

/// Writes a mesh in the format that the extension asks for: .vtu, .msh (4.1) or .mesh (MEDIT).
///
/// @param data         arrays by cell and point; only .vtu holds them.
/// @param compression  of .vtu.
/// @throws invalid_option, io_error as the three writers do; io_error for another extension.
inline void write_mesh(const std::filesystem::path& path, const MixedMesh& mesh, const MeshData& data = {},
                       const VtuCompression& compression = {}) {
  switch (written_mesh_format(path)) {
    case MeshFormat::msh: return write_msh(path, mesh);
    case MeshFormat::medit: return write_medit(path, mesh);
    default: return write_vtu(path, mesh, data, compression);
  }
}

}  // namespace framehex
