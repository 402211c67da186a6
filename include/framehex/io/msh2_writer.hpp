// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/io/msh_writer.hpp"
#include "framehex/io/text_buffer.hpp"

namespace framehex {

/// Writes a mesh in Gmsh's MSH format, version 2.2, text: for the many programs that read no later one.
///
/// @param path  the file; appears whole or not at all (`OutputFile`).
/// @param mesh  labels are entities and physical groups as in `write_msh`. An element has one group in this version:
///              the first of `mesh.groups` that holds its label.
/// @param midside  nodes on its edges, when not null: elements are quadratic.
/// @throws io_error naming the file.
/// @par Complexity   O(n log labels).
/// @par Determinism  Same mesh, same bytes.
/// @par Source       Gmsh reference manual, MSH file format version 2.
inline void write_msh2(const std::filesystem::path& path, const MixedMesh& mesh,
                       const MidsideNodes* midside = nullptr) {
  const detail::MshBlocks blocks(mesh, midside);
  const std::vector<Vector3> points = detail::points_with(mesh, midside);
  const detail::MshGroups groups(mesh, blocks.entity_list());
  OutputFile file(path);
  detail::TextBuffer text(file);
  text << "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n" << groups.names() << "$Nodes\n" << points.size() << "\n";
  for (std::size_t v = 0; v < points.size(); ++v) {
    const Vector3& p = points[v];
    text << v + 1 << " " << p.x() << " " << p.y() << " " << p.z() << "\n";
  }
  text << "$EndNodes\n$Elements\n" << blocks.n_elements << "\n";
  std::size_t tag = 0;
  for (const auto& [key, rows] : blocks.blocks) {
    const int group = groups.tags({key.dimension, key.label}).front();
    for (std::size_t row = 0; row < rows.size(); ++row) {
      text << ++tag << " " << key.type << " 2 " << group << " " << detail::msh_tag(key.label);
      for (const index_t v : rows[row]) text << " " << std::size_t{v} + 1;
      text << "\n";
    }
  }
  text << "$EndElements\n";
  text.flush();
  file.commit();
}

}  // namespace framehex
