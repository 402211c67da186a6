// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/geometry/cell_kinds.hpp"
#include "framehex/geometry/validity.hpp"
#include "framehex/mesh/indexed_mesh.hpp"

#include <algorithm>
#include <map>
#include <numbers>
#include <set>

/// Potential cells from their definition: no search tree, no adjacency, no flood.
namespace framehex::test {

/// A cell with the tetrahedra strictly inside it (face slivers left out), for comparison.
struct ReferenceCell {
  std::vector<index_t> vertices;
  std::set<index_t> tets;
  friend auto operator<=>(const ReferenceCell&, const ReferenceCell&) = default;
};

class ReferenceFinder {
public:
  ReferenceFinder(const IndexedTetMesh& mesh, double floor, bool boundary_rule)
      : mesh_(mesh), floor_(floor), boundary_rule_(boundary_rule) {
    for (index_t t = 0; t < mesh.tets.size(); ++t)
      for (std::size_t i = 0; i < 4; ++i) {
        std::array<index_t, 3> f{};
        for (std::size_t j = 0, n = 0; j < 4; ++j)
          if (j != i) f[n++] = mesh.tets[t][j];
        std::ranges::sort(f);
        ++facets_[f];
      }
  }

  /// Whether the vertices, in the order of `kind`, are a potential cell; fills `cell`.
  bool is_potential(CellKind kind, const std::vector<index_t>& v, ReferenceCell& cell) const {
    std::vector<Vector3> p;
    for (const index_t w : v) p.push_back(mesh_.points[w]);
    for (const LocalCorner& c : corners_of(kind)) {
      const auto at = [&](std::int8_t i) { return p[static_cast<std::size_t>(i)]; };
      const Vector3 x = (at(c.x) - at(c.corner)).normalized(), y = (at(c.y) - at(c.corner)).normalized(),
                    z = (at(c.z) - at(c.corner)).normalized();
      if (x.dot(y.cross(z)) < floor_) return false;
    }
    std::vector<std::vector<std::vector<std::array<index_t, 3>>>> cuts;  // [face][cut][triangle]
    for (const LocalFace& face : faces_of(kind)) {
      const auto at = [&](int i) { return v[static_cast<std::size_t>(face.corners[static_cast<std::size_t>(i)])]; };
      auto& of_face = cuts.emplace_back();
      std::vector<std::vector<std::array<index_t, 3>>> all{{{at(0), at(1), at(2)}}};
      if (face.size() == 4)
        all = {{{at(0), at(1), at(2)}, {at(0), at(2), at(3)}}, {{at(1), at(2), at(3)}, {at(1), at(3), at(0)}}};
      for (const auto& cut : all)
        if (std::ranges::all_of(cut, [&](auto t) { return count(t) > 0; })) of_face.push_back(cut);
      if (of_face.empty()) return false;
    }
    if (!is_valid(kind, p)) return false;
    return fits_some_cut(kind, v, cuts, cell);
  }

  /// All potential hexahedra by all sets of eight vertices in all orders.
  std::set<ReferenceCell> hexahedra() const { return cells(CellKind::hexahedron, 8); }

  std::set<ReferenceCell> cells(CellKind kind, std::size_t n_corners) const {
    std::set<ReferenceCell> found;
    std::vector<index_t> chosen(n_corners);
    choose(kind, chosen, 0, 0, found);
    return found;
  }

private:
  int count(std::array<index_t, 3> facet) const {
    std::ranges::sort(facet);
    const auto it = facets_.find(facet);
    return it == facets_.end() ? 0 : it->second;
  }

  void choose(CellKind kind, std::vector<index_t>& chosen, std::size_t n, index_t from,
              std::set<ReferenceCell>& found) const {
    if (n < chosen.size()) {
      for (index_t v = from; v < mesh_.points.size(); ++v) {
        chosen[n] = v;
        choose(kind, chosen, n + 1, v + 1, found);
      }
      return;
    }
    auto order = chosen;
    do {
      // One representative of the rotations: the one that the finders promise.
      if (kind == CellKind::pyramid ? order[0] > std::min({order[1], order[2], order[3]}) : order[0] != chosen[0])
        continue;
      if (kind == CellKind::hexahedron && (order[1] > order[3] || order[1] > order[4])) continue;
      ReferenceCell cell;
      if (is_potential(kind, order, cell)) found.insert(cell);
    } while (std::ranges::next_permutation(order).found);
  }

