// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/geometry/quadrilateral.hpp"
#include "framehex/geometry/rotation.hpp"
#include "framehex/quads/detail/triangle_fan.hpp"
#include "framehex/quads/matching.hpp"

#include <compare>
#include <span>

namespace framehex::detail {

/// Two triangles that meet in a vertex only, or would: joined, they open it.
struct Opening {
  index_t a, b;  ///< triangles, a < b
  std::int64_t cost;
  index_t vertex;

  friend auto operator<=>(const Opening&, const Opening&) = default;
};

/// Which triangles may be joined, and what it costs.
class PairingGraph {
public:
  static constexpr double unit = 10'000;  ///< costs are whole parts of this

  /// @param frames  one a triangle, or empty.
  /// @param alignment  weight of the cross field, 0 to 1.
  PairingGraph(const Surface& surface, const PatchSides& sides, std::span<const Quaternion> frames, double alignment)
      : surface_(surface), sides_(sides), frames_(frames), alignment_(frames.empty() ? 0 : alignment) {
    const TriangleAdjacency& adjacency = surface.adjacency;
    for (index_t h = 0; h < adjacency.opposite.size(); ++h)
      if (const index_t g = adjacency.opposite[h]; g > h && !sides.is_wall(h) && !meet_twice(h))
        edges_.push_back({h / 3, g / 3, whole(cost(h))});
  }

  /// Lets triangles beside each other on a rim or curve be joined through the vertex between them.
  void add_openings_on_curves(double cost) {
    TriangleFan fan;
    for (index_t h = 0; h < surface_.adjacency.opposite.size(); ++h) {
      if (!sides_.is_wall(h)) continue;
      sides_.fan(h, fan);
      add_opening(fan.outgoing.front() / 3, fan.outgoing.back() / 3, surface_.adjacency.from(h), cost);
    }
    finish_openings();
  }

  /// Lets two neighbours of every triangle be joined through the vertex that all three have. With these a connected
  /// patch of an even number of triangles always falls into pairs: from the leaves of a spanning tree inwards, two
  /// that are alone below one triangle are joined, one that is alone is joined with the triangle itself.
  void add_openings_everywhere(double cost) {
    const TriangleAdjacency& adjacency = surface_.adjacency;
    for (index_t h = 0; h < adjacency.opposite.size(); ++h) {
      const index_t in = TriangleAdjacency::previous(h);
      if (!sides_.is_wall(h) && !sides_.is_wall(in))
        add_opening(adjacency.opposite[h] / 3, adjacency.opposite[in] / 3, adjacency.from(h), cost);
    }
    finish_openings();
  }

  const std::vector<MatchingEdge>& edges() const { return edges_; }
  std::size_t n_openings() const { return openings_.size(); }

  /// The half edge of triangle t beyond which triangle s lies, in one patch; `no_index`: they share no edge.
  index_t shared_edge(index_t t, index_t s) const {
    for (index_t h = 3 * t; h < 3 * t + 3; ++h)
      if (!sides_.is_wall(h) && surface_.adjacency.opposite[h] / 3 == s) return h;
    return no_index;
  }

  /// The vertex that two triangles without a shared edge open when they are joined.
  index_t opened_vertex(index_t t, index_t s) const {
    return std::lower_bound(openings_.begin(), openings_.end(), Opening{std::min(t, s), std::max(t, s), 0, 0})->vertex;
  }

private:
  static std::int64_t whole(double cost) { return static_cast<std::int64_t>(std::lround(unit * cost)); }

  bool meet_twice(index_t h) const {
    const index_t s = surface_.adjacency.opposite[h] / 3;
    int n = 0;
    for (index_t i = 3 * (h / 3); i < 3 * (h / 3) + 3; ++i)
      n += !sides_.is_wall(i) && surface_.adjacency.opposite[i] / 3 == s;
    return n > 1;
  }

  void add_opening(index_t t, index_t s, index_t vertex, double cost) {
    if (t != s && shared_edge(t, s) == no_index)
      openings_.push_back({std::min(t, s), std::max(t, s), whole(cost), vertex});
  }

  /// The cheapest of each pair takes its place among the edges.
  void finish_openings() {
    std::sort(openings_.begin(), openings_.end());
    const auto same_pair = [](const Opening& x, const Opening& y) { return x.a == y.a && x.b == y.b; };
    openings_.erase(std::unique(openings_.begin(), openings_.end(), same_pair), openings_.end());
    std::erase_if(edges_, [&](const MatchingEdge& edge) { return shared_edge(edge.a, edge.b) == no_index; });
    for (const Opening& opening : openings_) edges_.push_back({opening.a, opening.b, opening.cost});
  }

  /// Of the quadrilateral that is left when an edge is removed.
  double cost(index_t h) const {
    const TriangleAdjacency& adjacency = surface_.adjacency;
    const index_t g = adjacency.opposite[h];
    const std::array<index_t, 4> v{adjacency.from(h), adjacency.apex(g), adjacency.to(h), adjacency.apex(h)};
    std::array<Vector3, 4> p;
    for (std::size_t i = 0; i < 4; ++i) p[i] = surface_.points[v[i]];
    const Vector3 normal = (p[2] - p[0]).cross(p[3] - p[1]).normalized();
    const double shape = angle_deviation(p, normal) / (std::numbers::pi / 2);
    if (alignment_ == 0) return shape;
    double turn = 0;
    for (std::size_t i = 0; i < 4; ++i) turn += misalignment(i < 2 ? g / 3 : h / 3, p[(i + 1) % 4] - p[i]) / 4;
    return (1 - alignment_) * shape + alignment_ * turn;
  }

  /// Angle of a direction to the nearest of a triangle's cross, 0 to 1 at 45 degrees.
  double misalignment(index_t triangle, const Vector3& direction) const {
    const Vector3 local = frames_[triangle].conjugate() * direction;
    return std::abs(quarter_remainder(std::atan2(local.y(), local.x()))) / (std::numbers::pi / 4);
  }

  const Surface& surface_;
  const PatchSides& sides_;
  std::span<const Quaternion> frames_;
  double alignment_;
  std::vector<MatchingEdge> edges_;
  std::vector<Opening> openings_;  ///< sorted, one a pair
};

}  // namespace framehex::detail
