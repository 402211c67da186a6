// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/geometry/symmetric_matrix.hpp"
#include "framehex/lattice/singular_points.hpp"
#include "framehex/surface/surface_locator.hpp"

#include <optional>

namespace framehex {

namespace detail {

class SingularPointFinder {
public:
  SingularPointFinder(const LatticeGraph& graph, const SingularLines& lines, const std::vector<Vector3>& phases,
                      const Surface& surface, std::span<const double> sizes, bool all_whole)
      : graph_(graph), lines_(lines), phases_(phases), surface_(surface), sizes_(sizes), all_whole_(all_whole) {}

  SingularPoints run() {
    constexpr double least_parity = 0.3;
    result_.are_exact = all_whole_;
    for (const SingularLines::Line& line : lines_.lines()) {
      if (!all_whole_ && lines_.parity(line, phases_) <= least_parity) continue;
      const auto facets = lines_.facets(line);
      find_along(facets);
      if (facets.front().on_boundary) find_end(facets, 0);
      if (facets.back().on_boundary) find_end(facets, facets.size() - 1);
    }
    return std::move(result_);
  }

private:
  using Facets = std::span<const SingularLines::Facet>;

  /// The coordinate along the line at the centre of a facet, up to whole numbers, and its growth per length.
  struct Along {
    double phase, rate;
  };
  Along along(const SingularLines::Facet& facet) const {
    double cosine = 0, sine = 0, rate = 0;
    for (const index_t v : facet.vertices) {
      const Vector3 local = graph_.axes(v).transpose() * facet.axis;
      Eigen::Index axis = 0;
      local.cwiseAbs().maxCoeff(&axis);
      const double sign = local[axis] < 0 ? -1 : 1;
      const Vector3 growth = sign * lines_.rate(v, static_cast<int>(axis));
      const double angle =
          2 * std::numbers::pi * (sign * phases_[v][axis] + (facet.centre - graph_.points()[v]).dot(growth));
      cosine += std::cos(angle);
      sine += std::sin(angle);
      rate += growth.norm() / 3;
    }
    return {std::atan2(sine, cosine) / (2 * std::numbers::pi), rate};
  }

  void find_along(Facets facets) {
    Along before = along(facets[0]);
    double u = before.phase;
    for (std::size_t i = 1; i < facets.size(); ++i) {
      const Along here = along(facets[i]);
      const Vector3 step = facets[i].centre - facets[i - 1].centre;
      const double expected = step.dot(facets[i].axis + facets[i - 1].axis) * (here.rate + before.rate) / 4;
      const double gap = here.phase - u - expected, next = u + expected + gap - std::round(gap);
      for (double k = std::ceil(std::min(u, next)); k <= std::floor(std::max(u, next)); ++k) {
        const double share = next != u ? (k - u) / (next - u) : 0;
        const Vector3 point = facets[i - 1].centre + share * step;
        result_.interior.push_back({refined(point, facets, i, Vector3::Zero()), facets[i].vertices[0]});
      }
      u = next;
      before = here;
    }
  }

  void find_end(Facets facets, std::size_t i) {
    const auto& v = facets[i].vertices;
    const auto& p = graph_.points();
    const Vector3 normal = (p[v[1]] - p[v[0]]).cross(p[v[2]] - p[v[0]]).normalized();
    if (!locator_) locator_.emplace(surface_);
    result_.surface.push_back(locator_->nearest(refined(facets[i].centre, facets, i, normal)));
  }

  /// The lattice point near a place on a line by what the vertices round it know; the place itself when that is far.
  ///
  /// @param normal  the point moves across it only; zero: anywhere.
  Vector3 refined(const Vector3& place, Facets facets, std::size_t at, const Vector3& normal) const {
    constexpr double longest_move = 0.45;  // sizes
    const std::size_t first = at > 1 ? at - 2 : 0, last = std::min(at + 2, facets.size());
    const double h = sizes_[facets[at].vertices[0]];
    std::vector<index_t> vertices;
    for (std::size_t i = first; i < last; ++i)
      vertices.insert(vertices.end(), facets[i].vertices.begin(), facets[i].vertices.end());
    std::sort(vertices.begin(), vertices.end());
    vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
    Eigen::Matrix3d matrix = 1e6 / (h * h) * normal * normal.transpose();
    Vector3 right = Vector3::Zero();
    for (const index_t v : vertices) {
      const double weight = 1 / (0.3 + (graph_.points()[v] - place).norm() / h);
      for (int axis = 0; axis < 3; ++axis) {
        const Vector3 growth = lines_.rate(v, axis);
        const double u = phases_[v][axis] + (place - graph_.points()[v]).dot(growth);
        matrix += weight * weight * growth * growth.transpose();
        right += weight * weight * (std::round(u) - u) * growth;
      }
    }
    const Vector3 move = solve_symmetric(matrix, right);
    return move.norm() < longest_move * h ? Vector3(place + move) : place;
  }

  const LatticeGraph& graph_;
  const SingularLines& lines_;
  const std::vector<Vector3>& phases_;
  const Surface& surface_;
  std::span<const double> sizes_;
  bool all_whole_;
  std::optional<SurfaceLocator> locator_;
  SingularPoints result_;
};

}  // namespace detail

FRAMEHEX_INLINE SingularPoints find_singular_points(const LatticeGraph& graph, const SingularLines& lines,
                                                    const std::vector<Vector3>& phases, const Surface& surface,
                                                    std::span<const double> sizes, bool all_whole) {
  return detail::SingularPointFinder(graph, lines, phases, surface, sizes, all_whole).run();
}

}  // namespace framehex
