// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/io/label_names.hpp"
#include "framehex/io/quadratic_elements.hpp"
#include "framehex/io/text_buffer.hpp"
#include "framehex/mesh/mixed_faces.hpp"

namespace framehex {

/// What a pyramid is in an Abaqus file.
enum class InpPyramids {
  own_type,          ///< C3D5, which Abaqus knows; C3D13 with nodes on the edges
  degenerate_bricks  ///< C3D8 (C3D20) whose upper four nodes are one, for CalculiX and others that know no pyramids
};

namespace detail {

/// Number of a face of a cell in Abaqus, from 1, by its position in `faces_of(kind)`.
inline int inp_face(CellKind kind, std::size_t local, InpPyramids pyramids) {
  constexpr std::array<int, 4> tetrahedron{3, 4, 2, 1};
  constexpr std::array<int, 5> pyramid{1, 2, 3, 4, 5}, brick{1, 3, 4, 5, 6}, prism{1, 2, 3, 4, 5};
  constexpr std::array<int, 6> hexahedron{1, 2, 3, 4, 5, 6};
  switch (kind) {
    case CellKind::tetrahedron: return tetrahedron[local];
    case CellKind::pyramid: return pyramids == InpPyramids::own_type ? pyramid[local] : brick[local];
    case CellKind::prism: return prism[local];
    default: return hexahedron[local];
  }
}

class InpWriter {
public:
  InpWriter(OutputFile& file, const MixedMesh& mesh, InpPyramids pyramids, const MidsideNodes* midside)
      : text_(file), mesh_(mesh), pyramids_(pyramids), midside_(midside) {}

  void write() {
    text_ << "*HEADING\nwritten by framehex\n*NODE, NSET=N_ALL\n";
    const std::vector<Vector3> points = points_with(mesh_, midside_);
    for (std::size_t v = 0; v < points.size(); ++v) {
      const Vector3& p = points[v];
      text_ << v + 1 << ", " << p.x() << ", " << p.y() << ", " << p.z() << "\n";
    }
    write_elements();
    write_element_sets();
    write_node_sets();
    write_surfaces();
    text_.flush();
  }

private:
  std::string_view type(CellKind kind) const {
    switch (kind) {
      case CellKind::tetrahedron: return midside_ ? "C3D10" : "C3D4";
      case CellKind::pyramid:
        if (pyramids_ == InpPyramids::own_type) return midside_ ? "C3D13" : "C3D5";
        break;
      case CellKind::prism: return midside_ ? "C3D15" : "C3D6";
      default: break;
    }
    return midside_ ? "C3D20" : "C3D8";
  }

  /// Nodes of a cell's element. Where a brick stands for a pyramid its upper nodes, and those between them, are one.
  std::vector<std::size_t> nodes_of(std::size_t cell) const {
    const auto row = mesh_.cells[cell];
    const bool is_brick = mesh_.kinds[cell] == CellKind::pyramid && pyramids_ == InpPyramids::degenerate_bricks;
    std::vector<std::size_t> nodes(row.begin(), row.end());
    if (is_brick) nodes.insert(nodes.end(), 3, row[4]);
    if (midside_) {
      append_midside(nodes, *midside_, mesh_.points.size(), row, vtk_edge_order(mesh_.kinds[cell]));
      if (is_brick) nodes.insert(nodes.end() - 4, 4, row[4]);
    }
    return nodes;
  }

  /// All elements of one kind together; an element keeps the number of its cell, plus one.
  void write_elements() {
    if (mesh_.n_cells() == 0) return write_shells();
    for (const CellKind kind : all_cell_kinds) {
      if (std::find(mesh_.kinds.begin(), mesh_.kinds.end(), kind) == mesh_.kinds.end()) continue;
      text_ << "*ELEMENT, TYPE=" << type(kind) << ", ELSET=E_ALL\n";
      for (std::size_t c = 0; c < mesh_.n_cells(); ++c) {
        if (mesh_.kinds[c] != kind) continue;
        text_ << c + 1;
        // A line holds 16 numbers at most; one that ends with a comma goes on.
        const std::vector<std::size_t> nodes = nodes_of(c);
        for (std::size_t i = 0; i < nodes.size(); ++i) text_ << (i == 15 ? ",\n" : ", ") << nodes[i] + 1;
        text_ << "\n";
      }
    }
  }

  /// Without a volume the faces are the elements, and patches element sets.
  void write_shells() {
    for (const std::size_t size : {std::size_t{3}, std::size_t{4}}) {
      bool first = true;
      for (std::size_t f = 0; f < mesh_.faces.size(); ++f) {
        const LabelledFace& face = mesh_.faces[f];
        if (face.size() != size) continue;
        if (std::exchange(first, false)) text_ << "*ELEMENT, TYPE=S" << size << ", ELSET=E_ALL\n";
        text_ << f + 1;
        for (std::size_t i = 0; i < size; ++i) text_ << ", " << std::size_t{face.vertices[i]} + 1;
        text_ << "\n";
      }
    }
    for (const auto& [name, labels] : labels_of_plain_names(mesh_, 2)) {
      std::vector<std::size_t> elements;
      for (std::size_t f = 0; f < mesh_.faces.size(); ++f)
        if (std::binary_search(labels.begin(), labels.end(), mesh_.faces[f].label)) elements.push_back(f + 1);
      text_ << "*ELSET, ELSET=E_" << name << "\n";
      write_list(elements);
    }
  }

