// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/errors.hpp"
#include "framehex/mesh/adjacency.hpp"
#include "framehex/mesh/quad_mesh.hpp"
#include "framehex/quads/detail/journal.hpp"

#include <algorithm>
#include <array>
#include <unordered_set>

namespace framehex::detail {

/// A mesh of quadrilaterals (and triangles) that can be changed in place, and changed back.
///
/// Half edge 4q+i runs from corner i of cell q to the next. A dead cell has `no_index` as its first corner. Feature edges
/// have no opposite: where curves divide the cells round a vertex, each fan has a copy of it for itself.
class EditableQuads {
public:
  using Cell = QuadMesh::Cell;

  JournaledArray<Vector3> points;   ///< by copy; copies of a vertex lie in one place
  JournaledArray<Vector3> normals;  ///< by copy: of its patch
  JournaledArray<Cell> corners;
  JournaledArray<index_t> opposite;  ///< by half edge; `no_index` on curves and rims
  JournaledArray<index_t>
      half_edge_of;                 ///< by copy: one that leaves it, the first of the fan if it is open; or `no_index`
  JournaledArray<index_t> n_cells;  ///< by copy: round it
  JournaledArray<index_t> patch;    ///< by cell
  JournaledArray<index_t> curve;    ///< by copy: on which it may move; `no_index`: none
  std::vector<index_t> target;      ///< by copy: how many cells its angle has room for; 4 inside
  std::vector<index_t> name;        ///< by copy: the vertex of the mesh
  std::vector<index_t> next_copy;   ///< by copy: the copies of a vertex form a ring

  static index_t first(index_t q) { return 4 * q; }
  index_t size(index_t q) const { return corners[q][3] == no_index ? 3 : 4; }
  index_t next(index_t h) const { return h % 4 + 1 == size(h / 4) ? h - h % 4 : h + 1; }
  index_t previous(index_t h) const { return h % 4 == 0 ? h + size(h / 4) - 1 : h - 1; }
  index_t from(index_t h) const { return corners[h / 4][h % 4]; }
  index_t to(index_t h) const { return from(next(h)); }
  bool alive(index_t q) const { return corners[q][0] != no_index; }
  bool is_quad(index_t q) const { return corners[q][3] != no_index; }

  /// Is the fan of a copy closed, without a curve or rim?
  bool is_inside(index_t v) const { return curve[v] == no_index && !fixed_[v] && next_copy[v] == v; }
  bool is_fixed(index_t v) const { return fixed_[v]; }
  /// Is it a corner inside a patch?
  bool is_tip(index_t v) const {
    return fixed_[v] && next_copy[v] == v && half_edge_of[v] != no_index && opposite[half_edge_of[v]] != no_index;
  }

  explicit EditableQuads(const QuadMesh& mesh) {
    std::unordered_set<std::uint64_t> walls;
    for (const LabelledEdge& edge : mesh.edges) walls.insert(edge_key(edge.vertices[0], edge.vertices[1]));
    corners = JournaledArray<Cell>(mesh.cells);
    patch = JournaledArray<index_t>(mesh.patches);
    find_opposites(mesh.points.size(), walls);
    divide_fans(mesh);
  }

  template <class Visit>
  void for_each_copy(index_t v, Visit&& visit) const {
    index_t copy = v;
    do {
      visit(copy);
      copy = next_copy[copy];
    } while (copy != v);
  }

  /// Calls `visit(h)` for each half edge that leaves the copy and has a cell on its left, anticlockwise.
  template <class Visit>
  void for_each_outgoing(index_t v, Visit&& visit) const {
    const index_t start = half_edge_of[v];
    if (start == no_index) return;
    index_t h = start;
    do {
      visit(h);
      h = opposite[previous(h)];
    } while (h != start && h != no_index);
  }

  /// Calls `visit(copy of a neighbour)` for each edge of the fan.
  template <class Visit>
  void for_each_neighbour(index_t v, Visit&& visit) const {
    for_each_outgoing(v, [&](index_t h) {
      visit(to(h));
      if (opposite[previous(h)] == no_index) visit(from(previous(h)));
    });
  }

  /// Calls `visit(copy of a corner)` for all corners of the cells round a vertex, itself among them, some twice.
  template <class Visit>
  void for_each_corner_about(index_t v, Visit&& visit) const {
    for_each_copy(v, [&](index_t copy) {
      for_each_outgoing(copy, [&](index_t h) {
        for (index_t i = 0; i < size(h / 4); ++i) visit(corners[h / 4][i]);
      });
    });
  }

  bool joined(index_t v, index_t w) const {
    bool found = name[v] == name[w];
    for_each_copy(
        v, [&](index_t copy) { for_each_neighbour(copy, [&](index_t x) { found = found || name[x] == name[w]; }); });
    return found;
  }

