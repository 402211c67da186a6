// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/errors.hpp"
#include "framehex/geometry/quality.hpp"
#include "framehex/geometry/validity.hpp"
#include "framehex/mesh/mixed_mesh.hpp"

#include <algorithm>
#include <string>
#include <unordered_map>
#include <unordered_set>

namespace framehex::detail {

/// The vertices of a face in ascending order; a triangle's last is `no_index`. Equal keys: the same face.
using FaceKey = std::array<index_t, 4>;

inline FaceKey face_key(const std::array<index_t, 4>& v) {
  const index_t a = std::min(v[0], v[1]), b = std::max(v[0], v[1]), c = std::min(v[2], v[3]), d = std::max(v[2], v[3]);
  const index_t low = std::min(b, d), high = std::max(a, c);
  return {std::min(a, c), std::min(low, high), std::max(low, high), std::max(b, d)};
}

struct FaceKeyHash {
  std::size_t operator()(const FaceKey& key) const {
    std::uint64_t h = 0x9e3779b97f4a7c15u;
    for (const index_t v : key) {
      h ^= v;
      h *= 0xff51afd7ed558ccdu;
      h ^= h >> 32;
    }
    return static_cast<std::size_t>(h);
  }
};

/// The vertices of an oriented face rotated so that the smallest comes first.
inline std::array<index_t, 4> rotated(std::array<index_t, 4> face) {
  const auto end = face.begin() + (face[3] == no_index ? 3 : 4);
  std::rotate(face.begin(), std::min_element(face.begin(), end), end);
  return face;
}

/// A quadrilateral of a cell that faces two triangles.
struct OpenQuad {
  std::array<index_t, 4> vertices;  ///< anticlockwise seen from outside `cell`
  index_t cell;                     ///< whose face it is
  int diagonal;                     ///< the two triangles share vertices `diagonal` and `diagonal` + 2
  bool half_boundary;               ///< one of the triangles lies on the boundary: only splitting `cell` closes it
  bool open;

  /// Triangle 0 or 1 of the two, anticlockwise seen from outside `cell`.
  std::array<index_t, 4> triangle(int i) const {
    const auto at = [&](int k) { return vertices[static_cast<std::size_t>((diagonal + 2 * i + k) % 4)]; };
    return {at(0), at(1), at(2), no_index};
  }
};

/// A triangle of a labelled quadrilateral cut along its other diagonal, as which it may come back.
struct OtherCut {
  LabelledFace face;  ///< oriented as the label that was given
  FaceKey given;      ///< one of the two triangles that were given: where it is a face, this one is not labelled
};

/// Cells of all four kinds under modification: cells come and go, faces are matched by their vertices.
///
/// The incidence lists are threaded through the corners of the cells, so that nothing is allocated per vertex or cell.
class CellComplex {
public:
  struct Cell {
    std::array<index_t, 8> corners;
    CellKind kind;
    bool alive;
    index_t region;
    index_t source;  ///< candidate of a hexahedron or prism, `no_index` for other cells
  };

  std::vector<Vector3> points;
  std::vector<Cell> cells;
  std::vector<OpenQuad> open_quads;
  std::vector<std::array<index_t, 4>> refused_quads;         ///< see `add_open_quad`
  std::vector<std::uint8_t> on_boundary;                     ///< by vertex
  std::vector<std::uint8_t> is_protected;                    ///< by vertex: may not vanish
  std::unordered_set<FaceKey, FaceKeyHash> protected_faces;  ///< inner faces that must stay
  std::unordered_set<FaceKey, FaceKeyHash> protected_edges;  ///< edges that must stay, as (v, w, none, none)

  // Where only some of the cells are to be worked on; by vertex, those after the last are none of them.
  std::vector<std::uint8_t> settled;   ///< cells that have no other vertices are not improved for their own sake
  std::vector<std::uint8_t> deferred;  ///< open quadrilaterals at them stay open
  std::vector<std::uint8_t> spared;    ///< no hexahedron or prism is split for the sake of a cell at them

  std::size_t n_vertices() const { return points.size(); }

  /// Eight corner slots a cell are counted in 32 bits, and numbers of cells that are gone are not used again.
  static constexpr std::size_t most_cells = no_index / 8;
  static index_t next_cell(std::size_t n_cells) {
    if (n_cells >= most_cells)
      throw error("assembly makes more than " + std::to_string(most_cells) + " cells; recombine the mesh in parts");
    return static_cast<index_t>(n_cells);
  }

