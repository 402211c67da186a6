// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/insertion/cross_sampler.hpp"
#include "framehex/insertion/curve_inserter.hpp"
#include "framehex/insertion/curve_sites.hpp"
#include "framehex/insertion/estimate.hpp"
#include "framehex/insertion/insertion_order.hpp"
#include "framehex/insertion/lattice_links.hpp"
#include "framehex/insertion/proximity.hpp"
#include "framehex/insertion/surface_insertion.hpp"
#include "framehex/insertion/surface_walker.hpp"
#include "framehex/insertion/volume_inserter.hpp"
#include "framehex/observer.hpp"

#include <algorithm>
#include <array>
#include <cmath>
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
template <InsertionOrder Order, detail::SizeCallable Size, ProximityFilter Proximity = HashGrid>
class SurfaceInserter {
public:
  /// @param surface, adjacency, features  n triangles; kept by reference, as is `size`.
  /// @param frames      n; z is the outward normal, x and y the cross.
  /// @param smoothness  n_vertices, or empty.
  /// @param curves      samples of the corners and curves of `features`.
  /// @throws invalid_option  options out of range, or sizes that ask for more than `max_points` samples.
  /// @throws invalid_field   a size that is not positive and finite.
  SurfaceInserter(const IndexedTriangleMesh& surface, const TriangleAdjacency& adjacency, const FeatureGraph& features,
                  std::span<const Quaternion> frames, std::span<const double> smoothness, const CurveInsertion& curves,
                  const Size& size, SurfaceOptions options = {}, Order order = Order{})
      : surface_(surface),
        features_(features),
        size_(size),
        options_(std::move(options)),
        queue_(std::move(order)),
        rejection_(options_.rejection.value_or(detail::surface_rejection<Order>())),
        walker_(surface, adjacency, features.is_feature),
        cross_(surface, adjacency, walker_, frames, smoothness),
        proximity_(1.0) {
    detail::check_factor("rejection", rejection_, 0.05, 0.95);
    detail::check_factor("boundary_distance", options_.boundary_distance, 1e-3, 2);
    detail::check_factor("link_distance", options_.link_distance, 0, rejection_);
    estimate();
    proximity_ = Proximity(largest_size_);
    add_curve_samples(detail::CurveSites(surface, adjacency, features, walker_), curves);
    add_patch_seeds();
  }

  SurfaceInserter(const SurfaceInserter&) = delete;
  SurfaceInserter& operator=(const SurfaceInserter&) = delete;

  /// Lets the next sample of the queue propose its neighbours. @return false when there was none.
  bool step() {
    if (queue_.empty()) return false;
    const index_t p = queue_.pop();
    if (p < result_.n_curve_samples) {
      for (const detail::Sector& sector : sectors_[p]) leave_curve(p, sector);
      return true;
    }
    for (std::size_t direction = 0; direction < 4; ++direction)
      if (result_.links[p][direction] == no_index)
        propose(p, direction,
                {result_.samples[p].entity, result_.samples[p].point, lattice_direction(axes_[p], direction)});
    return true;
  }

  /// Runs to the end, or until the observer or `max_points` stops it.
  SurfaceInsertion finish() {
    run_queue();
    for (index_t round = 0; round < options_.rounds && result_.status == Status::complete; ++round) {
      for (index_t sweep = 0; sweep < options_.sweeps; ++sweep) relax();
      rebuild_proximity();
      for (index_t p = 0; p < result_.samples.size(); ++p) queue_.push(p, result_.smoothness[p], generations_[p]);
      run_queue();
    }
    return std::move(result_);
  }

  const SurfaceInsertion& result() const { return result_; }

private:
  struct Place {
    index_t triangle;
    Vector3 point;
    Eigen::Matrix3d axes;
    double smoothness, size;
  };
  struct Parent {
    index_t sample = no_index;
    double miss = 0;
    Vector3 prediction;
  };
  static constexpr double max_move = 0.1;          // of a sweep, in sizes
  static constexpr std::size_t any_direction = 4;  // of curve samples, whose links are in no order

  void run_queue() {
    constexpr std::size_t steps_per_report = 1024;
    for (std::size_t n = 0; step(); ++n) {
      if (result_.samples.size() - result_.n_curve_samples > options_.max_points) {
        result_.status = Status::budget_exhausted;
        return;
      }
      const double done = static_cast<double>(n) / (estimate_ + static_cast<double>(result_.n_curve_samples) + 1);
      if (n % steps_per_report == 0 && !keep_going(options_.observer, "surface insertion", std::min(done, 1.0))) {
        result_.status = Status::cancelled;
        return;
      }
    }
  }

  Place place(index_t triangle, const Vector3& p) const {
    const CrossSampler::Sample sample = cross_.at(triangle, p);
    return {triangle, p, sample.axes, sample.smoothness, detail::checked_size(size_, p)};
  }

