// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/geometry/triangle_distance.hpp"
#include "framehex/surface/detail/box_tree.hpp"
#include "framehex/surface/detail/delaunay_flips.hpp"

#include <algorithm>
#include <limits>
#include <utility>

namespace framehex::detail {

/// Keeps an EditableSurface near the surface that it stands for: where triangles cut off the tip of an ear, vertices of
/// the input come back.
///
/// Features are left alone: their samples follow them within a fifth of the spacing.
class SurfaceFit {
public:
  /// @param features   of the input.
  /// @param tolerance  distance, > 0, in the unit of the coordinates. Where edges are long, `least_share` of them is
  ///                   tolerated too: a coarse surface stays coarse.
  SurfaceFit(EditableSurface& surface, SectorNormals& normals, DelaunayFlipper& flipper, const FeatureGraph& features,
             double tolerance, Pulse& pulse)
      : surface_(surface),
        normals_(normals),
        flipper_(flipper),
        squared_tolerance_(tolerance * tolerance),
        pulse_(pulse) {
    find_inner_vertices(features);
  }

  void run(int max_rounds) {
    for (int round = 0; round < max_rounds; ++round) {
      if (bring_back_vertices() == 0) return;
      flipper_.run(DelaunayFlipper::Scope::within_patches);
    }
  }

private:
  /// A vertex of the input, off the features, and a triangle of the input that holds it.
  struct InnerVertex {
    index_t vertex, triangle;
    int corner;
  };
  /// The vertex of the input that is farthest from a triangle, of those nearest to it.
  struct Farthest {
    double squared_distance = 0;
    index_t inner = no_index;
  };

  void find_inner_vertices(const FeatureGraph& features) {
    std::vector<char> seen(surface_.points.size(), 0);
    for (index_t t = 0; t < normals_.n_triangles(); ++t)
      for (std::size_t i = 0; i < 3; ++i)
        if (features.is_feature[3 * t + i])
          for (const std::size_t end : {i, (i + 1) % 3}) seen[normals_.corners_of(t)[end]] = 1;
    for (index_t t = 0; t < normals_.n_triangles(); ++t)
      for (std::size_t i = 0; i < 3; ++i) {
        const index_t v = normals_.corners_of(t)[i];
        if (!seen[v]) inner_.push_back({v, t, static_cast<int>(i)});
        seen[v] = 1;
      }
  }

  std::size_t bring_back_vertices() {
    build_tree();
    std::vector<Farthest> farthest(surface_.n_triangles());
    for (index_t i = 0; i < inner_.size(); ++i) {
      if (!pulse_.beat()) return 0;
      const Vector3& p = normals_.point(inner_[i].vertex);
      const auto [t, distance] = nearest_triangle(p, [](index_t) { return true; });
      if (distance <= squared_tolerance_) continue;
      const Vector3 facing = normals_.of_triangle(inner_[i].triangle);
      const index_t patch = normals_.patch_of(inner_[i].triangle);
      const auto [own, own_distance] =
          nearest_triangle(p, [&](index_t s) { return surface_.patch[s] == patch && normal(s).dot(facing) > 0; });
      if (own == no_index || own_distance <= farthest[own].squared_distance) continue;
      if (own_distance > least_share * least_share * mean_squared_edge(own)) farthest[own] = {own_distance, i};
    }
    std::size_t n_cuts = 0;
    for (index_t t = 0; t < farthest.size(); ++t)
      if (farthest[t].inner != no_index) n_cuts += bring_back(inner_[farthest[t].inner], t);
    return n_cuts;
  }

  /// Makes a vertex of the input one of triangle t or of one of its edges, whichever leaves triangles that stand most
  /// upright, if they do.
  bool bring_back(const InnerVertex& inner, index_t t) {
    const Vector3& p = normals_.point(inner.vertex);
    const index_t sector = normals_.add(surface_, inner.triangle, Vector3::Unit(inner.corner));
    const auto stands = [&](index_t h) {
      const index_t next = EditableSurface::next(h);
      const Vector3 reference = normals_.at(h) + normals_.at(next) + normals_.of_sector(sector);
      return uprightness(corner(h), corner(next), p, reference);
    };
    double best = std::min({stands(3 * t), stands(3 * t + 1), stands(3 * t + 2)});
    index_t edge = no_index;
    for (index_t h = 3 * t; h < 3 * t + 3; ++h) {
      const index_t g = surface_.opposite[h];
      if (surface_.feature[h] || g == no_index) continue;
      const double least = std::min({stands(EditableSurface::next(h)), stands(EditableSurface::previous(h)),
                                     stands(EditableSurface::next(g)), stands(EditableSurface::previous(g))});
      if (least <= best) continue;
      best = least;
      edge = h;
    }
    if (best < least_upright) return false;
    const index_t v = surface_.add_vertex(p);
    if (edge == no_index)
      surface_.split_triangle(t, v, sector);
    else
      surface_.split_edge(edge, v, sector, sector);
    flipper_.push_star(v);
    return true;
  }

  const Vector3& corner(index_t h) const { return surface_.points[surface_.from(h)]; }

  Vector3 normal(index_t t) const {
    return (corner(3 * t + 1) - corner(3 * t)).cross(corner(3 * t + 2) - corner(3 * t));
  }

  double mean_squared_edge(index_t t) const {
    const Vector3 &a = corner(3 * t), &b = corner(3 * t + 1), &c = corner(3 * t + 2);
    return ((b - a).squaredNorm() + (c - b).squaredNorm() + (a - c).squaredNorm()) / 3;
  }

  void build_tree() {
    std::vector<BoxTree::Bounds> boxes;
    triangle_of_.clear();
    for (index_t t = 0; t < surface_.n_triangles(); ++t) {
      if (!surface_.alive(t)) continue;
      triangle_of_.push_back(t);
      boxes.push_back(triangle_bounds(corner(3 * t), corner(3 * t + 1), corner(3 * t + 2)));
    }
    tree_ = BoxTree(boxes);
  }

  /// Nearest triangle of those that are wanted, the smallest of several, and its squared distance.
  template <class Wanted>
  std::pair<index_t, double> nearest_triangle(const Vector3& p, Wanted&& wanted) const {
    std::pair<index_t, double> best{no_index, std::numeric_limits<double>::infinity()};
    tree_.nearest(p, best.second, [&](index_t first, index_t count) {
      for (index_t i = first; i < first + count; ++i) {
        const index_t t = triangle_of_[tree_.order()[i]];
        if (!wanted(t)) continue;
        const double d = nearest_on_triangle(p, corner(3 * t), corner(3 * t + 1), corner(3 * t + 2)).squared_distance;
        if (d < best.second || (d == best.second && t < best.first)) best = {t, d};
      }
      return best.second;
    });
    return best;
  }

  static constexpr double least_upright = 0.05;  // cosine
  static constexpr double least_share = 0.4;     // of the edges

  EditableSurface& surface_;
  SectorNormals& normals_;
  DelaunayFlipper& flipper_;
  double squared_tolerance_;
  Pulse& pulse_;
  std::vector<InnerVertex> inner_;
  BoxTree tree_;                      // of the triangles as they are
  std::vector<index_t> triangle_of_;  // item of the tree
};

}  // namespace framehex::detail
