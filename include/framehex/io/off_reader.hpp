// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/io/input_file.hpp"
#include "framehex/io/surface_soup.hpp"

namespace framehex {

/// Reads the polygons of an OFF file in text, with or without normals, colours and texture coordinates.
///
/// @param name   of the file, for errors.
/// @param bytes  what it holds.
/// @return coordinates in double precision, no patches.
/// @throws io_error naming file and line; invalid_connectivity naming the polygon.
/// @par Complexity   O(n).
inline SurfaceSoup read_off(const std::string& name, std::string_view bytes) {
  detail::Cursor in(name, bytes, '#');
  const std::string_view magic = in.word();
  // ST, C and N before it tell what follows a vertex's coordinates on its line.
  if (magic != "OFF" && magic != "COFF" && magic != "NOFF" && magic != "CNOFF" && magic != "STOFF" &&
      magic != "STCOFF" && magic != "STNOFF" && magic != "STCNOFF")
    in.fail("not an OFF file of a surface in space");
  if (in.peek_word() == "BINARY") in.fail("binary OFF files are not read");
  const std::size_t n_points = in.count("the number of vertices", 6), n_polygons = in.count("the number of faces", 2);
  in.line();  // the number of edges, which is often wrong

  detail::SoupBuilder builder(name);
  const index_t patch = builder.patch("");
  for (std::size_t v = 0; v < n_points; ++v) {
    const auto x = in.number<double>("a coordinate"), y = in.number<double>("a coordinate"),
               z = in.number<double>("a coordinate");
    builder.add_point(x, y, z);
    in.line();
  }
  std::vector<std::int64_t> corners;
  for (std::size_t p = 0; p < n_polygons; ++p) {
    corners.resize(in.count("the number of a face's vertices", 2));
    for (std::int64_t& v : corners) v = in.number<std::int64_t>("a vertex");
    builder.add_polygon(corners, patch);
    in.line();  // a colour
  }
  return builder.finish();
}

}  // namespace framehex
