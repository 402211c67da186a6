// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/geometry/cell_kinds.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <vector>

/// All ways to cut a hexahedron into tetrahedra on its eight corners, as combinatorial balls.
namespace framehex::test {

using Subdivision = std::set<std::array<int, 4>>;  ///< tetrahedra on corners 0 to 7, ascending

class SubdivisionEnumerator {
public:
  /// At least one of each class under the 48 symmetries: all those of one way to cut the six faces for each class of
  /// such ways.
  std::set<Subdivision> up_to_symmetry() {
    std::set<std::set<std::set<int>>> seen;
    for (unsigned cut = 0; cut < 64; ++cut) {
      open_.clear();
      used_.clear();
      tets_.clear();
      std::set<std::set<int>> diagonals;
      for (std::size_t f = 0; f < 6; ++f) {
        const auto& c = cell_tables::hexahedron_faces[f].corners;
        const std::size_t s = cut >> f & 1;
        open_.insert(turned({c[s], c[s + 1], c[s + 2]}));
        open_.insert(turned({c[s], c[s + 2], c[(s + 3) % 4]}));
        diagonals.insert({c[s], c[s + 2]});
      }
      if (!seen.insert(diagonals).second) continue;
      for (const auto& map : symmetries()) {
        std::set<std::set<int>> mapped;
        for (const auto& d : diagonals)
          mapped.insert({map[static_cast<std::size_t>(*d.begin())], map[static_cast<std::size_t>(*d.rbegin())]});
        seen.insert(mapped);
      }
      hull_ = open_;
      grow();
    }
    return found_;
  }

  /// The 48 ways to map the hexahedron onto itself, mirrored ones included.
  static std::vector<std::array<int, 8>> symmetries() {
    constexpr std::array<int, 8> code{0, 1, 3, 2, 4, 5, 7, 6}, corner{0, 1, 3, 2, 4, 5, 7, 6};
    std::vector<std::array<int, 8>> maps;
    std::array<int, 3> axes{0, 1, 2};
    do {
      for (int flip = 0; flip < 8; ++flip) {
        std::array<int, 8> map{};
        for (std::size_t i = 0; i < 8; ++i) {
          int image = 0;
          for (std::size_t k = 0; k < 3; ++k) image |= (code[i] >> k & 1) << axes[k];
          map[i] = corner[static_cast<std::size_t>(image ^ flip)];
        }
        maps.push_back(map);
      }
    } while (std::ranges::next_permutation(axes).found);
    return maps;
  }

  static Subdivision image(const Subdivision& s, const std::array<int, 8>& map) {
    Subdivision mapped;
    for (auto tet : s) {
      for (int& v : tet) v = map[static_cast<std::size_t>(v)];
      std::ranges::sort(tet);
      mapped.insert(tet);
    }
    return mapped;
  }

private:
  using Facet = std::array<int, 3>;  ///< smallest corner first, anticlockwise seen from the outside of its tetrahedron

  static Facet turned(Facet f) {
    std::ranges::rotate(f, std::ranges::min_element(f));
    return f;
  }
  static Facet reversed(const Facet& f) { return {f[0], f[2], f[1]}; }

  /// Closes the first open facet in all ways.
  void grow() {
    if (open_.empty()) {
      if (is_ball()) {
        Subdivision s;
        for (auto tet : tets_) {
          std::ranges::sort(tet);
          s.insert(tet);
        }
        found_.insert(s);
      }
      return;
    }
    const Facet base = *open_.begin();
    for (int apex = 0; apex < 8; ++apex) {
      if (std::ranges::find(base, apex) != base.end()) continue;
      const std::array<int, 4> tet{apex, base[0], base[1], base[2]};
      if (is_flat(tet)) continue;
      const auto open = open_, used = used_;
      bool fits = true;
      for (const LocalFace& face : cell_tables::tetrahedron_faces) {
        const auto at = [&](std::size_t i) { return tet[static_cast<std::size_t>(face.corners[i])]; };
        fits &= add(turned({at(0), at(1), at(2)}));
      }
      if (fits) {
        tets_.push_back(tet);
        grow();
        tets_.pop_back();
      }
      open_ = open;
      used_ = used;
    }
  }

  bool add(const Facet& f) {
    if (open_.erase(f) == 1) {
      used_.insert(f);
      return true;
    }
    const Facet back = reversed(f);
    if (used_.count(f) || used_.count(back) || open_.count(back) || hull_.count(f) || hull_.count(back)) return false;
    used_.insert(f);
    open_.insert(back);
    return true;
  }

  static bool is_flat(const std::array<int, 4>& tet) {
    return std::ranges::any_of(cell_tables::hexahedron_faces, [&](const LocalFace& face) {
      return std::ranges::all_of(tet, [&](int v) { return std::ranges::find(face.corners, v) != face.corners.end(); });
    });
  }

  /// Whether the link of every corner is a disk.
  bool is_ball() const {
    for (int v = 0; v < 8; ++v) {
      std::set<int> vertices;
      std::map<int, std::vector<std::array<int, 2>>> star;  // corner of the link -> opposite edges of its triangles
      std::set<std::array<int, 2>> edges;
      int n_triangles = 0;
      for (const auto& tet : tets_) {
        if (std::ranges::find(tet, v) == tet.end()) continue;
        std::vector<int> t;
        for (const int w : tet)
          if (w != v) t.push_back(w);
        ++n_triangles;
        for (std::size_t i = 0; i < 3; ++i) {
          const int p = t[i], q = t[(i + 1) % 3], r = t[(i + 2) % 3];
          vertices.insert(p);
          star[p].push_back({q, r});
          edges.insert({std::min(p, q), std::max(p, q)});
        }
      }
      if (n_triangles == 0) return false;
      for (const auto& [w, links] : star)
        if (!is_connected(links)) return false;
      if (!is_connected({edges.begin(), edges.end()})) return false;
      if (static_cast<int>(vertices.size()) - static_cast<int>(edges.size()) + n_triangles != 1) return false;
    }
    return true;
  }

  static bool is_connected(const std::vector<std::array<int, 2>>& edges) {
    std::set<int> reached{edges[0][0]};
    for (std::size_t pass = 0; pass < edges.size(); ++pass)
      for (const auto& [p, q] : edges)
        if (reached.count(p) || reached.count(q)) reached.insert({p, q});
    return std::ranges::all_of(edges, [&](const auto& e) { return reached.count(e[0]) == 1; });
  }

  std::set<Facet> open_, used_, hull_;
  std::vector<std::array<int, 4>> tets_;
  std::set<Subdivision> found_;
};

}  // namespace framehex::test