  void move(index_t v, const Vector3& place) {
    for_each_copy(v, [&](index_t copy) { points.set(copy, place); });
  }

  void mark() {
    each([](auto& array) { array.mark(); }), n_marked_ = target.size();
  }
  void keep() {
    each([](auto& array) { array.keep(); });
  }
  void take_back() {
    each([](auto& array) { array.take_back(); });
    for (auto* array : {&target, &name, &next_copy}) array->resize(n_marked_);
    fixed_.resize(n_marked_);
  }

  /// Turns the edge of two quadrilaterals to the next corners anticlockwise of its ends. @return the edge turned.
  index_t rotate(index_t h) {
    const index_t g = opposite[h], a_cell = h / 4, b_cell = g / 4;
    const index_t b = to(h), c = to(next(h)), d = from(previous(h)), a = from(h), e = to(next(g)),
                  f = from(previous(g));
    const index_t bc = opposite[next(h)], cd = opposite[next(next(h))], da = opposite[previous(h)];
    const index_t ae = opposite[next(g)], ef = opposite[next(next(g))], fb = opposite[previous(g)];
    corners.set(a_cell, {c, d, a, e});
    corners.set(b_cell, {e, f, b, c});
    attach(4 * a_cell, cd);
    attach(4 * a_cell + 1, da);
    attach(4 * a_cell + 2, ae);
    attach(4 * b_cell, ef);
    attach(4 * b_cell + 1, fb);
    attach(4 * b_cell + 2, bc);
    attach(4 * a_cell + 3, 4 * b_cell + 3);
    count(a, -1), count(b, -1), count(c, 1), count(e, 1);
    for (const index_t v : {a, b, c, d, e, f}) start_fan(v, v == a || v == d || v == c ? a_cell : b_cell);
    return 4 * a_cell + 3;
  }

  /// Lays the first corner of half edge h, which is inside, on the opposite corner of its quadrilateral, which vanishes.
  void collapse(index_t h) {
    const index_t q = h / 4, p = from(h), b = to(h), r = to(next(h)), d = from(previous(h));
    const index_t pb = opposite[h], br = opposite[next(h)], rd = opposite[next(next(h))], dp = opposite[previous(h)];
    std::vector<index_t> fan;
    for_each_outgoing(p, [&](index_t o) { fan.push_back(o); });
    for (const index_t o : fan) set_corner(o, r);
    count(r, static_cast<int>(n_cells[p]) - 2);
    count(b, -1), count(d, -1);
    n_cells.set(p, 0);
    half_edge_of.set(p, no_index);
    corners.set(q, {no_index, no_index, no_index, no_index});
    attach(pb, br);
    attach(dp, rd);
    start_fan(b, pb / 4), start_fan(r, pb / 4), start_fan(r, dp / 4), start_fan(d, dp / 4);
  }

  /// Joins the two quadrilaterals round a vertex inside that has no others.
  void remove_doublet(index_t v) {
    const index_t h = half_edge_of[v], g = opposite[previous(h)], q = h / 4, dead = g / 4;
    const index_t a = to(h), x = to(next(h)), c = to(g), y = to(next(g));
    const index_t ax = opposite[next(h)], xc = opposite[next(next(h))];
    const index_t cy = opposite[next(g)], ya = opposite[next(next(g))];
    corners.set(q, {a, x, c, y});
    corners.set(dead, {no_index, no_index, no_index, no_index});
    attach(4 * q, ax), attach(4 * q + 1, xc), attach(4 * q + 2, cy), attach(4 * q + 3, ya);
    count(a, -1), count(c, -1);
    n_cells.set(v, 0);
    half_edge_of.set(v, no_index);
    for (const index_t w : {a, x, c, y}) start_fan(w, q);
  }

  /// Opens a vertex along the edges of two half edges that leave it and have cells on both sides: a new vertex takes the
  /// cells from the first to the second, and a new quadrilateral lies between. @return the new vertex.
  index_t split(index_t h, index_t k) {
    const index_t v = from(h), p = to(h), r = to(k), south_p = opposite[h], north_r = opposite[k];
    std::vector<index_t> north;
    for (index_t o = h; o != k; o = opposite[previous(o)]) north.push_back(o);
    const index_t w = add_vertex(v), q = add_cell({v, p, w, r}, patch[h / 4]);
    for (const index_t o : north) set_corner(o, w);
    attach(4 * q, south_p), attach(4 * q + 1, h), attach(4 * q + 2, north_r), attach(4 * q + 3, k);
    const auto n = static_cast<int>(north.size());
    n_cells.set(w, static_cast<index_t>(n + 1));
    count(v, 1 - n), count(p, 1), count(r, 1);
    half_edge_of.set(w, 4 * q + 2);
    for (const index_t x : {v, p, r}) start_fan(x, q);
    return w;
  }