  bool fits_some_cut(CellKind kind, const std::vector<index_t>& v,
                     const std::vector<std::vector<std::vector<std::array<index_t, 3>>>>& cuts,
                     ReferenceCell& cell) const {
    // With a face sliver both cuts of its face fit: the inner cut decides what is inside, the outer one what is
    // boundary.
    std::vector<std::size_t> choice(cuts.size(), 0);
    std::set<index_t> inner, outer;
    bool any = false, keeps_rule = false;
    while (true) {
      std::vector<std::array<index_t, 3>> surface;
      bool rule = true;
      for (std::size_t f = 0; f < cuts.size(); ++f) {
        const auto& cut = cuts[f][choice[f]];
        surface.insert(surface.end(), cut.begin(), cut.end());
        if (cut.size() == 2) rule &= (count(cut[0]) == 1) == (count(cut[1]) == 1);
      }
      std::set<index_t> inside;
      if (encloses(v, surface, inside)) {
        if (!any || inside.size() < inner.size()) inner = inside;
        if (!any || inside.size() > outer.size()) {
          outer = inside;
          keeps_rule = rule;
        }
        any = true;
      }
      std::size_t f = 0;
      while (f < cuts.size() && ++choice[f] == cuts[f].size()) choice[f++] = 0;
      if (f == cuts.size()) break;
    }
    if (!any || (boundary_rule_ && !keeps_rule)) return false;
    cell.vertices = v;
    cell.tets.clear();
    for (const index_t t : inner)
      if (!is_face_sliver(kind, v, mesh_.tets[t])) cell.tets.insert(t);
    return true;
  }

  static bool is_face_sliver(CellKind kind, const std::vector<index_t>& v, const std::array<index_t, 4>& tet) {
    return std::ranges::any_of(faces_of(kind), [&](const LocalFace& face) {
      return face.size() == 4 && std::ranges::all_of(tet, [&](index_t w) {
               return std::ranges::any_of(face.corners, [&](auto c) { return v[static_cast<std::size_t>(c)] == w; });
             });
    });
  }

  /// Tetrahedra whose centroid lies inside a closed surface, which they must fill, all on the cell's vertices.
  bool encloses(const std::vector<index_t>& v, const std::vector<std::array<index_t, 3>>& surface,
                std::set<index_t>& inside) const {
    const auto& p = mesh_.points;
    double volume = 0, filled = 0;
    for (const auto& t : surface) volume += (p[t[0]] - p[v[0]]).dot((p[t[1]] - p[v[0]]).cross(p[t[2]] - p[v[0]])) / 6;
    if (volume <= 0) return false;
    for (index_t t = 0; t < mesh_.tets.size(); ++t) {
      const auto& tet = mesh_.tets[t];
      if (!std::ranges::all_of(tet, [&](index_t w) { return std::ranges::find(v, w) != v.end(); })) continue;
      const Vector3 centre = (p[tet[0]] + p[tet[1]] + p[tet[2]] + p[tet[3]]) / 4;
      double angle = 0;  // the surface's solid angle, by van Oosterom and Strackee
      for (const auto& s : surface) {
        const Vector3 a = p[s[0]] - centre, b = p[s[1]] - centre, c = p[s[2]] - centre;
        angle += 2 * std::atan2(a.dot(b.cross(c)), a.norm() * b.norm() * c.norm() + a.dot(b) * c.norm() +
                                                       b.dot(c) * a.norm() + c.dot(a) * b.norm());
      }
      if (angle < 2 * std::numbers::pi) continue;
      inside.insert(t);
      filled += orientation_determinant(p[tet[0]], p[tet[1]], p[tet[2]], p[tet[3]]) / 6;
    }
    return std::abs(filled - volume) < 1e-9 * volume;
  }

  const IndexedTetMesh& mesh_;
  double floor_;
  bool boundary_rule_;
  std::map<std::array<index_t, 3>, int> facets_;
};

}  // namespace framehex::test
