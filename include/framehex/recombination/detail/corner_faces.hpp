// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/geometry/detail/jacobian_bezier.hpp"
#include "framehex/recombination/detail/finder_input.hpp"

#include <cmath>

namespace framehex::detail {

/// The quadrilaterals that a cell could have at one vertex a, and the tests that prune a search. Scratch memory for one
/// thread.
class CornerFaces {
public:
  /// The quadrilaterals of a with its neighbours at two positions: a range of opposite vertices.
  struct Face {
    index_t other, begin, end;
  };

  explicit CornerFaces(const FinderInput& input) : points_(input.points().data()), links_(&input.links()) {
    const double floor = input.options().quality_floor - 1e-12;
    signed_square_ = floor * std::abs(floor);
  }

  /// Gathers the quadrilaterals whose smallest vertex is `a`.
  void collect(index_t a) {
    const auto ring = links_->neighbours(a);
    faces_.clear();
    opposites_.clear();
    first_face_.assign(1, 0);
    seen_.assign(ring.size(), 0);
    for (index_t i = 0; i < ring.size(); ++i) {
      if (ring[i] > a) collect(a, i);
      first_face_.push_back(faces_.size());
    }
  }

  /// Those with the neighbour at `i` and another at a higher position, ascending.
  std::span<const Face> faces(index_t i) const {
    return {faces_.data() + first_face_[i], faces_.data() + first_face_[i + 1]};
  }

  /// The vertices opposite a, each once; all above a.
  std::span<const index_t> opposites(const Face& face) const {
    return {opposites_.data() + face.begin, opposites_.data() + face.end};
  }

  const VertexLinks& links() const { return *links_; }

  /// Whether the edges from o to x, y, z keep the quality floor, but for rounding. Squares are compared: no root.
  bool is_corner(index_t o, index_t x, index_t y, index_t z) const {
    const auto edge = [this, &from = points_[o]](index_t to) {
      const Vector3& p = points_[to];
      return Triple<double>{p.x() - from.x(), p.y() - from.y(), p.z() - from.z()};
    };
    const Triple<double> u = edge(x), v = edge(y), w = edge(z);
    const double determinant = dot(cross(u, v), w);
    return determinant * std::abs(determinant) >= signed_square_ * (dot(u, u) * dot(v, v) * dot(w, w));
  }

private:
  void collect(index_t a, index_t i) {
    const auto ring = links_->neighbours(a);
    reach_.clear();
    const auto reach = [&](index_t j) {
      if (j > i && seen_[j] == 0) {
        seen_[j] = 1;
        reach_.push_back(j);
      }
    };
    links_->for_each_link(a, i, [&](index_t j) {
      reach(j);
      links_->for_each_link_in_reach(a, j, i, reach);
    });
    std::sort(reach_.begin(), reach_.end());
    for (const index_t j : reach_) {
      seen_[j] = 0;
      const auto begin = static_cast<index_t>(opposites_.size());
      links_->for_each_opposite(a, i, j, [&](index_t c) {
        if (c > a) opposites_.push_back(c);
      });
      const auto end = static_cast<index_t>(opposites_.size());
      if (end > begin && ring[j] > a) faces_.push_back({j, begin, end});
    }
  }

  const Vector3* points_;
  const VertexLinks* links_;
  double signed_square_;  ///< of the quality floor, less what rounding may do
  std::vector<Face> faces_;
  std::vector<std::size_t> first_face_;  ///< by position among the neighbours of a
  std::vector<index_t> opposites_, reach_;
  std::vector<std::uint8_t> seen_;
};

}  // namespace framehex::detail
