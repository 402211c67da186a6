// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/recombination/candidates.hpp"

#include <algorithm>
#include <cstddef>
#include <span>

namespace framehex {

namespace detail {

/// What two corners of a cell are to one another; a diagonal comes with the two other corners of its quadrilateral.
struct CornerPair {
  enum class Link : std::uint8_t { edge, diagonal, apart } link = Link::apart;
  index_t low = no_index, high = no_index;

  bool agrees_with(const CornerPair& other) const {
    if (link == Link::apart || other.link == Link::apart) return true;
    return link == other.link && low == other.low && high == other.high;
  }
};

inline CornerPair corner_pair(CellKind kind, std::span<const index_t> vertices, index_t v, index_t w) {
  const auto at = [&](std::int8_t i) { return vertices[static_cast<std::size_t>(i)]; };
  const auto is_pair = [&](std::int8_t i, std::int8_t j) {
    return (at(i) == v && at(j) == w) || (at(i) == w && at(j) == v);
  };
  for (const auto& e : edges_of(kind))
    if (is_pair(e[0], e[1])) return {CornerPair::Link::edge, no_index, no_index};
  for (const LocalFace& face : faces_of(kind)) {
    if (face.size() == 3) continue;
    const auto& c = face.corners;
    for (std::size_t i = 0; i < 2; ++i)
      if (is_pair(c[i], c[i + 2])) {
        const auto [low, high] = std::minmax({at(c[1 - i]), at(c[3 - i])});
        return {CornerPair::Link::diagonal, low, high};
      }
  }
  return {};
}

}  // namespace detail

/// Whether the faces of two cells fit, their vertices alone being looked at.
///
/// Refused is a pair of common vertices that is an edge of one cell and a diagonal of a quadrilateral of the other, or
/// the diagonal of two different quadrilaterals. It follows that three common vertices of a quadrilateral come with the
/// fourth, that a triangle never faces a quadrilateral, and that two quadrilaterals with the same vertices have the
/// same edges.
///
/// @param kind_a, a  kind of one cell and its n_corners(kind_a) vertices, in the order of geometry/cell_kinds.hpp.
/// @param kind_b, b  the other.
/// @par Complexity   O(1), some 100 comparisons and more for each common pair: for tests and checks; the conflicts of
///                   many candidates are found from their pairs of vertices at once.
inline bool faces_fit(CellKind kind_a, std::span<const index_t> a, CellKind kind_b, std::span<const index_t> b) {
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (std::ranges::find(b, a[i]) == b.end()) continue;
    for (std::size_t j = 0; j < i; ++j) {
      if (std::ranges::find(b, a[j]) == b.end()) continue;
      if (!detail::corner_pair(kind_a, a, a[i], a[j]).agrees_with(detail::corner_pair(kind_b, b, a[i], a[j])))
        return false;
    }
  }
  return true;
}

/// Whether two ascending lists have nothing in common.
inline bool are_disjoint(std::span<const index_t> a, std::span<const index_t> b) {
  for (auto i = a.begin(), j = b.begin(); i != a.end() && j != b.end();) {
    if (*i == *j) return false;
    *i < *j ? ++i : ++j;
  }
  return true;
}

/// Whether two potential cells can both be cells of one mesh.
///
/// They can when they have no tetrahedron in common, face slivers excepted, and what they share is nothing, vertices,
/// edges of both, or whole faces of both (see `faces_fit`).
///
/// @param a, i  candidates and the row of one.
/// @param b, j  candidates of the same or another kind, over the same mesh, and the row of the other.
/// @par Complexity   O(1): one pair at a time; see `faces_fit`.
/// @par Source       Bernard, Remacle, Kowalski, Geuzaine, Frame field smoothness-based approach for hex-dominant
///                   meshing, Computer-Aided Design 72 (2016), section 2.1.
template <int CornersA, int CornersB>
bool compatible(const Candidates<CornersA>& a, std::size_t i, const Candidates<CornersB>& b, std::size_t j) {
  return are_disjoint(a.tets[i], b.tets[j]) &&
         faces_fit(kind_with<CornersA>, a.vertices[i], kind_with<CornersB>, b.vertices[j]);
}

/// The same for two rows of one set of candidates.
template <int Corners>
bool compatible(const Candidates<Corners>& candidates, std::size_t i, std::size_t j) {
  return compatible(candidates, i, candidates, j);
}

}  // namespace framehex
