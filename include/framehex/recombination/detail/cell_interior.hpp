// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/recombination/detail/finder_input.hpp"

#include <bit>
#include <bitset>

namespace framehex::detail {

/// What a tetrahedron on a set of a cell's corners can be: `foreign` ones have corners elsewhere.
enum class OnCorners : std::uint8_t { foreign, three_of_four, all_four, face_sliver };

/// The triangles that the faces of a kind of cell can be cut into, found by the set of their three corners.
///
/// Triangle 4 f + t belongs to face f: t = 0 and 1 share the diagonal of its corners 0 and 2, t = 2 and 3 the other; a
/// triangular face has t = 0 only.
template <CellKind Kind>
struct FaceTriangles {
  static constexpr std::size_t n_faces = faces_of(Kind).size();
  std::array<std::int8_t, 256> of_corners{};                      ///< set of corners -> triangle, or -1
  std::array<OnCorners, 256> tet{};                               ///< set of corners -> tetrahedron
  std::array<std::array<std::int8_t, 3>, 4 * n_faces> corners{};  ///< anticlockwise seen from outside

  constexpr FaceTriangles() {
    of_corners.fill(-1);
    for (unsigned set = 0; set < 256; ++set)
      tet[set] = std::popcount(set) == 4   ? OnCorners::all_four
                 : std::popcount(set) == 3 ? OnCorners::three_of_four
                                           : OnCorners::foreign;
    constexpr std::array<std::array<std::size_t, 3>, 4> cuts{{{0, 1, 2}, {0, 2, 3}, {1, 2, 3}, {1, 3, 0}}};
    for (std::size_t f = 0; f < n_faces; ++f) {
      const LocalFace face = faces_of(Kind)[f];
      unsigned whole = 0;
      for (int i = 0; i < face.size(); ++i) whole |= 1u << face.corners[static_cast<std::size_t>(i)];
      if (face.size() == 4) tet[whole] = OnCorners::face_sliver;
      for (std::size_t t = 0; t < (face.size() == 3 ? 1u : 4u); ++t) {
        unsigned set = 0;
        for (std::size_t i = 0; i < 3; ++i) {
          corners[4 * f + t][i] = face.corners[cuts[t][i]];
          set |= 1u << corners[4 * f + t][i];
        }
        of_corners[set] = static_cast<std::int8_t>(4 * f + t);
      }
    }
  }
};

/// Finds the tetrahedra inside a cell given by its vertices, and applies the rules that depend on them. Scratch memory
/// for one thread.
///
/// The flood starts at a corner and never crosses a triangle of the cell's own faces. What it covers is the cell
/// exactly when it leaves through one pair of triangles with a common diagonal a quadrilateral, and one triangle a
/// triangular face: the cell's boundary is then the boundary of the tetrahedra.
///
/// A triangle on three corners of a face can also lie inside the cell, when the face is cut the other way and bent.
/// Where stopping at all of them fails, the ways to cut the faces are tried one by one.
template <int Corners>
class CellInterior {
public:
  static constexpr CellKind kind = kind_with<Corners>;
  using Vertices = std::array<index_t, static_cast<std::size_t>(Corners)>;

  explicit CellInterior(const FinderInput& input)
      : input_(&input),
        corner_set_(input.adjacency().n_vertices(), std::uint8_t{0}),
        place_(input.adjacency().n_vertices(), std::uint8_t{0}) {}

  /// Prepares for cells whose corner 0 is `a`; without it they only take longer.
  void start_from(index_t a) {
    const TetAdjacency& adjacency = input_->adjacency();
    if (first_ != no_index)
      for (const index_t w : input_->links().neighbours(first_)) place_[w] = 0;
    around_.clear();
    const auto ring = input_->links().neighbours(a);
    first_ = ring.size() < 64 ? a : no_index;
    if (first_ == no_index) return;
    for (std::size_t i = 0; i < ring.size(); ++i) place_[ring[i]] = static_cast<std::uint8_t>(i + 1);
    for (const index_t tet : adjacency.tets_of_vertex[a]) around_.push_back(places_of(adjacency.tets[tet]));
  }

  /// @return whether the cell is full of tetrahedra and keeps the rules; `tets` and `slivers` then hold them.
  bool fill(const Vertices& vertices) {
    for (std::size_t i = 0; i < vertices.size(); ++i) corner_set_[vertices[i]] = static_cast<std::uint8_t>(1u << i);
    walls_ = all_walls;
    bool filled = (flood(vertices) && closes()) || flood_cut_by_cut(vertices);
    filled = filled && check_slivers(vertices) && keeps_features(vertices);
    for (const index_t v : vertices) corner_set_[v] = 0;
    if (filled) {
      std::sort(tets.begin(), tets.end());
      std::sort(slivers.begin(), slivers.end());
    }
    return filled;
  }

