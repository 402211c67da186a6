// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/mesh/validation.hpp"
#include "framehex/surface/detail/constrained_delaunay.hpp"
#include "framehex/surface/detail/least_distance.hpp"
#include "framehex/surface/detail/outline_names.hpp"
#include "framehex/surface/planar_outline.hpp"

#include <sstream>
#include <utility>

namespace framehex {

/// Triangles of a planar domain, all of whose vertices are the outline's.
struct OutlineTriangulation {
  IndexedTriangleMesh mesh;      ///< z = 0, anticlockwise; vertices under the outline's numbers
  std::vector<index_t> regions;  ///< n_triangles labels, from 0
  index_t n_regions = 0;
  std::vector<std::array<index_t, 2>> segments;  ///< of the polylines, in their order

  /// As a surface whose features are the polylines.
  Surface surface(FeatureOptions options = {}) const {
    options.given_edges = segments;
    options.patches = regions;
    return Surface(mesh, options);
  }
};

namespace detail {

/// Finds out which triangles between the segments of an outline belong to its domain.
class OutlineFaces {
public:
  OutlineFaces(const PlanarOutline& outline, const ConstrainedDelaunay& delaunay)
      : outline_(outline), delaunay_(delaunay), mesh_(delaunay.mesh()) {}

  OutlineTriangulation run() {
    mark_loops();
    face_ = label_faces([&](index_t h) { return in_loop_[h] != 0; }, n_faces_);
    find_depths();
    index_t n_pieces = 0;
    const std::vector<index_t> piece = label_faces([&](index_t h) { return mesh_.feature[h] != 0; }, n_pieces);
    OutlineTriangulation result;
    std::vector<index_t> region(n_pieces, no_index);
    for (index_t t = 0; t < mesh_.n_triangles(); ++t) {
      if (!is_inside(t)) continue;
      index_t& name = region[piece[t]];
      if (name == no_index) name = result.n_regions++;
      result.mesh.triangles.push_back(mesh_.corners[t]);
      result.regions.push_back(name);
    }
    if (result.n_regions == 0) throw invalid_outline("the outline bounds nothing");
    for (std::size_t i = 0; i < outline_.n_polylines(); ++i) {
      const auto row = outline_.polyline(i);
      for (std::size_t k = 0; k + 1 < row.size(); ++k) {
        const index_t h = mesh_.find(row[k], row[k + 1]);
        if (!is_inside(h / 3) && !is_inside(mesh_.opposite[h] / 3))
          throw invalid_outline("polyline " + std::to_string(i) + " lies outside the domain", Entity::polyline, {i});
        result.segments.push_back({row[k], row[k + 1]});
      }
    }
    return result;
  }

private:
  bool is_inside(index_t triangle) const { return depth_[face_[triangle]] % 2 != 0; }

  void mark_loops() {
    in_loop_.assign(mesh_.opposite.size(), 0);
    for (std::size_t i = 0; i < outline_.loops.size(); ++i) {
      const auto row = outline_.loops[i];
      for (std::size_t k = 1; k < row.size(); ++k) {
        const index_t h = mesh_.find(row[k - 1], row[k]);
        in_loop_[h] = in_loop_[mesh_.opposite[h]] = 1;
      }
    }
  }

  /// Triangles that are joined without crossing a wall; the face that holds the box is 0.
  template <class Wall>
  std::vector<index_t> label_faces(const Wall& is_wall, index_t& n_faces) const {
    std::vector<index_t> face(mesh_.n_triangles(), no_index), stack;
    const auto flood = [&](index_t seed) {
      const index_t name = n_faces++;
      face[seed] = name;
      stack.push_back(seed);
      while (!stack.empty()) {
        const index_t t = stack.back();
        stack.pop_back();
        for (index_t h = 3 * t; h < 3 * t + 3; ++h) {
          const index_t g = mesh_.opposite[h];
          if (g == no_index || is_wall(h) || face[g / 3] != no_index) continue;
          face[g / 3] = name;
          stack.push_back(g / 3);
        }
      }
    };
    index_t outside = 0;
    while (!delaunay_.is_box_corner(mesh_.from(3 * outside))) ++outside;
    flood(outside);
    for (index_t t = 0; t < face.size(); ++t)
      if (face[t] == no_index) flood(t);
    return face;
  }

