// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/mesh/mixed_faces.hpp"

#include <map>
#include <set>

namespace framehex::verify {

/// What is wrong with the faces of a mixed mesh. All lists empty: conforming.
struct ConformityReport {
  std::vector<index_t> malformed_cells;   ///< a corner out of range, or the same vertex twice; these are left out below
  std::vector<CellFace> used_over_twice;  ///< faces that three cells or more have: every use
  std::vector<CellFace> same_side;        ///< faces whose two cells lie on the same side: both uses
  std::vector<CellFace> twisted;          ///< quadrilaterals that two cells take in different cyclic order: both uses
  std::vector<CellFace> open_quadrilaterals;       ///< face one triangle or two
  std::vector<CellFace> open_triangles;            ///< face a quadrilateral
  std::vector<CellFace> three_vertices_shared;     ///< pairs of quadrilaterals that face each other with three vertices
  std::vector<std::array<index_t, 2>> open_edges;  ///< of the boundary: used by an odd number of its faces, or one way
  std::vector<std::array<index_t, 2>> nonmanifold_edges;  ///< of the boundary: used by more than two faces

  /// Every inner face is used by two cells from its two sides, and no quadrilateral faces triangles.
  bool conforming() const {
    return malformed_cells.empty() && used_over_twice.empty() && same_side.empty() && twisted.empty() &&
           open_quadrilaterals.empty() && open_triangles.empty() && three_vertices_shared.empty();
  }
  /// The boundary has no rim. It may touch itself along an edge (`nonmanifold_edges`).
  bool closed() const { return open_edges.empty(); }
  explicit operator bool() const { return conforming() && closed(); }

  /// The cells concerned by anything but `nonmanifold_edges` and `open_edges`, ascending.
  std::vector<index_t> cells() const {
    std::vector<index_t> all = malformed_cells;
    for (const auto* list :
         {&used_over_twice, &same_side, &twisted, &open_quadrilaterals, &open_triangles, &three_vertices_shared})
      for (const CellFace& face : *list) all.push_back(face.cell);
    std::sort(all.begin(), all.end());
    all.erase(std::unique(all.begin(), all.end()), all.end());
    return all;
  }
};

namespace detail {

/// The corners of a cell are in range and distinct.
inline bool is_well_formed(const MixedMesh& mesh, std::size_t cell) {
  const auto corners = mesh.cells[cell];
  if (corners.size() != static_cast<std::size_t>(n_corners(mesh.kinds[cell]))) return false;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    if (corners[i] >= mesh.points.size()) return false;
    for (std::size_t j = 0; j < i; ++j)
      if (corners[j] == corners[i]) return false;
  }
  return true;
}

inline Vector3 unit_normal(const MixedMesh& mesh, const CellFace& face) {
  const auto p = [&](std::size_t i) -> const Vector3& { return mesh.points[face.vertices[i]]; };
  const Vector3 n = face.size() == 4 ? (p(2) - p(0)).cross(p(3) - p(1)) : (p(1) - p(0)).cross(p(2) - p(0));
  const double length = n.norm();
  return length > 0 ? Vector3(n / length) : Vector3(Vector3::Zero());
}

/// The vertex after, and the one opposite (of a quadrilateral), the smallest vertex of a face.
inline std::array<index_t, 2> cyclic_order(const CellFace& face) {
  const std::size_t n = face.size();
  const auto first = static_cast<std::size_t>(
      std::min_element(face.vertices.begin(), face.vertices.begin() + static_cast<std::ptrdiff_t>(n)) -
      face.vertices.begin());
  return {face.vertices[(first + 1) % n], n == 4 ? face.vertices[(first + 2) % 4] : no_index};
}

/// Moves from `once` to the report what faces another face with three common vertices.
inline void find_open_interfaces(const MixedMesh& mesh, const std::vector<CellFace>& once, ConformityReport& report,
                                 std::vector<std::uint8_t>& is_open) {
  using Triple = std::array<index_t, 3>;
  std::map<Triple, std::vector<std::size_t>> faces_at;  // triangles, and the four halves of each quadrilateral
  const auto triple = [](index_t a, index_t b, index_t c) {
    Triple t{a, b, c};
    std::sort(t.begin(), t.end());
    return t;
  };
  for (std::size_t i = 0; i < once.size(); ++i) {
    const auto& v = once[i].vertices;
    if (once[i].size() == 3)
      faces_at[triple(v[0], v[1], v[2])].push_back(i);
    else
      for (std::size_t k = 0; k < 4; ++k) faces_at[triple(v[k], v[(k + 1) % 4], v[(k + 2) % 4])].push_back(i);
  }
  std::set<std::size_t> quads, triangles, three;
  // A quadrilateral may be bent so much that one of two triangles that cover it is far from facing its mean normal.
  const auto covers_half = [&](std::size_t quad, std::size_t triangle) {
    const auto &v = once[quad].vertices, &t = once[triangle].vertices;
    std::size_t k = 0;
    while (k < 3 && std::find(t.begin(), t.begin() + 3, v[k]) != t.begin() + 3) ++k;  // v[k] is not the triangle's
    const auto at = [&](std::size_t i) -> const Vector3& { return mesh.points[v[(k + i) % 4]]; };
    const auto is_triangle = [&](std::size_t face) { return once[face].size() == 3; };
    const auto other = faces_at.find(triple(v[(k + 3) % 4], v[k], v[(k + 1) % 4]));
    return (at(2) - at(1)).cross(at(3) - at(1)).dot(unit_normal(mesh, once[triangle])) < 0 && other != faces_at.end() &&
           std::any_of(other->second.begin(), other->second.end(), is_triangle);
  };
  for (const auto& [key, list] : faces_at)
    for (std::size_t i = 0; i < list.size(); ++i)
      for (std::size_t j = 0; j < i; ++j) {
        const int n_quads = (once[list[i]].size() == 4 ? 1 : 0) + (once[list[j]].size() == 4 ? 1 : 0);
        const double dot = unit_normal(mesh, once[list[i]]).dot(unit_normal(mesh, once[list[j]]));
        // Two faces of one boundary may share three vertices too, at a vertex of valence two: they do not face.
        if (n_quads == 2 && dot < -0.9) three.insert({list[i], list[j]});
        if (n_quads != 1) continue;
        const bool i_is_quad = once[list[i]].size() == 4;
        if (dot >= -0.5 && !covers_half(list[i_is_quad ? i : j], list[i_is_quad ? j : i])) continue;
        quads.insert(list[i_is_quad ? i : j]);
        triangles.insert(list[i_is_quad ? j : i]);
      }
  const auto move = [&](const std::set<std::size_t>& from, std::vector<CellFace>& to) {
    for (const std::size_t i : from) {
      to.push_back(once[i]);
      is_open[i] = 1;
    }
  };
  move(quads, report.open_quadrilaterals);
  move(triangles, report.open_triangles);
  move(three, report.three_vertices_shared);
}

inline void check_boundary_edges(const std::vector<CellFace>& once, const std::vector<std::uint8_t>& is_open,
                                 ConformityReport& report) {
  std::vector<std::array<index_t, 3>> uses;  // low, high, direction
  for (std::size_t i = 0; i < once.size(); ++i) {
    if (is_open[i]) continue;
    const std::size_t n = once[i].size();
    for (std::size_t k = 0; k < n; ++k) {
      const index_t a = once[i].vertices[k], b = once[i].vertices[(k + 1) % n];
      uses.push_back({std::min(a, b), std::max(a, b), a < b ? 1u : 0u});
    }
  }
  std::sort(uses.begin(), uses.end());
  for (std::size_t i = 0; i < uses.size();) {
    std::size_t end = i, forward = 0;
    for (; end < uses.size() && uses[end][0] == uses[i][0] && uses[end][1] == uses[i][1]; ++end)
      forward += uses[end][2];
    if (2 * forward != end - i) report.open_edges.push_back({uses[i][0], uses[i][1]});
    if (end - i > 2) report.nonmanifold_edges.push_back({uses[i][0], uses[i][1]});
    i = end;
  }
}

}  // namespace detail

