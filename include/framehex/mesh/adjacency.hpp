// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/errors.hpp"
#include "framehex/geometry/cell_kinds.hpp"
#include "framehex/mesh/concepts.hpp"
#include "framehex/mesh/csr.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

namespace framehex {

namespace detail {

/// Vertices, and cells or triangles, are counted in 32 bits, and one number means "none".
inline void check_count(std::size_t n, std::size_t most, const char* what) {
  if (n > most)
    throw invalid_connectivity("the mesh has " + std::to_string(n) + " " + what + ", more than " +
                               std::to_string(most));
}

/// Neighbours of each vertex, ascending, from cells given by vertex indices.
template <std::size_t Corners>
Csr<index_t> vertex_neighbours(const std::vector<std::array<index_t, Corners>>& cells,
                               const Csr<index_t>& cells_of_vertex) {
  Csr<index_t> graph;
  graph.offsets.reserve(cells_of_vertex.offsets.size());
  std::vector<index_t> ring, last_seen_by(cells_of_vertex.size(), no_index);
  for (index_t v = 0; v < cells_of_vertex.size(); ++v) {
    ring.clear();
    last_seen_by[v] = v;
    for (const index_t cell : cells_of_vertex[v])
      for (const index_t w : cells[cell])
        if (std::exchange(last_seen_by[w], v) != v) ring.push_back(w);
    std::sort(ring.begin(), ring.end());
    graph.values.insert(graph.values.end(), ring.begin(), ring.end());
    graph.end_row();
  }
  return graph;
}

template <std::size_t Corners>
Csr<index_t> incident_cells(std::size_t n_vertices, const std::vector<std::array<index_t, Corners>>& cells) {
  return make_csr(n_vertices, [&](auto&& put) {
    for (std::size_t cell = 0; cell < cells.size(); ++cell)
      for (const index_t v : cells[cell]) put(v, static_cast<index_t>(cell));
  });
}

/// One number for an edge, whichever end comes first.
inline std::uint64_t edge_key(index_t a, index_t b) {
  return std::uint64_t{std::min(a, b)} << 32 | std::max(a, b);
}

inline std::array<index_t, 3> sorted(std::array<index_t, 3> facet) {
  std::sort(facet.begin(), facet.end());
  return facet;
}

}  // namespace detail

/// Facet `face` (opposite corner `face`) of a tetrahedron, anticlockwise seen from outside.
inline std::array<index_t, 3> facet(const std::array<index_t, 4>& tet, int face) {
  const LocalFace& local = cell_tables::tetrahedron_faces[static_cast<std::size_t>(face)];
  return {tet[static_cast<std::size_t>(local.corners[0])], tet[static_cast<std::size_t>(local.corners[1])],
          tet[static_cast<std::size_t>(local.corners[2])]};
}

/// Who touches whom in a tetrahedral mesh, by dense indices.
struct TetAdjacency {
  std::vector<std::array<index_t, 4>> tets;        ///< corners
  std::vector<std::array<index_t, 4>> neighbours;  ///< across the facet opposite corner i; `no_index` on the boundary
  Csr<index_t> tets_of_vertex;                     ///< ascending
  Csr<index_t> vertices_of_vertex;                 ///< ascending

  std::size_t n_vertices() const { return tets_of_vertex.size(); }
};

/// Builds the adjacency of a mesh whose indices are in range (see `validate`).
///
/// @throws invalid_connectivity  when its vertices or tetrahedra cannot be counted in 32 bits.
/// @throws nonmanifold  with the facet's three vertices, when more than two tetrahedra share it.
/// @par Complexity   O(n) for bounded valence; about 130 bytes a tetrahedron.
template <TetMesh M>
TetAdjacency make_adjacency(const M& mesh) {
  TetAdjacency a;
  detail::check_count(n_vertices(mesh), no_index, "vertices");
  a.tets = tetrahedra(mesh);
  detail::check_count(a.tets.size(), no_index, "tetrahedra");
  a.tets_of_vertex = detail::incident_cells(n_vertices(mesh), a.tets);
  a.vertices_of_vertex = detail::vertex_neighbours(a.tets, a.tets_of_vertex);
  a.neighbours.assign(a.tets.size(), {no_index, no_index, no_index, no_index});

  // Facets are gathered at their smallest vertex, then matched by the two others: no hashing, and local memory.
  struct Facet {
    index_t mid, high, tet;
    std::uint8_t face;
  };
  std::vector<Facet> facets;
  for (std::size_t v = 0; v < a.n_vertices(); ++v) {
    facets.clear();
    for (const index_t tet : a.tets_of_vertex[v]) {
      const auto& corners = a.tets[tet];
      std::array<std::uint8_t, 3> others{};
      for (std::uint8_t i = 0, n = 0; i < 4; ++i)
        if (corners[i] != v) others[n++] = i;
      for (std::size_t i = 0; i < 3; ++i) {
        const auto [mid, high] = std::minmax(corners[others[(i + 1) % 3]], corners[others[(i + 2) % 3]]);
        if (mid > v) facets.push_back({mid, high, tet, others[i]});
      }
    }
    std::sort(facets.begin(), facets.end(), [](const Facet& x, const Facet& y) {
      return std::tie(x.mid, x.high, x.tet) < std::tie(y.mid, y.high, y.tet);
    });
    for (std::size_t i = 0; i + 1 < facets.size(); ++i) {
      const Facet &x = facets[i], &y = facets[i + 1];
      if (x.mid != y.mid || x.high != y.high) continue;
      if (a.neighbours[x.tet][x.face] != no_index)
        throw nonmanifold("facet (" + std::to_string(v) + ", " + std::to_string(x.mid) + ", " + std::to_string(x.high) +
                              ") is shared by more than two tetrahedra",
                          Entity::vertex, {v, x.mid, x.high});
      a.neighbours[x.tet][x.face] = y.tet;
      a.neighbours[y.tet][y.face] = x.tet;
    }
  }
  return a;
}

/// Who touches whom on a triangulated surface, by dense indices. Half edge 3t+i runs from corner i of triangle t to
/// corner i+1.
struct TriangleAdjacency {
  /// As many as have half edges that an index can count, one number being "none".
  static constexpr std::size_t most_triangles = no_index / 3;

