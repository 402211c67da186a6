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

/// @param n_kept  as many vertices come first, in their numbers, used or not.
inline MixedExport export_cells(const CellComplex& complex, std::size_t n_kept) {
  MixedExport result;
  std::vector<index_t> number(complex.n_vertices(), no_index);
  for (index_t v = 0; v < complex.n_vertices(); ++v) {
    if (v >= n_kept && complex.unused(v)) continue;
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
/// @param result_of  vertex of the labels -> vertex of the mesh.
inline void label_edges(MixedMesh& mesh, std::span<const index_t> result_of, std::span<const LabelledEdge> labels) {
  for (const LabelledEdge& edge : labels)
    mesh.edges.push_back({{result_of[edge.vertices[0]], result_of[edge.vertices[1]]}, edge.label});
}

/// Labels the boundary faces, and the inner faces that lie on labelled triangles, of a mixed mesh.
///
/// A quadrilateral takes the label of the triangles that it replaced; a boundary face without one has the label after the
/// greatest, 0 when there is none.
inline void label_faces(MixedMesh& mesh, std::span<const index_t> vertex_of, std::span<const LabelledFace> labels,
                        std::span<const OtherCut> other_cuts, const std::vector<OpenInterface>& open) {
  std::unordered_map<FaceKey, const LabelledFace*, FaceKeyHash> label_of;
  for (const LabelledFace& face : labels) label_of.emplace(face_key(face.vertices), &face);
  index_t unlabelled = 0;
  for (const LabelledFace& face : labels) unlabelled = std::max(unlabelled, face.label + 1);
  std::unordered_set<FaceKey, FaceKeyHash> skip;
  for (const OpenInterface& interface : open) {
    const auto& q = interface.quadrilateral;
    skip.insert(face_key(q));
    for (std::size_t i = 0; i < 4; ++i) skip.insert(face_key({q[i], q[(i + 1) % 4], q[(i + 2) % 4], no_index}));
  }
  const auto in_complex = [&](std::array<index_t, 4> v) {
    for (index_t& x : v)
      if (x != no_index) x = vertex_of[x];
    return v;
  };
  const auto find = [&](const CellFace& face) -> const LabelledFace* {
    const auto v = in_complex(face.vertices);
    if (face.size() == 3) {
      const auto found = label_of.find(face_key(v));
      return found == label_of.end() ? nullptr : found->second;
    }
    // Both halves of one cut: a single triangle may lie on a patch beside the quadrilateral.
    const auto half = [&](std::size_t i) {
      return label_of.find(face_key({v[i], v[(i + 1) % 4], v[(i + 2) % 4], no_index}));
    };
    for (std::size_t cut = 0; cut < 2; ++cut)
      if (half(cut) != label_of.end() && half(cut + 2) != label_of.end()) return half(cut)->second;
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
  std::unordered_set<FaceKey, FaceKeyHash> present;
  for (std::size_t i = 0; i < table.n_groups(); ++i) {
    const FaceKey key = face_key(in_complex(table.group(i)[0].vertices));
    if (label_of.contains(key)) present.insert(key);
  }
  for (const OtherCut& cut : other_cuts)
    if (!present.contains(cut.given)) label_of.emplace(face_key(cut.face.vertices), &cut.face);
  for (std::size_t i = 0; i < table.n_groups(); ++i) {
    const auto uses = table.group(i);
    const LabelledFace* const label = find(uses[0]);
    if (uses.size() == 1) {
      // Of a labelled interface that is open, the side that looks as its label does.
      if (skip.contains(face_key(uses[0].vertices)) && !(label && same_orientation(uses[0], *label))) continue;
      mesh.faces.push_back({uses[0].vertices, label ? label->label : unlabelled});
    } else if (label) {
      mesh.faces.push_back({uses[same_orientation(uses[0], *label) ? 0 : 1].vertices, label->label});
    }
  }
}

}  // namespace framehex::detail
