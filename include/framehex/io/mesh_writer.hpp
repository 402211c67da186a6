// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/io/html_writer.hpp"
#include "framehex/io/inp_writer.hpp"
#include "framehex/io/input_file.hpp"
#include "framehex/io/medit_writer.hpp"
#include "framehex/io/msh2_writer.hpp"
#include "framehex/io/msh_writer.hpp"
#include "framehex/io/polymesh_writer.hpp"
#include "framehex/io/vtu_writer.hpp"

#include <optional>

namespace framehex {

/// Formats of a volume mesh, told by a file's extension or, for OpenFOAM, by a folder's name.
enum class MeshFormat { vtu, vtk, msh, medit, meshb, inp, polymesh, html };

/// Version of Gmsh's format.
enum class MshVersion { v4_1, v2_2 };

/// How a mesh is written, beyond what the file's name tells.
struct MeshWriteOptions {
  VtuCompression compression = {};               ///< of .vtu
  MshVersion msh = MshVersion::v4_1;             ///< of .msh
  InpPyramids pyramids = InpPyramids::own_type;  ///< of .inp
  const MidsideNodes* midside = nullptr;         ///< for quadratic elements in .vtu, .msh and .inp
};

/// @return the format that a file's extension (.vtu .vtk .msh .mesh .meshb .inp .html, in any case) or the name of a folder
///         (polyMesh) stands for; none for any other.
inline std::optional<MeshFormat> known_mesh_format(const std::filesystem::path& path) {
  const std::string extension = detail::lower_text(path.extension().string());
  if (extension == ".vtu") return MeshFormat::vtu;
  if (extension == ".vtk") return MeshFormat::vtk;
  if (extension == ".msh") return MeshFormat::msh;
  if (extension == ".mesh") return MeshFormat::medit;
  if (extension == ".meshb") return MeshFormat::meshb;
  if (extension == ".inp") return MeshFormat::inp;
  if (extension == ".html") return MeshFormat::html;
  if (path.filename() == "polyMesh") return MeshFormat::polymesh;
  return std::nullopt;
}

/// `known_mesh_format`. @throws io_error  where there is none.
inline MeshFormat mesh_format(const std::filesystem::path& path) {
  if (const std::optional<MeshFormat> format = known_mesh_format(path)) return *format;
  throw io_error(path.string() +
                 ": unknown extension of a mesh (known: .vtu .vtk .msh .mesh .meshb .inp .html, polyMesh)");
}

/// Checks that a mesh can be written in the format that a file's name asks for.
///
/// @throws io_error  for another than .vtu, .msh, .mesh, .inp, .html and polyMesh.
inline MeshFormat written_mesh_format(const std::filesystem::path& path) {
  const MeshFormat format = mesh_format(path);
  if (format == MeshFormat::vtk) throw io_error(path.string() + ": .vtk is read but not written (write .vtu)");
  if (format == MeshFormat::meshb) throw io_error(path.string() + ": .meshb is read but not written (write .mesh)");
  return format;
}

/// Whether a format is written with quadratic elements.
inline bool holds_quadratic(MeshFormat format) {
  return format == MeshFormat::vtu || format == MeshFormat::msh || format == MeshFormat::inp;
}

/// Writes a mesh in the format that the name asks for: .vtu, .msh, .mesh (MEDIT), .inp (Abaqus, CalculiX), .html (a page
/// that shows it) or a folder polyMesh (OpenFOAM).
///
/// @param data  arrays by cell and point; only .vtu holds them, and .html what it can show of them.
/// @throws invalid_option, nonmanifold, io_error as the writers do; io_error for another name, and
///         for nodes on edges in a format that is not written with them.
inline void write_mesh(const std::filesystem::path& path, const MixedMesh& mesh, const MeshData& data = {},
                       const MeshWriteOptions& options = {}) {
  const MeshFormat format = written_mesh_format(path);
  if (options.midside && !holds_quadratic(format))
    throw io_error(path.string() + ": quadratic elements are written to .vtu, .msh and .inp");
  switch (format) {
    case MeshFormat::msh:
      return options.msh == MshVersion::v2_2 ? write_msh2(path, mesh, options.midside)
                                             : write_msh(path, mesh, options.midside);
    case MeshFormat::medit: return write_medit(path, mesh);
    case MeshFormat::inp: return write_inp(path, mesh, options.pyramids, options.midside);
    case MeshFormat::polymesh: return write_polymesh(path, mesh);
    case MeshFormat::html: return write_html(path, mesh, data);
    default: return write_vtu(path, mesh, data, options.compression, options.midside);
  }
}

}  // namespace framehex