  std::vector<index_t> tets, slivers;  ///< ascending

private:
  static constexpr FaceTriangles<kind> triangles{};
  static constexpr std::size_t n_faces = triangles.n_faces;

  struct Exit {
    index_t tet;
    std::int8_t facet, triangle;
  };
  struct Tet {
    std::array<std::uint8_t, 4> corner;  ///< set of one corner of the cell, or none
    std::uint8_t all;

    OnCorners kind() const { return triangles.tet[all]; }
    std::size_t facet(std::size_t i) const { return all & ~unsigned{corner[i]}; }  ///< corners opposite corner i
  };

  /// The triangle of the cell's faces opposite corner i that the flood stops at, or -1.
  int wall(const Tet& t, std::size_t i) const {
    const int triangle = triangles.of_corners[t.facet(i)];
    return triangle >= 0 && (walls_ >> triangle & 1) != 0 ? triangle : -1;
  }

  Tet look_at(index_t tet) const {
    const auto& v = input_->adjacency().tets[tet];
    Tet t{{corner_set_[v[0]], corner_set_[v[1]], corner_set_[v[2]], corner_set_[v[3]]}, 0};
    t.all = static_cast<std::uint8_t>(t.corner[0] | t.corner[1] | t.corner[2] | t.corner[3]);
    return t;
  }

  /// The set of places of some vertices among the neighbours of `first_`; bit 0 is for those elsewhere.
  template <std::size_t N>
  std::uint64_t places_of(const std::array<index_t, N>& vertices) const {
    std::uint64_t places = 0;
    for (const index_t v : vertices) places |= std::uint64_t{1} << place_[v];
    return places;
  }

  /// A tetrahedron inside that has a triangle of the cell's faces: at corner 0, or at a vertex with few.
  index_t find_start(const Vertices& vertices) const {
    const auto& tets_of_vertex = input_->adjacency().tets_of_vertex;
    if (vertices[0] == first_) {
      const std::uint64_t elsewhere = ~places_of(vertices);
      const auto at_first = tets_of_vertex[first_];
      for (std::size_t n = 0; n < at_first.size(); ++n) {
        const std::uint64_t foreign = around_[n] & elsewhere;
        const bool at_most_one = (foreign & (foreign - 1)) == 0;
        if (at_most_one && is_start(vertices, at_first[n])) return at_first[n];
      }
      return no_index;
    }
    const index_t v = *std::ranges::min_element(vertices, {}, [&](index_t w) { return tets_of_vertex[w].size(); });
    for (const index_t tet : tets_of_vertex[v])
      if (is_start(vertices, tet)) return tet;
    return no_index;
  }

  /// Does it have a triangle of the cell's faces, seen from inside?
  bool is_start(const Vertices& vertices, index_t tet) const {
    const Tet t = look_at(tet);
    if (t.kind() != OnCorners::all_four && t.kind() != OnCorners::three_of_four) return false;
    for (std::size_t i = 0; i < 4; ++i)
      if (const int triangle = wall(t, i); triangle >= 0 && is_seen_from_inside(vertices, triangle, tet, i))
        return true;
    return false;
  }

  bool is_seen_from_inside(const Vertices& vertices, int triangle, index_t tet, std::size_t i) const {
    const auto& outward = triangles.corners[static_cast<std::size_t>(triangle)];
    const auto seen = facet(input_->adjacency().tets[tet], static_cast<int>(i));
    const index_t first = vertices[static_cast<std::size_t>(outward[0])];
    const std::size_t next = seen[0] == first ? 1 : seen[1] == first ? 2 : 0;
    return seen[next] == vertices[static_cast<std::size_t>(outward[1])];
  }

  bool flood(const Vertices& vertices) {
    tets.clear();
    corners_of_.clear();
    foreign_.clear();
    n_exits_.fill(0);
    crossed_.reset();
    const index_t start = find_start(vertices);
    if (start == no_index || !enter(start)) return false;
    for (std::size_t n = 0; n < tets.size(); ++n) {
      const index_t tet = tets[n];
      const Tet t = corners_of_[n];
      for (std::size_t i = 0; i < 4; ++i) {
        const int triangle = wall(t, i);
        if (triangle >= 0) {
          const auto face = static_cast<std::size_t>(triangle) / 4;
          if (n_exits_[face] == 2) return false;
          exits_[face][n_exits_[face]++] = {tet, static_cast<std::int8_t>(i), static_cast<std::int8_t>(triangle)};
          continue;
        }
        if (is_crossed_again(t.facet(i))) continue;
        const index_t next = input_->adjacency().neighbours[tet][i];
        if (next == no_index || input_->patch(tet, i) != no_index) return false;
        if (std::find(tets.begin(), tets.end(), next) == tets.end() && !enter(next)) return false;
      }
    }
    return true;
  }

