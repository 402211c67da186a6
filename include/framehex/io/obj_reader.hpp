// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/io/input_file.hpp"
#include "framehex/io/surface_soup.hpp"

namespace framehex {

namespace detail {

/// The vertex that a word `v`, `v/t`, `v//n` or `v/t/n` means: numbers count from 1, negative ones from the last point backwards.
inline std::int64_t obj_vertex(const Cursor& in, std::string_view word, std::size_t n_points) {
  const std::string_view digits = word.substr(0, word.find('/'));
  std::int64_t v = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), v);
  if (digits.empty() || end != digits.data() + digits.size() || error != std::errc{} || v == 0)
    in.fail("a vertex should stand where \"" + Cursor::printable(word) + "\" does");
  return v > 0 ? v - 1 : static_cast<std::int64_t>(n_points) + v;
}

class ObjReader {
public:
  ObjReader(const std::string& name, std::string_view bytes) : in_(name, bytes), builder_(name) {}

  SurfaceSoup read() {
    while (!in_.at_end()) {
      const std::string_view keyword = in_.word();
      if (keyword == "v")
        read_point();
      else if (keyword == "f")
        read_polygon();
      else if (keyword == "g" || keyword == "o")
        set_name(group_);
      else if (keyword == "usemtl")
        set_name(material_);
      else
        in_.line();  // normals, textures, lines, comments
    }
    return builder_.finish();
  }

private:
  void read_point() {
    const auto x = in_.number<double>("a coordinate"), y = in_.number<double>("a coordinate"),
               z = in_.number<double>("a coordinate");
    builder_.add_point(x, y, z);
    in_.line();  // a weight or a colour
  }

  void set_name(std::string& name) {
    name = trimmed(in_.line());
    patch_ = no_index;
  }

  /// Corners up to the end of the line, which a backslash continues.
  void read_polygon() {
    corners_.clear();
    for (bool goes_on = true; goes_on;) {
      goes_on = false;
      for (Cursor line = in_.rest_of_line(); !line.at_end();) {
        std::string_view word = line.word();
        goes_on = word.ends_with('\\');
        if (goes_on) word.remove_suffix(1);
        if (!word.empty()) corners_.push_back(obj_vertex(line, word, builder_.n_points()));
      }
    }
    if (patch_ == no_index) patch_ = builder_.patch(patch_name());
    builder_.add_polygon(corners_, patch_);
  }

  std::string patch_name() const {
    if (group_.empty() && material_.empty()) return "default";
    return group_.empty() || material_.empty() ? group_ + material_ : group_ + ":" + material_;
  }

  Cursor in_;
  SoupBuilder builder_;
  std::string group_, material_;
  index_t patch_ = no_index;  // of group and material; none yet where they changed
  std::vector<std::int64_t> corners_;
};

}  // namespace detail

/// Reads the polygons of a Wavefront OBJ file.
///
/// @param name   of the file, for errors.
/// @param bytes  what it holds.
/// @return coordinates in double precision; groups (or objects) and materials are patches, named after the group, the
///         material, or "group:material".
/// @throws io_error naming file and line; invalid_connectivity naming the polygon.
/// @par Complexity   O(n).
inline SurfaceSoup read_obj(const std::string& name, std::string_view bytes) {
  return detail::ObjReader(name, bytes).read();
}

}  // namespace framehex
