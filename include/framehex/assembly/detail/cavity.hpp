// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/assembly/detail/quality_energy.hpp"

#include <limits>

namespace framehex::detail {

/// A ball of cells that is to be filled anew by joining its faces to one apex: every change of connectivity is one.
///
/// With an apex on the cavity it merges tetrahedra into a pyramid, flips 2-3, 3-2 and 4-4, removes edges and contracts
/// them; with a new apex it raises a pyramid or splits a cell from its centre. Since the faces stay, so do all cells
/// around, and when every new cell is positive the volume is filled exactly once.
struct Cavity {
  /// Larger ones are not tried: filling takes the square of their size, and a ring of so many cells is no better
  /// filled.
  static constexpr std::size_t most_cells = 60;

  std::vector<index_t> cells;
  std::vector<std::array<index_t, 4>> faces;  ///< anticlockwise seen from outside; a triangle's fourth is `no_index`
  std::vector<index_t> vertices;              ///< of the faces, ascending
  std::vector<index_t> closed_quads;          ///< open quadrilaterals that meet a whole face after the change
  index_t region = 0;

  bool contains(index_t cell) const { return std::find(cells.begin(), cells.end(), cell) != cells.end(); }
};

/// Kinds that may be taken apart at no loss.
inline bool is_soft(CellKind kind) {
  return kind == CellKind::tetrahedron || kind == CellKind::pyramid;
}

/// The cell on the other side of a face of a cavity; `no_index` on the boundary.
inline index_t cell_behind(const CellComplex& complex, const Cavity& cavity, const std::array<index_t, 4>& face) {
  return complex.with_face(face, [&](index_t cell) { return !cavity.contains(cell); });
}

/// Calls `f()` with the cells round each edge of a cell in `ring`, where all have that edge and are of kinds that may be
/// taken apart (the cell itself always is).
template <class Usable, class F>
void for_each_ring(const CellComplex& complex, index_t cell, std::vector<index_t>& ring, Usable&& usable, F&& f) {
  for (const auto& edge : edges_of(complex.cells[cell].kind)) {
    const index_t v = complex.cells[cell].corners[static_cast<std::size_t>(edge[0])];
    const index_t w = complex.cells[cell].corners[static_cast<std::size_t>(edge[1])];
    ring.clear();
    bool all_usable = true;
    complex.for_each_cell_at(v, [&](index_t other) {
      if (!all_usable || !complex.has_vertex(other, w)) return;
      all_usable = complex.has_edge(other, v, w) && (other == cell || usable(complex.cells[other].kind));
      ring.push_back(other);
    });
    if (all_usable && ring.size() > 1 && ring.size() < Cavity::most_cells) f();
  }
}

/// The cell that joins a face of a cavity to an apex inside.
struct StarCell {
  CellKind kind;
  std::array<index_t, 5> corners;
};

inline StarCell star_cell(const std::array<index_t, 4>& face, index_t apex) {
  if (face[3] == no_index) return {CellKind::tetrahedron, {apex, face[0], face[1], face[2], no_index}};
  return {CellKind::pyramid, {face[0], face[3], face[2], face[1], apex}};
}

/// Builds cavities and fills them; holds the scratch memory.
class CavityFiller {
public:
  explicit CavityFiller(CellComplex& complex) : complex_(complex) {}

  /// Gathers the faces of a set of cells. Two triangles of an open interface that both lie on the cavity become the
  /// quadrilateral that they face; an open quadrilateral of a cell inside becomes its two triangles.
  /// @return false unless the cells form a ball in one region without anything protected inside.
  [[nodiscard]] bool build(Cavity& cavity) { return gather(cavity) && is_fillable(cavity); }

  /// The first, quick half of `build`: faces and vertices. @return false if the cells are of several regions.
  bool gather(Cavity& cavity) {
    cavity.faces.clear();
    cavity.closed_quads.clear();
    cavity.region = complex_.cells[cavity.cells.front()].region;
    gather_faces(cavity);
    for (const Face& f : scratch_) {
      if (f.inner) continue;
      const index_t quad = complex_.open_quad_at(f.vertices);
      if (quad == no_index) {
        cavity.faces.push_back(f.vertices);
      } else if (f.vertices[3] != no_index) {
        for (int i = 0; i < 2; ++i) cavity.faces.push_back(complex_.open_quads[quad].triangle(i));
        cavity.closed_quads.push_back(quad);
      } else if (both_triangles_outside(quad)) {
        if (std::find(cavity.closed_quads.begin(), cavity.closed_quads.end(), quad) != cavity.closed_quads.end())
          continue;
        const auto& q = complex_.open_quads[quad].vertices;
        cavity.faces.push_back({q[3], q[2], q[1], q[0]});
        cavity.closed_quads.push_back(quad);
      } else {
        cavity.faces.push_back(f.vertices);
      }
    }
    for (const index_t cell : cavity.cells)
      if (complex_.cells[cell].region != cavity.region) return false;
    cavity.vertices.clear();
    for (const auto& face : cavity.faces)
      for (std::size_t i = 0; i < 4 && face[i] != no_index; ++i)
        if (std::find(cavity.vertices.begin(), cavity.vertices.end(), face[i]) == cavity.vertices.end())
          cavity.vertices.push_back(face[i]);
    std::sort(cavity.vertices.begin(), cavity.vertices.end());
    return true;
  }

