// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/io/obj_reader.hpp"
#include "framehex/io/off_reader.hpp"
#include "framehex/io/ply_reader.hpp"
#include "framehex/io/soup_repair.hpp"
#include "framehex/io/stl_reader.hpp"

#include <string_view>

namespace framehex {

/// Reads the triangles of a file as they stand there: .stl .obj .off .ply, told by the extension in any case.
///
/// @throws io_error, invalid_connectivity as the four readers do; io_error for another extension.
inline SurfaceSoup read_surface_soup(const std::filesystem::path& path) {
  const std::string name = path.string();
  const std::string extension = detail::lower_text(path.extension().string());
  using Reader = SurfaceSoup (*)(const std::string&, std::string_view);
  const Reader reader = extension == ".stl"   ? &read_stl
                        : extension == ".obj" ? &read_obj
                        : extension == ".off" ? &read_off
                        : extension == ".ply" ? &read_ply
                                              : nullptr;
  if (!reader) throw io_error(name + ": unknown extension of a surface (known: .stl .obj .off .ply)");
  const std::string bytes = read_file(path);
  if (bytes.empty()) throw io_error(name + ": is empty");
  return reader(name, bytes);
}

namespace detail {

/// Coordinates that cannot be used are reported with the file, once.
template <class Job>
auto with_file_name(const std::filesystem::path& path, Job&& job) {
  try {
    return job();
  } catch (const invalid_coordinate& e) {
    if (std::string_view(e.what()).starts_with(path.string())) throw;
    throw invalid_coordinate(path.string() + ": " + e.what(), e.entity(), e.indices());
  }
}

}  // namespace detail

/// Reads a surface of triangles or polygons, which are cut into triangles: STL of both kinds, OBJ, OFF, PLY. Coordinates
/// keep every digit.
///
/// @param path  the file; its extension tells the format.
/// @return welded and oriented as `surface_of_soup` says, with the file's patches, their names and its polygons' numbers.
/// @throws io_error naming file and line; invalid_coordinate and invalid_connectivity, naming the file and the vertex or
///         polygon in its order.
/// @par Complexity   O(n log n).
inline SoupSurface read_surface(const std::filesystem::path& path) {
  return detail::with_file_name(path, [&] { return surface_of_soup(read_surface_soup(path)); });
}

/// `read_surface` after `repair_soup`.
///
/// @param largest_tolerance  the most that vertices are moved, by the diagonal of the surface's box.
/// @param repair             becomes what was done.
inline SoupSurface read_surface_repaired(const std::filesystem::path& path, double largest_tolerance,
                                         SoupRepair& repair) {
  return detail::with_file_name(path, [&] {
    SurfaceSoup soup = read_surface_soup(path);
    repair = repair_soup(soup, largest_tolerance);
    return surface_of_soup(soup);
  });
}

}  // namespace framehex
