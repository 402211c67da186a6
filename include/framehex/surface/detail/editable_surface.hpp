// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/surface/surface.hpp"

#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

namespace framehex::detail {

/// A triangulated surface that can be flipped, split and collapsed in place, in flat arrays.
///
/// Half edge 3t+i runs from corner i of triangle t to corner i+1, as in TriangleAdjacency. A dead triangle has
/// `no_index` as its corners. `sector` names, at each corner, the smooth sector of the vertex's star that the triangle
/// belongs to: sectors are divided by feature edges, and whoever needs a normal that does not average over a sharp edge
/// keeps one for each sector.
///
/// Where several sheets meet, in an edge of three or more triangles or in a vertex, each fan of triangles has a copy of
/// the vertex for itself, and the sheets end in rims; `name` tells copies of one vertex. What happens to a rim happens
/// to all its sides.
class EditableSurface {
public:
  std::vector<Vector3> points;
  std::vector<std::array<index_t, 3>> corners;
  std::vector<index_t> opposite;      ///< per half edge; `no_index` on a rim
  std::vector<std::uint8_t> feature;  ///< per half edge
  std::vector<index_t> sector;        ///< per corner, numbered like the half edge that leaves it
  std::vector<index_t> patch;         ///< per triangle
  std::vector<index_t> parent;        ///< per triangle: triangle of the surface that was read
  std::vector<index_t> half_edge_of;  ///< per vertex: one that leaves it; `no_index` for a vertex without triangles
  std::vector<index_t> name;          ///< per vertex: the first of its copies, usually itself

  explicit EditableSurface(const Surface& surface)
      : points(surface.points),
        corners(surface.triangles()),
        opposite(surface.adjacency.opposite),
        feature(surface.features.is_feature),
        sector(3 * corners.size(), no_index),
        patch(surface.features.triangle_patch),
        parent(corners.size()),
        half_edge_of(surface.points.size(), no_index),
        name(surface.points.size()) {
    std::iota(parent.begin(), parent.end(), index_t{0});
    std::iota(name.begin(), name.end(), index_t{0});
    next_copy_ = name;
    give_fans_copies();
    number_sectors();
  }

  std::size_t n_triangles() const { return corners.size(); }
  index_t n_sectors() const { return n_sectors_; }
  index_t add_sector() { return n_sectors_++; }
  bool alive(index_t triangle) const { return corners[triangle][0] != no_index; }

  static index_t next(index_t h) { return h % 3 == 2 ? h - 2 : h + 1; }
  static index_t previous(index_t h) { return h % 3 == 0 ? h + 2 : h - 1; }
  index_t from(index_t h) const { return corners[h / 3][h % 3]; }
  index_t to(index_t h) const { return from(next(h)); }
  index_t apex(index_t h) const { return from(previous(h)); }

  index_t add_vertex(const Vector3& point) {
    const auto v = static_cast<index_t>(points.size());
    points.push_back(point);
    half_edge_of.push_back(no_index);
    name.push_back(v);
    next_copy_.push_back(v);
    return v;
  }

  /// Another vertex at the place of v, for another fan.
  index_t add_copy(index_t v) {
    const index_t copy = add_vertex(Vector3(points[v]));
    name[copy] = name[v];
    next_copy_[copy] = std::exchange(next_copy_[v], copy);
    return copy;
  }
  bool has_copies(index_t v) const { return next_copy_[v] != v; }

  template <class Visit>
  void for_each_copy(index_t v, Visit&& visit) const {
    index_t copy = v;
    do {
      visit(copy);
      copy = next_copy_[copy];
    } while (copy != v);
  }

  /// Numbers the vertices by their names and takes the copies out. @return old number -> new number.
  std::vector<index_t> join_copies() {
    std::vector<index_t> number(points.size());
    index_t n = 0;
    for (index_t v = 0; v < points.size(); ++v) {
      number[v] = name[v] == v ? n++ : number[name[v]];
      points[number[v]] = points[v];
    }
    points.resize(n);
    for (auto& triangle : corners)
      for (index_t& v : triangle)
        if (v != no_index) v = number[v];
    return number;
  }

  /// The half edges, but h, that lie on the same edge where it is a rim.
  std::vector<index_t> other_sides(index_t h) const {
    std::vector<index_t> result;
    if (opposite[h] != no_index) return result;
    const index_t end = name[to(h)];
    for_each_copy(from(h), [&](index_t copy) {
      for_each_outgoing(copy, [&](index_t o) {
        const index_t in = previous(o);
        if (o != h && opposite[o] == no_index && name[to(o)] == end) result.push_back(o);
        if (opposite[in] == no_index && name[from(in)] == end) result.push_back(in);
      });
    });
    return result;
  }

