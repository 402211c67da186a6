// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/geometry/proximity.hpp"
#include "framehex/lattice/lattice_points.hpp"
#include "framehex/lattice/lattice_regularity.hpp"

namespace framehex {

namespace detail {

/// Points kept when none is near: of several that differ by rounding only the first stays.
class ThinnedPoints {
public:
  explicit ThinnedPoints(double largest_size) : grid_(largest_size) {}

  /// @param group  points of other groups do not count. @return false when a kept one is within half a size.
  bool add(const Vector3& point, double size, index_t group = 0) {
    const Vector3 reach = Vector3::Constant(0.5 * size);
    bool free = true;
    grid_.for_each_in_box(point - reach, point + reach, [&](index_t i, const Vector3& other) {
      if (groups_[i] == group && (other - point).squaredNorm() < 0.25 * size * size) free = false;
    });
    if (!free) return false;
    grid_.insert(point, size);
    groups_.push_back(group);
    return true;
  }

private:
  HashGrid grid_;
  std::vector<index_t> groups_;
};

/// Calls `visit(weights)` for each whole point of a simplex of N corners in N - 1 dimensions.
template <std::size_t N, class Visit>
void for_each_whole_point(const std::array<Eigen::Matrix<double, N - 1, 1>, N>& corners, Visit&& visit) {
  constexpr int d = N - 1;
  using Point = Eigen::Matrix<double, d, 1>;
  Eigen::Matrix<double, d, d> edges;
  Point low = corners[0], high = corners[0];
  for (std::size_t i = 1; i < N; ++i) {
    edges.col(static_cast<Eigen::Index>(i) - 1) = corners[i] - corners[0];
    low = low.cwiseMin(corners[i]);
    high = high.cwiseMax(corners[i]);
  }
  const Eigen::Matrix<double, d, d> inverse = edges.inverse();
  constexpr double slack = 1e-7;
  low = (low.array() - 1e-9).ceil();
  high = (high.array() + 1e-9).floor();
  Point at = low;
  while ((at.array() <= high.array()).all()) {
    const Point weights = inverse * (at - corners[0]);
    std::array<double, N> all{1 - weights.sum()};
    for (std::size_t i = 1; i < N; ++i) all[i] = weights[static_cast<Eigen::Index>(i) - 1];
    if (*std::min_element(all.begin(), all.end()) > -slack) visit(all);
    int axis = 0;
    for (at[0] += 1; axis + 1 < d && at[axis] > high[axis]; ++at[axis]) at[axis] = low[axis], ++axis;
  }
}

/// Finds the points of the lattice on all parts of a mesh.
class LatticeExtraction {
public:
  LatticeExtraction(const LatticeMap& map, const Surface& surface, const BoundaryAxes& boundary,
                    std::span<const double> sizes, std::span<const index_t> vertex_of)
      : map_(map),
        graph_(map.graph()),
        regularity_(map, surface, boundary, sizes, vertex_of),
        surface_(surface),
        features_(surface.features),
        sizes_(sizes),
        inside_(*std::max_element(sizes.begin(), sizes.end())),
        on_patches_(*std::max_element(sizes.begin(), sizes.end())) {}

  LatticePoints run(const SingularPoints& singular) {
    if (singular.are_exact) add(singular);
    find_in_tets();
    find_on_triangles();
    if (!singular.are_exact) add(singular);
    for (std::size_t c = 0; c < features_.curves.size(); ++c) find_on_curve(features_.curves[c]);
    return std::move(result_);
  }

private:
  index_t in_mesh(index_t v) const { return regularity_.in_mesh(v); }
  double size(index_t v) const { return sizes_[v]; }

  void find_in_tets() {
    std::vector<std::uint8_t> on_surface(graph_.n_vertices(), 0);
    for (const auto& t : surface_.triangles())
      for (const index_t v : t) on_surface[in_mesh(v)] = 1;
    result_.complete_tets.assign(graph_.tets().size(), 0);
    double volume = 0, complete = 0;
    for (index_t tet = 0; tet < graph_.tets().size(); ++tet) {
      const auto& t = graph_.tets()[tet];
      const double six_volumes = graph_.six_volumes(t);
      volume += six_volumes;
      if (graph_.is_singular(tet)) {
        ++result_.n_singular_tets;
        continue;
      }
      const auto corners = map_.unwrapped(t);
      if (!corners) {
        ++result_.n_defect_tets;
        continue;
      }
      const auto& u = *corners;
      const double h = regularity_.mean_size(t);
      const bool regular = LatticeRegularity::is_regular(regularity_.density(t, u));
      // Flat in the lattice: all corners on the same sheet, beside which others are regular.
      const bool flat = on_surface[t[0]] && on_surface[t[1]] && on_surface[t[2]] && on_surface[t[3]];
      if (!regular && !flat) continue;
      result_.complete_tets[tet] = 1;
      complete += six_volumes;
      if (!regular) continue;
      for_each_whole_point<4>(u, [&](const std::array<double, 4>& weights) {
        Vector3 p = Vector3::Zero();
        for (std::size_t i = 0; i < 4; ++i) p += weights[i] * graph_.points()[t[i]];
        if (inside_.add(p, h)) result_.interior.push_back(p);
      });
    }
    result_.complete_volume = volume > 0 ? complete / volume : 0;
  }