  index_t add_vertex(const Vector3& point, bool boundary) {
    points.push_back(point);
    head_.push_back(no_index);
    changed_.push_back(0);
    on_boundary.push_back(boundary ? 1 : 0);
    is_protected.push_back(boundary ? 1 : 0);
    return static_cast<index_t>(points.size() - 1);
  }

  /// @pre no cell has it.
  void remove_last_vertex() {
    points.pop_back();
    head_.pop_back();
    changed_.pop_back();
    on_boundary.pop_back();
    is_protected.pop_back();
  }

  index_t add(CellKind kind, std::span<const index_t> corners, index_t region, index_t source) {
    const index_t id = next_cell(cells.size());
    Cell& cell = cells.emplace_back();
    cell.kind = kind;
    cell.alive = true;
    cell.region = region;
    cell.source = source;
    cell.corners.fill(no_index);
    std::copy(corners.begin(), corners.end(), cell.corners.begin());
    next_.resize(8 * cells.size(), no_index);
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const auto slot = static_cast<index_t>(8 * id + i);
      next_[slot] = head_[corners[i]];
      head_[corners[i]] = slot;
      changed_[corners[i]] = now_;
    }
    return id;
  }

  void remove(index_t id) {
    Cell& cell = cells[id];
    cell.alive = false;
    for (std::size_t i = 0; i < static_cast<std::size_t>(n_corners(cell.kind)); ++i) {
      const auto slot = static_cast<index_t>(8 * id + i);
      index_t* link = &head_[cell.corners[i]];
      while (*link != slot) link = &next_[*link];
      *link = next_[slot];
    }
  }

  /// Moves a vertex.
  void move(index_t vertex, const Vector3& place) {
    points[vertex] = place;
    for_each_cell_at(vertex, [&](index_t cell) {
      for (const index_t v : corners(cell)) changed_[v] = now_;
    });
  }

  // What was tried in vain is worth trying again only when something has changed there: times tell.

  using Time = std::uint64_t;
  /// A time later than any change so far.
  Time tick() { return ++now_; }
  /// Whether cells at a vertex came new, or a vertex of one of them moved, since `tick` returned a time.
  bool changed_since(index_t vertex, Time time) const { return changed_[vertex] >= time; }
  bool cell_changed_since(index_t cell, Time time) const {
    for (const index_t v : corners(cell))
      if (changed_since(v, time)) return true;
    return false;
  }

  /// Calls `visit(cell)` for each living cell at a vertex, newest first.
  template <class Visit>
  void for_each_cell_at(index_t vertex, Visit&& visit) const {
    for (index_t slot = head_[vertex]; slot != no_index; slot = next_[slot]) visit(slot / 8);
  }

  bool is_settled(index_t cell) const {
    return !settled.empty() &&
           std::ranges::all_of(corners(cell), [this](index_t v) { return v < settled.size() && settled[v] != 0; });
  }
  bool is_deferred(const OpenQuad& quad) const { return any_in(deferred, quad.vertices); }
  bool is_spared(index_t cell) const { return any_in(spared, corners(cell)); }

  bool unused(index_t vertex) const { return head_[vertex] == no_index; }

  std::span<const index_t> corners(index_t cell) const {
    return {cells[cell].corners.data(), static_cast<std::size_t>(n_corners(cells[cell].kind))};
  }

  bool has_vertex(index_t cell, index_t vertex) const {
    const auto c = corners(cell);
    return std::find(c.begin(), c.end(), vertex) != c.end();
  }

  bool has_edge(index_t cell, index_t v, index_t w) const {
    for (const auto& local : edges_of(cells[cell].kind)) {
      const index_t a = cells[cell].corners[static_cast<std::size_t>(local[0])];
      const index_t b = cells[cell].corners[static_cast<std::size_t>(local[1])];
      if ((a == v && b == w) || (a == w && b == v)) return true;
    }
    return false;
  }

  std::size_t n_faces(index_t cell) const { return faces_of(cells[cell].kind).size(); }

