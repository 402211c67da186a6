// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/geometry/predicates.hpp"
#include "framehex/mesh/enclosed_volume.hpp"
#include "framehex/surface/surface.hpp"
#include "framehex/surface/surface_locator.hpp"

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace framehex {

/// Which parts of space the patches of a surface separate.
struct SurfaceRegions {
  /// n_patches: the region behind each patch (its normals point out of it) and the one in front; `no_index`: empty space.
  std::vector<std::array<index_t, 2>> sides;
  index_t n_regions = 0;

  /// Has the patch material on both sides?
  bool is_interface(index_t patch) const { return sides[patch][0] != no_index && sides[patch][1] != no_index; }
  bool has_interfaces() const {
    for (index_t patch = 0; patch < sides.size(); ++patch)
      if (is_interface(patch)) return true;
    return false;
  }
};

namespace detail {

/// Sets of numbers that are joined one by one; each is known by its smallest member.
class DisjointSets {
public:
  explicit DisjointSets(std::size_t n) : parent_(n) { std::iota(parent_.begin(), parent_.end(), index_t{0}); }
  index_t find(index_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void join(index_t i, index_t j) {
    i = find(i);
    j = find(j);
    parent_[std::max(i, j)] = std::min(i, j);
  }

private:
  std::vector<index_t> parent_;
};

/// Walks over the two sides of every triangle: 2 t is the side behind triangle t, 2 t + 1 the one in front. Sides that
/// are joined round their edges are a shell. A shell of positive volume bounds a cell of space; one of negative volume
/// is a part of the surface seen from outside, and floats in a cell of another part or in the outer space.
class RegionFinder {
public:
  explicit RegionFinder(const Surface& surface)
      : surface_(surface),
        adjacency_(surface.adjacency),
        sides_(2 * adjacency_.triangles.size()),
        parts_(adjacency_.triangles.size()) {
    join_sides();
    collect_shells();
    place_floating_shells();
  }

  SurfaceRegions regions() {
    number_regions();
    if (n_regions_ == 0)
      throw invalid_surface("the surface is inside out: its triangles must be anticlockwise seen from outside");
    SurfaceRegions result;
    result.n_regions = n_regions_;
    result.sides.assign(surface_.features.n_patches, {no_index, no_index});
    for (index_t t = 0; t < adjacency_.triangles.size(); ++t) {
      const index_t behind = region_of_side(2 * t), front = region_of_side(2 * t + 1);
      if (behind == no_index)
        throw invalid_surface("triangle " + std::to_string(t) +
                                  (front == no_index ? " has no material on either side"
                                                     : " is inside out: its normal points into the material"),
                              Entity::triangle, {t});
      result.sides[surface_.features.triangle_patch[t]] = {behind, front};
    }
    return result;
  }

  /// Which triangles have to be turned for every closed cell to be a region: space outside lies in front of the outermost,
  /// and behind every other is the cell that is farther from it. Each cell has a triangle in front of which there is one
  /// that is nearer.
  std::vector<std::uint8_t> wrong_for_regions() const {
    const std::vector<index_t> depth = cell_depths();
    std::vector<std::uint8_t> wrong(adjacency_.triangles.size(), 0);
    for (index_t t = 0; t < wrong.size(); ++t) {
      const index_t behind = cell_of_side(2 * t), front = cell_of_side(2 * t + 1);
      wrong[t] = front != no_index && (behind == no_index || depth[behind] < depth[front]);
    }
    return wrong;
  }

private:
  struct Shell {
    std::vector<std::array<index_t, 3>> triangles;  ///< normals out of the cell
    index_t part;
    double volume = 0;
    index_t cell = no_index;  ///< the shell that bounds the cell this one looks into; `no_index`: the outer space
    bool only_fronts = true;
    index_t region = no_index;
  };

  void join_sides() {
    std::vector<std::array<index_t, 3>> junctions;
    for (index_t h = 0; h < adjacency_.opposite.size(); ++h) {
      const index_t g = adjacency_.opposite[h], t = h / 3, s = g / 3;
      if (g == no_index) {
        const auto [low, high] = std::minmax({adjacency_.from(h), adjacency_.to(h)});
        junctions.push_back({low, high, h});
      } else if (h < g) {
        sides_.join(2 * t, 2 * s);
        sides_.join(2 * t + 1, 2 * s + 1);
        parts_.join(t, s);
      }
    }
    std::sort(junctions.begin(), junctions.end());
    for (std::size_t i = 0, end = 0; i < junctions.size(); i = end) {
      while (end < junctions.size() && junctions[end][0] == junctions[i][0] && junctions[end][1] == junctions[i][1])
        ++end;
      join_round(std::span(junctions).subspan(i, end - i));
    }
  }

  /// Neighbours in the order of their angles about an edge look at each other.
  void join_round(std::span<std::array<index_t, 3>> fan) {
    const index_t low = fan[0][0], high = fan[0][1];
    if (fan.size() == 1)
      throw open_surface("the surface is open along edge (" + std::to_string(low) + ", " + std::to_string(high) + ")",
                         Entity::edge, {low, high});
    sort_by_angle(fan);
    // Along the edge from low to high the front of a triangle looks the way of rising angles.
    const auto side = [&](index_t h, bool rising) { return 2 * (h / 3) + ((adjacency_.from(h) == low) == rising); };
    for (std::size_t i = 0; i < fan.size(); ++i) {
      const index_t h = fan[i][2], next = fan[(i + 1) % fan.size()][2];
      sides_.join(side(h, true), side(next, false));
      parts_.join(h / 3, next / 3);
    }
  }

  /// From the first, by the exact predicate: which of two comes first is plain within half a turn.
  void sort_by_angle(std::span<std::array<index_t, 3>> fan) const {
    const Vector3 &a = surface_.points[fan[0][0]], &b = surface_.points[fan[0][1]];
    const auto apex = [&](const std::array<index_t, 3>& use) { return surface_.points[adjacency_.apex(use[2])]; };
    const Vector3 first = apex(fan[0]), axis = b - a;
    const auto quarter = [&](const Vector3& p) {
      const int side = orientation(a, b, first, p);
      if (side != 0) return side > 0 ? 1 : 3;
      return (first - a).cross(axis).dot((p - a).cross(axis)) > 0 ? 0 : 2;
    };
    std::sort(fan.begin(), fan.end(), [&](const auto& x, const auto& y) {
      const Vector3 p = apex(x), q = apex(y);
      const int of_p = quarter(p), of_q = quarter(q);
      if (of_p != of_q) return of_p < of_q;
      const int turn = orientation(a, b, p, q);
      return turn != 0 ? turn > 0 : x[2] < y[2];
    });
  }

  void collect_shells() {
    const auto n_sides = static_cast<index_t>(2 * adjacency_.triangles.size());
    shell_of_side_.assign(n_sides, no_index);
    for (index_t side = 0; side < n_sides; ++side) {
      const index_t root = sides_.find(side);
      if (root == side) {
        shell_of_side_[side] = static_cast<index_t>(shells_.size());
        shells_.push_back({.triangles = {}, .part = parts_.find(side / 2)});
      }
      Shell& shell = shells_[shell_of_side_[side] = shell_of_side_[root]];
      auto& triangle = shell.triangles.emplace_back(adjacency_.triangles[side / 2]);
      if (side % 2 == 1)
        std::swap(triangle[1], triangle[2]);
      else
        shell.only_fronts = false;
    }
    for (Shell& shell : shells_) shell.volume = enclosed_volume(TriangleView{surface_.points, shell.triangles});
  }

  /// The smallest cell of another part round a shell that is seen from outside is the one it floats in.
  void place_floating_shells() {
    std::vector<SurfaceLocator> locators(shells_.size());
    for (index_t i = 0; i < shells_.size(); ++i) {
      Shell& shell = shells_[i];
      if (shell.volume > 0) {
        shell.cell = i;
        continue;
      }
      const auto& t = shell.triangles.front();
      const Vector3 p = (surface_.points[t[0]] + surface_.points[t[1]] + surface_.points[t[2]]) / 3;
      for (index_t j = 0; j < shells_.size(); ++j) {
        const Shell& other = shells_[j];
        if (other.volume <= 0 || other.part == shell.part) continue;
        if (shell.cell != no_index && shells_[shell.cell].volume <= other.volume) continue;
        if (locators[j].empty()) locators[j] = SurfaceLocator(TriangleView{surface_.points, other.triangles});
        if (locators[j].inside(p)) shell.cell = j;
      }
    }
  }

  /// A cell into which all normals point is a cavity.
  void number_regions() {
    std::vector<std::uint8_t> filled(shells_.size(), 0);
    for (const Shell& shell : shells_)
      if (shell.cell != no_index && !shell.only_fronts) filled[shell.cell] = 1;
    for (index_t i = 0; i < shells_.size(); ++i)
      if (filled[i]) shells_[i].region = n_regions_++;
  }

  index_t cell_of_side(index_t side) const { return shells_[shell_of_side_[side]].cell; }

  /// How many triangles are passed on the way from a cell to the space outside, at least.
  std::vector<index_t> cell_depths() const {
    std::vector<index_t> depth(shells_.size(), no_index), front, next;
    const Csr<index_t> neighbours = make_csr(shells_.size() + 1, [&](auto&& put) {
      for (index_t side = 0; side < shell_of_side_.size(); ++side) {
        const index_t from = cell_of_side(side), to = cell_of_side(side ^ 1u);
        if (to != no_index && to != from) put(from == no_index ? shells_.size() : from, to);
      }
    });
    front.push_back(static_cast<index_t>(shells_.size()));
    for (index_t level = 0; !front.empty(); ++level) {
      next.clear();
      for (const index_t cell : front)
        for (const index_t other : neighbours[cell])
          if (depth[other] == no_index) {
            depth[other] = level;
            next.push_back(other);
          }
      front.swap(next);
    }
    return depth;
  }

  index_t region_of_side(index_t side) const {
    const index_t cell = cell_of_side(side);
    return cell == no_index ? no_index : shells_[cell].region;
  }

  const Surface& surface_;
  const TriangleAdjacency& adjacency_;
  DisjointSets sides_;
  DisjointSets parts_;  // triangles joined by edges
  std::vector<index_t> shell_of_side_;
  std::vector<Shell> shells_;
  index_t n_regions_ = 0;
};

}  // namespace detail

/// The regions into which a surface divides space: every cell that it closes off, but for cavities.
///
/// Patches may separate two materials; edges where they meet have three or more triangles. The normals of the outer
/// boundary point away from the material; those of an interface point either way. A cell into which all normals point
/// is a cavity, and empty. Parts of the surface may be nested.
///
/// @param surface  no triangles that cross (`find_self_intersections`).
/// @return for each patch what lies behind and in front of it; regions are numbered by their first triangle.
/// @throws open_surface  with an edge that only one triangle has; invalid_surface  for a surface that is inside out, or
///         with the first triangle whose normal points into the material, or that has none on either side.
/// @par Complexity   O(n log n), and O(parts^2 log n) for the nesting of parts.
inline SurfaceRegions find_regions(const Surface& surface) {
  return detail::RegionFinder(surface).regions();
}

/// Turns triangles so that `find_regions` takes every part of space that the surface closes off for a region, none for a
/// cavity.
///
/// @param mesh  no triangles that cross; which way they look does not matter.
/// @return how many were turned.
/// @throws open_surface  with an edge that only one triangle has.
/// @par Complexity   as `find_regions`.
inline std::size_t turn_to_regions(IndexedTriangleMesh& mesh) {
  const Surface surface(mesh);
  const std::vector<std::uint8_t> wrong = detail::RegionFinder(surface).wrong_for_regions();
  for (std::size_t t = 0; t < wrong.size(); ++t)
    if (wrong[t]) std::swap(mesh.triangles[t][1], mesh.triangles[t][2]);
  return static_cast<std::size_t>(std::count(wrong.begin(), wrong.end(), 1));
}

/// The closed surface of one region, numbered for itself.
struct RegionSurface {
  IndexedTriangleMesh surface;     ///< outward; vertices ascending
  std::vector<index_t> vertex_of;  ///< vertex -> vertex of the whole
};

/// Cuts out the surface of a region.
///
/// @par Complexity   O(n).
inline RegionSurface region_surface(const Surface& whole, const SurfaceRegions& regions, index_t region) {
  RegionSurface result;
  for (std::size_t t = 0; t < whole.triangles().size(); ++t) {
    const auto [behind, front] = regions.sides[whole.features.triangle_patch[t]];
    auto triangle = whole.triangles()[t];
    if (front == region) std::swap(triangle[1], triangle[2]);
    if (behind == region || front == region) result.surface.triangles.push_back(triangle);
  }
  std::vector<index_t> number(whole.points.size(), no_index);
  for (const auto& t : result.surface.triangles)
    for (const index_t v : t) number[v] = 0;
  for (index_t v = 0; v < number.size(); ++v) {
    if (number[v] == no_index) continue;
    number[v] = static_cast<index_t>(result.vertex_of.size());
    result.vertex_of.push_back(v);
    result.surface.points.push_back(whole.points[v]);
  }
  for (auto& t : result.surface.triangles)
    for (index_t& v : t) v = number[v];
  return result;
}

/// The surface without its interfaces, its features found anew, and the vertices that it keeps.
///
/// @par Complexity   O(n).
inline std::pair<Surface, std::vector<index_t>> outer_boundary(const Surface& whole, SurfaceRegions regions,
                                                               const FeatureOptions& features) {
  for (std::array<index_t, 2>& sides : regions.sides) sides[0] = sides[1] == no_index ? 0 : 1;
  RegionSurface part = region_surface(whole, regions, 0);
  return {Surface(part.surface, {.angle = features.angle, .corner_angle = features.corner_angle}),
          std::move(part.vertex_of)};
}

}  // namespace framehex