  void estimate() {
    const PointEstimate estimate = estimate_surface_points(surface_, size_);
    estimate_ = estimate.n_points;
    largest_size_ = estimate.largest_size;
    detail::check_estimate("surface", estimate_, options_.max_points);
  }

  void add_curve_samples(const detail::CurveSites& sites, const CurveInsertion& curves) {
    result_.n_curve_samples = curves.samples.size();
    for (const SurfaceSample& sample : curves.samples) {
      const std::vector<detail::Sector>& sectors = sectors_.emplace_back(sites.sectors(sample));
      std::vector<index_t> patches;
      for (const detail::Sector& sector : sectors) patches.push_back(features_.triangle_patch[sector.triangle]);
      std::sort(patches.begin(), patches.end());
      patches.erase(std::unique(patches.begin(), patches.end()), patches.end());
      patches_.push_back(std::move(patches));
      store(sample, place(sectors.front().triangle, sample.point));
    }
    link_along_curves(curves);
    for (index_t i = 0; i < result_.n_curve_samples; ++i) queue_.push(i, result_.smoothness[i], 0);
  }

  void link_along_curves(const CurveInsertion& curves) {
    along_curve_.resize(result_.n_curve_samples);
    const auto corner_at = [&](index_t v) {
      const auto at = std::lower_bound(features_.corners.begin(), features_.corners.end(), v);
      return at != features_.corners.end() && *at == v ? static_cast<index_t>(at - features_.corners.begin())
                                                       : no_index;
    };
    for (std::size_t c = 0; c < features_.curves.size(); ++c) {
      const std::span<const index_t> row = features_.curves[c];
      const index_t first = curves.first_of_curve[c], last = curves.first_of_curve[c + 1];
      const index_t start = corner_at(row.front()), end = corner_at(row.back());
      index_t previous = start;
      for (index_t i = first; i < last; ++i) previous = join(previous, i);
      join(previous, end != no_index ? end : first);
    }
  }

  index_t join(index_t a, index_t b) {
    if (a != no_index && b != no_index && a != b) {
      connect(a, any_direction, b, any_direction);
      along_curve_[a].push_back(b);
      along_curve_[b].push_back(a);
    }
    return b;
  }

  /// A patch that no curve bounds starts from one sample in its smoothest triangle.
  void add_patch_seeds() {
    std::vector<std::uint8_t> has_sample(features_.n_patches, 0);
    for (const auto& patches : patches_)
      for (const index_t patch : patches) has_sample[patch] = 1;
    std::vector<std::optional<Place>> best(features_.n_patches);
    for (index_t t = 0; t < surface_.triangles.size(); ++t) {
      const index_t patch = features_.triangle_patch[t];
      if (has_sample[patch]) continue;
      const auto& v = surface_.triangles[t];
      const Place at = place(t, (surface_.points[v[0]] + surface_.points[v[1]] + surface_.points[v[2]]) / 3);
      if (!best[patch] || at.smoothness > best[patch]->smoothness) best[patch] = at;
    }
    for (const auto& at : best)
      if (at) {
        const index_t i = store({at->point, SampleKind::surface, at->triangle, 0.0}, *at);
        queue_.push(i, at->smoothness, 0);
        ++result_.statistics.seeds;
      }
  }

  index_t store(const SurfaceSample& sample, const Place& at, index_t generation = 0) {
    result_.samples.push_back(sample);
    result_.frames.emplace_back(at.axes);
    result_.sizes.push_back(at.size);
    result_.smoothness.push_back(at.smoothness);
    result_.links.push_back({no_index, no_index, no_index, no_index});
    axes_.push_back(at.axes);
    generations_.push_back(generation);
    proximity_.insert(sample.point, at.size);
    return static_cast<index_t>(result_.samples.size() - 1);
  }

  void leave_curve(index_t p, const detail::Sector& sector) {
    const Vector3 origin = result_.samples[p].point;  // a copy: proposals add samples
    const Eigen::Matrix3d axes = cross_.at(sector.triangle, origin).axes;
    const Vector3 side = walker_.normal(sector.triangle).cross(sector.reference);
    for (std::size_t direction = 0; direction < 4; ++direction) {
      const Vector3 d = lattice_direction(axes, direction);
      double angle = std::atan2(d.dot(side), d.dot(sector.reference));
      if (angle < -std::numbers::pi / 2) angle += 2 * std::numbers::pi;
      if (angle >= sector.low && angle <= sector.high) propose(p, any_direction, {sector.triangle, origin, d});
    }
  }

