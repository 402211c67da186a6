// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/geometry/predicates.hpp"
#include "framehex/surface/detail/delaunay_flips.hpp"
#include "framehex/surface/detail/outline_names.hpp"

#include <algorithm>
#include <cmath>
#include <deque>
#include <string>

namespace framehex::detail {

/// Delaunay triangulation of points of the plane z = 0 in a box round them, with segments that stay edges.
///
/// Which side a point is on is decided exactly; whether an edge is Delaunay within rounding.
class ConstrainedDelaunay {
public:
  /// @param points  z = 0; no two alike, or `insert_points` says so.
  /// @param names   for errors; must outlive this.
  ConstrainedDelaunay(std::span<const Vector3> points, const OutlineNames& names)
      : n_(points.size()), names_(names), mesh_(box_round(points)) {}

  /// @throws invalid_outline  with two vertices of one place.
  void insert_points() {
    std::vector<index_t> order(n_);
    for (index_t v = 0; v < n_; ++v) order[v] = v;
    sort_in_rows(order);
    index_t hint = 0;
    for (const index_t v : order) hint = insert(v, hint);
  }

  /// Makes a segment an edge. @throws invalid_outline  where it meets a vertex or another segment, or is one already.
  void insert_segment(index_t a, index_t b) {
    if (index_t h = mesh_.find(a, b); h != no_index) {
      if (mesh_.feature[h]) throw invalid_outline(names_.repeated(a, b), Entity::edge, {a, b});
      fix(h);
      return;
    }
    std::deque<std::pair<index_t, index_t>> crossed = find_crossed(a, b);
    std::vector<std::pair<index_t, index_t>> made;
    while (!crossed.empty()) {
      const auto [p, q] = crossed.front();
      crossed.pop_front();
      const index_t h = mesh_.find(p, q);
      const index_t c = mesh_.apex(h), d = mesh_.apex(mesh_.opposite[h]);
      if (turn(c, p, d) <= 0 || turn(d, q, c) <= 0) {  // not convex yet
        crossed.emplace_back(p, q);
        continue;
      }
      mesh_.flip(h);
      const bool on_segment = (c == a && d == b) || (c == b && d == a);
      const bool still = !on_segment && c != a && c != b && d != a && d != b && turn(a, b, c) * turn(a, b, d) < 0;
      if (still)
        crossed.emplace_back(c, d);
      else if (!on_segment)
        made.emplace_back(c, d);
    }
    fix(mesh_.find(a, b));
    for (const auto& [p, q] : made)
      if (const index_t h = mesh_.find(p, q); h != no_index) doubtful_.push_back(h);
    make_delaunay();
  }

  const EditableSurface& mesh() const { return mesh_; }
  bool is_box_corner(index_t v) const { return v >= n_; }

private:
  /// Room enough that the corners of the box are not in the way of the points' own triangles.
  static EditableSurface box_round(std::span<const Vector3> points) {
    Eigen::AlignedBox3d box;
    for (const Vector3& p : points) box.extend(p);
    const Vector3 room = Vector3(1, 1, 0) * (box.sizes().maxCoeff());
    const Vector3 low = box.min() - room, high = box.max() + room;
    IndexedTriangleMesh mesh{{points.begin(), points.end()}, {}};
    const auto n = static_cast<index_t>(points.size());
    for (const auto& [x, y] :
         {std::pair{low.x(), low.y()}, {high.x(), low.y()}, {high.x(), high.y()}, {low.x(), high.y()}})
      mesh.points.emplace_back(x, y, 0);
    mesh.triangles = {{n, n + 1, n + 2}, {n, n + 2, n + 3}};
    Surface surface;
    surface.points = mesh.points;
    surface.adjacency = make_adjacency(mesh);
    surface.features.triangle_patch.assign(2, 0);
    surface.features.n_patches = 1;
    surface.features.is_feature.assign(6, 0);
    return EditableSurface(surface);
  }

  [[noreturn]] void refuse_twins(index_t a, index_t b) const {
    throw invalid_outline(names_.vertex(a) + " and " + names_.vertex(b) + " are the same point", Entity::vertex,
                          {a, b});
  }

  int turn(index_t a, index_t b, index_t c) const {
    return projected_orientation(2, mesh_.points[a], mesh_.points[b], mesh_.points[c]);
  }

  void fix(index_t h) { mesh_.feature[h] = mesh_.feature[mesh_.opposite[h]] = 1; }

  /// Back and forth in rows, so that each point is near the one before.
  void sort_in_rows(std::vector<index_t>& order) const {
    Eigen::AlignedBox3d box;
    for (const index_t v : order) box.extend(mesh_.points[v]);
    const double rows = std::ceil(std::sqrt(static_cast<double>(n_))), height = box.sizes().y();
    const auto key = [&](index_t v) {
      const Vector3& p = mesh_.points[v];
      const double row = height > 0 ? std::floor(rows * (p.y() - box.min().y()) / height) : 0;
      return std::array{row, std::fmod(row, 2) == 0 ? p.x() : -p.x()};
    };
    std::sort(order.begin(), order.end(), [&](index_t v, index_t w) {
      const auto x = key(v), y = key(w);
      return x != y ? x < y : v < w;
    });
  }

