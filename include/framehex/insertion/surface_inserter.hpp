// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/geometry/rotation.hpp"
#include "framehex/insertion/curve_inserter.hpp"
#include "framehex/insertion/detail/run_front.hpp"
#include "framehex/insertion/detail/surface_relaxation.hpp"
#include "framehex/insertion/estimate.hpp"
#include "framehex/insertion/insertion_order.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace framehex {

/// Covers a triangulated surface with samples that continue its curve samples along a cross field: each proposes four
/// neighbours.
///
/// A proposal goes straight along the surface, one size far, in a direction of the cross that is corrected by the cross
/// half way. It ends at feature curves. It is dropped within `rejection` sizes of another sample of its patch or of
/// the patch's curves, in the infinity norm of the frame at its place, and near the curves. Samples of other patches,
/// and of sheets of the same patch that face the other way, do not count: a wall thinner than the size has samples on
/// both sides.
///
/// @tparam Order  FifoOrder or SmoothnessOrder, or a queue of your own.
/// @par Determinism   The result depends on the arguments only.
/// @par Source        the paper, section 3.2; Remacle et al., Int. J. Numer. Meth. Engng 94 (2013) 494-512. Departs:
///                    geodesics on the triangulation, lattice links, averaging of predictions, seeds.
template <InsertionOrder Order, SizeField Size, ProximityFilter Proximity = HashGrid>
class SurfaceInserter {
public:
  /// @param surface     n triangles; kept by reference, as is `size`.
  /// @param frames      n; z is the outward normal, x and y the cross.
  /// @param smoothness  n_vertices, or empty.
  /// @param curves      samples of the corners and curves of `surface`.
  /// @throws invalid_option  options out of range, arguments that belong to another surface as far as their numbers
  ///                         tell, or sizes that ask for more than `max_points` samples.
  /// @throws invalid_field   a size that is not positive and finite.
  SurfaceInserter(const Surface& surface, std::span<const Quaternion> frames, std::span<const double> smoothness,
                  const CurveInsertion& curves, const Size& size, SurfaceOptions options = {}, Order order = Order{})
      : options_(checked(std::move(options))),
        queue_(std::move(order)),
        lattice_(surface, frames, smoothness, size, *options_.rejection, options_) {
    check_curves(surface, curves);
    if (!options_.complete.empty())
      detail::one_each(options_.complete, surface.triangles().size(), "marks of completeness", "triangles");
    estimate(surface, size);
    add_curve_samples(surface, curves);
    add_patch_seeds(surface);
  }
  SurfaceInserter(const Surface&&, std::span<const Quaternion>, std::span<const double>, const CurveInsertion&,
                  const Size&, SurfaceOptions = {}, Order = Order{}) = delete;

  /// Adds a sample of a patch that is known already, with links to those before it that lie where its cross expects
  /// neighbours. It proposes neighbours when its turn comes.
  ///
  /// @param point  in triangle `triangle`.
  /// @return false, and nothing is added, within half a size of another sample or near a feature curve.
  bool add_sample(index_t triangle, const Vector3& point) {
    const Place at = lattice_.place(triangle, point);
    const auto [near, distance] = lattice_.nearest_within_rejection(at);
    if ((near != no_index && distance < std::min(0.5, *options_.rejection) * at.size) || !lattice_.clear_of_curves(at))
      return false;
    const Parents parents = lattice_.find_parents(at);
    const index_t index = lattice_.store({point, SampleKind::surface, triangle, 0.0}, at, 0);
    connect_parents(index, at, parents, no_index);
    push(index);
    return true;
  }

  /// Lets the next sample of the queue propose its neighbours. @return false when there was none.
  bool step() {
    if (queue_.empty()) return false;
    const index_t p = queue_.pop();
    if (p < sectors_.size()) {
      for (const detail::Sector& sector : sectors_[p]) leave_curve(p, sector);
      return true;
    }
    for (std::size_t direction = 0; direction < 4; ++direction) {
      if (lattice_.insertion().links[p][direction] != no_index) continue;
      const SurfaceSample& sample = lattice_.insertion().samples[p];
      propose(p, direction, {sample.entity, sample.point, lattice_direction(lattice_.axes(p), direction)});
    }
    return true;
  }

  /// Runs to the end, or until the observer or `max_points` stops it. Takes the result out, and with it what `result()`
  /// shows: for an inserter that is done with, `std::move(inserter).finish()`.
  SurfaceInsertion finish() && {
    SurfaceInsertion& now = lattice_.insertion();
    const auto given = static_cast<double>(now.n_curve_samples);
    now.status = detail::run_front(
        {"surface insertion", options_.observer, options_.rounds, options_.sweeps, options_.max_points,
         estimate_ + given + 1},
        [&] { return step(); }, [&] { return now.samples.size() - now.n_curve_samples; },
        [&] { detail::relax_surface(lattice_); },
        [&] {
          for (index_t p = 0; p < lattice_.n_samples(); ++p) push(p);
        });
    return std::move(now);
  }