  /// Which corners of the hexagon of two quadrilaterals a vertex in its middle is joined with: every other one.
  enum class Corners { with_end, with_start };  ///< the end or the start of the half edge among them

  /// Puts a vertex in place of the edge of two quadrilaterals, which become three. @return the vertex.
  index_t insert(index_t h, Corners joined_corners) {
    const index_t g = opposite[h];
    const std::array<index_t, 6> side{next(h), next(next(h)), previous(h), next(g), next(next(g)), previous(g)};
    std::array<index_t, 6> v{}, beyond{};
    for (std::size_t i = 0; i < 6; ++i) {
      v[i] = from(side[i]);
      beyond[i] = opposite[side[i]];
    }
    const index_t w = add_vertex(v[0]), extra = add_cell({no_index, no_index, no_index, no_index}, patch[h / 4]);
    const std::array<index_t, 3> cells{h / 4, g / 4, extra};
    const std::size_t offset = joined_corners == Corners::with_end ? 0 : 1;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t i = offset + 2 * k;
      corners.set(cells[k], {w, v[i], v[(i + 1) % 6], v[(i + 2) % 6]});
      attach(4 * cells[k] + 1, beyond[i]);
      attach(4 * cells[k] + 2, beyond[(i + 1) % 6]);
    }
    for (std::size_t k = 0; k < 3; ++k) attach(4 * cells[k] + 3, 4 * cells[(k + 1) % 3]);
    for (std::size_t i = 0; i < 6; ++i) {
      const bool was_end = i == 0 || i == 3, is_joined = i % 2 == offset;
      count(v[i], static_cast<int>(is_joined) - static_cast<int>(was_end));
    }
    n_cells.set(w, 3);
    half_edge_of.set(w, 4 * extra);
    for (std::size_t k = 0; k < 3; ++k)
      for (const index_t x : {corners[cells[k]][1], corners[cells[k]][2]}) start_fan(x, cells[k]);
    return w;
  }

  /// Lays a ring of four quadrilaterals into one, round a smaller copy of it. @return the first of four new vertices.
  index_t pillow(index_t q) {
    const Cell outer = corners[q];
    std::array<index_t, 4> beyond{};
    for (index_t i = 0; i < 4; ++i) beyond[i] = opposite[4 * q + i];
    Cell inner{};
    for (std::size_t i = 0; i < 4; ++i) inner[i] = add_vertex(outer[i]);
    std::array<index_t, 4> ring{};
    for (std::size_t i = 0; i < 4; ++i) {
      const std::size_t j = (i + 1) % 4;
      ring[i] = add_cell({outer[i], outer[j], inner[j], inner[i]}, patch[q]);
    }
    corners.set(q, inner);
    for (index_t i = 0; i < 4; ++i) {
      attach(4 * ring[i], beyond[i]);
      attach(4 * ring[i] + 2, 4 * q + i);
      attach(4 * ring[i] + 1, 4 * ring[(i + 1) % 4] + 3);
    }
    for (index_t i = 0; i < 4; ++i) {
      count(outer[i], 1);
      n_cells.set(inner[i], 3);
      half_edge_of.set(inner[i], 4 * q + i);
      start_fan(outer[i], ring[i]);
    }
    return inner[0];
  }

private:
  template <class Change>
  void each(Change&& change) {
    change(points), change(normals), change(corners), change(opposite), change(half_edge_of), change(n_cells),
        change(patch), change(curve);
  }

  void attach(index_t h, index_t g) {
    if (h != no_index) opposite.set(h, g);
    if (g != no_index) opposite.set(g, h);
  }
  void count(index_t v, int change) { n_cells.set(v, static_cast<index_t>(static_cast<int>(n_cells[v]) + change)); }
  void set_corner(index_t h, index_t v) {
    Cell cell = corners[h / 4];
    cell[h % 4] = v;
    corners.set(h / 4, cell);
  }

  /// Lets the fan of v start in a cell that has it, or at the rim clockwise of that.
  void start_fan(index_t v, index_t q) {
    index_t h = 4 * q;
    while (from(h) != v) ++h;
    const index_t begin = h;
    while (opposite[h] != no_index) {
      h = next(opposite[h]);
      if (h == begin) break;
    }
    half_edge_of.set(v, h);
  }

  index_t add_cell(const Cell& cell, index_t label) {
    const auto q = static_cast<index_t>(corners.size());
    corners.push_back(cell);
    for (int i = 0; i < 4; ++i) opposite.push_back(no_index);
    patch.push_back(index_t{label});
    return q;
  }

