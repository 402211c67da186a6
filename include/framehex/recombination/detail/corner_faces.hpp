// SPDX-License-Identifier: BSL-1.0
#pragma once

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
    bool is_rich = true;  ///< some opposite vertex is no hub; see `has_hubs`
  };

  explicit CornerFaces(const FinderInput& input)
      : points_(input.points().data()), links_(&input.links()), floor_(input.options().quality_floor - 1e-12) {}

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
    find_hubs(a);
  }

  /// Whether one or two neighbours of a are hubs: their edges with a have so many facets that the quadrilaterals with
  /// those diagonals, one for each two of the facets, are too many to combine freely. Three quadrilaterals at a have
  /// three different opposite vertices: one of them at least is rich.
  bool has_hubs() const { return !hubs_.empty() && hubs_.size() <= 2; }

  /// Those with the neighbour at `i` and another at a higher position, ascending.
  std::span<const Face> faces(index_t i) const {
    return {faces_.data() + first_face_[i], faces_.data() + first_face_[i + 1]};
  }

  /// The vertices opposite a, each once; all above a.
  std::span<const index_t> opposites(const Face& face) const {
    return {opposites_.data() + face.begin, opposites_.data() + face.end};
  }

  const VertexLinks& links() const { return *links_; }

  /// Whether the edges from o to x, y, z keep the quality floor, but for rounding.
  bool is_corner(index_t o, index_t x, index_t y, index_t z) const {
    const Vector3 u = points_[x] - points_[o], v = points_[y] - points_[o], w = points_[z] - points_[o];
    return u.cross(v).dot(w) >= floor_ * std::sqrt(u.squaredNorm() * v.squaredNorm() * w.squaredNorm());
  }

private:
  static constexpr std::size_t hub_degree = 32;

  void find_hubs(index_t a) {
    hubs_.clear();
    const auto ring = links_->neighbours(a);
    if (ring.size() <= hub_degree) return;
    for (index_t i = 0; i < ring.size(); ++i)
      if (links_->degree(a, i) > hub_degree) hubs_.push_back(ring[i]);
    if (!has_hubs()) return;
    for (Face& face : faces_)
      face.is_rich = std::ranges::any_of(opposites(face),
                                         [this](index_t o) { return std::ranges::find(hubs_, o) == hubs_.end(); });
  }

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
      links_->for_each_link(a, j, reach);
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
  double floor_;
  std::vector<Face> faces_;
  std::vector<std::size_t> first_face_;  ///< by position among the neighbours of a
  std::vector<index_t> opposites_, reach_, hubs_;
  std::vector<std::uint8_t> seen_;
};

}  // namespace framehex::detail
