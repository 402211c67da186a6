// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/geometry/cell_kinds.hpp"

#include <algorithm>
#include <array>
#include <utility>

namespace framehex::detail {

/// The 24 pairs of corners that decide whether two hexahedra fit: 12 edges, then 12 face diagonals, those of one face
/// in consecutive places.
inline constexpr std::size_t n_pairs = 24;
inline constexpr std::size_t n_edge_pairs = 12;

inline constexpr std::array<cell_tables::LocalEdge, n_pairs> hexahedron_pairs = [] {
  std::array<cell_tables::LocalEdge, n_pairs> pairs{};
  std::size_t n = 0;
  for (const auto& edge : cell_tables::hexahedron_edges) pairs[n++] = edge;
  for (const auto& face : cell_tables::hexahedron_faces) {
    pairs[n++] = {face.corners[0], face.corners[2]};
    pairs[n++] = {face.corners[1], face.corners[3]};
  }
  return pairs;
}();

/// The other diagonal of the face of a diagonal.
constexpr std::size_t other_diagonal(std::size_t place) {
  return n_edge_pairs + ((place - n_edge_pairs) ^ 1U);
}

/// Two vertices, the smaller first.
using VertexPair = std::pair<index_t, index_t>;

inline VertexPair pair_at(const std::array<index_t, 8>& corners, std::size_t place) {
  const auto& local = hexahedron_pairs[place];
  return std::minmax(corners[static_cast<std::size_t>(local[0])], corners[static_cast<std::size_t>(local[1])]);
}

/// Place of the pair of two corners, or `n_pairs` when they are the same or opposite in the hexahedron.
inline constexpr std::array<std::array<std::uint8_t, 8>, 8> place_of_corners = [] {
  std::array<std::array<std::uint8_t, 8>, 8> places{};
  for (auto& row : places) row.fill(n_pairs);
  for (std::size_t place = 0; place < n_pairs; ++place) {
    const auto a = static_cast<std::size_t>(hexahedron_pairs[place][0]);
    const auto b = static_cast<std::size_t>(hexahedron_pairs[place][1]);
    places[a][b] = places[b][a] = static_cast<std::uint8_t>(place);
  }
  return places;
}();

/// Whether a pair of vertices at place `p` of one hexahedron and at place `q` of another keeps them apart: an edge of
/// one and a diagonal of the other, or diagonals of different quadrilaterals. Two quadrilaterals with one diagonal in
/// common are the same exactly when they have the other in common, too.
inline bool pair_clashes(const std::array<index_t, 8>& a, std::size_t p, const std::array<index_t, 8>& b,
                         std::size_t q) {
  if ((p < n_edge_pairs) != (q < n_edge_pairs)) return true;
  return p >= n_edge_pairs && pair_at(a, other_diagonal(p)) != pair_at(b, other_diagonal(q));
}

/// The rule of pairs for two hexahedra; the same as `faces_fit`, at a tenth of its time.
inline bool hexahedra_fit(const std::array<index_t, 8>& a, const std::array<index_t, 8>& b) {
  std::array<std::array<std::uint8_t, 2>, 8> common{};
  std::size_t n = 0;
  for (std::uint8_t i = 0; i < 8; ++i)
    for (std::uint8_t j = 0; j < 8; ++j)
      if (a[i] == b[j]) common[n++] = {i, j};
  for (std::size_t x = 1; x < n; ++x)
    for (std::size_t y = 0; y < x; ++y) {
      const std::size_t p = place_of_corners[common[x][0]][common[y][0]];
      const std::size_t q = place_of_corners[common[x][1]][common[y][1]];
      if (p != n_pairs && q != n_pairs && pair_clashes(a, p, b, q)) return false;
    }
  return true;
}

}  // namespace framehex::detail
