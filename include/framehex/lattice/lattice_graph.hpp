// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/field/detail/laplace_solver.hpp"
#include "framehex/field/detail/representatives.hpp"
#include "framehex/field/singular_graph.hpp"
#include "framehex/option_ranges.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace framehex {

/// How the axes of a frame are those of the frame matched with it: axis a of the first is `sign[a]` times axis
/// `axis[a]` of the second.
struct AxisMatching {
  std::array<std::uint8_t, 3> axis{0, 1, 2};
  std::array<std::int8_t, 3> sign{1, 1, 1};

  /// Components along the axes of the second frame, in terms of the first.
  template <class Vector>
  Vector to_first(const Vector& second) const {
    return {sign[0] * second[axis[0]], sign[1] * second[axis[1]], sign[2] * second[axis[2]]};
  }
  /// The inverse, of components that have no sense of direction.
  Vector3 to_second_unsigned(const Vector3& first) const {
    Vector3 second;
    for (int a = 0; a < 3; ++a) second[axis[static_cast<std::size_t>(a)]] = first[a];
    return second;
  }
  /// The inverse.
  template <class Vector>
  Vector to_second(const Vector& first) const {
    Vector second;
    for (int a = 0; a < 3; ++a) {
      const auto i = static_cast<std::size_t>(a);
      second[axis[i]] = sign[i] * first[a];
    }
    return second;
  }
};

/// The matching that an element of CubeRotationGroup stands for (see `detail::edge_symmetry`).
inline const AxisMatching& axis_matching(int symmetry) {
  static const std::array<AxisMatching, 24> table = [] {
    std::array<AxisMatching, 24> result;
    for (int g = 0; g < 24; ++g) {
      const Eigen::Matrix3d m = CubeRotationGroup<>::element(g).toRotationMatrix();
      for (int a = 0; a < 3; ++a) {
        Eigen::Index b = 0;
        m.row(a).cwiseAbs().maxCoeff(&b);
        AxisMatching& matching = result[static_cast<std::size_t>(g)];
        matching.axis[static_cast<std::size_t>(a)] = static_cast<std::uint8_t>(b);
        matching.sign[static_cast<std::size_t>(a)] = m(a, b) > 0 ? 1 : -1;
      }
    }
    return result;
  }();
  return table[static_cast<std::size_t>(symmetry)];
}

/// The edges of a tetrahedral mesh and how the frames at their ends match: on it live the steps and phases of a
/// periodic parameterisation.
///
/// A value per axis and vertex is a Vector3 a vertex, one per axis and edge a Vector3 an edge along the axes of the
/// edge's lower vertex. Frames are kept in representatives aligned along a tree of edges, so that most matchings are the
/// identity; everything that speaks of an axis by its number means these.
class LatticeGraph {
public:
  /// @param adjacency  of the mesh; kept by reference.
  /// @param points     n_vertices, host's unit; kept by reference.
  /// @param frames     n_vertices unit quaternions.
  /// @throws invalid_option  when counts do not match.
  /// @par Complexity   O(edges log valence); about 60 bytes an edge.
  LatticeGraph(const TetAdjacency& adjacency, std::span<const Vector3> points, std::span<const Quaternion> frames)
      : adjacency_(adjacency), points_(points), frames_(frames.begin(), frames.end()) {
    if (points.size() != adjacency.n_vertices() || frames.size() != points.size())
      throw invalid_option("points and frames are not one for each vertex of the mesh");
    align_representatives(adjacency_, frames_);
    axes_.reserve(frames_.size());
    for (const Quaternion& frame : frames_) axes_.push_back(frame.toRotationMatrix());
    make_edges();
    find_singular_tets();
    volumes_.assign(points.size(), 0.0);
    for (const auto& t : adjacency_.tets)
      for (const index_t v : t) volumes_[v] += six_volumes(t) / 24;
  }

  std::size_t n_vertices() const { return points_.size(); }
  std::size_t n_edges() const { return edges_.size(); }
  const TetAdjacency& adjacency() const { return adjacency_; }
  const std::vector<std::array<index_t, 4>>& tets() const { return adjacency_.tets; }
  std::span<const Vector3> points() const { return points_; }
  const std::vector<Quaternion>& frames() const { return frames_; }
  /// Columns: the axes of the frame.
  const Eigen::Matrix3d& axes(index_t vertex) const { return axes_[vertex]; }
  /// Vertices of each edge, ascending.
  const std::vector<std::array<index_t, 2>>& edges() const { return edges_; }
  /// Weights of the Dirichlet integral, host's unit, never below a fiftieth of the edge's length.
  const std::vector<double>& weights() const { return weights_; }
  /// Volume of each vertex: a quarter of its tetrahedra's.
  const std::vector<double>& volumes() const { return volumes_; }
  /// Does a singular line pass through the tetrahedron?
  bool is_singular(index_t tet) const { return singular_[tet] != 0; }

