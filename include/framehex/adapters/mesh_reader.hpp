// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/adapters/vtu_reader.hpp"
#include "framehex/io/legacy_vtk_reader.hpp"
#include "framehex/io/medit_reader.hpp"
#include "framehex/io/mesh_writer.hpp"
#include "framehex/io/msh_reader.hpp"
#include "framehex/io/surface_reader.hpp"

namespace framehex {

namespace detail {

/// @throws io_error  for a format that is not read, with those that are.
inline MeshFormat read_mesh_format(const std::filesystem::path& path) {
  const std::string known = "(meshes are read from .vtu .vtk .msh .mesh .meshb)";
  const std::string extension = lower_text(path.extension().string());
  for (const char* const surface : {".stl", ".obj", ".off", ".ply"})
    if (extension == surface) throw io_error(path.string() + ": is a surface, not a mesh " + known);
  const std::optional<MeshFormat> format = known_mesh_format(path);
  if (!format) throw io_error(path.string() + ": unknown extension of a mesh " + known);
  if (format == MeshFormat::inp || format == MeshFormat::polymesh || format == MeshFormat::html)
    throw io_error(path.string() + ": is written but not read " + known);
  return *format;
}

/// @throws io_error  when an array is wanted of a format that has none.
inline void check_has_arrays(const std::filesystem::path& path, MeshFormat format, const MeshReadOptions& options) {
  if (format != MeshFormat::vtk && format != MeshFormat::vtu && !options.regions.empty())
    throw io_error(path.string() + ": has no arrays by cell; regions are its physical groups or references");
}

}  // namespace detail

/// Reads a volume mesh in the format that the extension tells: .vtu .vtk .msh .mesh .meshb. Needs pugixml, zlib and
/// liblzma.
///
/// @param options  which array by cell holds the labels, for .vtu and .vtk only; whether there have to be volume cells.
/// @param notes    what else was found, when not null; the arrays that `options` asks for, of .vtu, .vtk and .msh.
/// @throws io_error, invalid_connectivity, invalid_coordinate as the four readers do; io_error for another extension, and
///         for an array wanted of a format that has none.
inline MixedMesh read_mesh(const std::filesystem::path& path, const MeshReadOptions& options = {},
                           MeshReadNotes* notes = nullptr) {
  const MeshFormat format = detail::read_mesh_format(path);
  detail::check_has_arrays(path, format, options);
  if (format == MeshFormat::vtk) return read_legacy_vtk(path, options, notes);
  if (format == MeshFormat::vtu) return read_vtu(path, options, notes);
  if (format != MeshFormat::msh) return read_medit(path, options.volume);
  return read_msh(path, options.volume, notes && options.arrays == FileArrays::read ? &notes->data : nullptr);
}

/// Reads a surface in any format there is: those of `read_surface_soup`, and the triangles and quadrilaterals of a
/// .vtu .vtk .msh .mesh .meshb, whose labels bound patches.
///
/// @param options  which array by cell holds the labels, for .vtu and .vtk.
/// @return patches are called as the file calls their labels, or patch_0, patch_1...
/// @throws as the readers do; io_error for a file that holds no faces.
/// @par Complexity   O(n).
inline SurfaceSoup read_any_surface_soup(const std::filesystem::path& path, const MeshReadOptions& options = {},
                                         MeshReadNotes* notes = nullptr) {
  const std::string extension = detail::lower_text(path.extension().string());
  constexpr std::array<std::string_view, 5> of_meshes{".vtu", ".vtk", ".msh", ".mesh", ".meshb"};
  if (std::find(of_meshes.begin(), of_meshes.end(), extension) == of_meshes.end()) return read_surface_soup(path);
  const MixedMesh mesh = read_mesh(path, {.volume = Volume::optional, .regions = options.regions}, notes);
  detail::SoupBuilder soup(path.string());
  for (const Vector3& p : mesh.points) soup.add_point(p.x(), p.y(), p.z());
  for (const LabelledFace& face : mesh.faces) {
    std::string name = "patch_" + std::to_string(face.label);
    for (const LabelGroup& group : mesh.groups)
      if (group.dimension == 2 && std::binary_search(group.labels.begin(), group.labels.end(), face.label))
        name = group.name;
    std::array<std::int64_t, 4> corners{};
    std::copy_n(face.vertices.begin(), face.size(), corners.begin());
    soup.add_polygon(std::span(corners).first(face.size()), soup.patch(name));
  }
  return soup.finish();
}

/// `read_surface` for any format there is; see `read_any_surface_soup`.
inline SoupSurface read_any_surface(const std::filesystem::path& path, const MeshReadOptions& options = {},
                                    MeshReadNotes* notes = nullptr) {
  return detail::with_file_name(path, [&] { return surface_of_soup(read_any_surface_soup(path, options, notes)); });
}

/// `read_any_surface` after `repair_soup`; see `read_surface_repaired`.
inline SoupSurface read_any_surface_repaired(const std::filesystem::path& path, double largest_tolerance,
                                             SoupRepair& repair, const MeshReadOptions& options = {},
                                             MeshReadNotes* notes = nullptr,
                                             TouchingFaces touching = TouchingFaces::opened) {
  return detail::with_file_name(path, [&] {
    SurfaceSoup soup = read_any_surface_soup(path, options, notes);
    repair = repair_soup(soup, largest_tolerance, touching);
    return surface_of_soup(soup);
  });
}

}  // namespace framehex
