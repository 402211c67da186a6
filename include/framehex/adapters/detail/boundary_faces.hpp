// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/errors.hpp"
#include "framehex/mesh/mixed_faces.hpp"

#include <vector>

namespace framehex::detail {

/// Adds the boundary of a mixed mesh, triangles and quadrilaterals, to a host's polygon mesh.
///
/// @param add_vertex  point -> handle.
/// @param add_face    handles of 3 or 4 corners, anticlockwise seen from outside -> false when the host refuses it.
/// @return vertex added -> vertex of `mesh`, in the order in which they were added.
/// @throws nonmanifold  with the cell whose face the host refuses.
template <class Vertex, class AddVertex, class AddFace>
std::vector<index_t> add_boundary_faces(const MixedMesh& mesh, AddVertex&& add_vertex, AddFace&& add_face) {
  std::vector<index_t> vertex_of;
  std::vector<index_t> number(mesh.points.size(), no_index);
  std::vector<Vertex> handles, corners;
  for (const CellFace& face : faces_used_once(mesh)) {
    corners.clear();
    for (std::size_t i = 0; i < face.size(); ++i) {
      const index_t v = face.vertices[i];
      if (number[v] == no_index) {
        number[v] = static_cast<index_t>(handles.size());
        handles.push_back(add_vertex(mesh.points[v]));
        vertex_of.push_back(v);
      }
      corners.push_back(handles[number[v]]);
    }
    if (!add_face(corners))
      throw nonmanifold(
          "the host refuses a face of cell " + std::to_string(face.cell) + ": the boundary touches itself there",
          Entity::cell, {face.cell});
  }
  return vertex_of;
}

}  // namespace framehex::detail