  /// A facet on three corners of the cell has two sides only: who meets it again came from where it leads.
  bool is_crossed_again(std::size_t facet) {
    if (triangles.tet[facet] != OnCorners::three_of_four) return false;
    const bool again = crossed_[facet];
    crossed_[facet] = true;
    return again;
  }

  bool enter(index_t tet) {
    const FinderOptions& options = input_->options();
    if (!options.free_tets.empty() && options.free_tets[tet] == 0) return false;
    if (!options.regions.empty() && !tets.empty() && options.regions[tet] != options.regions[tets[0]]) return false;
    const Tet t = look_at(tet);
    if (t.kind() == OnCorners::face_sliver) return false;
    if (t.kind() != OnCorners::all_four && !swallow_foreign(tet)) return false;
    tets.push_back(tet);
    corners_of_.push_back(t);
    return true;
  }

  bool swallow_foreign(index_t tet) {
    if (input_->options().max_interior_vertices == 0) return false;
    for (const index_t v : input_->adjacency().tets[tet]) {
      if (corner_set_[v] != 0 || std::ranges::find(foreign_, v) != foreign_.end()) continue;
      if (foreign_.size() == input_->options().max_interior_vertices || input_->features().touches(v)) return false;
      foreign_.push_back(v);
    }
    return true;
  }

  /// Whether the flood has left every face by one of its cuts.
  bool closes() const {
    for (std::size_t f = 0; f < n_faces; ++f) {
      const auto& exits = exits_[f];
      if (faces_of(kind)[f].size() == 3 ? n_exits_[f] != 1
                                        : n_exits_[f] != 2 || exits[0].triangle / 2 != exits[1].triangle / 2 ||
                                              exits[0].triangle == exits[1].triangle)
        return false;
    }
    return true;
  }

  /// The flood for each way to cut the faces by facets of the mesh; stops at the one with the fewest tetrahedra.
  bool flood_cut_by_cut(const Vertices& vertices) {
    std::array<std::uint8_t, n_faces> cuts{};
    for (std::size_t f = 0; f < n_faces; ++f) {
      const auto is_facet = [&](std::size_t t) {
        const auto& c = triangles.corners[4 * f + t];
        const auto at = [&](std::size_t i) { return vertices[static_cast<std::size_t>(c[i])]; };
        return input_->links().is_facet(at(0), at(1), at(2));
      };
      if (faces_of(kind)[f].size() == 3)
        cuts[f] = is_facet(0) ? 1 : 0;
      else
        cuts[f] =
            static_cast<std::uint8_t>((is_facet(0) && is_facet(1) ? 1 : 0) | (is_facet(2) && is_facet(3) ? 2 : 0));
      if (cuts[f] == 0) return false;
    }
    std::size_t fewest = static_cast<std::size_t>(-1);
    std::uint32_t best = 0;
    for (unsigned choice = 0; choice < (1u << n_faces); ++choice) {
      std::uint32_t walls = 0;
      bool possible = true;
      for (std::size_t f = 0; f < n_faces; ++f) {
        const unsigned cut = choice >> f & 1;
        possible &= (cuts[f] >> cut & 1) != 0;
        walls |= 3u << (4 * f + 2 * cut);
      }
      if (!possible) continue;
      walls_ = walls;
      if (!flood(vertices) || !closes() || tets.size() >= fewest) continue;
      fewest = tets.size();
      best = walls;
    }
    walls_ = best;
    return best != 0 && flood(vertices) && closes();
  }

  bool check_slivers(const Vertices& vertices) {
    slivers.clear();
    for (std::size_t f = 0; f < n_faces; ++f)
      if (faces_of(kind)[f].size() == 4 && !check_quadrilateral(vertices, exits_[f])) return false;
    return true;
  }