  void find_on_triangles() {
    result_.complete_triangles.assign(surface_.triangles().size(), 0);
    for (index_t triangle = 0; triangle < surface_.triangles().size(); ++triangle) {
      const auto u = regularity_.on_triangle(triangle);
      if (!u) continue;
      result_.complete_triangles[triangle] = 1;
      const auto& s = surface_.triangles()[triangle];
      const double h = regularity_.mean_size(regularity_.triangle(triangle));
      for_each_whole_point<3>(*u, [&](std::array<double, 3> weights) {
        Vector3 p = Vector3::Zero();
        double sum = 0;
        for (double& w : weights) sum += w = std::max(w, 0.0);
        for (std::size_t i = 0; i < 3; ++i) p += weights[i] / sum * surface_.points[s[i]];
        add_on_surface(p, triangle, h);
      });
    }
  }

  void add_on_surface(const Vector3& p, index_t triangle, double h) {
    if (on_patches_.add(p, h, features_.triangle_patch[triangle]))
      result_.surface.push_back({p, SampleKind::surface, triangle, 0.0});
  }

  void add(const SingularPoints& singular) {
    for (const SingularPoint& s : singular.interior)
      if (inside_.add(s.point, size(s.vertex))) result_.interior.push_back(s.point);
    for (const SurfacePoint& s : singular.surface)
      add_on_surface(s.point, s.triangle, size(in_mesh(surface_.triangles()[s.triangle][0])));
  }

  /// Follows the axis along the tangent: whole coordinates where it has grown past them.
  void find_on_curve(std::span<const index_t> row) {
    const bool closed =
        row.front() == row.back() && !std::binary_search(features_.corners.begin(), features_.corners.end(), row[0]);
    std::vector<double> arc{0}, coordinate;
    bool rising = true;
    for (std::size_t i = 0; i + 1 < row.size(); ++i) {
      const index_t v = in_mesh(row[i]), w = in_mesh(row[i + 1]);
      const Vector3 edge = graph_.points()[w] - graph_.points()[v];
      arc.push_back(arc.back() + edge.norm());
      const Vector3 along = graph_.axes(v).transpose() * edge;
      Eigen::Index axis = 0;
      along.cwiseAbs().maxCoeff(&axis);
      const double sign = along[axis] < 0 ? -1 : 1;
      if (i == 0) coordinate.push_back(sign * map_.phase(v)[axis]);
      coordinate.push_back(coordinate.back() + sign * map_.difference(v, w)[axis]);
      rising = rising && coordinate[i + 1] > coordinate[i];
    }
    const std::size_t before = result_.curves.arcs.values.size();
    const bool usable = rising && add_arcs(row, arc, coordinate, closed);
    if (!usable) result_.curves.arcs.values.resize(before);
    result_.curves.arcs.end_row();
    result_.curves.is_usable.push_back(usable ? 1 : 0);
  }

  /// @return false when they are too few or too near to each other.
  bool add_arcs(std::span<const index_t> row, const std::vector<double>& arc, const std::vector<double>& coordinate,
                bool closed) {
    auto& arcs = result_.curves.arcs.values;
    const double first = std::ceil(coordinate.front() - 1e-6), length = coordinate.back() - coordinate.front();
    const auto n =
        static_cast<std::size_t>(closed ? std::round(length) : std::floor(coordinate.back() + 1e-6) - first + 1);
    std::size_t segment = 0;
    double last = closed ? -1e300 : 0;
    std::size_t n_added = 0;
    for (std::size_t k = 0; k < n; ++k) {
      const double wanted = first + static_cast<double>(k);
      while (segment + 2 < coordinate.size() && wanted > coordinate[segment + 1]) ++segment;
      const double share = (wanted - coordinate[segment]) / (coordinate[segment + 1] - coordinate[segment]);
      const double s = arc[segment] + std::clamp(share, 0.0, 1.0) * (arc[segment + 1] - arc[segment]);
      const double least = 0.4 * size(in_mesh(row[segment]));
      if (!closed && (s <= least || s >= arc.back() - least)) continue;
      if (s - last < least) return false;
      arcs.push_back(last = s);
      ++n_added;
    }
    return !closed || n_added >= 4;
  }

  const LatticeMap& map_;
  const LatticeGraph& graph_;
  LatticeRegularity regularity_;
  const Surface& surface_;
  const FeatureGraph& features_;
  std::span<const double> sizes_;
  ThinnedPoints inside_, on_patches_;
  LatticePoints result_;
};

}  // namespace detail

FRAMEHEX_INLINE LatticePoints extract_lattice_points(const LatticeMap& map, const Surface& surface,
                                                     const BoundaryAxes& boundary, std::span<const double> sizes,
                                                     const SingularPoints& singular,
                                                     std::span<const index_t> vertex_of) {
  if (map.graph().n_vertices() == 0) return {};
  if (sizes.size() != map.graph().n_vertices()) throw invalid_option("there is not one size for each vertex");
  return detail::LatticeExtraction(map, surface, boundary, sizes, vertex_of).run(singular);
}

}  // namespace framehex
