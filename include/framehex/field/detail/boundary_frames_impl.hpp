// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/field/boundary_frames.hpp"
#include "framehex/geometry/rotation.hpp"

#include <algorithm>
#include <numeric>
#include <string>

namespace framehex {

namespace detail {

/// One vertex of the surface and what surrounds it, with scratch memory for the next.
class BoundaryFrameBuilder {
public:
  BoundaryFrameBuilder(const Surface& surface, std::span<const Quaternion> triangle_frames,
                       const BoundaryFrameOptions& options)
      : surface_(surface),
        adjacency_(surface.adjacency),
        features_(surface.features),
        crosses_(triangle_frames),
        options_(options) {}

  void build(index_t v, BoundaryFrames& out) {
    gather(v);
    if (fan_.empty()) return;
    const bool featured = !tangents_.empty();
    if (!featured && use_mean_normal(v, out)) return;
    directions_.clear();
    collect_sectors();
    const std::size_t n_normals = directions_.size();
    const bool on_curve = tangents_.size() == 2 && !is_corner(v);
    Vector3 tangent = Vector3::Zero();
    if (on_curve) tangent = tangents_[0] - tangents_[1];
    if (on_curve && tangent.norm() > 0.5)
      directions_.push_back({tangent.normalized(), 1});
    else
      for (const Vector3& t : tangents_) directions_.push_back({t, 0.5});

    // Starts from some crosses, evenly spaced, are enough round a vertex of many triangles.
    const std::size_t n_starts = std::min(fan_.size(), max_starts);
    FrameFit best;
    for (std::size_t i = 0; i < n_starts; ++i) {
      const FrameFit fit = fit_frame(crosses_[fan_[i * fan_.size() / n_starts].triangle], directions_);
      if (i == 0 || fit.cost < best.cost - 1e-9) best = fit;
    }
    out.frames[v] = best.frame;
    out.constraints[v] = FrameConstraint::fixed;
    double worst = 0;
    for (std::size_t i = 0; i < n_normals; ++i)
      worst = std::max(worst, rotation_onto(best.frame, directions_[i].direction).norm());
    if (on_curve && tangent.norm() > 0.5 && worst > options_.curve_tolerance) {
      out.axes[v] = tangent.normalized();
      out.frames[v] = snapped(best.frame, out.axes[v]);
      out.constraints[v] = FrameConstraint::axis;
    }
  }

private:
  static constexpr std::size_t max_starts = 24;

  struct Corner {
    index_t triangle;
    index_t half_edge;  ///< leaves the vertex
    Vector3 normal;
    double angle;
    std::size_t sector;
  };

  bool is_corner(index_t v) const { return std::binary_search(features_.corners.begin(), features_.corners.end(), v); }
  bool is_feature(index_t half_edge) const { return !features_.is_feature.empty() && features_.is_feature[half_edge]; }

  void gather(index_t v) {
    fan_.clear();
    tangents_.clear();
    tangent_ends_.clear();
    for (const index_t t : adjacency_.triangles_of_vertex[v]) {
      index_t h = 3 * t;
      while (adjacency_.from(h) != v) ++h;
      const Vector3& p = surface_.points[v];
      const Vector3 a = surface_.points[adjacency_.to(h)] - p, b = surface_.points[adjacency_.apex(h)] - p;
      const Vector3 cross = a.cross(b);
      const double area = cross.norm();
      if (is_feature(h)) add_tangent(adjacency_.to(h), a);
      const index_t in = TriangleAdjacency::previous(h);
      if (is_feature(in) && adjacency_.opposite[in] == no_index) add_tangent(adjacency_.from(in), b);
      if (!(area > 0)) continue;  // a triangle without area has no normal
      fan_.push_back({t, h, cross / area, std::atan2(area, a.dot(b)), fan_.size()});
    }
    if (fan_.empty() && !adjacency_.triangles_of_vertex[v].empty())
      throw invalid_field("no triangle round vertex " + std::to_string(v) + " has a normal", Entity::vertex, {v});
  }

  /// Where several sheets meet each has the edge; it counts once.
  void add_tangent(index_t end, const Vector3& edge) {
    if (std::find(tangent_ends_.begin(), tangent_ends_.end(), end) != tangent_ends_.end()) return;
    tangent_ends_.push_back(end);
    const double length = edge.norm();
    if (length > 0) tangents_.push_back(edge / length);
  }

  /// A smooth place: the normal is the mean by angle, the cross the mean of the crosses carried to it.
  bool use_mean_normal(index_t v, BoundaryFrames& out) const {
    Vector3 sum = Vector3::Zero();
    double total = 0;
    for (const Corner& c : fan_) {
      sum += c.angle * c.normal;
      total += c.angle;
    }
    if (!(sum.norm() > 0.2 * total)) return false;
    const Vector3 normal = sum.normalized();
    const Quaternion reference = carried(fan_.front(), normal);
    double cosine = 0, sine = 0;
    for (const Corner& c : fan_) {
      const Vector3 x = reference.conjugate() * (carried(c, normal) * Vector3::UnitX());
      const double angle = std::atan2(x.y(), x.x());
      cosine += c.angle * std::cos(4 * angle);
      sine += c.angle * std::sin(4 * angle);
    }
    const bool decided = cosine * cosine + sine * sine > 1e-20 * total * total;
    const double turn = decided ? std::atan2(sine, cosine) / 4 : 0;
    out.frames[v] = (reference * Quaternion(Eigen::AngleAxisd(turn, Vector3::UnitZ()))).normalized();
    out.constraints[v] = FrameConstraint::axis;
    out.axes[v] = normal;
    return true;
  }