  void propose(index_t p, std::size_t direction, const SurfaceRay& ray) {
    ++result_.statistics.proposals;
    const SurfaceWalk half = walker_.walk(ray, 0.5 * result_.sizes[p]);
    if (half.wall != no_index) {
      ++result_.statistics.too_near_curve;
      return;
    }
    const Place middle = place(half.end.triangle, half.end.point);
    const SurfaceWalk whole =
        walker_.walk(walker_.turned(ray, correction(half.end.direction, middle.axes)), middle.size);
    SurfaceRay end = whole.end;
    // Beyond a curve there is only the curve itself to meet.
    end.point += (middle.size - whole.length) * end.direction;
    Place at = place(end.triangle, end.point);

    const auto [near, distance] = nearest_within_rejection(at);
    if (near != no_index) {
      const bool same = distance < options_.link_distance * at.size && near != p;
      if (same && connect(p, direction, near, back_direction(near, end.direction)))
        ++result_.statistics.linked;
      else
        ++result_.statistics.too_near_point;
      return;
    }
    if (whole.wall != no_index || !clear_of_curves(at)) {
      ++result_.statistics.too_near_curve;
      return;
    }
    const std::array<Parent, 4> parents = find_parents(at);
    if (options_.averaging == ParentAveraging::parents) average(p, parents, at);
    const index_t index = store({at.point, SampleKind::surface, at.triangle, 0.0}, at, generations_[p] + 1);
    connect(p, direction, index, nearest_direction(at.axes, -end.direction));
    for (std::size_t d = 0; d < 4; ++d)
      if (parents[d].sample != no_index && parents[d].sample != p)
        connect(index, d, parents[d].sample, back_direction(parents[d].sample, lattice_direction(at.axes, d)));
    queue_.push(index, at.smoothness, generations_[index]);
  }

  /// Angle from a direction to the nearest one of a cross.
  static double correction(const Vector3& direction, const Eigen::Matrix3d& axes) {
    const double angle = std::atan2(direction.dot(axes.col(1)), direction.dot(axes.col(0)));
    constexpr double quarter = std::numbers::pi / 2;
    return quarter * std::round(angle / quarter) - angle;
  }

  std::size_t back_direction(index_t q, const Vector3& along) const {
    if (q < result_.n_curve_samples) return any_direction;
    const Vector3 tangent = along - along.dot(axes_[q].col(2)) * axes_[q].col(2);
    return nearest_direction(axes_[q], -tangent);
  }

  bool connect(index_t p, std::size_t p_direction, index_t q, std::size_t q_direction) {
    const auto slot = [&](index_t i, std::size_t direction) {
      if (direction != any_direction) return direction;
      const auto& row = result_.links[i];
      return static_cast<std::size_t>(std::find(row.begin(), row.end(), no_index) - row.begin());
    };
    const std::size_t a = slot(p, p_direction), b = slot(q, q_direction);
    return a < 4 && b < 4 && detail::connect(result_.links, p, a, q, b);
  }

  /// Is sample q on the patch of the place, facing the same way?
  bool counts(index_t q, const Place& at) const {
    const index_t patch = features_.triangle_patch[at.triangle];
    if (q < result_.n_curve_samples) return std::binary_search(patches_[q].begin(), patches_[q].end(), patch);
    return features_.triangle_patch[result_.samples[q].entity] == patch && axes_[q].col(2).dot(at.axes.col(2)) > 0;
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
    const double least = options_.boundary_distance * at.size;
    bool clear = true;
    for_each_near(proximity_, at.point, at.axes, 1.5 * at.size, [&](index_t q, const Vector3& a, double) {
      if (q >= result_.n_curve_samples || !clear || !counts(q, at)) return;
      for (const index_t r : along_curve_[q]) {
        if (!counts(r, at)) continue;
        const Vector3 edge = result_.samples[r].point - a;
        const double s = std::clamp((at.point - a).dot(edge) / std::max(edge.squaredNorm(), 1e-300), 0.0, 1.0);
        if ((at.point - a - s * edge).norm() < least) clear = false;
      }
    });
    return clear;
  }

  /// For each direction of a place the present sample that the lattice expects there, within `link_distance`.
  std::array<Parent, 4> find_parents(const Place& at) const {
    std::array<Parent, 4> parents;
    const double tolerance = options_.link_distance * at.size;
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
    if (q >= result_.n_curve_samples) along += lattice_direction(axes_[q], back_direction(q, out));
    return result_.samples[q].point + 0.5 * (size + result_.sizes[q]) * along.normalized();
  }

  void rebuild_proximity() {
    proximity_ = Proximity(largest_size_);
    for (std::size_t i = 0; i < result_.samples.size(); ++i)
      proximity_.insert(result_.samples[i].point, result_.sizes[i]);
  }