  /// The second half of `build`. @pre `gather` of this very cavity was the last.
  bool is_fillable(const Cavity& cavity) { return is_ball(cavity) && nothing_protected_inside(cavity); }

  /// Least quality of the cells from a point to all faces of the cavity but those that contain vertex `apex`
  /// (`no_index`: a new vertex). Stops early below `threshold`.
  double evaluate(const Cavity& cavity, const Vector3& point, index_t apex, double threshold = -2.0) const {
    double worst = std::numeric_limits<double>::infinity();
    const std::size_t n = cavity.faces.size();
    // The face that ended the last search comes first: it is likely to end this one.
    if (limiting_ >= n) limiting_ = 0;
    for (std::size_t i = 0, f = limiting_; i < n; ++i, f = f + 1 == n ? 0 : f + 1) {
      const auto& face = cavity.faces[f];
      if (apex != no_index && std::find(face.begin(), face.end(), apex) != face.end()) {
        if (face[3] != no_index) return -1.0;  // the pyramid would be flat
        continue;
      }
      worst = std::min(worst, quality_from(face, point));
      if (worst > threshold) continue;
      limiting_ = f;
      return worst;
    }
    return worst;
  }

  /// Scaled Jacobian of the cell that joins a face to a point.
  double quality_from(const std::array<index_t, 4>& face, const Vector3& point) const {
    const auto& p = complex_.points;
    if (face[3] == no_index) return tetrahedron_quality(point, p[face[0]], p[face[1]], p[face[2]]);
    return pyramid_quality({p[face[0]], p[face[3]], p[face[2]], p[face[1]]}, point);
  }

  /// The vertex of the cavity from which the least quality is best; `no_index` when none beats `best`, which is raised.
  index_t best_apex(const Cavity& cavity, double& best) const {
    index_t apex = no_index;
    for (const index_t v : cavity.vertices) {
      const double q = evaluate(cavity, complex_.points[v], v, best);
      if (q > best) {
        best = q;
        apex = v;
      }
    }
    return apex;
  }

  /// Improves the place of a new vertex.
  double improve_point(const Cavity& cavity, Vector3& point, double step, double best) const {
    return climb(point, step, best,
                 [&](const Vector3& p, double least) { return evaluate(cavity, p, no_index, least); });
  }

  /// Moves a point uphill by a pattern search along the axes and the diagonals. @return the height reached.
  ///
  /// @param height  callable: point, the height from which on it must be exact -> height.
  template <class Height>
  static double climb(Vector3& point, double step, double best, const Height& height) {
    constexpr double least_step = 1.0 / 64;
    // Where no place sees all faces the best one may be at infinity, nearer and nearer to none at all.
    constexpr int most_rounds = 256;
    const double first = step;
    for (int round = 0; step > least_step * first && round < most_rounds; ++round) {
      bool moved = false;
      for (int d = 0; d < 14; ++d) {
        Vector3 direction;
        if (d < 6)
          direction = Vector3::Unit(d / 2) * (d % 2 == 0 ? 1.0 : -1.0);
        else
          direction = Vector3((d - 6) & 1 ? 1 : -1, (d - 6) & 2 ? 1 : -1, (d - 6) & 4 ? 1 : -1) * 0.57735026918962576;
        const Vector3 trial = point + step * direction;
        const double q = height(trial, best);
        if (q > best) {
          best = q;
          point = trial;
          moved = true;
        }
      }
      if (!moved) step *= 0.5;
    }
    return best;
  }

