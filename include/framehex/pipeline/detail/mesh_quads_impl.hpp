// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/pipeline/detail/mesh_quads.hpp"
#include "framehex/pipeline/detail/quad_mesher.hpp"
#include "framehex/verify/quad_quality.hpp"

#include <numbers>

namespace framehex::detail {

/// How good a mesh of quadrilaterals is where that is not the input's doing: what its worst cells are like.
class QuadMerit {
public:
  explicit QuadMerit(const QuadMesh& mesh) {
    std::vector<char> is_corner(mesh.points.size(), 0), is_tip(mesh.points.size(), 0);
    std::vector<index_t> n_cells(mesh.points.size(), 0);
    for (const index_t v : mesh.corners) is_corner[v] = is_tip[v] = 1;
    for (const LabelledEdge& edge : mesh.edges)
      for (const index_t v : edge.vertices) is_tip[v] = 0;
    for (const auto& cell : mesh.cells)
      for (std::size_t i = 0; i < QuadMesh::n_corners(cell); ++i) ++n_cells[cell[i]];
    // A corner of the input that one cell fills is as sharp as the input has it, unless it has room for more; so is a tip
    // that three surround.
    const auto given = [&](index_t v) { return is_corner[v] && n_cells[v] <= (is_tip[v] ? 3 : 1); };
    const verify::QuadQuality quality = verify::quad_quality(mesh);
    mean_ = quality.mean;
    for (index_t c = 0; c < mesh.cells.size(); ++c) {
      const QuadMesh::Cell& cell = mesh.cells[c];
      const bool forced = std::any_of(cell.begin(), cell.begin() + QuadMesh::n_corners(cell), given);
      const double worst = forced ? least_free_angle(mesh, cell, given) : quality.scaled_jacobian[c];
      least_ = std::min(least_, worst);
      if (worst < poor) poor_cells_.push_back(c);
    }
  }

  const std::vector<index_t>& poor_cells() const { return poor_cells_; }
  bool operator<(const QuadMerit& other) const {
    return std::pair(std::min(least_, poor), mean_) < std::pair(std::min(other.least_, poor), other.mean_);
  }

private:
  static constexpr double poor = 0.6;                               ///< scaled Jacobian
  static constexpr double room_for_two = -std::numbers::sqrt2 / 2;  ///< cosine of 135 degrees

  template <class Given>
  static double least_free_angle(const QuadMesh& mesh, const QuadMesh::Cell& cell, const Given& given) {
    const std::size_t n = QuadMesh::n_corners(cell);
    double least = 1;
    for (std::size_t i = 0; i < n; ++i) {
      const Vector3& p = mesh.points[cell[i]];
      const Vector3 x = (mesh.points[cell[(i + 1) % n]] - p).normalized(),
                    y = (mesh.points[cell[(i + n - 1) % n]] - p).normalized();
      if (given(cell[i]) && x.dot(y) > room_for_two) continue;
      least = std::min(least, x.cross(y).norm());
    }
    return least;
  }

  double least_ = 1, mean_ = 0;
  std::vector<index_t> poor_cells_;
};

/// The middles and mean sides of cells.
FRAMEHEX_INLINE std::vector<SizeLimit> cells_as_limits(const QuadMesh& mesh, const std::vector<index_t>& cells) {
  std::vector<SizeLimit> limits;
  for (const index_t c : cells) {
    const QuadMesh::Cell& cell = mesh.cells[c];
    const std::size_t n = QuadMesh::n_corners(cell);
    SizeLimit& limit = limits.emplace_back(SizeLimit{Vector3::Zero(), 0});
    for (std::size_t i = 0; i < n; ++i) {
      const Vector3 &p = mesh.points[cell[i]], &q = mesh.points[cell[(i + 1) % n]];
      limit.place += p / static_cast<double>(n);
      limit.length += (q - p).norm() / static_cast<double>(n);
    }
  }
  return limits;
}

FRAMEHEX_INLINE QuadMeshing mesh_quads(const Surface& input, const SizeFieldRef& size, const MatcherRef& matcher,
                                       QuadMeshingOptions options) {
  constexpr std::size_t most_cells = 500, most_tried = 5'000;
  QuadMesher first(matcher, size, options);
  QuadMeshing best = first.run(input);
  const QuadMeshingStatistics& s = best.statistics;
  if (best.status == Status::cancelled || best.mesh.cells.size() > most_cells || best.mesh.n_triangles() > 0 ||
      s.n_widened_edges > 0 || options.improvement.scope != QuadImprovementScope::everywhere)
    return best;
  QuadMerit merit(best.mesh);
  std::size_t n_tried = s.n_tried_changes;
  const std::vector<SizeLimit> poor = cells_as_limits(best.mesh, merit.poor_cells());
  const FrontOrder given = options.order, other = given == FrontOrder::fifo ? FrontOrder::smoothness : FrontOrder::fifo;
  for (const auto& [order, factor] :
       {std::pair{other, 1.0}, {given, 0.9}, {other, 0.9}, {given, 0.8}, {other, 0.8}, {given, 0.7}}) {
    // Cells that no change mends are not worth more than some seconds.
    if (merit.poor_cells().empty() || n_tried > most_tried) break;
    options.order = order;
    std::vector<SizeLimit> limits;
    if (factor < 1)
      for (const SizeLimit& cell : poor) limits.push_back({cell.place, factor * first.size_at(cell.place)});
    QuadMeshing next;
    try {
      QuadMesher again(matcher, size, options);
      again.limit(first.limits());
      again.limit_inside(std::move(limits));
      next = again.run(input);
    } catch (const error&) {
      continue;  // there is a mesh already
    }
    if (next.status == Status::cancelled) return next;
    next.seconds += best.seconds;
    n_tried += next.statistics.n_tried_changes;
    QuadMerit next_merit(next.mesh);
    const double near = std::max(options.retriangulation.max_deviation, best.statistics.deviation);
    if (next.mesh.n_triangles() == 0 && next.statistics.deviation <= near && merit < next_merit) {
      best = std::move(next);
      merit = std::move(next_merit);
    } else {
      best.seconds = next.seconds;
    }
  }
  best.statistics.n_tried_changes = n_tried;
  return best;
}

}  // namespace framehex::detail