  /// Calls `visit(h)` for each half edge that leaves v, anticlockwise from `half_edge_of[v]`, or from the rim if it is
  /// met. `visit` must not change the surface.
  template <class Visit>
  void for_each_outgoing(index_t v, Visit&& visit) const {
    const index_t start = half_edge_of[v];
    if (start == no_index) return;
    index_t h = start;
    do {
      visit(h);
      h = opposite[previous(h)];
    } while (h != start && h != no_index);
    if (h == start) return;
    for (h = opposite[start]; h != no_index; h = opposite[h]) {
      h = next(h);
      visit(h);
    }
  }

  /// Half edge from v to w or their copies; `no_index` when they are not joined, or only by the other half on a rim.
  index_t find(index_t v, index_t w) const {
    index_t found = no_index;
    for_each_copy(v, [&](index_t copy) {
      for_each_outgoing(copy, [&](index_t h) {
        if (name[to(h)] == name[w]) found = h;
      });
    });
    return found;
  }

  /// Are v and w, or copies of them, joined by an edge, or one vertex?
  bool joined(index_t v, index_t w) const {
    const index_t wanted = name[w];
    bool result = name[v] == wanted;
    for_each_copy(v, [&](index_t copy) {
      for_each_outgoing(copy, [&](index_t h) { result = result || name[to(h)] == wanted || name[apex(h)] == wanted; });
    });
    return result;
  }

  /// Turns the edge in the quadrilateral of its two triangles. @pre not a rim; the other diagonal does not exist yet.
  void flip(index_t h) {
    const index_t g = opposite[h], t = h / 3, s = g / 3;
    const Corner a = corner(h), b = corner(next(h)), c = corner(previous(h)), d = corner(previous(g));
    const Side bc = side(next(h)), ca = side(previous(h)), ad = side(next(g)), db = side(previous(g));
    set(t, {a, d, c});
    set(s, {b, c, d});
    attach(3 * t, ad);
    join(3 * t + 1, 3 * s + 1, 0);
    attach(3 * t + 2, ca);
    attach(3 * s, bc);
    attach(3 * s + 2, db);
  }

  /// Cuts edge h = (a, b) at v: h becomes (a, v), still in its triangle.
  /// @param left,right  sector of v in the triangles of h and of its opposite.
  /// @return the half edge from v to b.
  index_t split_edge(index_t h, index_t v, index_t left, index_t right) {
    const index_t g = opposite[h], t = h / 3;
    const std::uint8_t flag = feature[h];
    const Corner a = corner(h), b = corner(next(h)), c = corner(previous(h));
    const Corner v_left{v, left}, v_right{v, right};
    const Side bc = side(next(h));
    const index_t t2 = add_triangle(t);
    corners[t][next(h) % 3] = v;
    sector[next(h)] = left;
    set(t2, {v_left, b, c});
    attach(3 * t2 + 1, bc);
    join(3 * t2 + 2, next(h), 0);
    feature[3 * t2] = flag;
    half_edge_of[v] = 3 * t2;
    half_edge_of[a.vertex] = h;
    half_edge_of[b.vertex] = 3 * t2 + 1;
    half_edge_of[c.vertex] = 3 * t2 + 2;
    opposite[3 * t2] = no_index;
    if (g == no_index) return 3 * t2;

    const Corner d = corner(previous(g)), a_right = corner(next(g));
    const index_t s = g / 3;
    const Side ad = side(next(g));
    const index_t s2 = add_triangle(s);
    corners[s][next(g) % 3] = v;
    sector[next(g)] = right;
    set(s2, {v_right, a_right, d});
    attach(3 * s2 + 1, ad);
    join(3 * s2 + 2, next(g), 0);
    half_edge_of[d.vertex] = 3 * s2 + 2;
    join(3 * s2, h, flag);
    join(g, 3 * t2, flag);
    half_edge_of[a.vertex] = h;
    return 3 * t2;
  }

  /// Cuts triangle t into three about v.
  void split_triangle(index_t t, index_t v, index_t v_sector) {
    const Corner a = corner(3 * t), b = corner(3 * t + 1), c = corner(3 * t + 2), m{v, v_sector};
    const Side bc = side(3 * t + 1), ca = side(3 * t + 2);
    const index_t t2 = add_triangle(t), t3 = add_triangle(t);
    set(t, {a, b, m});
    set(t2, {b, c, m});
    set(t3, {c, a, m});
    attach(3 * t2, bc);
    attach(3 * t3, ca);
    join(3 * t + 1, 3 * t2 + 2, 0);
    join(3 * t2 + 1, 3 * t3 + 2, 0);
    join(3 * t3 + 1, 3 * t + 2, 0);
  }

