// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/io/input_file.hpp"
#include "framehex/io/mesh_builder.hpp"

namespace framehex {

namespace detail {

/// A section of elements of a MEDIT file.
struct MeditSection {
  std::string_view keyword;
  int dimension;
  CellKind kind;
  std::size_t n_corners;
};

inline constexpr std::array<MeditSection, 8> medit_sections{{{"Edges", 1, {}, 2},
                                                             {"Triangles", 2, {}, 3},
                                                             {"Quadrilaterals", 2, {}, 4},
                                                             {"Tetrahedra", 3, CellKind::tetrahedron, 4},
                                                             {"Pyramids", 3, CellKind::pyramid, 5},
                                                             {"Prisms", 3, CellKind::prism, 6},
                                                             {"Hexahedra", 3, CellKind::hexahedron, 8},
                                                             {"Hexaedra", 3, CellKind::hexahedron, 8}}};

inline bool is_number(std::string_view word) {
  return !word.empty() && (word[0] == '-' || word[0] == '+' || word[0] == '.' || (word[0] >= '0' && word[0] <= '9'));
}

}  // namespace detail

/// Reads a mesh in MEDIT's text format.
///
/// @return cells, faces and edges with their references less one as labels (by rank where one is not positive). Other
///         sections (corners, ridges, normals...) are passed over.
/// @throws io_error naming file and line; invalid_connectivity (a vertex out of range) and invalid_coordinate (NaN,
///         infinity), both naming the file as well. Cells are numbered from 0 over the whole file.
/// @par Complexity   O(n).
inline MixedMesh read_medit(const std::filesystem::path& path) {
  const std::string bytes = read_file(path);
  detail::Cursor in(path.string(), bytes, '#');
  detail::MeshBuilder builder(path.string(), 1);
  if (in.word() != "MeshVersionFormatted") in.fail("not a MEDIT text file");
  in.number<int>("the version");

  std::size_t number = 0;
  while (!in.at_end()) {
    const std::string_view keyword = in.word();
    if (keyword == "End") break;
    const auto* const section = std::find_if(detail::medit_sections.begin(), detail::medit_sections.end(),
                                             [&](const auto& s) { return s.keyword == keyword; });
    if (keyword == "Dimension") {
      if (in.number<int>("the dimension") != 3) in.fail("not a mesh in space");
    } else if (keyword == "Vertices") {
      const std::size_t n = in.count("the number of vertices", 8);
      for (std::size_t i = 0; i < n; ++i) {
        const auto x = in.number<double>("a coordinate"), y = in.number<double>("a coordinate"),
                   z = in.number<double>("a coordinate");
        builder.add_point(x, y, z);
        in.number<std::int64_t>("a reference");
      }
    } else if (section != detail::medit_sections.end()) {
      const std::size_t n = in.count("the number of elements", 2 * section->n_corners);
      std::array<std::int64_t, 8> corners{};
      for (std::size_t i = 0; i < n; ++i, ++number) {
        for (std::size_t j = 0; j < section->n_corners; ++j) {
          const auto vertex = in.number<std::int64_t>("a vertex");
          corners[j] = vertex > 0 ? vertex - 1 : -1;  // the least integer has none below it
        }
        const auto label = in.number<std::int64_t>("a reference");
        builder.add(section->dimension, section->kind, std::span(corners).first(section->n_corners), label, number);
      }
    } else if (detail::is_number(keyword)) {
      in.fail("a keyword should stand where \"" + detail::Cursor::printable(keyword) + "\" does");
    } else {
      while (detail::is_number(in.peek_word())) in.word();
    }
  }
  return builder.finish();
}

}  // namespace framehex
