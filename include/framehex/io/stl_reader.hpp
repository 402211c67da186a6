// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/io/input_file.hpp"
#include "framehex/io/surface_soup.hpp"

namespace framehex {

namespace detail {

constexpr std::size_t stl_header_size = 84, stl_triangle_size = 50;

/// Number of triangles that the header of a binary file tells. @pre the header is there.
inline std::size_t stl_count(const std::string& name, std::string_view bytes) {
  return Cursor(name, bytes.substr(stl_header_size - 4)).raw<std::uint32_t>(std::endian::little);
}

/// Headers of binary files may begin with "solid" as well: the size decides where it fits, else a facet in text.
inline bool is_text_stl(const std::string& name, std::string_view bytes) {
  Cursor in(name, bytes);
  if (!same_word(in.word(), "solid")) return false;
  if (bytes.size() >= stl_header_size && bytes.size() == stl_header_size + stl_triangle_size * stl_count(name, bytes))
    return false;
  in.line();
  const std::string_view word = in.word();
  return same_word(word, "facet") || same_word(word, "endsolid");
}

class TextStlReader {
public:
  TextStlReader(const std::string& name, std::string_view bytes) : in_(name, bytes), builder_(name) {}

  SurfaceSoup read() {
    for (std::size_t n_solids = 0; !in_.at_end(); ++n_solids) read_solid(n_solids);
    return builder_.finish();
  }

private:
  void expect(std::string_view keyword) {
    const std::string_view word = in_.word();
    if (!same_word(word, keyword))
      in_.fail(std::string(keyword) + " should stand where \"" + Cursor::printable(word) + "\" does");
  }

  void read_solid(std::size_t n_solids) {
    expect("solid");
    const std::string_view name = trimmed(in_.line());
    const index_t patch = builder_.patch(name.empty() ? "solid_" + std::to_string(n_solids) : std::string(name));
    for (;;) {
      const std::string_view word = in_.word();
      if (same_word(word, "facet"))
        read_facet(patch);
      else if (same_word(word, "endsolid"))
        break;
      else
        in_.fail(word.empty() ? "the file ends within a solid"
                              : "facet or endsolid should stand where \"" + Cursor::printable(word) + "\" does");
    }
    in_.line();
  }

  /// Normals are not used: they may be zero, not finite, or left out.
  void read_facet(index_t patch) {
    std::string_view word = in_.word();
    for (int i = 0; i < 4 && !same_word(word, "outer"); ++i) word = in_.word();
    if (!same_word(word, "outer")) in_.fail("outer loop should stand here");
    expect("loop");
    std::vector<std::int64_t>& corners = corners_;
    corners.clear();
    for (word = in_.word(); same_word(word, "vertex"); word = in_.word()) {
      corners.push_back(static_cast<std::int64_t>(builder_.n_points()));
      const auto x = in_.number<double>("a coordinate"), y = in_.number<double>("a coordinate"),
                 z = in_.number<double>("a coordinate");
      builder_.add_point(x, y, z);
    }
    if (!same_word(word, "endloop")) in_.fail("vertex or endloop should stand here");
    if (corners.size() < 3) in_.fail("a facet has " + std::to_string(corners.size()) + " vertices");
    expect("endfacet");
    builder_.add_polygon(corners, patch);
  }

  Cursor in_;
  SoupBuilder builder_;
  std::vector<std::int64_t> corners_;
};

inline SurfaceSoup read_binary_stl(const std::string& name, std::string_view bytes) {
  if (bytes.size() < stl_header_size) throw io_error(name + ": cannot be understood: neither text nor binary STL");
  const std::size_t n = stl_count(name, bytes);
  if (n > (bytes.size() - stl_header_size) / stl_triangle_size)
    throw io_error(name + ": cannot be understood: its header tells " + std::to_string(n) +
                   " triangles, it has room for " +
                   std::to_string((bytes.size() - stl_header_size) / stl_triangle_size) +
                   " (a binary STL file cut short, or no STL file)");
  SoupBuilder builder(name);
  const index_t patch = builder.patch("");
  for (std::size_t t = 0; t < n; ++t) {
    Cursor in(name, bytes.substr(stl_header_size + t * stl_triangle_size, stl_triangle_size));
    std::array<float, 12> x{};  // the normal first
    in.raw(x.data(), x.size(), std::endian::little);
    const auto first = static_cast<std::int64_t>(builder.n_points());
    for (std::size_t i = 3; i < 12; i += 3) builder.add_point(x[i], x[i + 1], x[i + 2]);
    builder.add_polygon(std::array{first, first + 1, first + 2}, patch);
  }
  SurfaceSoup soup = builder.finish();
  soup.rounding = float_rounding(soup.mesh.points);
  return soup;
}

}  // namespace detail

/// Reads the triangles of an STL file, text (in upper or lower case, coordinates in double precision) or binary.
///
/// @param name   of the file, for errors.
/// @param bytes  what it holds. Bytes after the last triangle of a binary file are passed over.
/// @return three points of its own for each triangle; the solids of a text file are patches with their names.
/// @throws io_error naming file and line.
/// @par Complexity   O(n).
inline SurfaceSoup read_stl(const std::string& name, std::string_view bytes) {
  return detail::is_text_stl(name, bytes) ? detail::TextStlReader(name, bytes).read()
                                          : detail::read_binary_stl(name, bytes);
}

}  // namespace framehex