  index_t add_vertex(index_t like) {
    const auto v = static_cast<index_t>(points.size());
    points.push_back(Vector3(points[like]));
    normals.push_back(Vector3(normals[like]));
    half_edge_of.push_back(no_index);
    n_cells.push_back(0);
    curve.push_back(no_index);
    target.push_back(4);
    name.push_back(v + name_offset_);
    next_copy.push_back(v);
    fixed_.push_back(0);
    return v;
  }

  void find_opposites(std::size_t n_vertices, const std::unordered_set<std::uint64_t>& walls) {
    const auto n = static_cast<index_t>(corners.size());
    std::vector<index_t> opposites(4 * corners.size(), no_index);
    const Csr<index_t> sides = make_csr(n_vertices, [&](auto&& put) {
      for (index_t q = 0; q < n; ++q)
        for (index_t h = 4 * q; h < 4 * q + size(q); ++h) put(std::min(from(h), to(h)), h);
    });
    for (std::size_t v = 0; v < n_vertices; ++v)
      for (const index_t h : sides[v])
        for (const index_t g : sides[v])
          if (from(h) == to(g) && to(h) == from(g) && !walls.contains(edge_key(from(h), to(h)))) {
            if (opposites[h] != no_index)
              throw nonmanifold("edge (" + std::to_string(from(h)) + ", " + std::to_string(to(h)) +
                                    ") is used by more than two cells",
                                Entity::edge, {from(h), to(h)});
            opposites[h] = g;
          }
    opposite = JournaledArray<index_t>(std::move(opposites));
  }

  /// Gives each fan of a vertex a copy; copies are numbered from the vertices on.
  void divide_fans(const QuadMesh& mesh) {
    const std::size_t n = mesh.points.size();
    std::vector<index_t> curve_of(n, no_index);
    std::vector<char> is_fixed(n, 0);
    for (const LabelledEdge& edge : mesh.edges)
      for (const index_t v : edge.vertices) {
        if (curve_of[v] != no_index && curve_of[v] != edge.label) is_fixed[v] = 1;
        curve_of[v] = edge.label;
      }
    for (const index_t v : mesh.corners) is_fixed[v] = 1;
    std::vector<Vector3> places = mesh.points;
    std::vector<index_t> outgoing(n, no_index), counts(n, 0), curves(n, no_index);
    for (index_t v = 0; v < n; ++v) {
      name.push_back(v);
      next_copy.push_back(v);
    }
    fixed_.assign(n, 0);
    std::vector<char> seen(opposite.size(), 0);
    std::vector<index_t> fan;
    for (index_t q = 0; q < corners.size(); ++q)
      for (index_t side = 4 * q; side < 4 * q + size(q); ++side) {
        if (seen[side]) continue;
        index_t start = side;
        while (opposite[start] != no_index) {
          start = next(opposite[start]);
          if (start == side) break;
        }
        fan.clear();
        index_t h = start;
        do {
          fan.push_back(h);
          seen[h] = 1;
          h = opposite[previous(h)];
        } while (h != start && h != no_index);
        const index_t v = from(side);
        index_t copy = v;
        if (outgoing[v] != no_index) {
          copy = static_cast<index_t>(places.size());
          places.push_back(Vector3(places[v]));
          outgoing.push_back(no_index);
          counts.push_back(0);
          curves.push_back(no_index);
          name.push_back(v);
          next_copy.push_back(std::exchange(next_copy[v], copy));
          fixed_.push_back(0);
        }
        outgoing[copy] = start;
        counts[copy] = static_cast<index_t>(fan.size());
        const bool bare_rim = opposite[start] == no_index && curve_of[v] == no_index;
        fixed_[copy] = is_fixed[v] || bare_rim;
        if (!fixed_[copy]) curves[copy] = curve_of[v];
        for (const index_t o : fan) set_corner(o, copy);
      }
    name_offset_ = static_cast<index_t>(n - places.size());
    normals = JournaledArray<Vector3>(std::vector<Vector3>(places.size(), Vector3::Zero()));
    points = JournaledArray<Vector3>(std::move(places));
    half_edge_of = JournaledArray<index_t>(std::move(outgoing));
    n_cells = JournaledArray<index_t>(std::move(counts));
    curve = JournaledArray<index_t>(std::move(curves));
    target.assign(points.size(), 4);
  }

  std::vector<char> fixed_;  ///< by copy
  index_t name_offset_ = 0;  ///< from the number of a vertex that was added to its name, modulo 2^32
  std::size_t n_marked_ = 0;
};

}  // namespace framehex::detail