  /// Face `f` of a cell, anticlockwise seen from outside; a triangle's fourth vertex is `no_index`.
  std::array<index_t, 4> face(index_t cell, std::size_t f) const {
    const LocalFace& local = faces_of(cells[cell].kind)[f];
    std::array<index_t, 4> vertices{};
    for (std::size_t i = 0; i < 4; ++i)
      vertices[i] = local.corners[i] < 0 ? no_index : cells[cell].corners[static_cast<std::size_t>(local.corners[i])];
    return vertices;
  }

  /// The face of a cell with the vertices of `face`, as that cell has it. @pre there is one.
  std::array<index_t, 4> face_like(index_t cell, const std::array<index_t, 4>& face) const {
    std::size_t f = 0;
    while (face_key(this->face(cell, f)) != face_key(face)) ++f;
    return this->face(cell, f);
  }

  /// The other cell that has this very face, or `no_index`.
  index_t across(index_t cell, const std::array<index_t, 4>& face) const {
    return with_face(face, [cell](index_t other) { return other != cell; });
  }

  /// The cell, of those that `admitted` says true of, that has a face. `no_index`: none has.
  template <class Admitted>
  index_t with_face(const std::array<index_t, 4>& face, Admitted&& admitted) const {
    const FaceKey key = face_key(face);
    index_t found = no_index;
    for_each_cell_at(key[0], [&](index_t other) {
      if (found != no_index || !has_vertex(other, key[1]) || !has_vertex(other, key[2])) return;
      if ((key[3] != no_index && !has_vertex(other, key[3])) || !admitted(other)) return;
      for (std::size_t f = 0; f < n_faces(other); ++f)
        if (face_key(this->face(other, f)) == key) found = other;
    });
    return found;
  }

  template <std::size_t N = 8>
  std::span<const Vector3> gather(index_t cell, std::array<Vector3, N>& buffer) const {
    const auto c = corners(cell);
    for (std::size_t i = 0; i < c.size(); ++i) buffer[i] = points[c[i]];
    return {buffer.data(), c.size()};
  }

  double quality(index_t cell) const {
    std::array<Vector3, 8> buffer;
    return scaled_jacobian(cells[cell].kind, gather(cell, buffer));
  }

  bool valid(index_t cell) const {
    std::array<Vector3, 8> buffer;
    return is_valid(cells[cell].kind, gather(cell, buffer));
  }

  double volume(index_t cell) const {
    std::array<Vector3, 8> buffer;
    return cell_volume(cells[cell].kind, gather(cell, buffer));
  }

  // Open interfaces, found by either of their two sides.

  index_t open_quad_at(const std::array<index_t, 4>& face) const {
    const auto found = open_faces_.find(face_key(face));
    return found == open_faces_.end() ? no_index : found->second;
  }

  /// Faces are found by their vertices: a quadrilateral of which one side is open already, for another cell, cannot be
  /// open too. It is refused, and remembered in `refused_quads`: the cells that meet there do not fit together.
  void add_open_quad(OpenQuad quad) {
    const std::array<FaceKey, 3> keys{face_key(quad.vertices), face_key(quad.triangle(0)), face_key(quad.triangle(1))};
    if (std::ranges::any_of(keys, [&](const FaceKey& key) { return open_faces_.contains(key); })) {
      refused_quads.push_back(quad.vertices);
      return;
    }
    quad.open = true;
    for (const FaceKey& key : keys) open_faces_.emplace(key, static_cast<index_t>(open_quads.size()));
    open_quads.push_back(quad);
  }

  void close_quad(index_t id) {
    OpenQuad& quad = open_quads[id];
    quad.open = false;
    open_faces_.erase(face_key(quad.vertices));
    for (int i = 0; i < 2; ++i) open_faces_.erase(face_key(quad.triangle(i)));
  }

private:
  static bool any_in(const std::vector<std::uint8_t>& set, std::span<const index_t> vertices) {
    return !set.empty() && std::ranges::any_of(vertices, [&](index_t v) { return v < set.size() && set[v] != 0; });
  }

  std::vector<index_t> head_;  ///< by vertex: a corner slot (8 cell + corner), the first of its list
  std::vector<index_t> next_;  ///< by corner slot
  std::vector<Time> changed_;  ///< by vertex
  Time now_ = 0;
  std::unordered_map<FaceKey, index_t, FaceKeyHash> open_faces_;
};

}  // namespace framehex::detail
