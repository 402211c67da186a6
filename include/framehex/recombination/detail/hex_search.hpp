// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/recombination/detail/finder_input.hpp"

namespace framehex::detail {

/// Enumerates eight vertices with the connectivity of a hexahedron. Scratch memory for one thread.
///
/// Names: a is the smallest vertex; b, d, e are its neighbours, c, f, h lie opposite it in its three quadrilaterals, g
/// opposite it in the cell:
///
///        h--------g
///       /|       /|
///      e--------f |
///      | |      | |
///      | d------|-c
///      |/       |/
///      a--------b
class HexSearch {
public:
  using Vertices = std::array<index_t, 8>;

  explicit HexSearch(const FinderInput& input)
      : input_(&input), links_(&input.links()), floor_(input.options().quality_floor - 1e-12) {}

  /// Calls emit(vertices) for each hexahedron with smallest vertex `a`, once. Corners below the quality floor by more
  /// than rounding are pruned; the rest is for the caller to check.
  template <class Emit>
  void search(index_t a, Emit&& emit) {
    a_ = a;
    collect_faces();
    const auto ring = links_->neighbours(a);
    for (std::size_t i = 0; i + 1 < first_face_.size(); ++i) {
      for (std::size_t p = first_face_[i]; p < first_face_[i + 1]; ++p) face_at_[faces_[p].other] = p;
      for (std::size_t p = first_face_[i]; p < first_face_[i + 1]; ++p) {
        const std::size_t j = faces_[p].other;
        for (std::size_t r = first_face_[j]; r < first_face_[j + 1]; ++r) {
          const std::size_t q = face_at_[faces_[r].other];
          if (q == none) continue;
          const index_t b = ring[i], x = ring[j], y = ring[faces_[r].other];
          if (is_corner(a, b, x, y))
            complete(b, x, y, faces_[p], faces_[q], faces_[r], emit);
          else if (is_corner(a, b, y, x))
            complete(b, y, x, faces_[q], faces_[p], faces_[r], emit);
        }
      }
      for (std::size_t p = first_face_[i]; p < first_face_[i + 1]; ++p) face_at_[faces_[p].other] = none;
    }
  }

private:
  static constexpr std::size_t none = static_cast<std::size_t>(-1);

  /// The quadrilaterals with a between the neighbours i and `other` > i: a range of `opposites_`.
  struct Face {
    index_t other, begin, end;
  };

  void collect_faces() {
    const auto ring = links_->neighbours(a_);
    faces_.clear();
    opposites_.clear();
    first_face_.assign(1, 0);
    face_at_.assign(ring.size(), none);
    for (index_t i = 0; i < ring.size(); ++i) {
      if (ring[i] > a_) {
        reach_.clear();
        const auto reach = [&](index_t j) {
          if (j > i && ring[j] > a_ && face_at_[j] == none) {
            face_at_[j] = 0;
            reach_.push_back(j);
          }
        };
        links_->for_each_link(a_, i, [&](index_t j) {
          reach(j);
          links_->for_each_link(a_, j, reach);
        });
        std::sort(reach_.begin(), reach_.end());
        for (const index_t j : reach_) {
          face_at_[j] = none;
          const auto begin = static_cast<index_t>(opposites_.size());
          links_->for_each_opposite(a_, i, j, [&](index_t c) {
            if (c > a_) opposites_.push_back(c);
          });
          const auto end = static_cast<index_t>(opposites_.size());
          if (end > begin) faces_.push_back({j, begin, end});
        }
      }
      first_face_.push_back(faces_.size());
    }
  }

  std::span<const index_t> opposites(const Face& face) const {
    return {opposites_.data() + face.begin, opposites_.data() + face.end};
  }

  template <class Emit>
  void complete(index_t b, index_t d, index_t e, const Face& bd, const Face& be, const Face& de, Emit& emit) const {
    for (const index_t c : opposites(bd)) {
      if (c == e) continue;
      for (const index_t f : opposites(be)) {
        if (f == c || f == d || !is_corner(b, c, a_, f)) continue;
        links_->for_each_opposite(b, links_->position(b, c), links_->position(b, f), [&](index_t g) {
          if (g <= a_ || g == d || g == e || !is_corner(c, d, b, g) || !is_corner(f, e, g, b)) return;
          for (const index_t h : opposites(de)) {
            if (h == b || h == c || h == f || h == g) continue;
            if (!is_quadrilateral(d, c, g, h) || !is_quadrilateral(e, f, g, h)) continue;
            if (is_corner(d, a_, c, h) && is_corner(e, h, f, a_) && is_corner(g, f, h, c) && is_corner(h, g, e, d))
              emit(Vertices{a_, b, c, d, e, f, g, h});
          }
        });
      }
    }
  }

  bool is_corner(index_t o, index_t x, index_t y, index_t z) const {
    const auto& p = input_->points();
    const Vector3 u = p[x] - p[o], v = p[y] - p[o], w = p[z] - p[o];
    return u.cross(v).dot(w) >= floor_ * std::sqrt(u.squaredNorm() * v.squaredNorm() * w.squaredNorm());
  }

  bool is_facet(index_t u, index_t v, index_t w) const {
    const index_t i = links_->position(u, v), j = links_->position(u, w);
    return i != no_index && j != no_index && links_->are_linked(u, i, j);
  }

  bool is_quadrilateral(index_t p, index_t q, index_t r, index_t s) const {
    return (is_facet(p, q, r) && is_facet(p, r, s)) || (is_facet(q, r, s) && is_facet(q, s, p));
  }

  const FinderInput* input_;
  const VertexLinks* links_;
  double floor_;
  index_t a_ = no_index;
  std::vector<Face> faces_;
  std::vector<std::size_t> first_face_;  ///< by position among the neighbours of a
  std::vector<std::size_t> face_at_;
  std::vector<index_t> opposites_, reach_;
};

}  // namespace framehex::detail
