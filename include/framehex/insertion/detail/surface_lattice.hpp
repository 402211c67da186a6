// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/geometry/proximity.hpp"
#include "framehex/geometry/size_field.hpp"
#include "framehex/insertion/detail/curve_sites.hpp"
#include "framehex/insertion/detail/insertion_checks.hpp"
#include "framehex/insertion/lattice_links.hpp"
#include "framehex/insertion/surface_options.hpp"
#include "framehex/surface/cross_sampler.hpp"
#include "framehex/surface/surface_walker.hpp"

#include <algorithm>
#include <array>
#include <numbers>
#include <span>
#include <utility>
#include <vector>

namespace framehex::detail {

/// The samples of a surface while they come and move, with their lattice links, and the rules about where one may
/// stand.
template <SizeField Size, ProximityFilter Proximity>
class SurfaceLattice {
public:
  /// A point of a triangle with the cross and the size there.
  struct Place {
    index_t triangle;
    Vector3 point;
    Eigen::Matrix3d axes;
    double smoothness, size;
  };
  /// A sample that predicts the candidate's place: it is its neighbour along `direction` of the candidate.
  struct Parent {
    index_t sample = no_index;
    double miss = 0;
    Vector3 prediction;
  };
  using Parents = std::array<Parent, 4>;           ///< along the four directions of the candidate
  static constexpr std::size_t any_direction = 4;  ///< of curve samples, whose links are in no order

  /// @param surface, size  kept by reference.
  /// @throws invalid_option  when something is not one for each of what it belongs to.
  SurfaceLattice(const Surface& surface, std::span<const Quaternion> frames, std::span<const double> smoothness,
                 const Size& size, double rejection, const SurfaceOptions& options)
      : features_(surface.features),
        size_(size),
        rejection_(rejection),
        boundary_distance_(options.boundary_distance),
        link_distance_(*options.link_distance),
        walker_(with_features(surface)),
        cross_(surface, walker_, one_each(frames, surface.triangles().size(), "frames", "triangles"),
               smoothness.empty() ? smoothness
                                  : one_each(smoothness, surface.points.size(), "smoothness values", "vertices")),
        proximity_(1.0) {}

  SurfaceLattice(const SurfaceLattice&) = delete;
  SurfaceLattice& operator=(const SurfaceLattice&) = delete;

  /// Before the first sample: sizes are up to `largest`.
  void set_largest_size(double largest) {
    proximity_ = Proximity(largest);
    largest_size_ = largest;
  }

  const SurfaceWalker& walker() const { return walker_; }
  const SurfaceInsertion& insertion() const { return insertion_; }
  SurfaceInsertion& insertion() { return insertion_; }
  index_t n_samples() const { return static_cast<index_t>(insertion_.samples.size()); }
  index_t generation(index_t p) const { return generations_[p]; }
  /// Columns: the cross and the outward normal at sample p.
  const Eigen::Matrix3d& axes(index_t p) const { return axes_[p]; }

  Place place(index_t triangle, const Vector3& p) const {
    const CrossSampler::Sample sample = cross_.at(triangle, p);
    return {triangle, p, sample.axes, sample.smoothness, checked_size(size_, p)};
  }

  /// Adds a sample of a corner or curve, before all others. @param sectors  its ways to leave, at least one.
  void add_curve_sample(const SurfaceSample& sample, std::span<const Sector> sectors) {
    std::vector<index_t>& patches = patches_.emplace_back();
    for (const Sector& sector : sectors) patches.push_back(features_.triangle_patch[sector.triangle]);
    std::sort(patches.begin(), patches.end());
    patches.erase(std::unique(patches.begin(), patches.end()), patches.end());
    along_curve_.emplace_back();
    store(sample, place(sectors.front().triangle, sample.point), 0);
    ++insertion_.n_curve_samples;
  }

  /// Makes two samples neighbours on their curve.
  void join_along_curve(index_t a, index_t b) {
    connect(a, any_direction, b, any_direction);
    along_curve_[a].push_back(b);
    along_curve_[b].push_back(a);
  }

  std::span<const index_t> patches_of_curve_sample(index_t p) const { return patches_[p]; }

  index_t store(const SurfaceSample& sample, const Place& at, index_t generation) {
    insertion_.samples.push_back(sample);
    insertion_.frames.emplace_back(at.axes);
    insertion_.sizes.push_back(at.size);
    insertion_.smoothness.push_back(at.smoothness);
    insertion_.links.push_back({no_index, no_index, no_index, no_index});
    axes_.push_back(at.axes);
    generations_.push_back(generation);
    largest_size_ = std::max(largest_size_, at.size);
    proximity_.insert(sample.point, at.size);
    return n_samples() - 1;
  }

  void move(index_t p, const Place& there) {
    insertion_.samples[p].point = there.point;
    insertion_.samples[p].entity = there.triangle;
    insertion_.frames[p] = Quaternion(there.axes);
    insertion_.sizes[p] = there.size;
    insertion_.smoothness[p] = there.smoothness;
    axes_[p] = there.axes;
    largest_size_ = std::max(largest_size_, there.size);
    proximity_.move(p, there.point, there.size);
  }

  /// The direction of sample q in which it looks back along a path that comes in direction `along`.
  std::size_t back_direction(index_t q, const Vector3& along) const {
    if (is_curve_sample(q)) return any_direction;
    const Vector3 tangent = along - along.dot(axes_[q].col(2)) * axes_[q].col(2);
    return nearest_direction(axes_[q], -tangent);
  }

