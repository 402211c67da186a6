// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/geometry/rotation.hpp"
#include "framehex/surface/detail/triangle_normals.hpp"

#include <cmath>
#include <complex>
#include <numbers>

namespace framehex::detail {

using Complex = std::complex<double>;

/// Flat triangles hinged at their edges: the connection on which crosses are compared.
///
/// Each edge's tangent plane is that of either triangle beside it, with the edge itself as the direction of angle 0. A
/// cross at angle a is the number exp(4ia), so the orientation of the edge does not matter. In a triangle angles are
/// counted from its first half edge.
struct EdgeConnection {
  std::vector<index_t> edge_of;                  ///< half edge -> edge
  std::vector<index_t> half_edge_of;             ///< edge -> its smaller half edge
  std::vector<double> direction;                 ///< half edge -> its angle in its triangle
  std::vector<std::array<double, 3>> cotangent;  ///< triangle -> cotangents of the angles at its corners
  std::vector<double> area;                      ///< triangle
  std::vector<double> angle;                     ///< corner (numbered like the half edge that leaves it)

  std::size_t n_edges() const { return half_edge_of.size(); }

  /// What turns a number relative to half edge h into one relative to its triangle.
  Complex turn(index_t h) const { return std::polar(1.0, 4 * direction[h]); }
};

inline EdgeConnection make_edge_connection(const std::vector<Vector3>& points, const TriangleAdjacency& adjacency) {
  EdgeConnection c;
  const std::size_t n_half_edges = adjacency.opposite.size();
  c.edge_of.resize(n_half_edges);
  for (index_t h = 0; h < n_half_edges; ++h) {
    const index_t twin = adjacency.opposite[h];
    if (twin == no_index || h < twin) {
      c.edge_of[h] = static_cast<index_t>(c.half_edge_of.size());
      c.half_edge_of.push_back(h);
    } else {
      c.edge_of[h] = c.edge_of[twin];
    }
  }
  c.direction.resize(n_half_edges);
  c.angle.resize(n_half_edges);
  c.cotangent.resize(adjacency.triangles.size());
  c.area.resize(adjacency.triangles.size());
  for (index_t t = 0; t < adjacency.triangles.size(); ++t) {
    const auto& v = adjacency.triangles[t];
    const double twice_area = (points[v[1]] - points[v[0]]).cross(points[v[2]] - points[v[0]]).norm();
    double longest = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      const Vector3 u = points[v[(i + 1) % 3]] - points[v[i]], w = points[v[(i + 2) % 3]] - points[v[i]];
      c.angle[3 * t + i] = std::atan2(u.cross(w).norm(), u.dot(w));
      c.cotangent[t][i] = u.dot(w) / twice_area;
      longest = std::max(longest, u.squaredNorm());
    }
    // A needle without area would dominate all sums; it only has to hold its neighbours together.
    if (!(twice_area > 1e-6 * longest)) c.cotangent[t].fill(std::numbers::inv_sqrt3);
    c.area[t] = twice_area / 2;
    c.direction[3 * t] = 0;
    c.direction[3 * t + 1] = std::numbers::pi - c.angle[3 * t + 1];
    c.direction[3 * t + 2] = c.direction[3 * t + 1] + std::numbers::pi - c.angle[3 * t + 2];
  }
  return c;
}

}  // namespace framehex::detail