  /// One sweep: each sample in turn goes to the mean of what its lattice neighbours predict, a tenth of the size at
  /// most, and only where it may stand.
  void relax() {
    rebuild_proximity();
    for (auto p = static_cast<index_t>(result_.n_curve_samples); p < result_.samples.size(); ++p) {
      const Vector3 origin = result_.samples[p].point;
      Vector3 sum = Vector3::Zero();
      double n = 0;
      for (std::size_t d = 0; d < 4; ++d) {
        const index_t q = result_.links[p][d];
        if (q == no_index) continue;
        sum += predicted_from(q, lattice_direction(axes_[p], d), result_.sizes[p]) - origin;
        ++n;
      }
      if (n < 2) continue;
      const Vector3 normal = axes_[p].col(2), move = (sum - sum.dot(normal) * normal) / n;
      const double length = move.norm();
      if (length < 1e-9 * result_.sizes[p]) continue;
      const SurfaceWalk walk = walker_.walk({result_.samples[p].entity, origin, move / length},
                                            std::min(length, max_move * result_.sizes[p]));
      if (walk.wall != no_index) continue;
      Place there = place(walk.end.triangle, walk.end.point);
      there.axes = renumbered(there.axes, axes_[p]);  // links keep their directions
      if (may_move(p, there) && clear_of_curves(there)) move_to(p, there);
    }
  }

  bool may_move(index_t p, const Place& there) const {
    bool free = true;
    for_each_near(
        proximity_, there.point, there.axes, (rejection_ + 3 * max_move) * there.size,
        [&](index_t q, const Vector3&, double) {
          if (q == p || !free || !counts(q, there)) return;
          const Vector3 offset =
              result_.samples[q].point - there.point;  // q may have moved since the search structure was built
          if (frame_infinity_norm(there.axes, offset) < rejection_ * there.size ||
              (q >= result_.n_curve_samples && frame_infinity_norm(axes_[q], offset) < rejection_ * result_.sizes[q]))
            free = false;
        });
    return free;
  }

  void move_to(index_t p, const Place& there) {
    result_.samples[p].point = there.point;
    result_.samples[p].entity = there.triangle;
    result_.frames[p] = Quaternion(there.axes);
    result_.sizes[p] = there.size;
    result_.smoothness[p] = there.smoothness;
    axes_[p] = there.axes;
  }

  /// Moves a place along the surface to the mean of its parents' predictions, where a sample may stand there.
  void average(index_t p, const std::array<Parent, 4>& parents, Place& at) const {
    Vector3 sum = Vector3::Zero();
    double n = 1;
    for (const Parent& parent : parents) {
      if (parent.sample == no_index || parent.sample == p) continue;
      sum += parent.prediction - at.point;
      ++n;
    }
    const Vector3 normal = at.axes.col(2), move = (sum - sum.dot(normal) * normal) / n;
    const double distance = move.norm();
    if (distance < 1e-9 * at.size) return;
    const SurfaceWalk walk = walker_.walk({at.triangle, at.point, move / distance}, distance);
    if (walk.wall != no_index) return;
    const Place there = place(walk.end.triangle, walk.end.point);
    if (nearest_within_rejection(there).first == no_index && clear_of_curves(there)) at = there;
  }

  const IndexedTriangleMesh& surface_;
  const FeatureGraph& features_;
  const Size& size_;
  SurfaceOptions options_;
  Order queue_;
  double rejection_;
  SurfaceWalker walker_;
  CrossSampler cross_;
  double estimate_ = 0, largest_size_ = 0;
  Proximity proximity_;
  SurfaceInsertion result_;
  std::vector<Eigen::Matrix3d> axes_;
  std::vector<index_t> generations_;
  std::vector<std::vector<detail::Sector>> sectors_;  // of the curve samples
  std::vector<std::vector<index_t>> patches_;         // of the curve samples, ascending
  std::vector<std::vector<index_t>> along_curve_;     // neighbours of the curve samples on their curves
};

/// Covers a surface with samples that continue its curve samples along a cross field; see `SurfaceInserter`.
///
/// @throws as `SurfaceInserter`.
/// @par Complexity   O(samples) proposals, each of two short walks and a search, after O(triangles).
template <InsertionOrder Order = SmoothnessOrder, ProximityFilter Proximity = HashGrid, detail::SizeCallable Size>
SurfaceInsertion insert_surface_points(const IndexedTriangleMesh& surface, const TriangleAdjacency& adjacency,
                                       const FeatureGraph& features, std::span<const Quaternion> frames,
                                       std::span<const double> smoothness, const CurveInsertion& curves,
                                       const Size& size, const SurfaceOptions& options = {}, Order order = Order{}) {
  return SurfaceInserter<Order, Size, Proximity>(surface, adjacency, features, frames, smoothness, curves, size,
                                                 options, std::move(order))
      .finish();
}

}  // namespace framehex