  bool check_quadrilateral(const Vertices& vertices, const std::array<Exit, 2>& exits) {
    const auto behind = [this](const Exit& e) {
      return input_->adjacency().neighbours[e.tet][static_cast<std::size_t>(e.facet)];
    };
    const index_t sliver = behind(exits[0]);
    if (sliver == no_index || sliver != behind(exits[1]) || look_at(sliver).kind() != OnCorners::face_sliver)
      return keeps_boundary_rule(exits[0].tet, static_cast<std::size_t>(exits[0].facet), exits[1].tet,
                                 static_cast<std::size_t>(exits[1].facet)) &&
             !faces_across_void(vertices, exits[0]);
    // It would vanish from behind the border of its own region, or from behind a patch.
    for (const Exit& e : exits)
      if (input_->is_boundary(e.tet, static_cast<std::size_t>(e.facet))) return false;
    slivers.push_back(sliver);
    // Behind a face sliver the outer triangles are its two facets that do not face the cell.
    std::array<std::size_t, 2> outer{};
    std::size_t n = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      const index_t next = input_->adjacency().neighbours[sliver][i];
      if ((next != exits[0].tet && next != exits[1].tet) || !shares_exit(sliver, i, exits)) {
        if (n == 2) return false;
        outer[n++] = i;
      }
    }
    return n == 2 && keeps_boundary_rule(sliver, outer[0], sliver, outer[1]);
  }

  /// Is a quadrilateral on the boundary cut the other way by a facet outside? The boundary then comes back to it over a
  /// void of the size of one tetrahedron, and what lies beyond would meet the quadrilateral in three corners.
  bool faces_across_void(const Vertices& vertices, const Exit& exit) const {
    if (!input_->is_boundary(exit.tet, static_cast<std::size_t>(exit.facet))) return false;
    const int other_cut = exit.triangle ^ 2;
    for (const int triangle : {other_cut, other_cut ^ 1}) {
      const auto& c = triangles.corners[static_cast<std::size_t>(triangle)];
      const auto at = [&](std::size_t i) { return vertices[static_cast<std::size_t>(c[i])]; };
      if (!input_->links().is_facet(at(0), at(1), at(2))) continue;
      for (const index_t tet : input_->adjacency().tets_of_vertex[at(0)]) {
        const auto& v = input_->adjacency().tets[tet];
        const bool has_both = std::ranges::count(v, at(1)) + std::ranges::count(v, at(2)) == 2;
        if (has_both && std::ranges::find(tets, tet) == tets.end()) return true;
      }
    }
    return false;
  }

  bool shares_exit(index_t sliver, std::size_t i, const std::array<Exit, 2>& exits) const {
    const auto key = sorted(facet(input_->adjacency().tets[sliver], static_cast<int>(i)));
    return std::ranges::any_of(
        exits, [&](const Exit& e) { return sorted(facet(input_->adjacency().tets[e.tet], e.facet)) == key; });
  }

  bool keeps_boundary_rule(index_t tet0, std::size_t facet0, index_t tet1, std::size_t facet1) const {
    if (input_->patch(tet0, facet0) != input_->patch(tet1, facet1)) return false;
    return input_->options().boundary_rule == BoundaryRule::ignore ||
           input_->is_boundary(tet0, facet0) == input_->is_boundary(tet1, facet1);
  }

  bool keeps_features(const Vertices& vertices) const {
    const FeatureEdges& features = input_->features();
    if (features.empty()) return true;
    for (std::size_t i = 0; i < vertices.size(); ++i) {
      if (!features.touches(vertices[i])) continue;
      for (std::size_t j = 0; j < i; ++j)
        if (features.contains(vertices[i], vertices[j]) && !is_edge(i, j)) return false;
    }
    return true;
  }

  static bool is_edge(std::size_t i, std::size_t j) {
    return std::ranges::any_of(edges_of(kind), [&](const auto& e) {
      const auto p = static_cast<std::size_t>(e[0]), q = static_cast<std::size_t>(e[1]);
      return (p == i && q == j) || (p == j && q == i);
    });
  }

  static constexpr std::uint32_t all_walls = ~std::uint32_t{0};

  const FinderInput* input_;
  std::uint32_t walls_ = all_walls;       ///< the triangles of FaceTriangles that the flood stops at
  std::vector<std::uint8_t> corner_set_;  ///< vertex -> set of its corner while a cell is looked at, else none
  index_t first_ = no_index;              ///< the corner 0 that is prepared for
  std::vector<std::uint8_t> place_;       ///< vertex -> 1 + its position among the neighbours of `first_`, else 0
  std::vector<std::uint64_t> around_;     ///< places of the corners of each tetrahedron of `first_`
  std::vector<Tet> corners_of_;           ///< parallel to `tets` during the flood
  std::bitset<256> crossed_;              ///< facets inside, by the set of their corners
  std::vector<index_t> foreign_;
  std::array<std::array<Exit, 2>, n_faces> exits_{};
  std::array<std::uint8_t, n_faces> n_exits_{};
};

}  // namespace framehex::detail