  /// Replaces the cells of the cavity by the star of a vertex.
  /// @return the number of new cells; 0, with nothing changed, when one of them would not be valid by the exact test.
  [[nodiscard]] std::size_t fill(const Cavity& cavity, index_t apex) {
    std::array<Vector3, 5> p;
    for (const auto& face : cavity.faces) {
      if (std::find(face.begin(), face.end(), apex) != face.end()) continue;
      const StarCell cell = star_cell(face, apex);
      const auto n = static_cast<std::size_t>(n_corners(cell.kind));
      for (std::size_t i = 0; i < n; ++i) p[i] = complex_.points[cell.corners[i]];
      if (!is_valid(cell.kind, {p.data(), n})) return 0;
    }
    for (const index_t quad : cavity.closed_quads) complex_.close_quad(quad);
    for (const index_t cell : cavity.cells) complex_.remove(cell);
    new_cells.clear();
    for (const auto& face : cavity.faces) {
      if (std::find(face.begin(), face.end(), apex) != face.end()) continue;
      const StarCell cell = star_cell(face, apex);
      new_cells.push_back(complex_.add(cell.kind, {cell.corners.data(), static_cast<std::size_t>(n_corners(cell.kind))},
                                       cavity.region, no_index));
    }
    return new_cells.size();
  }

  /// Replaces the cells of the cavity by the star of a new vertex.
  /// @return false, with nothing changed, when one of them would not be valid.
  bool fill_from_new_vertex(const Cavity& cavity, const Vector3& point) {
    const index_t vertex = complex_.add_vertex(point, false);
    if (fill(cavity, vertex) > 0) return true;
    complex_.remove_last_vertex();
    return false;
  }

  std::vector<index_t> new_cells;  ///< of the last `fill`

private:
  struct Face {
    std::array<index_t, 4> vertices;
    FaceKey key;
    std::uint64_t low, high;  ///< the key again, quick to compare
    bool inner;
  };
  using Edge = std::uint64_t;  ///< from, to
  static Edge edge(index_t from, index_t to) { return std::uint64_t{from} << 32 | to; }

  void gather_faces(const Cavity& cavity) {
    scratch_.clear();
    for (const index_t cell : cavity.cells)
      for (std::size_t f = 0; f < complex_.n_faces(cell); ++f) {
        const auto vertices = complex_.face(cell, f);
        const FaceKey key = face_key(vertices);
        scratch_.push_back({vertices, key, edge(key[0], key[1]), edge(key[2], key[3]), false});
      }
    for (std::size_t i = 0; i < scratch_.size(); ++i)
      for (std::size_t j = 0; j < i; ++j)
        if (scratch_[i].low == scratch_[j].low && scratch_[i].high == scratch_[j].high)
          scratch_[i].inner = scratch_[j].inner = true;
  }

  bool both_triangles_outside(index_t quad) const {
    int found = 0;
    for (int i = 0; i < 2; ++i) {
      const FaceKey key = face_key(complex_.open_quads[quad].triangle(i));
      for (const Face& f : scratch_)
        if (!f.inner && f.key == key) ++found;
    }
    return found == 2;
  }

  /// Closed, oriented, every edge between two faces, and of Euler characteristic 2.
  bool is_ball(const Cavity& cavity) {
    edges_.clear();
    for (const auto& face : cavity.faces) {
      const std::size_t n = face[3] == no_index ? 3 : 4;
      for (std::size_t i = 0; i < n; ++i) edges_.push_back(edge(face[i], face[i + 1 == n ? 0 : i + 1]));
    }
    if (cavity.vertices.size() + cavity.faces.size() != edges_.size() / 2 + 2) return false;
    std::sort(edges_.begin(), edges_.end());
    for (std::size_t i = 0; i + 1 < edges_.size(); ++i)
      if (edges_[i] == edges_[i + 1]) return false;
    for (const Edge e : edges_)
      if (!std::binary_search(edges_.begin(), edges_.end(), e << 32 | e >> 32)) return false;
    return true;
  }

  bool nothing_protected_inside(const Cavity& cavity) {
    for (const index_t cell : cavity.cells)
      for (const index_t v : complex_.corners(cell))
        if (complex_.is_protected[v] && !std::binary_search(cavity.vertices.begin(), cavity.vertices.end(), v))
          return false;
    if (!complex_.protected_faces.empty())
      for (const Face& f : scratch_)
        if (f.inner && complex_.protected_faces.contains(f.key)) return false;
    if (!complex_.protected_edges.empty())
      for (const index_t cell : cavity.cells)
        for (const auto& local : edges_of(complex_.cells[cell].kind)) {
          const index_t v = complex_.cells[cell].corners[static_cast<std::size_t>(local[0])];
          const index_t w = complex_.cells[cell].corners[static_cast<std::size_t>(local[1])];
          if (complex_.protected_edges.contains(face_key({v, w, no_index, no_index})) &&
              !std::binary_search(edges_.begin(), edges_.end(), edge(v, w)))
            return false;
        }
    return true;
  }

  CellComplex& complex_;
  mutable std::size_t limiting_ = 0;
  std::vector<Face> scratch_;
  std::vector<Edge> edges_;
};

}  // namespace framehex::detail
