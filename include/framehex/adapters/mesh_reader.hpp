// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/adapters/vtu_reader.hpp"
#include "framehex/io/legacy_vtk_reader.hpp"
#include "framehex/io/medit_reader.hpp"
#include "framehex/io/mesh_writer.hpp"
#include "framehex/io/msh_reader.hpp"

namespace framehex {

/// Reads a volume mesh in the format that the extension tells: .vtu .vtk .msh .mesh. Needs pugixml and zlib.
///
/// @throws io_error, invalid_connectivity, invalid_coordinate as the four readers do; io_error for another extension.
inline MixedMesh read_mesh(const std::filesystem::path& path) {
  switch (mesh_format(path)) {
    case MeshFormat::vtk: return read_legacy_vtk(path);
    case MeshFormat::msh: return read_msh(path);
    case MeshFormat::medit: return read_medit(path);
    default: return read_vtu(path);
  }
}

}  // namespace framehex
