// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/assembly/detail/cell_complex.hpp"
#include "framehex/assembly/options.hpp"
#include "framehex/mesh/mixed_faces.hpp"

namespace framehex::detail {

/// The living cells as a mixed mesh: hexahedra, prisms, pyramids, tetrahedra, each in the order in which they were
/// made.
struct MixedExport {
  MixedMesh mesh;
  std::vector<index_t> vertex_of;  ///< vertex of the mesh -> of the complex
  std::vector<index_t> cell_of;    ///< cell of the mesh -> of the complex
};

inline MixedExport export_cells(const CellComplex& complex) {
  MixedExport result;
  std::vector<index_t> number(complex.n_vertices(), no_index);
  for (index_t v = 0; v < complex.n_vertices(); ++v) {
    if (complex.unused(v)) continue;
    number[v] = static_cast<index_t>(result.vertex_of.size());
    result.vertex_of.push_back(v);
    result.mesh.points.push_back(complex.points[v]);
  }
  std::array<index_t, 8> corners{};
  for (auto kind = all_cell_kinds.rbegin(); kind != all_cell_kinds.rend(); ++kind)
    for (index_t id = 0; id < complex.cells.size(); ++id) {
      const CellComplex::Cell& cell = complex.cells[id];
      if (!cell.alive || cell.kind != *kind) continue;
      const auto n = static_cast<std::size_t>(n_corners(cell.kind));
      for (std::size_t i = 0; i < n; ++i) corners[i] = number[cell.corners[i]];
      result.mesh.add(cell.kind, {corners.data(), n});
      result.mesh.regions.push_back(cell.region);
      result.cell_of.push_back(id);
    }
  return result;
}

/// Carries the labelled edges over: they were protected, so that all are still there.
inline void label_edges(MixedMesh& mesh, std::span<const index_t> vertex_of, std::span<const LabelledEdge> labels) {
  std::unordered_map<index_t, index_t> number;
  for (const LabelledEdge& edge : labels)
    for (const index_t v : edge.vertices) number[v] = no_index;
  for (index_t i = 0; i < vertex_of.size(); ++i)
    if (const auto found = number.find(vertex_of[i]); found != number.end()) found->second = i;
  for (const LabelledEdge& edge : labels) {
    const index_t v = number[edge.vertices[0]], w = number[edge.vertices[1]];
    if (v != no_index && w != no_index) mesh.edges.push_back({{v, w}, edge.label});
  }
}

/// Labels the boundary faces, and the inner faces that lie on labelled triangles, of a mixed mesh.
///
/// A quadrilateral takes the label of the triangles that it replaced; a boundary face without one has label 0.
inline void label_faces(MixedMesh& mesh, std::span<const index_t> vertex_of, std::span<const LabelledFace> labels,
                        const std::vector<OpenInterface>& open) {
  std::unordered_map<FaceKey, const LabelledFace*, FaceKeyHash> label_of;
  for (const LabelledFace& face : labels) label_of.emplace(face_key(face.vertices), &face);
  std::unordered_set<FaceKey, FaceKeyHash> skip;
  for (const OpenInterface& interface : open) {
    const auto& q = interface.quadrilateral;
    skip.insert(face_key(q));
    for (std::size_t i = 0; i < 4; ++i) skip.insert(face_key({q[i], q[(i + 1) % 4], q[(i + 2) % 4], no_index}));
  }
  const auto find = [&](const CellFace& face) -> const LabelledFace* {
    std::array<index_t, 4> v = face.vertices;
    for (index_t& x : v)
      if (x != no_index) x = vertex_of[x];
    if (face.size() == 3) {
      const auto found = label_of.find(face_key(v));
      return found == label_of.end() ? nullptr : found->second;
    }
    for (std::size_t i = 0; i < 4; ++i) {
      const auto found = label_of.find(face_key({v[i], v[(i + 1) % 4], v[(i + 2) % 4], no_index}));
      if (found != label_of.end()) return found->second;
    }
    return nullptr;
  };
  // An inner face is written as its label is oriented.
  const auto same_orientation = [&](const CellFace& face, const LabelledFace& label) {
    const std::size_t n = face.size();
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t k = 0; k < 3; ++k)
        if (vertex_of[face.vertices[i]] == label.vertices[k]) {
          const index_t next = vertex_of[face.vertices[(i + 1) % n]];
          if (next == label.vertices[(k + 1) % 3]) return true;
          if (next == label.vertices[(k + 2) % 3]) return false;
        }
    return true;
  };
  const FaceTable table = make_face_table(mesh);
  for (std::size_t i = 0; i < table.n_groups(); ++i) {
    const auto uses = table.group(i);
    const LabelledFace* const label = find(uses[0]);
    if (uses.size() == 1) {
      if (!label && skip.contains(face_key(uses[0].vertices))) continue;
      mesh.faces.push_back({uses[0].vertices, label ? label->label : 0});
    } else if (label) {
      mesh.faces.push_back({uses[same_orientation(uses[0], *label) ? 0 : 1].vertices, label->label});
    }
  }
}

}  // namespace framehex::detail
