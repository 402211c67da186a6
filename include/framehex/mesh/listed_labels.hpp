// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/mesh/adjacency.hpp"
#include "framehex/mesh/indexed_mesh.hpp"
#include "framehex/mesh/mixed_mesh.hpp"

#include <cmath>
#include <numbers>

namespace framehex {

namespace detail {

/// Facets of the boundary and between regions, three sorted vertices each, ascending, and one tetrahedron behind each.
struct BoundingFacets {
  struct Facet {
    std::array<index_t, 3> vertices, outward;  // sorted, and as seen from outside the tetrahedron
    auto operator<=>(const Facet& other) const { return vertices <=> other.vertices; }
    bool operator==(const Facet& other) const { return vertices == other.vertices; }
  };
  std::vector<Facet> facets;
  std::size_t n_inner = 0;  // facets between tetrahedra of one region

  BoundingFacets(const TetAdjacency& adjacency, const std::vector<index_t>& regions) {
    for (index_t tet = 0; tet < adjacency.tets.size(); ++tet)
      for (std::size_t i = 0; i < 4; ++i) {
        const index_t other = adjacency.neighbours[tet][i];
        if (other != no_index && other < tet) continue;
        if (other != no_index && (regions.empty() || regions[tet] == regions[other])) {
          ++n_inner;
          continue;
        }
        const auto outward = facet(adjacency.tets[tet], static_cast<int>(i));
        facets.push_back({sorted(outward), outward});
      }
    std::sort(facets.begin(), facets.end());
  }

  bool contains(const LabelledFace& face) const {
    const Facet key{sorted({face.vertices[0], face.vertices[1], face.vertices[2]}), {}};
    return std::binary_search(facets.begin(), facets.end(), key);
  }
};

/// Edges of the bounding facets where a curve may lie: the facets there are not two, or are not of one label, or are
/// bent by more than `angle`. Two sorted vertices each, ascending.
inline std::vector<std::array<index_t, 2>> possible_curves(const MixedMesh& mesh, const BoundingFacets& bounding,
                                                           double angle) {
  std::vector<std::pair<std::array<index_t, 3>, index_t>> label_of_facet;
  for (const LabelledFace& face : mesh.faces)
    label_of_facet.emplace_back(sorted({face.vertices[0], face.vertices[1], face.vertices[2]}), face.label);
  std::sort(label_of_facet.begin(), label_of_facet.end());
  struct Side {
    std::array<index_t, 2> edge;
    index_t label;
    Vector3 normal;
  };
  std::vector<Side> sides;
  for (const auto& [vertices, outward] : bounding.facets) {
    const Vector3 &a = mesh.points[outward[0]], &b = mesh.points[outward[1]], &c = mesh.points[outward[2]];
    const auto at = std::lower_bound(label_of_facet.begin(), label_of_facet.end(), std::pair(vertices, index_t{0}));
    const index_t label = at != label_of_facet.end() && at->first == vertices ? at->second : no_index;
    const Vector3 normal = (b - a).cross(c - a).normalized();
    for (std::size_t i = 0; i < 3; ++i)
      sides.push_back({{vertices[i == 2 ? 0 : i], vertices[i == 2 ? 2 : i + 1]}, label, normal});
  }
  std::sort(sides.begin(), sides.end(), [](const Side& s, const Side& t) { return s.edge < t.edge; });
  std::vector<std::array<index_t, 2>> curves;
  for (std::size_t i = 0, j = 0; i < sides.size(); i = j) {
    while (j < sides.size() && sides[j].edge == sides[i].edge) ++j;
    const bool smooth = j - i == 2 && sides[i].label == sides[i + 1].label &&
                        sides[i].normal.dot(sides[i + 1].normal) > std::cos(angle);
    if (!smooth) curves.push_back(sides[i].edge);
  }
  return curves;
}

}  // namespace detail

/// Drops the labelled faces that neither lie on the boundary nor between regions. Returns how many.
///
/// @param adjacency  of the mesh's tetrahedra.
/// @par Complexity   O(n log n).
inline std::size_t drop_inner_faces(MixedMesh& mesh, const TetAdjacency& adjacency) {
  const detail::BoundingFacets bounding(adjacency, mesh.regions);
  return std::erase_if(mesh.faces, [&](const LabelledFace& face) { return !bounding.contains(face); });
}

/// What `drop_listed_labels` found and dropped.
struct ListedLabels {
  bool all_faces = false, all_edges = false;  ///< the mesh lists every facet, every edge
  std::size_t n_faces = 0, n_edges = 0;       ///< dropped
};

/// Drops labels that bound nothing, from meshes that list every facet or every edge of their tetrahedra.
///
/// Some programs write all of them, labelled or not. Taken for faults and curves they would forbid every other cell. Of
/// faces those on the boundary and between regions stay; of edges those where such faces of two labels meet, or meet
/// other than in pairs, or at an angle.
///
/// @param mesh       tetrahedra with labelled faces and edges, which are dropped from it. Indices in range.
/// @param adjacency  of its tetrahedra.
/// @param angle      rad; faces bent by more than this from flat make a curve.
/// @par Complexity   O(n log n).
inline ListedLabels drop_listed_labels(MixedMesh& mesh, const TetAdjacency& adjacency,
                                       double angle = 40 * std::numbers::pi / 180) {
  ListedLabels found;
  if (mesh.faces.empty() && mesh.edges.empty()) return found;
  const detail::BoundingFacets bounding(adjacency, mesh.regions);

  std::vector<std::array<index_t, 3>> inner;
  for (const LabelledFace& face : mesh.faces)
    if (!bounding.contains(face))
      inner.push_back(detail::sorted({face.vertices[0], face.vertices[1], face.vertices[2]}));
  std::sort(inner.begin(), inner.end());
  inner.erase(std::unique(inner.begin(), inner.end()), inner.end());
  found.all_faces = !inner.empty() && inner.size() >= bounding.n_inner;
  if (found.all_faces)
    found.n_faces = std::erase_if(mesh.faces, [&](const LabelledFace& face) { return !bounding.contains(face); });

  std::vector<std::array<index_t, 2>> edges;
  const auto ends = [](const LabelledEdge& edge) {
    return std::array{std::min(edge.vertices[0], edge.vertices[1]), std::max(edge.vertices[0], edge.vertices[1])};
  };
  for (const LabelledEdge& edge : mesh.edges) edges.push_back(ends(edge));
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  found.all_edges = !edges.empty() && 2 * edges.size() >= adjacency.vertices_of_vertex.values.size();
  if (found.all_edges) {
    const auto curves = detail::possible_curves(mesh, bounding, angle);
    found.n_edges = std::erase_if(mesh.edges, [&](const LabelledEdge& edge) {
      return !std::binary_search(curves.begin(), curves.end(), ends(edge));
    });
  }
  return found;
}

}  // namespace framehex