  const SurfaceInsertion& result() const { return lattice_.insertion(); }

private:
  using Lattice = detail::SurfaceLattice<Size, Proximity>;
  using Place = typename Lattice::Place;
  using Parents = typename Lattice::Parents;

  /// The options with the order's own filled in.
  static SurfaceOptions checked(SurfaceOptions options) {
    check_options(options);
    if (!options.rejection) options.rejection = detail::surface_rejection<Order>();
    if (!options.link_distance) options.link_distance = std::min(0.35, *options.rejection);
    detail::check_link_distance(*options.link_distance, *options.rejection);
    return options;
  }

  static void check_curves(const Surface& surface, const CurveInsertion& curves) {
    const FeatureGraph& features = surface.features;
    detail::one_each(std::span(features.triangle_patch), surface.triangles().size(), "patch labels", "triangles");
    detail::one_each(std::span(curves.first_of_curve), features.curves.size() + 1, "rows of curve samples",
                     "curves and their end");
    detail::one_each(std::span(curves.samples), curves.first_of_curve.back(), "curve samples", "places in their rows");
    for (std::size_t i = 0; i < curves.samples.size(); ++i) {
      const SurfaceSample& sample = curves.samples[i];
      const bool corner = i < features.corners.size();
      if (sample.kind != (corner ? SampleKind::corner : SampleKind::curve) ||
          sample.entity >= (corner ? features.corners.size() : features.curves.size()))
        throw invalid_option("curve sample " + std::to_string(i) + " is of no corner or curve of this surface",
                             Entity::vertex, {i});
    }
  }

  void push(index_t p) { queue_.push(p, lattice_.insertion().smoothness[p], lattice_.generation(p)); }

  void estimate(const Surface& surface, const Size& size) {
    const PointEstimate on_surface = estimate_surface_points(surface, size);
    estimate_ = on_surface.n_points;
    detail::check_estimate("surface", estimate_, options_.max_points);
    lattice_.set_largest_size(on_surface.largest_size);
  }

  void add_curve_samples(const Surface& surface, const CurveInsertion& curves) {
    const detail::CurveSites sites(surface, lattice_.walker());
    for (const SurfaceSample& sample : curves.samples) {
      sectors_.push_back(sites.sectors(sample));
      lattice_.add_curve_sample(sample, sectors_.back());
    }
    detail::for_each_interval(surface.features, curves, [&](index_t a, index_t b) { lattice_.join_along_curve(a, b); });
    for (index_t p = 0; p < lattice_.n_samples(); ++p) push(p);
  }

  /// A patch that no curve bounds starts from one sample in its smoothest triangle.
  void add_patch_seeds(const Surface& surface) {
    const FeatureGraph& features = surface.features;
    std::vector<std::uint8_t> has_sample(features.n_patches, 0);
    for (index_t p = 0; p < lattice_.n_samples(); ++p)
      for (const index_t patch : lattice_.patches_of_curve_sample(p)) has_sample[patch] = 1;
    std::vector<std::optional<Place>> best(features.n_patches);
    for (index_t t = 0; t < surface.triangles().size(); ++t) {
      const index_t patch = features.triangle_patch[t];
      if (has_sample[patch]) continue;
      const auto& v = surface.triangles()[t];
      const Place at = lattice_.place(t, (surface.points[v[0]] + surface.points[v[1]] + surface.points[v[2]]) / 3);
      if (!best[patch] || at.smoothness > best[patch]->smoothness) best[patch] = at;
    }
    for (const auto& at : best)
      if (at) {
        push(lattice_.store({at->point, SampleKind::surface, at->triangle, 0.0}, *at, 0));
        ++lattice_.insertion().statistics.seeds;
      }
  }

  void leave_curve(index_t p, const detail::Sector& sector) {
    const Vector3 origin = lattice_.insertion().samples[p].point;  // a copy: proposals add samples
    const Eigen::Matrix3d axes = lattice_.place(sector.triangle, origin).axes;
    const Vector3 side = lattice_.walker().normal(sector.triangle).cross(sector.reference);
    for (std::size_t direction = 0; direction < 4; ++direction) {
      const Vector3 d = lattice_direction(axes, direction);
      double angle = std::atan2(d.dot(side), d.dot(sector.reference));
      if (angle < -std::numbers::pi / 2) angle += 2 * std::numbers::pi;
      if (angle >= sector.low && angle <= sector.high) propose(p, Lattice::any_direction, {sector.triangle, origin, d});
    }
  }

