// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/mesh/adjacency.hpp"
#include "framehex/mesh/mixed_mesh.hpp"

namespace framehex {

namespace detail {

/// A facet of a tetrahedral mesh, seen from one of its tetrahedra.
struct FacetPlace {
  index_t tet = no_index;  ///< `no_index`: there is no such facet
  std::size_t corner = 0;  ///< opposite the facet
};

inline FacetPlace find_facet(const TetAdjacency& adjacency, const std::array<index_t, 3>& triangle) {
  for (const index_t tet : adjacency.tets_of_vertex[triangle[0]]) {
    const auto& v = adjacency.tets[tet];
    std::size_t n = 0, other = 0;
    for (std::size_t i = 0; i < 4; ++i)
      if (std::find(triangle.begin(), triangle.end(), v[i]) != triangle.end())
        ++n;
      else
        other = i;
    if (n == 3) return {tet, other};
  }
  return {};
}

[[noreturn]] inline void refuse_label(Entity entity, std::size_t i, const std::string& reason) {
  throw invalid_option(
      (entity == Entity::labelled_face ? "labelled face " : "labelled edge ") + std::to_string(i) + " " + reason,
      entity, {i});
}

inline FacetPlace checked_facet(const TetAdjacency& adjacency, std::span<const LabelledFace> faces, std::size_t i) {
  const LabelledFace& face = faces[i];
  if (face.label == no_index) refuse_label(Entity::labelled_face, i, "has the label that means none");
  if (face.size() != 3) refuse_label(Entity::labelled_face, i, "has four vertices: label its triangles");
  const std::array<index_t, 3> triangle{face.vertices[0], face.vertices[1], face.vertices[2]};
  for (std::size_t k = 0; k < 3; ++k) {
    if (triangle[k] >= adjacency.n_vertices())
      refuse_label(Entity::labelled_face, i,
                   "refers to vertex " + std::to_string(triangle[k]) + " of " + std::to_string(adjacency.n_vertices()));
    if (triangle[k] == triangle[(k + 1) % 3]) refuse_label(Entity::labelled_face, i, "has a vertex twice");
  }
  const FacetPlace place = find_facet(adjacency, triangle);
  if (place.tet == no_index) refuse_label(Entity::labelled_face, i, "is no facet of the mesh");
  return place;
}

}  // namespace detail

/// Labels of the facets opposite each corner of each tetrahedron, from labelled triangles.
///
/// @param faces  facets of the mesh, on its boundary or inside; one may be given twice, with one label.
/// @return by tetrahedron and corner, the same from both sides; `no_index` where no label is given.
/// @throws invalid_option  with the position of a face that has four vertices, is no facet or has the label `no_index`;
///                         or of two that give one facet two labels.
/// @par Complexity   O(n_tets + n_faces) for bounded valence; 16 bytes a tetrahedron, as much again on the way.
inline std::vector<std::array<index_t, 4>> facet_labels(const TetAdjacency& adjacency,
                                                        std::span<const LabelledFace> faces) {
  const std::size_t n = adjacency.tets.size();
  std::vector<std::array<index_t, 4>> face_at(n, {no_index, no_index, no_index, no_index});
  for (std::size_t i = 0; i < faces.size(); ++i) {
    const detail::FacetPlace place = detail::checked_facet(adjacency, faces, i);
    const index_t first = face_at[place.tet][place.corner];
    if (first != no_index && faces[first].label != faces[i].label)
      throw invalid_option(
          "labelled faces " + std::to_string(first) + " and " + std::to_string(i) + " give one facet two labels",
          Entity::labelled_face, {first, i});
    if (first != no_index) continue;
    face_at[place.tet][place.corner] = static_cast<index_t>(i);
    const index_t beyond = adjacency.neighbours[place.tet][place.corner];
    if (beyond == no_index) continue;
    std::size_t corner = 0;  // of the tetrahedron beyond: the one that is not on the facet
    const auto& v = adjacency.tets[place.tet];
    for (std::size_t k = 0; k < 4; ++k) {
      const auto on_facet = std::find(v.begin(), v.end(), adjacency.tets[beyond][k]);
      if (on_facet == v.end() || static_cast<std::size_t>(on_facet - v.begin()) == place.corner) corner = k;
    }
    face_at[beyond][corner] = static_cast<index_t>(i);
  }
  for (auto& facets : face_at)
    for (index_t& face : facets)
      if (face != no_index) face = faces[face].label;
  return face_at;
}

/// Checks that labelled edges are edges of a tetrahedral mesh.
///
/// @throws invalid_option  with the position of the first that is not.
/// @par Complexity   O(n_edges) for bounded valence.
inline void check_labelled_edges(const TetAdjacency& adjacency, std::span<const LabelledEdge> edges) {
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const auto [v, w] = edges[i].vertices;
    for (const index_t end : edges[i].vertices)
      if (end >= adjacency.n_vertices())
        detail::refuse_label(
            Entity::labelled_edge, i,
            "refers to vertex " + std::to_string(end) + " of " + std::to_string(adjacency.n_vertices()));
    const auto ring = adjacency.vertices_of_vertex[v];
    if (!std::binary_search(ring.begin(), ring.end(), w))
      detail::refuse_label(Entity::labelled_edge, i, "is no edge of the mesh");
  }
}

/// @throws invalid_option  when there are labels of regions, but not one for each tetrahedron.
inline void check_regions(const TetAdjacency& adjacency, std::span<const index_t> regions) {
  if (!regions.empty() && regions.size() != adjacency.tets.size())
    throw invalid_option(std::to_string(regions.size()) + " region labels for " +
                         std::to_string(adjacency.tets.size()) + " tetrahedra");
}

}  // namespace framehex