  void write_list(const std::vector<std::size_t>& numbers) {
    for (std::size_t i = 0; i < numbers.size(); ++i)
      text_ << numbers[i] << (i % 16 == 15 || i + 1 == numbers.size() ? "\n" : ", ");
  }

  void write_element_sets() {
    if (mesh_.n_cells() == 0) return;
    for (const auto& [name, labels] : labels_of_plain_names(mesh_, 3)) {
      std::vector<std::size_t> elements;
      for (std::size_t c = 0; c < mesh_.n_cells(); ++c)
        if (std::binary_search(labels.begin(), labels.end(), mesh_.regions.empty() ? 0 : mesh_.regions[c]))
          elements.push_back(c + 1);
      text_ << "*ELSET, ELSET=E_" << name << "\n";
      write_list(elements);
    }
  }

  void insert_nodes(std::set<std::size_t>& nodes, std::span<const index_t> corners) const {
    std::vector<std::size_t> all(corners.begin(), corners.end());
    if (midside_) append_midside(all, *midside_, mesh_.points.size(), corners, face_edge_order(corners.size()));
    for (const std::size_t v : all) nodes.insert(v + 1);
  }

  void write_node_sets() {
    for (const int dimension : {2, 1})
      for (const auto& [name, labels] : labels_of_plain_names(mesh_, dimension)) {
        std::set<std::size_t> nodes;
        const auto has = [&](index_t label) { return std::binary_search(labels.begin(), labels.end(), label); };
        if (dimension == 2)
          for (const LabelledFace& face : mesh_.faces)
            if (has(face.label)) insert_nodes(nodes, std::span(face.vertices).first(face.size()));
        if (dimension == 1)
          for (const LabelledEdge& edge : mesh_.edges)
            if (has(edge.label)) insert_nodes(nodes, edge.vertices);
        text_ << "*NSET, NSET=N_" << name << "\n";
        write_list({nodes.begin(), nodes.end()});
      }
  }

  /// Patches by element and number of its face; of two elements at an inner face the first.
  void write_surfaces() {
    if (mesh_.faces.empty() || mesh_.n_cells() == 0) return;
    struct Sided {
      std::array<index_t, 4> key;
      index_t cell;
      int face;
    };
    std::vector<Sided> sides;
    const FaceTable table = make_face_table(mesh_);
    for (std::size_t g = 0; g < table.n_groups(); ++g) {
      const CellFace& face = table.group(g)[0];
      sides.push_back({sorted_key(face.vertices), face.cell, inp_face(mesh_.kinds[face.cell], face.local, pyramids_)});
    }
    const auto less = [](const Sided& a, const Sided& b) { return a.key < b.key; };
    std::sort(sides.begin(), sides.end(), less);
    for (const auto& [name, labels] : labels_of_plain_names(mesh_, 2)) {
      text_ << "*SURFACE, NAME=S_" << name << ", TYPE=ELEMENT\n";
      for (const LabelledFace& face : mesh_.faces) {
        if (!std::binary_search(labels.begin(), labels.end(), face.label)) continue;
        const Sided wanted{sorted_key(face.vertices), 0, 0};
        const auto at = std::lower_bound(sides.begin(), sides.end(), wanted, less);
        if (at != sides.end() && at->key == wanted.key) text_ << std::size_t{at->cell} + 1 << ", S" << at->face << "\n";
      }
    }
  }

  static std::array<index_t, 4> sorted_key(std::array<index_t, 4> vertices) {
    std::sort(vertices.begin(), vertices.end());
    return vertices;
  }

  TextBuffer text_;
  const MixedMesh& mesh_;
  InpPyramids pyramids_;
  const MidsideNodes* midside_;
};

}  // namespace detail

/// Writes a mesh as an input file of Abaqus and CalculiX: nodes, elements, and sets of them.
///
/// @param path      the file; appears whole or not at all (`OutputFile`).
/// @param mesh      regions become element sets (E_ and the group's name, or E_region_0...), patches and curves node sets
///                  (N_...), patches surfaces by element face (S_...) too. Without a volume the faces are shells (S3, S4). Characters that a name may not have become _.
/// @param pyramids  what a pyramid becomes.
/// @param midside   nodes on its edges, when not null: elements are quadratic.
/// @throws io_error naming the file.
/// @par Complexity   O(n log n + n groups).
/// @par Determinism  Same mesh, same bytes.
/// @par Source       Abaqus keywords reference; G. Dhondt, CalculiX CrunchiX user's manual. Its corner order is ours.
inline void write_inp(const std::filesystem::path& path, const MixedMesh& mesh,
                      InpPyramids pyramids = InpPyramids::own_type, const MidsideNodes* midside = nullptr) {
  OutputFile file(path);
  detail::InpWriter(file, mesh, pyramids, midside).write();
  file.commit();
}

}  // namespace framehex
