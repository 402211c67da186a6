// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/errors.hpp"
#include "framehex/geometry/predicates.hpp"
#include "framehex/insertion/lattice_links.hpp"
#include "framehex/mesh/adjacency.hpp"
#include "framehex/mesh/indexed_mesh.hpp"

#include <algorithm>
#include <array>
#include <span>
#include <string>
#include <vector>

namespace framehex {

using VertexPair = std::array<index_t, 2>;  ///< ascending

/// What became of edges that a mesh should have.
struct EdgeRestoration {
  std::size_t n_missing = 0;   ///< of the wanted, before
  std::size_t n_restored = 0;  ///< of these
};

/// The links of a lattice as edges, sorted.
///
/// @param vertex_of  point of the lattice -> vertex of the mesh.
/// @par Complexity   O(n log n).
template <std::size_t Directions, class VertexOf>
std::vector<VertexPair> lattice_edges(const LatticeLinks<Directions>& links, VertexOf&& vertex_of) {
  std::vector<VertexPair> edges;
  for (index_t p = 0; p < links.size(); ++p)
    for (const index_t q : links[p]) {
      if (q == no_index || q < p) continue;
      const index_t a = vertex_of(p), b = vertex_of(q);
      edges.push_back({std::min(a, b), std::max(a, b)});
    }
  std::sort(edges.begin(), edges.end());
  return edges;
}

namespace detail {

/// One pass over the missing edges: each is put in by a flip where its place is crossed by one facet (2-3) or by one
/// edge of four tetrahedra (4-4).
class EdgeFlipper {
public:
  using Tet = std::array<index_t, 4>;

  EdgeFlipper(IndexedTetMesh& mesh, std::span<const VertexPair> wanted)
      : mesh_(mesh), wanted_(wanted), adjacency_(make_adjacency(mesh)), changed_(mesh.tets.size(), 0) {}

  /// @return the wanted edges that the mesh did not have at the start.
  std::vector<VertexPair> missing() const {
    std::vector<VertexPair> result;
    for (const VertexPair& edge : wanted_)
      if (const auto ring = adjacency_.vertices_of_vertex[edge[0]];
          !std::binary_search(ring.begin(), ring.end(), edge[1]))
        result.push_back(edge);
    return result;
  }

  /// Flips what does not touch an earlier flip. @return the number of flips.
  std::size_t run() {
    std::size_t n_flips = 0;
    for (const auto& [p, q] : missing()) n_flips += static_cast<std::size_t>(put_in(p, q));
    return n_flips;
  }

private:
  /// What the segment from p to q crosses first: two vertices of an edge, or three of a facet.
  using Crossing = std::vector<index_t>;

  bool put_in(index_t p, index_t q) {
    const Crossing crossing = first_crossing(p, q);
    if (crossing.empty() || (crossing.size() == 2 && is_wanted(crossing[0], crossing[1]))) return false;
    const std::vector<index_t> cavity = cells_at(crossing);
    const std::vector<Tet> fan = fan_of(cavity, crossing, p, q);
    if (fan.empty()) return false;
    for (std::size_t i = 0; i < fan.size(); ++i) {
      if (i < cavity.size())
        mesh_.tets[cavity[i]] = fan[i];
      else
        mesh_.tets.push_back(fan[i]);
    }
    for (const index_t tet : cavity) changed_[tet] = 1;
    return true;
  }

  /// @return empty when the segment passes through a vertex first.
  Crossing first_crossing(index_t p, index_t q) const {
    for (const index_t tet : adjacency_.tets_of_vertex[p]) {
      const auto& corners = adjacency_.tets[tet];
      const auto at = static_cast<int>(std::find(corners.begin(), corners.end(), p) - corners.begin());
      const auto opposite = facet(corners, at);
      Crossing crossing;
      int least = 1;
      for (std::size_t i = 0; i < 3; ++i) {
        const index_t a = opposite[i], b = opposite[(i + 1) % 3];
        // Seen from p the facet turns clockwise, from outside anticlockwise.
        const int side = orientation(mesh_.points[p], mesh_.points[q], mesh_.points[a], mesh_.points[b]);
        least = std::min(least, side);
        if (side == 0) crossing.insert(crossing.end(), {a, b});
      }
      if (least < 0 || crossing.size() > 2) continue;
      if (crossing.empty()) crossing.assign(opposite.begin(), opposite.end());
      return crossing;
    }
    return {};
  }

  bool is_wanted(index_t a, index_t b) const {
    return std::binary_search(wanted_.begin(), wanted_.end(), VertexPair{std::min(a, b), std::max(a, b)});
  }

  /// The tetrahedra that have all corners of what is crossed.
  std::vector<index_t> cells_at(const Crossing& crossing) const {
    std::vector<index_t> cells;
    for (const index_t tet : adjacency_.tets_of_vertex[crossing[0]]) {
      const auto& t = adjacency_.tets[tet];
      if (std::all_of(crossing.begin(), crossing.end(),
                      [&](index_t v) { return std::find(t.begin(), t.end(), v) != t.end(); }))
        cells.push_back(tet);
    }
    return cells;
  }

