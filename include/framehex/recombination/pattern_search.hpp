// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/recombination/detail/find_cells.hpp"

#include <numeric>
#include <optional>

namespace framehex {

/// Hexahedra of five, six or seven tetrahedra by the three patterns of the paper, for comparison with it: what
/// `find_potential_hexahedra` finds is a superset.
///
/// The patterns grow a hexahedron from
///  - a corner: a tetrahedron that is one corner of it (147 of the 174 ways to cut a hexahedron have one);
///  - a body diagonal: an edge with exactly six tetrahedra round it;
///  - a central tetrahedron: four alternate corners, with its four neighbours on the others.
///
/// @par Source  Bernard, Remacle, Kowalski, Geuzaine, Frame field smoothness-based approach for hex-dominant meshing,
///              Computer-Aided Design 72 (2016), section 2.1, after Yamakawa and Shimada, 2003. Departs: the rules of
///              FinderOptions and exact validity are applied.
template <TetMesh Mesh>
class PatternSearch {
public:
  explicit PatternSearch(const Mesh& mesh, const FinderOptions& options = {}) : input_(mesh, options) {}

  /// @return each hexahedron once, ordered by vertices.
  /// @par Complexity   O(n) for bounded valence, and a sort.
  PotentialHexahedra find() const {
    std::vector<Vertices> found;
    const auto& tets = input_.adjacency().tets;
    for (index_t tet = 0; tet < tets.size(); ++tet) {
      for (std::size_t i = 0; i < 4; ++i) {
        const auto [x, y, z] = facet(tets[tet], static_cast<int>(i));
        grow_from_corner(tets[tet][i], x, y, z, found);
      }
      grow_from_centre(tet, found);
    }
    for (index_t v = 0; v < input_.adjacency().n_vertices(); ++v)
      for (const index_t w : input_.adjacency().vertices_of_vertex[v])
        if (v < w) grow_from_diagonal(v, w, found);
    return filtered(found);
  }

private:
  using Vertices = std::array<index_t, 8>;

  /// The rotation of the cube that makes the smallest vertex corner 0 and its smallest neighbour corner 1.
  static Vertices canonical(const Vertices& v) {
    constexpr auto& corners = cell_tables::hexahedron_corners;
    const auto at = [&](std::size_t i) -> index_t { return v[i]; };
    const auto& c = corners[static_cast<std::size_t>(std::ranges::min_element(v) - v.begin())];
    std::array<std::size_t, 3> axes{static_cast<std::size_t>(c.x), static_cast<std::size_t>(c.y),
                                    static_cast<std::size_t>(c.z)};
    while (at(axes[0]) > at(axes[1]) || at(axes[0]) > at(axes[2]))
      std::rotate(axes.begin(), axes.begin() + 1, axes.end());
    // Corner codes are coordinates in the unit cube: the three axes flip one bit each.
    constexpr std::array<std::size_t, 8> code{0, 1, 3, 2, 4, 5, 7, 6}, corner{0, 1, 3, 2, 4, 5, 7, 6};
    const std::size_t origin = code[static_cast<std::size_t>(c.corner)];
    const std::size_t x = code[axes[0]] ^ origin, y = code[axes[1]] ^ origin, z = code[axes[2]] ^ origin;
    Vertices w{};
    for (std::size_t i = 0; i < 8; ++i) {
      const std::size_t bits = code[i];
      w[i] = v[corner[origin ^ (bits & 1 ? x : 0) ^ (bits & 2 ? y : 0) ^ (bits & 4 ? z : 0)]];
    }
    return w;
  }

  static bool are_distinct(Vertices v) {
    std::ranges::sort(v);
    return std::ranges::adjacent_find(v) == v.end();
  }

  /// `tet` = a b d e in an order of positive volume.
  void grow_from_corner(index_t a, index_t b, index_t d, index_t e, std::vector<Vertices>& found) const {
    const detail::VertexLinks& links = input_.links();
    const auto opposites = [&links](index_t v, index_t x, index_t y, auto&& f) {
      links.for_each_opposite(v, links.position(v, x), links.position(v, y), f);
    };
    const auto is_opposite = [&links](index_t v, index_t x, index_t y, index_t o) {
      return links.is_opposite(v, links.position(v, x), links.position(v, y), o);
    };
    opposites(a, b, d, [&](index_t c) {
      opposites(a, b, e, [&](index_t f) {
        opposites(b, c, f, [&](index_t g) {
          opposites(a, d, e, [&](index_t h) {
            const Vertices v{a, b, c, d, e, f, g, h};
            if (are_distinct(v) && is_opposite(d, c, h, g) && is_opposite(e, f, h, g)) found.push_back(canonical(v));
          });
        });
      });
    });
  }

