// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/lattice/lattice_graph.hpp"
#include "framehex/surface/surface.hpp"

namespace framehex {

/// Axes of a frame, one bit each.
using AxisMask = std::uint8_t;

/// Which axes of the frames stand on the boundary, and so have whole coordinates there.
struct BoundaryAxes {
  static constexpr std::uint8_t none = 3;
  std::vector<std::uint8_t> normal_axis;  ///< 3 n_triangles: axis along the normal of the corner's patch, or `none`
  std::vector<AxisMask> whole;            ///< per vertex of the mesh: axes whose coordinate is whole
};

/// Finds the axes that are normal to the patches of the boundary.
///
/// At each vertex and patch it is the axis nearest to the mean normal of the patch's triangles there, when it is within
/// 41 degrees; on curves the axes of both patches come about by themselves. At corners all three are whole.
///
/// @param surface    the boundary of the mesh.
/// @param vertex_of  surface vertex -> vertex of the mesh; empty: the same number.
/// @par Complexity   O(triangles * valence).
inline BoundaryAxes find_boundary_axes(const LatticeGraph& graph, const Surface& surface,
                                       std::span<const index_t> vertex_of = {}) {
  const FeatureGraph& features = surface.features;
  constexpr double least_cosine = 0.75;
  BoundaryAxes result;
  result.normal_axis.assign(3 * surface.triangles().size(), BoundaryAxes::none);
  result.whole.assign(graph.n_vertices(), 0);
  const auto in_mesh = [&](index_t v) { return vertex_of.empty() ? v : vertex_of[v]; };
  std::vector<Vector3> normals;  // twice the area long
  normals.reserve(surface.triangles().size());
  for (const auto& t : surface.triangles())
    normals.push_back((surface.points[t[1]] - surface.points[t[0]]).cross(surface.points[t[2]] - surface.points[t[0]]));
  for (index_t corner = 0; corner < result.normal_axis.size(); ++corner) {
    const index_t patch = features.triangle_patch[corner / 3], v = surface.triangles()[corner / 3][corner % 3];
    Vector3 normal = Vector3::Zero();
    for (const index_t t : surface.adjacency.triangles_of_vertex[v])
      if (features.triangle_patch[t] == patch) normal += normals[t];
    const double length = normal.norm();
    if (!(length > 0)) continue;
    Eigen::Index axis = 0;
    const double cosine = (graph.axes(in_mesh(v)).transpose() * normal).cwiseAbs().maxCoeff(&axis) / length;
    if (cosine <= least_cosine) continue;
    result.normal_axis[corner] = static_cast<std::uint8_t>(axis);
    result.whole[in_mesh(v)] |= static_cast<AxisMask>(1 << axis);
  }
  for (const index_t corner : features.corners) result.whole[in_mesh(corner)] = 7;
  return result;
}

}  // namespace framehex