  bool connect(index_t p, std::size_t p_direction, index_t q, std::size_t q_direction) {
    const auto slot = [&](index_t i, std::size_t direction) {
      if (direction != any_direction) return direction;
      const auto& row = insertion_.links[i];
      return static_cast<std::size_t>(std::find(row.begin(), row.end(), no_index) - row.begin());
    };
    const std::size_t a = slot(p, p_direction), b = slot(q, q_direction);
    return a < 4 && b < 4 && detail::connect(insertion_.links, p, a, q, b);
  }

  std::pair<index_t, double> nearest_within_rejection(const Place& at) const {
    std::pair<index_t, double> best{no_index, 0};
    for_each_near(proximity_, at.point, at.axes, rejection_ * at.size, [&](index_t i, const Vector3&, double distance) {
      if (!counts(i, at)) return;
      if (best.first == no_index || distance < best.second || (distance == best.second && i < best.first))
        best = {i, distance};
    });
    return best;
  }

  /// Far enough from the chords between neighbouring samples of the curves round the patch?
  bool clear_of_curves(const Place& at) const {
    const double least = boundary_distance_ * at.size;
    bool clear = true;
    for_each_near(proximity_, at.point, at.axes, 1.5 * at.size, [&](index_t q, const Vector3& a, double) {
      if (!is_curve_sample(q) || !clear || !counts(q, at)) return;
      for (const index_t r : along_curve_[q]) {
        if (!counts(r, at)) continue;
        const Vector3 edge = insertion_.samples[r].point - a;
        const double s = std::clamp((at.point - a).dot(edge) / std::max(edge.squaredNorm(), 1e-300), 0.0, 1.0);
        if ((at.point - a - s * edge).norm() < least) clear = false;
      }
    });
    return clear;
  }

  /// For each direction of a place the present sample that the lattice expects there, within `link_distance`.
  Parents find_parents(const Place& at) const {
    Parents parents;
    const double tolerance = link_distance_ * at.size;
    for_each_near(proximity_, at.point, at.axes, at.size + tolerance, [&](index_t q, const Vector3& point, double) {
      if (!counts(q, at)) return;
      const Vector3 offset = point - at.point;
      const std::size_t direction =
          nearest_direction(at.axes, Vector3(offset - offset.dot(at.axes.col(2)) * at.axes.col(2)));
      const Vector3 prediction = predicted_from(q, lattice_direction(at.axes, direction), at.size);
      const double miss = frame_infinity_norm(at.axes, prediction - at.point);
      Parent& parent = parents[direction];
      const bool better = parent.sample == no_index || miss < parent.miss || (miss == parent.miss && q < parent.sample);
      if (miss < tolerance && better) parent = {q, miss, prediction};
    });
    return parents;
  }

  /// Where q expects its neighbour from which it lies in direction `out`.
  Vector3 predicted_from(index_t q, const Vector3& out, double size) const {
    Vector3 along = -out;  // a curve sample has no cross of its own
    if (!is_curve_sample(q)) along += lattice_direction(axes_[q], back_direction(q, out));
    return insertion_.samples[q].point + 0.5 * (size + insertion_.sizes[q]) * along.normalized();
  }

  /// The rule, in the cross and size of the place and in those of every sample near it, as in the volume.
  bool may_move(index_t p, const Place& there) const {
    const double least = rejection_ * there.size;
    const Vector3 half = Vector3::Constant(std::numbers::sqrt3 * least);
    bool free = true;
    const auto forbids = [&](index_t q, const Vector3& point) {
      if (!free || q == p || !counts(q, there)) return;
      const Vector3 offset = point - there.point;
      free = frame_infinity_norm(there.axes, offset) >= least &&
             (is_curve_sample(q) || frame_infinity_norm(axes_[q], offset) >= rejection_ * insertion_.sizes[q]);
    };
    proximity_.for_each_in_box(there.point - half, there.point + half, forbids);
    if (free && largest_size_ > there.size)
      proximity_.for_each_reaching(there.point, std::numbers::sqrt3 * rejection_, forbids);
    return free;
  }

private:
  static const Surface& with_features(const Surface& surface) {
    one_each(std::span(surface.features.is_feature), 3 * surface.triangles().size(), "feature flags", "half edges");
    return surface;
  }

  bool is_curve_sample(index_t q) const { return q < insertion_.n_curve_samples; }

  /// Is sample q on the patch of the place, facing the same way?
  bool counts(index_t q, const Place& at) const {
    const index_t patch = features_.triangle_patch[at.triangle];
    if (is_curve_sample(q)) return std::binary_search(patches_[q].begin(), patches_[q].end(), patch);
    return features_.triangle_patch[insertion_.samples[q].entity] == patch && axes_[q].col(2).dot(at.axes.col(2)) > 0;
  }

  const FeatureGraph& features_;
  const Size& size_;
  double rejection_, boundary_distance_, link_distance_;
  SurfaceWalker walker_;
  CrossSampler cross_;
  Proximity proximity_;
  double largest_size_ = 0;
  SurfaceInsertion insertion_;
  std::vector<Eigen::Matrix3d> axes_;
  std::vector<index_t> generations_;
  std::vector<std::vector<index_t>> patches_;      // of the curve samples, ascending
  std::vector<std::vector<index_t>> along_curve_;  // neighbours of the curve samples on their curves
};

}  // namespace framehex::detail