  void grow_from_centre(index_t tet, std::vector<Vertices>& found) const {
    const TetAdjacency& adjacency = input_.adjacency();
    std::array<index_t, 4> apex{};
    for (std::size_t i = 0; i < 4; ++i) {
      const index_t next = adjacency.neighbours[tet][i];
      if (next == no_index) return;
      const auto& t = adjacency.tets[tet];
      apex[i] = *std::ranges::find_if(adjacency.tets[next],
                                      [&](index_t v) { return v == t[i] || std::ranges::find(t, v) == t.end(); });
    }
    // The tetrahedron's corners are a, c, h, f, of positive volume in this order.
    const auto& t = adjacency.tets[tet];
    const Vertices v{t[0], apex[2], t[1], apex[3], apex[1], t[3], apex[0], t[2]};
    if (are_distinct(v)) found.push_back(canonical(v));
  }

  void grow_from_diagonal(index_t a, index_t g, std::vector<Vertices>& found) const {
    const auto ring = ring_of_six(a, g);
    if (!ring) return;
    // The ring turns anticlockwise seen from g: every second vertex is a neighbour of a.
    for (std::size_t first = 0; first < 2; ++first) {
      const auto at = [&](std::size_t i) { return (*ring)[(first + i) % 6]; };
      const Vertices v{a, at(0), at(1), at(2), at(4), at(5), g, at(3)};
      if (are_distinct(v)) found.push_back(canonical(v));
    }
  }

  /// The vertices round an edge with exactly six tetrahedra, in order.
  std::optional<std::array<index_t, 6>> ring_of_six(index_t a, index_t g) const {
    std::array<std::array<index_t, 2>, 6> links{};
    std::size_t n = 0;
    for (const index_t tet : input_.adjacency().tets_of_vertex[a]) {
      const auto& t = input_.adjacency().tets[tet];
      const auto i = static_cast<std::size_t>(std::ranges::find(t, a) - t.begin());
      const auto j = static_cast<std::size_t>(std::ranges::find(t, g) - t.begin());
      if (j == 4) continue;
      if (n == 6) return std::nullopt;
      // The two others, such that (a, g, p, q) has positive volume.
      auto seen = facet(t, static_cast<int>(i));
      std::ranges::rotate(seen, std::ranges::find(seen, g));
      links[n++] = {seen[1], seen[2]};
    }
    if (n != 6) return std::nullopt;
    std::array<index_t, 6> ring{links[0][0]};
    for (std::size_t k = 1; k < 6; ++k) {
      const auto next = std::ranges::find_if(links, [&](const auto& link) { return link[0] == ring[k - 1]; });
      if (next == links.end()) return std::nullopt;
      ring[k] = (*next)[1];
    }
    return ring;
  }

  PotentialHexahedra filtered(std::vector<Vertices>& found) const {
    std::ranges::sort(found);
    found.erase(std::unique(found.begin(), found.end()), found.end());
    detail::CellInterior<8> interior(input_);
    PotentialHexahedra result;
    for (const Vertices& v : found) {
      std::array<Vector3, 8> corners;
      for (std::size_t i = 0; i < 8; ++i) corners[i] = input_.points()[v[i]];
      detail::CellValues values{};
      if (!detail::evaluate<CellKind::hexahedron>(corners, input_.options().quality_floor, values) ||
          !interior.fill(v) || interior.tets.size() > 7)
        continue;
      result.vertices.push_back(v);
      result.quality.push_back(static_cast<float>(values.quality));
      result.volume.push_back(values.volume);
      for (auto* const row : {&interior.tets, &interior.slivers}) {
        Csr<index_t>& rows = row == &interior.tets ? result.tets : result.face_slivers;
        rows.values.insert(rows.values.end(), row->begin(), row->end());
        rows.end_row();
      }
    }
    return result;
  }

  detail::FinderInput input_;
};

/// The hexahedra that PatternSearch finds.
///
/// @throws invalid_option, and what `validate` throws.
template <TetMesh Mesh>
PotentialHexahedra find_pattern_hexahedra(const Mesh& mesh, const FinderOptions& options = {}) {
  return PatternSearch<Mesh>(mesh, options).find();
}

}  // namespace framehex