  /// The tetrahedra round pq that fill the cavity; none when they would not.
  std::vector<Tet> fan_of(std::span<const index_t> cavity, std::span<const index_t> crossed, index_t p,
                          index_t q) const {
    std::vector<Tet> fan;
    std::size_t n_facets = 0;
    for (const index_t tet : cavity) {
      if (changed_[tet]) return {};
      for (int i = 0; i < 4; ++i) {
        const index_t beyond = adjacency_.neighbours[tet][static_cast<std::size_t>(i)];
        if (beyond != no_index && std::find(cavity.begin(), cavity.end(), beyond) != cavity.end()) continue;
        auto side = facet(adjacency_.tets[tet], i);
        const auto has = [&](index_t v) { return std::find(side.begin(), side.end(), v) != side.end(); };
        // A facet with all that is crossed lies on the boundary of the mesh, which stays.
        if (has(p) == has(q) || std::all_of(crossed.begin(), crossed.end(), has)) return {};
        ++n_facets;
        if (!has(p)) continue;
        std::rotate(side.begin(), std::find(side.begin(), side.end(), p), side.end());
        if (orientation(mesh_.points[p], mesh_.points[q], mesh_.points[side[2]], mesh_.points[side[1]]) <= 0) return {};
        fan.push_back({p, q, side[2], side[1]});
      }
    }
    return n_facets == 2 * fan.size() ? fan : std::vector<Tet>{};
  }

  IndexedTetMesh& mesh_;
  std::span<const VertexPair> wanted_;
  TetAdjacency adjacency_;             // before the pass
  std::vector<std::uint8_t> changed_;  // tetrahedra of before that are no more
};

}  // namespace detail

/// Flips tetrahedra until wanted edges are there, or no flip brings another.
///
/// @param mesh    valid; stays valid, with the same vertices and boundary.
/// @param wanted  sorted; none of them that is there is flipped away.
/// @par Complexity   O(n) a pass, few passes. @par Determinism  The order of `wanted` decides.
inline EdgeRestoration restore_edges(IndexedTetMesh& mesh, std::span<const VertexPair> wanted) {
  constexpr int max_passes = 10;
  EdgeRestoration result;
  for (int pass = 0; pass < max_passes; ++pass) {
    detail::EdgeFlipper flipper(mesh, wanted);
    const std::size_t n_missing = flipper.missing().size();
    if (pass == 0) result.n_missing = n_missing;
    result.n_restored = result.n_missing - n_missing;
    if (flipper.run() == 0) break;
  }
  return result;
}

/// For each quadrilateral of the lattice that the mesh closes with neither diagonal, the shorter one; sorted.
///
/// @param cells  of eight vertices of the mesh, as `lattice_cells` gives them.
/// @par Complexity   O(n log n).
inline std::vector<VertexPair> missing_diagonals(const IndexedTetMesh& mesh,
                                                 std::span<const std::array<index_t, 8>> cells) {
  const TetAdjacency adjacency = make_adjacency(mesh);
  const auto length = [&](const VertexPair& e) { return (mesh.points[e[0]] - mesh.points[e[1]]).squaredNorm(); };
  const auto there = [&](const VertexPair& e) {
    const auto ring = adjacency.vertices_of_vertex[e[0]];
    return std::binary_search(ring.begin(), ring.end(), e[1]);
  };
  std::vector<VertexPair> missing;
  for (const auto& cell : cells)
    for (const LocalFace& face : cell_tables::hexahedron_faces) {
      const auto pair = [&](std::size_t i, std::size_t j) {
        const auto [low, high] = std::minmax(cell[static_cast<std::size_t>(face.corners[i])],
                                             cell[static_cast<std::size_t>(face.corners[j])]);
        return VertexPair{low, high};
      };
      const VertexPair first = pair(0, 2), second = pair(1, 3);
      if (!there(first) && !there(second)) missing.push_back(length(second) < length(first) ? second : first);
    }
  std::sort(missing.begin(), missing.end());
  missing.erase(std::unique(missing.begin(), missing.end()), missing.end());
  return missing;
}

/// Brings the edges of a lattice back into a mesh of its points, and a diagonal into each of its quadrilaterals.
///
/// Where eight points are nearly on a sphere, rounding decides how a tetrahedraliser joins them.
///
/// @param vertex_of  point of the lattice -> vertex of the mesh. Points inside come after all vertices of the boundary,
/// of
///                   which a retriangulation may have more than there are samples.
/// @throws invalid_option  with the first point whose vertex is out of range.
/// @return edges and diagonals together.
/// @par Complexity   O(n log n).
/// @par Source       the flips of Joe, SIAM J. Sci. Stat. Comput. 10 (1989), 718-741.
template <class VertexOf>
EdgeRestoration restore_lattice(IndexedTetMesh& mesh, const LatticeLinks<6>& links, VertexOf&& vertex_of) {
  for (index_t p = 0; p < links.size(); ++p)
    if (vertex_of(p) >= mesh.points.size())
      throw invalid_option("lattice point " + std::to_string(p) + " is not a vertex of the mesh", Entity::vertex, {p});
  std::vector<VertexPair> wanted = lattice_edges(links, vertex_of);
  const EdgeRestoration edges = restore_edges(mesh, wanted);
  std::vector<std::array<index_t, 8>> cells = lattice_cells(links);
  for (auto& cell : cells)
    for (index_t& v : cell) v = vertex_of(v);
  const std::vector<VertexPair> diagonals = missing_diagonals(mesh, cells);
  const std::size_t n_edges = wanted.size();
  wanted.insert(wanted.end(), diagonals.begin(), diagonals.end());
  std::inplace_merge(wanted.begin(), wanted.begin() + static_cast<std::ptrdiff_t>(n_edges), wanted.end());
  const EdgeRestoration all = restore_edges(mesh, wanted);
  return {edges.n_missing + diagonals.size(), edges.n_restored + all.n_restored};
}

}  // namespace framehex
