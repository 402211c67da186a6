// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/lattice/boundary_axes.hpp"
#include "framehex/lattice/lattice_map.hpp"

namespace framehex {

/// Where a map is regular: its cells can be told, and are not far from the sizes.
///
/// References are kept to all arguments.
class LatticeRegularity {
public:
  /// @param sizes      n_vertices of the mesh: wished distance of neighbours, host's unit.
  /// @param vertex_of  surface vertex -> vertex of the mesh; empty: the same number.
  LatticeRegularity(const LatticeMap& map, const Surface& surface, const BoundaryAxes& boundary,
                    std::span<const double> sizes, std::span<const index_t> vertex_of = {})
      : map_(map), graph_(map.graph()), surface_(surface), boundary_(boundary), sizes_(sizes), vertex_of_(vertex_of) {}

  index_t in_mesh(index_t surface_vertex) const {
    return vertex_of_.empty() ? surface_vertex : vertex_of_[surface_vertex];
  }

  template <std::size_t N>
  double mean_size(const std::array<index_t, N>& corners) const {
    double sum = 0;
    for (const index_t v : corners) sum += sizes_[v];
    return sum / static_cast<double>(N);
  }

  /// Cells in the volume of a tetrahedron, by that volume in cubes of the size. @param u  its corners' coordinates.
  double density(const std::array<index_t, 4>& t, const std::array<Vector3, 4>& u) const {
    const double h = mean_size(t);
    return (u[1] - u[0]).cross(u[2] - u[0]).dot(u[3] - u[0]) * h * h * h / graph_.six_volumes(t);
  }
  static bool is_regular(double density) { return density > 0.1 && density < 6; }

  std::array<index_t, 3> triangle(index_t number) const {
    const auto& s = surface_.triangles()[number];
    return {in_mesh(s[0]), in_mesh(s[1]), in_mesh(s[2])};
  }

  /// The two coordinates along the boundary at the corners of one of its triangles; nothing where the map is not regular.
  std::optional<std::array<Eigen::Vector2d, 3>> on_triangle(index_t number) const {
    const std::array<index_t, 3> t = triangle(number);
    const std::uint8_t normal = boundary_.normal_axis[std::size_t{3} * number];
    if (normal == BoundaryAxes::none || !graph_.is_regular(t)) return std::nullopt;
    const auto corners = map_.unwrapped(t);
    if (!corners) return std::nullopt;
    const int x = (normal + 1) % 3, y = (normal + 2) % 3;
    std::array<Eigen::Vector2d, 3> u;
    for (std::size_t i = 0; i < 3; ++i) u[i] = {(*corners)[i][x], (*corners)[i][y]};
    const Eigen::Vector2d first = u[1] - u[0], second = u[2] - u[0];
    const double cells = std::abs(first[0] * second[1] - first[1] * second[0]) / 2;
    const double density = cells / area(number);
    if (!(density > 0.15 && density < 4)) return std::nullopt;
    return u;
  }

  /// In squares of the size.
  double area(index_t number) const {
    const std::array<index_t, 3> t = triangle(number);
    const auto p = graph_.points();
    const double h = mean_size(t);
    return (p[t[1]] - p[t[0]]).cross(p[t[2]] - p[t[0]]).norm() / (2 * h * h);
  }

  /// Area of the boundary where the map is not regular, in squares of the size. @par Complexity   O(triangles).
  double irregular_area() const {
    double sum = 0;
    for (index_t number = 0; number < surface_.triangles().size(); ++number)
      if (!on_triangle(number)) sum += area(number);
    return sum;
  }

private:
  const LatticeMap& map_;
  const LatticeGraph& graph_;
  const Surface& surface_;
  const BoundaryAxes& boundary_;
  std::span<const double> sizes_;
  std::span<const index_t> vertex_of_;
};

}  // namespace framehex