  /// Calls visit(halfedge) for both sides of each segment of a loop between two faces.
  template <class Visit>
  void each_bounding(Visit&& visit) const {
    for (index_t h = 0; h < in_loop_.size(); ++h)
      if (in_loop_[h] && face_[h / 3] != face_[mesh_.opposite[h] / 3]) visit(h);
  }

  /// Number of the connected set of bounding segments of each vertex: its smallest vertex.
  std::vector<index_t> components() const {
    std::vector<index_t> parent(outline_.points.size());
    for (index_t v = 0; v < parent.size(); ++v) parent[v] = v;
    const auto root = [&](index_t v) {
      while (parent[v] != v) v = parent[v] = parent[parent[v]];
      return v;
    };
    each_bounding([&](index_t h) {
      const auto [low, high] = std::minmax({root(mesh_.from(h)), root(mesh_.to(h))});
      parent[high] = low;
    });
    for (index_t v = 0; v < parent.size(); ++v) parent[v] = root(v);
    return parent;
  }

  /// From the outside inwards. Each segment of closed curves leads from an even depth to an odd one or back. A set
  /// with vertices where an odd number of segments meet has no such depths: all that it encloses is one deeper than
  /// the face it lies in.
  void find_depths() {
    const std::vector<index_t> component = components();
    std::vector<char> is_odd(component.size(), 0), divides(component.size(), 0), visited(component.size(), 0);
    each_bounding([&](index_t h) { is_odd[mesh_.from(h)] ^= 1; });
    for (index_t v = 0; v < component.size(); ++v)
      if (is_odd[v]) divides[component[v]] = 1;
    const auto each = [&](auto&& visit) { each_bounding([&](index_t h) { visit(component[mesh_.from(h)], h); }); };
    const Csr<index_t> sides = make_csr(component.size(), [&](auto&& put) { each(put); });
    const Csr<index_t> bounds = make_csr(
        n_faces_, [&](auto&& put) { each([&](index_t /*set*/, index_t side) { put(face_[side / 3], side); }); });
    depth_.assign(n_faces_, no_index);
    depth_[0] = 0;
    std::vector<index_t> queue{0};
    const auto reach = [&](index_t face, index_t depth) {
      if (depth_[face] != no_index) return;
      depth_[face] = depth;
      queue.push_back(face);
    };
    for (std::size_t i = 0; i < queue.size(); ++i)
      for (const index_t side : bounds[queue[i]]) {
        const index_t set = component[mesh_.from(side)], depth = depth_[queue[i]] + 1;
        if (!divides[set])
          reach(face_[mesh_.opposite[side] / 3], depth);
        else if (!std::exchange(visited[set], 1))
          for (const index_t other : sides[set]) reach(face_[other / 3], depth);
      }
  }