  std::vector<std::array<index_t, 3>> triangles;
  std::vector<index_t> opposite;     ///< 3 n_triangles half edges; `no_index` on a rim
  Csr<index_t> triangles_of_vertex;  ///< ascending
  Csr<index_t> vertices_of_vertex;   ///< ascending

  std::size_t n_vertices() const { return triangles_of_vertex.size(); }
  index_t from(index_t half_edge) const { return triangles[half_edge / 3][half_edge % 3]; }
  index_t to(index_t half_edge) const { return triangles[half_edge / 3][(half_edge % 3 + 1) % 3]; }
  index_t apex(index_t half_edge) const { return triangles[half_edge / 3][(half_edge % 3 + 2) % 3]; }
  static index_t next(index_t half_edge) { return half_edge % 3 == 2 ? half_edge - 2 : half_edge + 1; }
  static index_t previous(index_t half_edge) { return half_edge % 3 == 0 ? half_edge + 2 : half_edge - 1; }
};

/// What becomes of edges where several sheets of a surface meet: of three or more triangles, or of two that run along it
/// the same way.
enum class Junctions {
  refused,
  open,  ///< none of their half edges has an opposite: each sheet ends there
};

/// Builds the adjacency of an oriented surface whose indices are in range.
///
/// @throws invalid_connectivity  when its half edges cannot be counted in 32 bits.
/// @throws nonmanifold  with an edge's two vertices, when more than two triangles share it or two run along it the same
/// way.
/// @par Complexity   O(n) for bounded valence.
template <TriangleMesh M>
TriangleAdjacency make_adjacency(const M& mesh, Junctions junctions = Junctions::refused) {
  TriangleAdjacency a;
  a.triangles = triangles(mesh);
  detail::check_count(a.triangles.size(), TriangleAdjacency::most_triangles, "triangles");
  a.triangles_of_vertex = detail::incident_cells(n_vertices(mesh), a.triangles);
  a.vertices_of_vertex = detail::vertex_neighbours(a.triangles, a.triangles_of_vertex);
  a.opposite.assign(3 * a.triangles.size(), no_index);

  struct HalfEdge {
    index_t high, id;
  };
  std::vector<HalfEdge> edges;
  for (std::size_t v = 0; v < a.n_vertices(); ++v) {
    edges.clear();
    for (const index_t t : a.triangles_of_vertex[v])
      for (index_t h = 3 * t; h < 3 * t + 3; ++h)
        if (std::min(a.from(h), a.to(h)) == v) edges.push_back({std::max(a.from(h), a.to(h)), h});
    std::sort(edges.begin(), edges.end(),
              [](const HalfEdge& x, const HalfEdge& y) { return std::tie(x.high, x.id) < std::tie(y.high, y.id); });
    for (std::size_t i = 0, end = 0; i < edges.size(); i = end) {
      const HalfEdge &x = edges[i], &y = edges[i + 1 < edges.size() ? i + 1 : i];
      while (end < edges.size() && edges[end].high == x.high) ++end;
      if (end - i == 1) continue;
      if (end - i == 2 && a.from(x.id) != a.from(y.id)) {
        a.opposite[x.id] = y.id;
        a.opposite[y.id] = x.id;
      } else if (junctions == Junctions::refused) {
        throw nonmanifold("edge (" + std::to_string(v) + ", " + std::to_string(x.high) +
                              ") is used by more than two triangles, or by two in one direction",
                          Entity::edge, {v, x.high});
      }
    }
  }
  return a;
}

}  // namespace framehex