  void propose(index_t p, std::size_t direction, const SurfaceRay& ray) {
    SurfaceStatistics& statistics = lattice_.insertion().statistics;
    const SurfaceWalker& walker = lattice_.walker();
    ++statistics.proposals;
    const SurfaceWalk half = walker.walk(ray, 0.5 * lattice_.insertion().sizes[p]);
    if (half.wall != no_index) {
      ++statistics.too_near_curve;
      return;
    }
    const Place middle = lattice_.place(half.end.triangle, half.end.point);
    const SurfaceWalk whole = walker.walk(walker.turned(ray, correction(half.end.direction, middle.axes)), middle.size);
    SurfaceRay end = whole.end;
    // Beyond a curve there is only the curve itself to meet.
    end.point += (middle.size - whole.length) * end.direction;
    Place at = lattice_.place(end.triangle, end.point);

    const auto [near, distance] = lattice_.nearest_within_rejection(at);
    if (near != no_index) {
      const bool same = distance < *options_.link_distance * at.size && near != p;
      if (same && lattice_.connect(p, direction, near, lattice_.back_direction(near, end.direction)))
        ++statistics.linked;
      else
        ++statistics.too_near_point;
      return;
    }
    if (whole.wall != no_index || !lattice_.clear_of_curves(at)) {
      ++statistics.too_near_curve;
      return;
    }
    if (!options_.complete.empty() && options_.complete[at.triangle]) {
      ++statistics.complete;
      return;
    }
    const Parents parents = lattice_.find_parents(at);
    if (options_.averaging == ParentAveraging::parents) average(p, parents, at);
    const index_t index =
        lattice_.store({at.point, SampleKind::surface, at.triangle, 0.0}, at, lattice_.generation(p) + 1);
    lattice_.connect(p, direction, index, nearest_direction(at.axes, -end.direction));
    connect_parents(index, at, parents, p);
    push(index);
  }

  /// @param not_this  linked already.
  void connect_parents(index_t index, const Place& at, const Parents& parents, index_t not_this) {
    for (std::size_t d = 0; d < 4; ++d) {
      const index_t q = parents[d].sample;
      if (q != no_index && q != not_this)
        lattice_.connect(index, d, q, lattice_.back_direction(q, lattice_direction(at.axes, d)));
    }
  }

  /// Angle from a direction to the nearest one of a cross.
  static double correction(const Vector3& direction, const Eigen::Matrix3d& axes) {
    return -quarter_remainder(std::atan2(direction.dot(axes.col(1)), direction.dot(axes.col(0))));
  }

  /// Moves a place along the surface to the mean of its parents' predictions, where a sample may stand there.
  void average(index_t p, const Parents& parents, Place& at) const {
    Vector3 sum = Vector3::Zero();
    double n = 1;
    for (const auto& parent : parents) {
      if (parent.sample == no_index || parent.sample == p) continue;
      sum += parent.prediction - at.point;
      ++n;
    }
    const Vector3 normal = at.axes.col(2), move = (sum - sum.dot(normal) * normal) / n;
    const double distance = move.norm();
    if (distance < 1e-9 * at.size) return;
    const SurfaceWalk walk = lattice_.walker().walk({at.triangle, at.point, move / distance}, distance);
    if (walk.wall != no_index) return;
    const Place there = lattice_.place(walk.end.triangle, walk.end.point);
    if (lattice_.nearest_within_rejection(there).first == no_index && lattice_.clear_of_curves(there)) at = there;
  }

  SurfaceOptions options_;
  Order queue_;
  double estimate_ = 0;
  Lattice lattice_;
  std::vector<std::vector<detail::Sector>> sectors_;  // of the curve samples: their ways to leave
};

/// Covers a surface with samples that continue its curve samples along a cross field; see `SurfaceInserter`.
///
/// @throws as `SurfaceInserter`.
/// @par Complexity   O(samples) proposals, each of two short walks and a search, after O(triangles).
template <InsertionOrder Order = SmoothnessOrder, ProximityFilter Proximity = HashGrid, SizeField Size>
SurfaceInsertion insert_surface_points(const Surface& surface, std::span<const Quaternion> frames,
                                       std::span<const double> smoothness, const CurveInsertion& curves,
                                       const Size& size, const SurfaceOptions& options = {}, Order order = Order{}) {
  return SurfaceInserter<Order, Size, Proximity>(surface, frames, smoothness, curves, size, options, std::move(order))
      .finish();
}

}  // namespace framehex