  /// Moves v = from(h) into w = to(h); v and the triangles of h vanish. @pre the link condition holds; v is not on a
  /// rim unless h or its opposite is.
  void collapse(index_t h) {
    const index_t g = opposite[h], v = from(h), w = to(h), t = h / 3;
    const index_t left = sector[next(h)], right = g == no_index ? left : sector[g];
    // Relabel the star of v, anticlockwise from h; past a feature edge the other side's sector begins.
    index_t now = left;
    index_t o = opposite[previous(h)];
    while (o != no_index && o / 3 != t && o != h) {
      if (feature[o]) now = right;
      corners[o / 3][o % 3] = w;
      sector[o] = now;
      o = opposite[previous(o)];
    }
    if (o == no_index && g != no_index)  // a rim was met: the rest is clockwise from h
      for (o = next(g); o != no_index; o = opposite[o] == no_index ? no_index : next(opposite[o])) {
        corners[o / 3][o % 3] = w;
        sector[o] = right;
      }
    close_up(h);
    if (g != no_index) close_up(g);
    half_edge_of[v] = no_index;
  }

  /// Moves v, one end of rim h, into the other end; v and the triangle of h vanish.
  /// @pre h is one of the two rims of v's fan, which holds no other feature.
  void collapse_rim(index_t h, index_t v) {
    const index_t other = from(h) == v ? next(h) : h, w = from(other);
    std::vector<index_t> fan;
    for_each_outgoing(v, [&](index_t o) { fan.push_back(o); });
    for (const index_t o : fan) {
      if (o / 3 == h / 3) continue;
      corners[o / 3][o % 3] = w;
      sector[o] = sector[other];
    }
    close_up(h);
    half_edge_of[v] = no_index;
  }

private:
  struct Corner {
    index_t vertex, sector;
  };
  struct Side {
    index_t opposite;
    std::uint8_t feature;
  };

  Corner corner(index_t h) const { return {from(h), sector[h]}; }
  Side side(index_t h) const { return {opposite[h], feature[h]}; }

  void set(index_t t, const std::array<Corner, 3>& c) {
    for (index_t i = 0; i < 3; ++i) {
      corners[t][i] = c[i].vertex;
      sector[3 * t + i] = c[i].sector;
      half_edge_of[c[i].vertex] = 3 * t + i;
    }
  }
  void attach(index_t h, const Side& s) {
    opposite[h] = s.opposite;
    feature[h] = s.feature;
    if (s.opposite != no_index) opposite[s.opposite] = h;
  }
  void join(index_t h, index_t g, std::uint8_t flag) {
    opposite[h] = g;
    opposite[g] = h;
    feature[h] = feature[g] = flag;
  }
  index_t add_triangle(index_t like) {
    check_count(corners.size() + 1, TriangleAdjacency::most_triangles, "triangles");
    const auto t = static_cast<index_t>(corners.size());
    corners.push_back({no_index, no_index, no_index});
    opposite.insert(opposite.end(), 3, no_index);
    feature.insert(feature.end(), 3, 0);
    sector.insert(sector.end(), 3, no_index);
    patch.push_back(patch[like]);
    parent.push_back(parent[like]);
    return t;
  }

  /// Takes away the triangle of h, whose two other sides become one.
  void close_up(index_t h) {
    const index_t x = opposite[next(h)], y = opposite[previous(h)];
    const std::uint8_t flag = feature[next(h)] | feature[previous(h)];
    if (x != no_index) {
      opposite[x] = y;
      feature[x] = flag;
      half_edge_of[from(x)] = x;
      half_edge_of[to(x)] = next(x);
    }
    if (y != no_index) {
      opposite[y] = x;
      feature[y] = flag;
      half_edge_of[from(y)] = y;
      half_edge_of[to(y)] = next(y);
    }
    corners[h / 3] = {no_index, no_index, no_index};
  }

  /// A vertex with several fans of triangles keeps the first; each other gets a copy.
  void give_fans_copies() {
    std::vector<std::uint8_t> seen(opposite.size(), 0);
    for (index_t h = 0; h < opposite.size(); ++h) {
      if (seen[h]) continue;
      const index_t v = half_edge_of[from(h)] == no_index ? from(h) : add_copy(from(h));
      half_edge_of[v] = h;
      for_each_outgoing(v, [&](index_t o) {
        corners[o / 3][o % 3] = v;
        seen[o] = 1;
      });
    }
  }

  /// Corners joined across edges that are not features share a sector.
  void number_sectors() {
    for (index_t v = 0; v < points.size(); ++v) {
      const index_t start = half_edge_of[v];
      if (start == no_index) continue;
      for_each_outgoing(v, [&](index_t h) {
        if (sector[h] != no_index) return;
        const index_t number = n_sectors_++;
        for (index_t o = h; o != no_index && sector[o] == no_index;) {
          sector[o] = number;
          const index_t p = previous(o);
          o = feature[p] ? no_index : opposite[p];
        }
        for (index_t o = h; !feature[o] && opposite[o] != no_index;) {
          o = next(opposite[o]);
          if (sector[o] != no_index) break;
          sector[o] = number;
        }
      });
    }
  }

  index_t n_sectors_ = 0;
  std::vector<index_t> next_copy_;  ///< per vertex: the copies of a vertex form a ring
};

}  // namespace framehex::detail