  const PlanarOutline& outline_;
  const ConstrainedDelaunay& delaunay_;
  const EditableSurface& mesh_;
  std::vector<char> in_loop_;   ///< by halfedge
  std::vector<index_t> face_;   ///< by triangle: between loops
  std::vector<index_t> depth_;  ///< by face: how many segments of loops lie between it and the outside
  index_t n_faces_ = 0;
};

/// Indices, coordinates and ends of an outline's polylines.
inline void check_outline(const PlanarOutline& outline) {
  const std::size_t n = outline.points.size();
  check_count(n, no_index - 4, "vertices");
  std::vector<index_t> n_ends(n, 0), last(n, 0);  // of loops
  std::vector<index_t> last_in(n, no_index);      // polyline in which a vertex was seen last
  if (outline.loops.size() == 0) throw invalid_outline("the outline has no loop");
  for (std::size_t i = 0; i < outline.n_polylines(); ++i) {
    const auto row = outline.polyline(i);
    const std::string name = "polyline " + std::to_string(i);
    if (row.size() < 2) throw invalid_outline(name + " has no segment", Entity::polyline, {i});
    for (std::size_t k = 0; k < row.size(); ++k) {
      if (row[k] >= n)
        throw invalid_connectivity(name + " refers to vertex " + std::to_string(row[k]) + " of " + std::to_string(n),
                                   Entity::polyline, {i});
      if (k > 0 && row[k] == row[k - 1])
        throw invalid_outline(name + " has vertex " + std::to_string(row[k]) + " twice in succession", Entity::polyline,
                              {i});
      const bool closes = k > 0 && k + 1 == row.size() && row[k] == row[0];
      if (last_in[row[k]] == i && !closes)
        throw invalid_outline(name + " comes to vertex " + std::to_string(row[k]) + " twice", Entity::polyline, {i});
      last_in[row[k]] = static_cast<index_t>(i);
      if (i >= outline.loops.size()) continue;
      n_ends[row[k]] += k == 0 || k + 1 == row.size() ? 1U : 2U;
      last[row[k]] = static_cast<index_t>(i);
    }
  }
  for (std::size_t v = 0; v < n; ++v) {
    if (last_in[v] == no_index)
      throw invalid_outline("vertex " + std::to_string(v) + " is of no polyline", Entity::vertex, {v});
    if (n_ends[v] == 1)
      throw invalid_outline("loop " + std::to_string(last[v]) + " is open: it ends at vertex " + std::to_string(v),
                            Entity::polyline, {last[v], v});
  }
}

/// Refuses vertices that are next to the same point, and a domain that is next to nothing between a vertex and a
/// segment: neighbours in a Delaunay triangulation both.
inline void check_separation(const PlanarOutline& outline, const ConstrainedDelaunay& delaunay,
                             const OutlineTriangulation& result) {
  Eigen::AlignedBox2d box;
  for (const Vector2& p : outline.points) box.extend(p);
  const double least = least_curve_distance * box.diagonal().norm();
  const OutlineNames names(outline);
  const auto refuse = [&](const std::string& what, double distance, std::vector<std::size_t> vertices) {
    std::ostringstream text;
    text << what << " are " << distance << " apart, less than " << least_curve_distance << " of the outline's diagonal";
    throw invalid_outline(text.str(), Entity::vertex, std::move(vertices));
  };
  const EditableSurface& mesh = delaunay.mesh();
  for (index_t h = 0; h < mesh.opposite.size(); ++h) {
    const index_t a = mesh.from(h), b = mesh.to(h);
    if (a > b || delaunay.is_box_corner(b)) continue;
    if (const double length = (outline.points[b] - outline.points[a]).norm(); length < least)
      refuse(names.vertex(a) + " and " + names.vertex(b), length, {a, b});
  }
  for (const auto& t : result.mesh.triangles)
    for (std::size_t i = 0; i < 3; ++i) {
      const index_t a = t[i], b = t[(i + 1) % 3], w = t[(i + 2) % 3];
      if (!mesh.feature[mesh.find(a, b)]) continue;
      const Vector2 side = outline.points[b] - outline.points[a], to = outline.points[w] - outline.points[a];
      // To the segment, not its line: along a curve of many points each is next to the lines of its neighbours.
      const double along = std::clamp(side.dot(to) / side.squaredNorm(), 0.0, 1.0),
                   distance = (to - along * side).norm();
      if (distance < least) refuse(names.vertex(w) + " and " + names.segment(a, b), distance, {w, a, b});
    }
}

}  // namespace detail

/// Triangulates a planar domain without adding a vertex: the constrained Delaunay triangulation of its outline.
///
/// @throws invalid_outline  for points that no polyline uses (the vertex), loops that are open (the loop and the vertex), segments that cross (their vertices) or
///         occur twice, vertices that are the same point (both) or lie on a segment (the vertex, then the segment's), or
///         are nearer to them within the domain than 1e-8 of the diagonal (the same), inner polylines outside (the
///         polyline), an outline that bounds nothing; invalid_coordinate, invalid_connectivity.
/// @par Complexity   about O(n log n) for n points.
/// @par Source       Lawson's flips; Sloan, Comput. Struct. 47 (1993) 441-450, for the segments.
inline OutlineTriangulation triangulate_outline(const PlanarOutline& outline) {
  IndexedTriangleMesh flat;
  for (const Vector2& p : outline.points) flat.points.emplace_back(p.x(), p.y(), 0);
  detail::check_coordinates(flat);
  detail::check_outline(outline);
  const detail::OutlineNames names(outline);
  detail::ConstrainedDelaunay delaunay(flat.points, names);
  delaunay.insert_points();
  for (std::size_t i = 0; i < outline.n_polylines(); ++i) {
    const auto row = outline.polyline(i);
    for (std::size_t k = 1; k < row.size(); ++k) delaunay.insert_segment(row[k - 1], row[k]);
  }
  OutlineTriangulation result = detail::OutlineFaces(outline, delaunay).run();
  detail::check_separation(outline, delaunay, result);
  result.mesh.points = std::move(flat.points);
  return result;
}

}  // namespace framehex