  /// @return a triangle beside v.
  index_t insert(index_t v, index_t hint) {
    const index_t t = walk(v, hint);
    std::array<index_t, 3> on{};
    std::size_t n_on = 0;
    for (index_t h = 3 * t; h < 3 * t + 3; ++h)
      if (turn(mesh_.from(h), mesh_.to(h), v) == 0) on[n_on++] = h;
    if (n_on > 1)
      for (const index_t w : mesh_.corners[t])
        if (mesh_.points[w] == mesh_.points[v]) refuse_twins(std::min(v, w), std::max(v, w));
    if (n_on == 0)
      mesh_.split_triangle(t, v, 0);
    else
      mesh_.split_edge(on[0], v, 0, 0);
    mesh_.for_each_outgoing(v, [&](index_t h) { doubtful_.push_back(EditableSurface::next(h)); });
    make_delaunay();
    return mesh_.half_edge_of[v] / 3;
  }

  index_t walk(index_t v, index_t t) const {
    for (std::size_t step = 0; step < 4 * mesh_.n_triangles() + 8; ++step) {
      index_t beyond = no_index;
      for (index_t h = 3 * t; h < 3 * t + 3 && beyond == no_index; ++h)
        if (turn(mesh_.from(h), mesh_.to(h), v) < 0) beyond = mesh_.opposite[h];
      if (beyond == no_index) return t;
      t = beyond / 3;
    }
    // Rounding has left an edge that is not Delaunay, and the walk goes round it.
    for (t = 0; t < mesh_.n_triangles(); ++t)
      if (turn(mesh_.from(3 * t), mesh_.to(3 * t), v) >= 0 &&
          turn(mesh_.from(3 * t + 1), mesh_.to(3 * t + 1), v) >= 0 &&
          turn(mesh_.from(3 * t + 2), mesh_.to(3 * t + 2), v) >= 0)
        break;
    return t;
  }

  void make_delaunay() {
    std::size_t budget = 64 + 100 * doubtful_.size() + mesh_.n_triangles();
    while (!doubtful_.empty()) {
      const index_t h = doubtful_.back();
      doubtful_.pop_back();
      if (budget == 0 || !is_not_delaunay(mesh_, h)) continue;
      const index_t g = mesh_.opposite[h], t = 3 * (h / 3), s = 3 * (g / 3);
      const index_t c = mesh_.apex(h), d = mesh_.apex(g);
      if (turn(c, mesh_.from(h), d) <= 0 || turn(d, mesh_.to(h), c) <= 0) continue;
      mesh_.flip(h);
      --budget;
      doubtful_.insert(doubtful_.end(), {t, t + 2, s, s + 2});
    }
  }

  /// Edges that segment (a, b) crosses, from a to b.
  std::deque<std::pair<index_t, index_t>> find_crossed(index_t a, index_t b) const {
    index_t in = no_index;  // the side, opposite a, of the triangle into which the segment starts
    mesh_.for_each_outgoing(a, [&](index_t h) {
      const index_t p = mesh_.to(h), q = mesh_.apex(h);
      const int right = turn(a, p, b), left = turn(a, b, q);
      if (right < 0 || left < 0) return;
      if (right == 0) refuse_touch(a, b, p);
      if (left == 0) refuse_touch(a, b, q);
      in = EditableSurface::next(h);
    });
    std::deque<std::pair<index_t, index_t>> crossed;
    for (index_t h = in; h != no_index;) {
      if (mesh_.feature[h]) {
        const auto [p, q] = std::minmax({mesh_.from(h), mesh_.to(h)});
        throw invalid_outline(names_.segment(a, b) + " and " + names_.segment(p, q) + " cross", Entity::edge,
                              {a, b, p, q});
      }
      crossed.emplace_back(mesh_.from(h), mesh_.to(h));
      const index_t g = mesh_.opposite[h], r = mesh_.apex(g);
      if (r == b) break;
      const int side = turn(a, b, r);
      if (side == 0) refuse_touch(a, b, r);
      h = side > 0 ? EditableSurface::next(g) : EditableSurface::previous(g);
    }
    return crossed;
  }

  [[noreturn]] void refuse_touch(index_t a, index_t b, index_t w) const {
    throw invalid_outline(names_.vertex(w) + " lies on " + names_.segment(a, b), Entity::vertex, {w, a, b});
  }

  std::size_t n_;
  const OutlineNames& names_;
  EditableSurface mesh_;
  std::vector<index_t> doubtful_;  ///< half edges to be looked at
};

}  // namespace framehex::detail
