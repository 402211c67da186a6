// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/tetrahedralization/tetrahedralizer.hpp"

#include <CGAL/Delaunay_triangulation_3.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_cell_base_with_info_3.h>
#include <CGAL/Triangulation_vertex_base_with_info_3.h>

/// CGAL's Delaunay tetrahedra as a Tetrahedralizer within the process.
///
/// CGAL's triangulations are under the GPL: a program that includes this header is bound by it.
namespace framehex {

namespace detail {

/// The Delaunay tetrahedra of points, parted by triangles that are facets of theirs.
class CgalPartition {
public:
  explicit CgalPartition(std::span<const Vector3> points) {
    std::vector<std::pair<Kernel::Point_3, index_t>> numbered;
    for (const Vector3& p : points)
      numbered.emplace_back(Kernel::Point_3(p.x(), p.y(), p.z()), static_cast<index_t>(numbered.size()));
    delaunay_.insert(numbered.begin(), numbered.end());
    vertex_.resize(points.size());
    for (const auto v : delaunay_.finite_vertex_handles()) vertex_[v->info()] = v;
  }

  /// Makes a triangle a wall between the inner cell behind it and the outer one before it.
  /// @return false when it is no facet of the tetrahedra.
  bool add_wall(const std::array<index_t, 3>& triangle) {
    // One of two points in the same place has no vertex.
    for (const index_t v : triangle)
      if (vertex_[v] == Vertex()) return false;
    Cell cell;
    int i = 0, j = 0, k = 0;
    if (!delaunay_.is_facet(vertex_[triangle[0]], vertex_[triangle[1]], vertex_[triangle[2]], cell, i, j, k))
      return false;
    const int opposite = 6 - i - j - k;
    const bool inner = is_odd({i, j, k, opposite});
    add_wall(cell, opposite, inner);
    add_wall(cell->neighbor(opposite), cell->neighbor(opposite)->index(cell), !inner);
    return true;
  }

  /// The tetrahedra that no wall parts from an inner one.
  std::vector<std::array<index_t, 4>> inner() {
    while (!next_.empty()) {
      const Cell cell = next_.back();
      next_.pop_back();
      for (int i = 0; i < 4; ++i)
        if (!cell->info().walls[static_cast<std::size_t>(i)]) mark(cell->neighbor(i), cell->info().side == Side::inner);
    }
    std::vector<std::array<index_t, 4>> tets;
    for (const auto c : delaunay_.finite_cell_handles())
      if (c->info().side == Side::inner)
        tets.push_back({c->vertex(0)->info(), c->vertex(1)->info(), c->vertex(2)->info(), c->vertex(3)->info()});
    return tets;
  }

private:
  using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
  enum class Side : std::uint8_t { unknown, inner, outer };
  struct CellState {
    Side side = Side::unknown;
    std::array<bool, 4> walls{};  // by opposite corner
  };
  using Structure = CGAL::Triangulation_data_structure_3<CGAL::Triangulation_vertex_base_with_info_3<index_t, Kernel>,
                                                         CGAL::Triangulation_cell_base_with_info_3<CellState, Kernel>>;
  using Delaunay = CGAL::Delaunay_triangulation_3<Kernel, Structure>;
  using Vertex = Delaunay::Vertex_handle;
  using Cell = Delaunay::Cell_handle;

  /// Of a permutation of 0..3. Cells are positive: they lie behind three of their corners, anticlockwise seen from before,
  /// when these and the fourth are in an odd order.
  static bool is_odd(const std::array<int, 4>& order) {
    bool odd = false;
    for (std::size_t a = 0; a < 4; ++a)
      for (std::size_t b = a + 1; b < 4; ++b) odd ^= order[a] > order[b];
    return odd;
  }

  void add_wall(Cell cell, int opposite, bool inner) {
    cell->info().walls[static_cast<std::size_t>(opposite)] = true;
    mark(cell, inner);
  }

  void mark(Cell cell, bool inner) {
    if (cell->info().side != Side::unknown) return;
    cell->info().side = inner ? Side::inner : Side::outer;
    next_.push_back(cell);
  }

  Delaunay delaunay_;
  std::vector<Vertex> vertex_;
  std::vector<Cell> next_;
};

}  // namespace detail

/// Tetrahedralizer for surfaces all of whose triangles are facets of the Delaunay tetrahedra of the points: the hull of
/// points no four of which lie in a plane and on a circle, and finely sampled surfaces without points near them.
///
/// @throws tetrahedralization_error with the corners of the first triangle that is none.
/// @par Determinism   the same input gives the same mesh.
/// @par Complexity    O(n log n) expected for points that fill a body evenly.
struct CgalDelaunay {
  TetrahedralizationResult operator()(const TetrahedralizationRequest& request) const {
    if (!keep_going(request.observer, "tetrahedra", 0)) return {{}, {}, Status::cancelled};
    detail::CgalPartition partition(request.points);
    std::vector<std::array<index_t, 3>> lost;
    for (const auto& triangle : request.triangles)
      if (!partition.add_wall(triangle)) lost.push_back(triangle);
    if (!lost.empty()) throw_lost(lost, request.triangles.size());
    return {partition.inner(), {}, Status::complete};
  }

private:
  [[noreturn]] static void throw_lost(const std::vector<std::array<index_t, 3>>& lost, std::size_t n_triangles) {
    const auto& [a, b, c] = lost.front();
    throw tetrahedralization_error(
        std::to_string(lost.size()) + " of " + std::to_string(n_triangles) +
            " triangles of the surface are no facets of Delaunay tetrahedra, the first is (" + std::to_string(a) +
            ", " + std::to_string(b) + ", " + std::to_string(c) + ") of the surface's own samples",
        Entity::vertex, {a, b, c});
  }
};
static_assert(Tetrahedralizer<CgalDelaunay>);

}  // namespace framehex