  double six_volumes(const std::array<index_t, 4>& t) const {
    const Vector3& a = points_[t[0]];
    return (points_[t[1]] - a).cross(points_[t[2]] - a).dot(points_[t[3]] - a);
  }

  /// Number of the edge between two neighbours.
  index_t edge(index_t v, index_t w) const {
    const auto row = adjacency_.vertices_of_vertex[v];
    const auto at = std::lower_bound(row.begin(), row.end(), w) - row.begin();
    return edge_of_slot_[adjacency_.vertices_of_vertex.offsets[v] + static_cast<offset_t>(at)];
  }
  /// The same by the position in `adjacency().vertices_of_vertex.values`.
  index_t edge_of_slot(offset_t slot) const { return edge_of_slot_[slot]; }

  /// Matching from the lower vertex of an edge to the higher.
  const AxisMatching& matching(index_t edge) const { return axis_matching(symmetry_[edge]); }
  /// Matching from v to its neighbour w.
  const AxisMatching& matching(index_t v, index_t w) const {
    const int g = symmetry_[edge(v, w)];
    return axis_matching(v < w ? g : CubeRotationGroup<>::inverse(g));
  }
  int symmetry(index_t edge) const { return symmetry_[edge]; }

  /// Is the composition of the matchings round a facet the identity?
  bool is_regular(const std::array<index_t, 3>& facet) const { return detail::monodromy(frames_, facet) == 0; }

  /// A value along the edge from v to w in the frame of v, of values stored by edges.
  Vector3 along(const std::vector<Vector3>& values, index_t v, index_t w) const {
    const index_t e = edge(v, w);
    if (v < w) return values[e];
    return -matching(e).to_second(values[e]);
  }

private:
  void make_edges() {
    const Csr<index_t>& ring = adjacency_.vertices_of_vertex;
    const std::vector<double> weight_of_slot = dirichlet_weights(adjacency_, points_);
    edge_of_slot_.resize(ring.values.size());
    // Numbered along a space-filling curve: neighbours in the mesh are near in memory.
    for (const index_t v : detail::spatial_order(points_))
      for (offset_t s = ring.offsets[v]; s < ring.offsets[v + 1]; ++s) {
        const index_t w = ring.values[s];
        if (w < v) continue;
        edge_of_slot_[s] = static_cast<index_t>(edges_.size());
        edges_.push_back({v, w});
        symmetry_.push_back(static_cast<std::uint8_t>(detail::edge_symmetry(frames_, v, w)));
        // Single precision: solvers that keep them so have the same equations.
        weights_.push_back(static_cast<float>(std::max(weight_of_slot[s], 0.02 * (points_[w] - points_[v]).norm())));
      }
    // Edges to lower neighbours: walked by ascending lower vertex, each row of a higher vertex fills up in order.
    std::vector<offset_t> next(ring.offsets.begin(), ring.offsets.end() - 1);
    for (index_t v = 0; v < ring.size(); ++v)
      for (offset_t s = ring.offsets[v]; s < ring.offsets[v + 1]; ++s)
        if (ring.values[s] > v) edge_of_slot_[next[ring.values[s]]++] = edge_of_slot_[s];
  }

  void find_singular_tets() {
    singular_.assign(tets().size(), 0);
    for (index_t tet = 0; tet < tets().size(); ++tet)
      for (int face = 0; face < 4; ++face) {
        const index_t other = adjacency_.neighbours[tet][static_cast<std::size_t>(face)];
        if (other < tet || is_regular(facet(tets()[tet], face))) continue;
        singular_[tet] = 1;
        if (other != no_index) singular_[other] = 1;
      }
  }

  const TetAdjacency& adjacency_;
  std::span<const Vector3> points_;
  std::vector<Quaternion> frames_;
  std::vector<Eigen::Matrix3d> axes_;
  std::vector<std::array<index_t, 2>> edges_;
  std::vector<index_t> edge_of_slot_;
  std::vector<std::uint8_t> symmetry_;
  std::vector<double> weights_, volumes_;
  std::vector<std::uint8_t> singular_;
};

}  // namespace framehex