  /// The frame of a triangle, its z axis turned onto `normal`.
  Quaternion carried(const Corner& corner, const Vector3& normal) const {
    const Quaternion& frame = crosses_[corner.triangle];
    return rotation_between(frame * Vector3::UnitZ(), normal) * frame;
  }

  /// Mean normals of the parts into which the feature edges cut the triangles round the vertex; of each triangle
  /// for itself where a part has no mean.
  void collect_sectors() {
    find_sectors();
    by_sector_.resize(fan_.size());
    std::iota(by_sector_.begin(), by_sector_.end(), std::size_t{0});
    std::stable_sort(by_sector_.begin(), by_sector_.end(),
                     [&](std::size_t c, std::size_t d) { return fan_[c].sector < fan_[d].sector; });
    for (std::size_t begin = 0, end = 0; begin < by_sector_.size(); begin = end) {
      Vector3 sum = Vector3::Zero();
      double total = 0;
      for (; end < by_sector_.size() && fan_[by_sector_[end]].sector == fan_[by_sector_[begin]].sector; ++end) {
        const Corner& c = fan_[by_sector_[end]];
        sum += c.angle * c.normal;
        total += c.angle;
      }
      if (total == 0) continue;
      if (sum.norm() > 0.2 * total) {
        directions_.push_back({sum.normalized(), 1});
      } else {
        for (std::size_t i = begin; i < end; ++i) {
          const Corner& c = fan_[by_sector_[i]];
          directions_.push_back({c.normal, c.angle / total});
        }
      }
    }
  }

  /// Gives the triangles of a part the least of their places in the fan as its number.
  void find_sectors() {
    const auto root = [&](std::size_t c) {
      while (fan_[c].sector != c) c = fan_[c].sector = fan_[fan_[c].sector].sector;
      return c;
    };
    for (std::size_t c = 0; c < fan_.size(); ++c) {
      const index_t h = fan_[c].half_edge;
      if (is_feature(h) || adjacency_.opposite[h] == no_index) continue;
      // The fan is in the order of its triangles; those without area are not in it.
      const index_t beyond = adjacency_.opposite[h] / 3;
      const auto d = std::ranges::lower_bound(fan_, beyond, {}, &Corner::triangle);
      if (d == fan_.end() || d->triangle != beyond) continue;
      const std::size_t a = root(c), b = root(static_cast<std::size_t>(d - fan_.begin()));
      fan_[std::max(a, b)].sector = std::min(a, b);
    }
    for (std::size_t c = 0; c < fan_.size(); ++c) fan_[c].sector = root(c);
  }

  const Surface& surface_;
  const TriangleAdjacency& adjacency_;
  const FeatureGraph& features_;
  std::span<const Quaternion> crosses_;
  BoundaryFrameOptions options_;
  std::vector<Corner> fan_;  // by triangle
  std::vector<std::size_t> by_sector_;
  std::vector<Vector3> tangents_;
  std::vector<index_t> tangent_ends_;
  std::vector<WeightedDirection> directions_;
};

FRAMEHEX_INLINE FrameFit fit_frame(Quaternion frame, std::span<const WeightedDirection> directions) {
  // A direction says nothing about turning round itself: Gauss-Newton with these projections. The small multiple of
  // the identity leaves the turn alone where all directions are parallel.
  Eigen::Matrix3d normal_matrix = 1e-9 * Eigen::Matrix3d::Identity();
  for (const auto& d : directions)
    normal_matrix += d.weight * (Eigen::Matrix3d::Identity() - d.direction * d.direction.transpose());
  const Eigen::Matrix3d inverse = normal_matrix.inverse();
  for (int iteration = 0; iteration < 50; ++iteration) {
    Vector3 residual = Vector3::Zero();
    for (const auto& d : directions) residual += d.weight * rotation_onto(frame, d.direction);
    const Vector3 step = inverse * residual;
    frame = (CubeRotationGroup<>::exponential(step) * frame).normalized();
    if (step.squaredNorm() < 1e-20) break;
  }
  FrameFit fit{frame, 0};
  for (const auto& d : directions) fit.cost += d.weight * rotation_onto(frame, d.direction).squaredNorm();
  return fit;
}

}  // namespace detail

FRAMEHEX_INLINE BoundaryFrames make_boundary_frames(const Surface& surface, std::span<const Quaternion> triangle_frames,
                                                    const BoundaryFrameOptions& options) {
  check_options(options);
  const std::size_t n_triangles = surface.triangles().size();
  if (triangle_frames.size() != n_triangles)
    throw invalid_option("there are " + std::to_string(triangle_frames.size()) + " frames for " +
                         std::to_string(n_triangles) + " triangles");
  if (!surface.features.is_feature.empty() && surface.features.is_feature.size() != 3 * n_triangles)
    throw invalid_option("the features are not those of this surface");
  for (std::size_t t = 0; t < triangle_frames.size(); ++t)
    if (!(std::abs(triangle_frames[t].norm() - 1) < 1e-6))
      throw invalid_field("the frame of triangle " + std::to_string(t) + " is not a unit quaternion", Entity::triangle,
                          {t});
  BoundaryFrames out;
  out.frames.assign(surface.points.size(), Quaternion::Identity());
  out.constraints.assign(surface.points.size(), FrameConstraint::none);
  out.axes.assign(surface.points.size(), Vector3::Zero());
  detail::BoundaryFrameBuilder builder(surface, triangle_frames, options);
  for (index_t v = 0; v < surface.points.size(); ++v) builder.build(v, out);
  return out;
}

}  // namespace framehex