/// Checks that the cells of a mixed mesh meet face to face.
///
/// @param mesh  any cells, also malformed ones: nothing is assumed.
/// @return what is wrong, by faces and their cells, in ascending order of the faces' vertices. A face used once that
///         shares three vertices with another face used once and looks the other way (the angle between the outward
///         normals above 120 degrees; 154 between two quadrilaterals) is an open interface; the other faces used once
///         are the boundary.
/// @par Complexity   O(n log n).
inline ConformityReport is_conforming(const MixedMesh& mesh) {
  ConformityReport report;
  MixedMesh well_formed_part;
  std::vector<index_t> cell_of;
  for (index_t cell = 0; cell < mesh.n_cells(); ++cell) {
    if (!detail::is_well_formed(mesh, cell)) {
      report.malformed_cells.push_back(cell);
      continue;
    }
    well_formed_part.add(mesh.kinds[cell], mesh.cells[cell]);
    cell_of.push_back(cell);
  }
  FaceTable table = make_face_table(well_formed_part);
  for (CellFace& face : table.faces) face.cell = cell_of[face.cell];

  std::vector<CellFace> once;
  const auto append = [](std::vector<CellFace>& list, std::span<const CellFace> uses) {
    list.insert(list.end(), uses.begin(), uses.end());
  };
  for (std::size_t i = 0; i < table.n_groups(); ++i) {
    const auto uses = table.group(i);
    if (uses.size() == 1) once.push_back(uses[0]);
    if (uses.size() > 2) append(report.used_over_twice, uses);
    if (uses.size() != 2) continue;
    const auto x = detail::cyclic_order(uses[0]), y = detail::cyclic_order(uses[1]);
    if (x[1] != y[1])
      append(report.twisted, uses);
    else if (x[0] == y[0])
      append(report.same_side, uses);
  }
  std::vector<std::uint8_t> is_open(once.size(), 0);
  detail::find_open_interfaces(mesh, once, report, is_open);
  detail::check_boundary_edges(once, is_open, report);
  return report;
}

}  // namespace framehex::verify
