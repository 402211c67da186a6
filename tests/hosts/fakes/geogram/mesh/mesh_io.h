// SPDX-License-Identifier: BSL-1.0
#pragma once

#include <geogram/mesh/mesh.h>

#include <string>

namespace GEO {
struct MeshIOFlags {};
bool mesh_load(const std::string& filename, Mesh& mesh, const MeshIOFlags& flags = MeshIOFlags());
bool mesh_save(const Mesh& mesh, const std::string& filename, const MeshIOFlags& flags = MeshIOFlags());
}  // namespace GEO
