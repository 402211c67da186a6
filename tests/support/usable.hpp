// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/adapters/mesh_reader.hpp"
#include "framehex/io/outline_reader.hpp"

namespace framehex::test {

/// Does everything in a mesh that came from a file refer to something, and is every point somewhere?
inline bool is_usable(const MixedMesh& mesh) {
  const auto fits = [&](index_t v) { return v < mesh.points.size(); };
  bool all = std::ranges::all_of(mesh.cells.values, fits);
  for (const LabelledFace& face : mesh.faces)
    for (std::size_t i = 0; i < face.size(); ++i) all = all && fits(face.vertices[i]);
  for (const LabelledEdge& edge : mesh.edges) all = all && fits(edge.vertices[0]) && fits(edge.vertices[1]);
  return all && (mesh.regions.empty() || mesh.regions.size() == mesh.n_cells()) &&
         std::ranges::all_of(mesh.points, [](const Vector3& p) { return p.allFinite(); });
}

inline bool is_usable(const SoupSurface& soup) {
  const IndexedTriangleMesh& surface = soup.surface;
  bool all = soup.patches.empty() || soup.patches.size() == surface.triangles.size();
  for (const auto& t : surface.triangles)
    for (const index_t v : t) all = all && v < surface.points.size();
  return all && std::ranges::all_of(surface.points, [](const Vector3& p) { return p.allFinite(); });
}

inline bool is_usable(const PlanarOutline& outline) {
  return std::ranges::all_of(outline.points, [](const auto& p) { return p.allFinite(); });
}

/// Reads a file by the reader that its extension tells; whether what was read can be used.
/// @throws what the reader throws.
inline bool reads_something_usable(const std::filesystem::path& file) {
  const std::string extension = file.extension().string();
  if (extension == ".txt") return is_usable(read_outline(file));
  if (extension == ".stl" || extension == ".obj" || extension == ".off" || extension == ".ply")
    return is_usable(read_surface(file));
  return is_usable(read_mesh(file, {.volume = Volume::optional}));
}

}  // namespace framehex::test
