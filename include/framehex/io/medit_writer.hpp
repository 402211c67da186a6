// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/io/label_limit.hpp"
#include "framehex/io/text_buffer.hpp"
#include "framehex/mesh/mixed_mesh.hpp"

#include <algorithm>

namespace framehex {

/// Writes a mesh in MEDIT's text format, for the mmg and FreeFem families of programs.
///
/// @param path  the file; appears whole or not at all (`OutputFile`).
/// @param mesh  labels of regions, faces and edges are written plus one, as references: 0 means "none" to most readers.
/// @throws io_error naming the file; for a label beyond 2^31 - 2 too.
/// @par Complexity   O(n).
/// @par Determinism  Same mesh, same bytes.
/// @par Source       P. Frey, MEDIT: an interactive mesh visualization software, INRIA RT-0253; with the keywords
///                   Prisms and Pyramids that mmg and Gmsh use.
inline void write_medit(const std::filesystem::path& path, const MixedMesh& mesh) {
  detail::check_labels_fit(path.string(), mesh);
  OutputFile file(path);
  detail::TextBuffer text(file);
  const auto section = [&](std::string_view keyword, std::size_t n) { text << "\n" << keyword << "\n" << n << "\n"; };
  const auto row = [&](std::span<const index_t> corners, index_t label) {
    for (const index_t v : corners) text << v + std::size_t{1} << " ";
    text << label + std::size_t{1} << "\n";
  };

  text << "MeshVersionFormatted 2\n\nDimension 3\n";
  section("Vertices", mesh.points.size());
  for (const Vector3& p : mesh.points) text << p.x() << " " << p.y() << " " << p.z() << " 0\n";

  if (!mesh.edges.empty()) section("Edges", mesh.edges.size());
  for (const LabelledEdge& edge : mesh.edges) row(edge.vertices, edge.label);

  for (const std::size_t size : {std::size_t{3}, std::size_t{4}}) {
    std::size_t n = 0;
    for (const LabelledFace& face : mesh.faces) n += face.size() == size;
    if (n == 0) continue;
    section(size == 3 ? "Triangles" : "Quadrilaterals", n);
    for (const LabelledFace& face : mesh.faces)
      if (face.size() == size) row(std::span(face.vertices).first(size), face.label);
  }

  constexpr std::array<std::string_view, 4> keywords{"Tetrahedra", "Pyramids", "Prisms", "Hexahedra"};
  for (const CellKind kind : all_cell_kinds) {
    const auto n = static_cast<std::size_t>(std::count(mesh.kinds.begin(), mesh.kinds.end(), kind));
    if (n == 0) continue;
    section(keywords[static_cast<std::size_t>(kind)], n);
    for (std::size_t c = 0; c < mesh.n_cells(); ++c)
      if (mesh.kinds[c] == kind) row(mesh.cells[c], mesh.regions.empty() ? 0 : mesh.regions[c]);
  }
  text << "\nEnd\n";
  text.flush();
  file.commit();
}

}  // namespace framehex
