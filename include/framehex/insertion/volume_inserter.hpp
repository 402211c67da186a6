// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/insertion/estimate.hpp"
#include "framehex/insertion/insertion_order.hpp"
#include "framehex/insertion/lattice_links.hpp"
#include "framehex/insertion/proximity.hpp"
#include "framehex/observer.hpp"
#include "framehex/surface/surface_locator.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <span>
#include <vector>

namespace framehex {

/// Frames in space, as `FrameField` gives them: `sample(p, hint)` returns `.frame` (Quaternion) and `.smoothness` at
/// any point near the domain; `hint` is where the caller's last search ended (`no_index` at first) and is updated.
template <class F>
concept FrameSource = requires(const F& field, const Vector3& p, index_t& hint) {
  { field.sample(p, hint).frame } -> std::convertible_to<Quaternion>;
  { field.sample(p, hint).smoothness } -> std::convertible_to<double>;
};

/// The domain: `clearance(p, limit)` is the distance from p to its boundary, negative outside; of a distance above
/// `limit` only that it is so need be told.
template <class D>
concept Domain = requires(const D& domain, const Vector3& p, double limit) {
  { domain.clearance(p, limit) } -> std::convertible_to<double>;
};

/// The inside of a closed surface as a `Domain`.
struct SurfaceDomain {
  const SurfaceLocator& locator;

  double clearance(const Vector3& p, double limit) const {
    const auto near = locator.nearest_within(p, limit);
    const double distance = near ? near->distance : limit;
    return locator.inside(p) ? distance : -distance;
  }
};

/// A point of the boundary from which the volume is filled.
struct BoundarySeed {
  Vector3 point;
  Vector3 normal;  ///< outward, unit; zero at corners and feature curves, where there are several
};

enum class ParentAveraging {
  none,    ///< a point stays where its first parent put it
  parents  ///< it moves to the mean of the positions that all points present predict for it
};

struct VolumeOptions {
  std::optional<double> rejection =
      std::nullopt;                ///< (0, 1): least distance in the infinity norm, in sizes; empty: the order's own
  double boundary_distance = 0.5;  ///< least distance to the boundary, in sizes
  double link_distance = 0.35;     ///< a proposal this near to a point (in sizes, infinity norm) is that point
  ParentAveraging averaging = ParentAveraging::parents;
  index_t rounds = 3;  ///< how often the points are relaxed, and those that moved propose again
  index_t sweeps =
      5;  ///< of a relaxation: each moves every point towards the mean of what its lattice neighbours predict
  double least_move = 0.005;  ///< of a sweep, in sizes: a point off by less stays; most of the cost of a relaxation
  std::size_t max_points = 5'000'000;  ///< refuse sizes that ask for more; stop when there are more
  Observer observer = {};
};

struct VolumeStatistics {
  std::size_t proposals = 0;       ///< positions computed
  std::size_t linked = 0;          ///< were a point already
  std::size_t too_near_point = 0;  ///< rejected, and not linked
  std::size_t too_near_boundary = 0;
};

/// Points for the volume, with the lattice they form.
struct VolumeInsertion {
  std::vector<Vector3> points;  ///< the seeds in their order, then the new ones in the order of insertion
  std::size_t n_seeds = 0;
  std::vector<Quaternion> frames;
  std::vector<double> sizes, smoothness;
  std::vector<index_t> generations;  ///< steps from the boundary
  LatticeLinks<6> links;
  VolumeStatistics statistics;
  Status status = Status::complete;
};

/// Fills a domain with points that continue its boundary points along a frame field: each point proposes six
/// neighbours.
///
/// A proposal starts along an axis of the point's frame, corrected by the frame half way (midpoint rule), one size
/// long. It is dropped outside and near the boundary (true distance), and within `rejection` sizes of another point in
/// the infinity norm of the frame at its place; if that point is within `link_distance` of it, both are linked as
/// lattice neighbours.
///
/// `step()` and `finish()` serve those who look on; `insert_volume_points` is the whole job in one call.
///
/// @tparam Order      FifoOrder or SmoothnessOrder, or a queue of your own.
/// @tparam Proximity  HashGrid, or RTreeFilter (slower by a factor that docs/insertion.md gives).
/// @par Determinism   The result depends on the arguments only.
/// @par Source        the paper, section 3.2; Carrier Baudouin et al., Adv. Model. Simul. Eng. Sci. 1:8 (2014).
///                    Departs: midpoint rule, lattice links, averaging of predictions.
template <InsertionOrder Order, FrameSource Frames, detail::SizeCallable Size, Domain D,
          ProximityFilter Proximity = HashGrid>
class VolumeInserter {
public:
  /// @param frames, size, domain  kept by reference.
  /// @param seeds                 n points on the boundary.
  /// @throws invalid_option       options out of range, or sizes that ask for more than `max_points` points.
  /// @throws invalid_field        a size that is not positive and finite.
  VolumeInserter(const Frames& frames, const Size& size, const D& domain, std::span<const BoundarySeed> seeds,
                 VolumeOptions options = {}, Order order = Order{})
      : frames_(frames),
        size_(size),
        domain_(domain),
        options_(std::move(options)),
        queue_(std::move(order)),
        rejection_(options_.rejection.value_or(Order::default_rejection)),
        proximity_(1.0) {
    detail::check_factor("rejection", rejection_, 0.05, 0.95);
    detail::check_factor("boundary_distance", options_.boundary_distance, 1e-3, 2);
    detail::check_factor("link_distance", options_.link_distance, 0, rejection_);
    detail::check_factor("least_move", options_.least_move, 1e-9, 1);
    estimate(seeds);
    proximity_ = Proximity(largest_size_);
    result_.n_seeds = seeds.size();
    for (const BoundarySeed& seed : seeds) add_seed(seed);
    for (index_t i = 0; i < seeds.size(); ++i) queue_.push(i, result_.smoothness[i], 0);
  }

  /// Lets the next point of the queue propose its neighbours. @return false when there was none.
  bool step() {
    if (queue_.empty()) return false;
    const index_t p = queue_.pop();
    for (std::size_t direction = 0; direction < 6; ++direction)
      if (result_.links[p][direction] == no_index && direction != outward_of(p)) propose(p, direction);
    return true;
  }

  /// Runs to the end, or until the observer or `max_points` stops it.
  VolumeInsertion finish() {
    run_queue();
    for (index_t round = 0; round < options_.rounds && result_.status == Status::complete; ++round) {
      for (index_t sweep = 0; sweep < options_.sweeps; ++sweep) relax();
      // A point that stayed would propose what was turned down before.
      for (index_t p = 0; p < sites_.size(); ++p)
        if (moved_[p]) queue_.push(p, result_.smoothness[p], result_.generations[p]);
      std::fill(moved_.begin(), moved_.end(), std::uint8_t{0});
      run_queue();
    }
    add_sites(result_);
    return std::move(result_);
  }

  /// What there is so far, in O(n).
  VolumeInsertion result() const {
    VolumeInsertion result = result_;
    add_sites(result);
    return result;
  }

private:
  /// What is asked for of neighbours, on one line of the cache.
  struct alignas(64) Site {
    Vector3 point;
    double size;
    Quaternion frame;
  };
  struct Probe {
    Eigen::Matrix3d axes;
    Quaternion frame;
    double smoothness, size;
    index_t hint;
  };
  /// A point that predicts the candidate's place: it is its neighbour along `direction` of the candidate.
  struct Parent {
    index_t point = no_index;
    double miss = 0;
    Vector3 prediction;
  };

  void add_sites(VolumeInsertion& result) const {
    result.points.reserve(sites_.size());
    result.frames.reserve(sites_.size());
    result.sizes.reserve(sites_.size());
    for (const Site& site : sites_) {
      result.points.push_back(site.point);
      result.frames.push_back(site.frame);
      result.sizes.push_back(site.size);
    }
  }

  void run_queue() {
    constexpr std::size_t steps_per_report = 2048;
    for (std::size_t n = 0; step(); ++n) {
      if (sites_.size() - result_.n_seeds > options_.max_points) {
        result_.status = Status::budget_exhausted;
        return;
      }
      const double done = static_cast<double>(n) / (estimate_ + static_cast<double>(result_.n_seeds));
      if (n % steps_per_report == 0 && !keep_going(options_.observer, "volume insertion", std::min(done, 1.0))) {
        result_.status = Status::cancelled;
        return;
      }
    }
  }

  Probe probe(const Vector3& p, index_t hint) const {
    const auto sample = frames_.sample(p, hint);
    const Quaternion frame = sample.frame;
    return {frame.toRotationMatrix(), frame, sample.smoothness, detail::checked_size(size_, p), hint};
  }

  /// Number of points to be expected, and the largest size, from a grid over the bounding box.
  void estimate(std::span<const BoundarySeed> seeds) {
    if (seeds.empty()) return;
    Vector3 low = seeds[0].point, high = low;
    for (const BoundarySeed& seed : seeds) {
      low = low.cwiseMin(seed.point);
      high = high.cwiseMax(seed.point);
      largest_size_ = std::max(largest_size_, detail::checked_size(size_, seed.point));
    }
    const PointEstimate inside = estimate_volume_points(low, high, domain_, size_);
    estimate_ = inside.n_points;
    largest_size_ = std::max(largest_size_, inside.largest_size);
    detail::check_estimate("volume", estimate_, options_.max_points);
  }

  void add_seed(const BoundarySeed& seed) {
    Probe at = probe(seed.point, no_index);
    std::uint8_t outward = none;
    if (!seed.normal.isZero()) {
      // The field is interpolated, the normal is not: put the nearest axis on it.
      const std::size_t direction = nearest_direction(at.axes, seed.normal);
      const Vector3 axis = lattice_direction(at.axes, direction);
      at.frame = (Quaternion::FromTwoVectors(axis, seed.normal) * at.frame).normalized();
      at.axes = at.frame.toRotationMatrix();
      outward = static_cast<std::uint8_t>(direction);
    }
    outward_.push_back(outward);
    store(seed.point, at, 0, 0);
  }

  index_t store(const Vector3& p, const Probe& at, index_t generation, double clearance) {
    const auto index = static_cast<index_t>(sites_.size());
    sites_.push_back({p, at.size, at.frame});
    result_.smoothness.push_back(at.smoothness);
    result_.generations.push_back(generation);
    result_.links.push_back({no_index, no_index, no_index, no_index, no_index, no_index});
    clearance_.push_back(clearance);
    hints_.push_back(at.hint);
    awake_.push_back(1);
    moved_.push_back(0);
    proximity_.insert(p, at.size);
    return index;
  }

  std::size_t outward_of(index_t p) const { return p < outward_.size() ? outward_[p] : std::size_t{none}; }

  void propose(index_t p, std::size_t direction) {
    ++result_.statistics.proposals;
    const Vector3 origin = sites_[p].point;
    const Vector3 start = lattice_direction(sites_[p].frame.toRotationMatrix(), direction);
    const Probe half = probe(origin + 0.5 * sites_[p].size * start, hints_[p]);
    const Vector3 middle = lattice_direction(half.axes, nearest_direction(half.axes, start));
    Vector3 candidate = origin + half.size * middle;
    Probe at = probe(candidate, half.hint);

    const auto [near, distance] = nearest_within_rejection(candidate, at);
    if (near != no_index) {
      const bool same = distance < options_.link_distance * at.size && near != p;
      if (same && connect(p, direction, near, middle))
        ++result_.statistics.linked;
      else
        ++result_.statistics.too_near_point;
      return;
    }
    const std::array<Parent, 6> parents = find_parents(candidate, at);
    double clearance = clearance_[p] - (candidate - origin).norm();
    for (const Parent& parent : parents)
      if (parent.point != no_index)
        clearance = std::max(clearance, clearance_[parent.point] - (candidate - sites_[parent.point].point).norm());
    if (!admissible(p, candidate, at.size, clearance)) {
      ++result_.statistics.too_near_boundary;
      return;
    }
    if (options_.averaging == ParentAveraging::parents) average(p, parents, candidate, at, clearance);

    const index_t index = store(candidate, at, result_.generations[p] + 1, clearance);
    detail::connect(result_.links, p, direction, index, nearest_direction(at.axes, -middle));
    for (std::size_t d = 0; d < 6; ++d)
      if (parents[d].point != no_index) connect(index, d, parents[d].point, lattice_direction(at.axes, d));
    queue_.push(index, at.smoothness, result_.generations[index]);
  }

  /// Links p along its `direction` with q, along that axis of q which points back.
  bool connect(index_t p, std::size_t direction, index_t q, const Vector3& along) {
    const std::size_t back = nearest_direction(sites_[q].frame.toRotationMatrix(), -along);
    if (!detail::connect(result_.links, p, direction, q, back)) return false;
    awake_[p] = awake_[q] = 1;
    return true;
  }

  std::pair<index_t, double> nearest_within_rejection(const Vector3& candidate, const Probe& at) const {
    std::pair<index_t, double> best{no_index, 0};
    for_each_near(proximity_, candidate, at.axes, rejection_ * at.size,
                  [&](index_t i, const Vector3&, double distance) {
                    if (best.first == no_index || distance < best.second || (distance == best.second && i < best.first))
                      best = {i, distance};
                  });
    return best;
  }

  /// Inside, and far enough from the boundary?
  ///
  /// @param clearance  a lower bound of the distance to the boundary, negative when nothing is known; receives a better
  ///                   one where it does not decide.
  bool admissible(index_t p, const Vector3& candidate, double size, double& clearance) const {
    const double step = (candidate - sites_[p].point).norm(), needed = options_.boundary_distance * size;
    // Balls round both ends that cover the step, nearly: it does not jump across a gap.
    const auto covered = [&] { return clearance_[p] + clearance >= 0.9 * step; };
    if (clearance >= needed && covered()) return true;
    clearance = domain_.clearance(candidate, clearance_reach * size);
    if (clearance < needed) return false;
    return covered() || domain_.clearance(0.5 * (candidate + sites_[p].point), size) > 0;
  }

  /// For each axis direction of the candidate the present point that the lattice expects there, within `link_distance`.
  std::array<Parent, 6> find_parents(const Vector3& candidate, const Probe& at) const {
    std::array<Parent, 6> parents;
    const double tolerance = options_.link_distance;
    for_each_local(
        proximity_, candidate, at.axes, (1 + tolerance) * at.size,
        [&](index_t q, const Vector3&, const Vector3& local) {
          if (beside_axes(local.cwiseAbs(), tolerance * at.size, 0.5 * (at.size + sites_[q].size))) return;
          const std::size_t direction = nearest_direction(local);
          const Vector3 prediction = predicted_from(q, lattice_direction(at.axes, direction), at.size);
          const double miss = frame_infinity_norm(at.axes, prediction - candidate);
          Parent& parent = parents[direction];
          if (miss >= tolerance * at.size ||
              (parent.point != no_index && (miss > parent.miss || (miss == parent.miss && q > parent.point))))
            return;
          parent = {q, miss, prediction};
        });
    return parents;
  }

  /// Is a point with these coordinates too far from every axis to be the neighbour along it? Its prediction turns by
  /// half of the angle between its axis and the candidate's, which is at most 54.8 degrees.
  static bool beside_axes(const Vector3& local, double tolerance, double step) {
    const double middle = local.sum() - local.maxCoeff() - local.minCoeff();
    return middle >= tolerance + 0.475 * step;
  }

  /// Moves a candidate to the mean of its parents' predictions where it may stand.
  void average(index_t p, const std::array<Parent, 6>& parents, Vector3& candidate, Probe& at,
               double& clearance) const {
    Vector3 sum = candidate;
    double n = 1;
    for (const Parent& parent : parents) {
      if (parent.point == no_index || parent.point == p) continue;
      sum += parent.prediction;
      ++n;
    }
    const Vector3 mean = sum / n;
    if ((mean - candidate).norm() < 1e-9 * at.size) return;
    const Probe there = probe(mean, at.hint);
    if (nearest_within_rejection(mean, there).first != no_index) return;
    double bound = clearance - (mean - candidate).norm();
    if (!admissible(p, mean, there.size, bound)) return;
    candidate = mean;
    at = there;
    clearance = bound;
  }

  /// One sweep: each point in turn goes to the mean of what its lattice neighbours predict, a tenth of the size at
  /// most, and only where it may stand. Points that stand well, or were in the way of nothing that moved, rest.
  void relax() {
    for (index_t p = static_cast<index_t>(result_.n_seeds); p < sites_.size(); ++p) {
      if (!awake_[p]) continue;
      awake_[p] = 0;
      Vector3 sum = Vector3::Zero();
      double n = 0;
      const Eigen::Matrix3d axes = sites_[p].frame.toRotationMatrix();
      for (std::size_t d = 0; d < 6; ++d) {
        const index_t q = result_.links[p][d];
        if (q == no_index) continue;
        sum += predicted_from(q, lattice_direction(axes, d), sites_[p].size);
        ++n;
      }
      if (n < 2) continue;
      Vector3 move = sum / n - sites_[p].point;
      const double longest = max_move * sites_[p].size, length = move.norm();
      if (length < options_.least_move * sites_[p].size) continue;
      if (length > longest) move *= longest / length;
      if (!move_to(p, sites_[p].point + move, axes)) continue;
      awake_[p] = 1;
      for (const index_t q : result_.links[p])
        if (q != no_index) awake_[q] = 1;
    }
  }

  bool move_to(index_t p, const Vector3& to, const Eigen::Matrix3d& axes) {
    Probe there = probe(to, hints_[p]);
    there.axes = renumbered(there.axes, axes);  // links keep their directions
    double clearance = clearance_[p] - (to - sites_[p].point).norm();
    if (!may_move(p, to, there) || !admissible(p, to, there.size, clearance)) return false;
    sites_[p].point = to;
    sites_[p].frame = Quaternion(there.axes);
    sites_[p].size = there.size;
    result_.smoothness[p] = there.smoothness;
    hints_[p] = there.hint;
    clearance_[p] = clearance;
    proximity_.move(p, to);
    moved_[p] = 1;
    return true;
  }

  /// Where q expects its neighbour from which it lies in direction `out`, by the mean of the axes at both ends: second
  /// order, as the midpoint rule.
  Vector3 predicted_from(index_t q, const Vector3& out, double size) const {
    const Eigen::Matrix3d axes = sites_[q].frame.toRotationMatrix();
    const Vector3 along = (lattice_direction(axes, nearest_direction(axes, -out)) - out).normalized();
    return sites_[q].point + 0.5 * (size + sites_[q].size) * along;
  }

  /// The rule, in the frame and size of the point and in those of every neighbour: however two frames are turned, the
  /// infinity norm of one is at least the length over the root of 3.
  bool may_move(index_t p, const Vector3& to, const Probe& there) const {
    const double least = rejection_ * there.size;
    const Vector3 half = Vector3::Constant(std::numbers::sqrt3 * least);
    bool free = true;
    proximity_.for_each_in_box(to - half, to + half, [&](index_t q, const Vector3& point) {
      if (!free || q == p) return;
      const Vector3 offset = point - to;
      free = frame_infinity_norm(there.axes, offset) >= least &&
             frame_infinity_norm(sites_[q].frame.toRotationMatrix(), offset) >= rejection_ * sites_[q].size;
    });
    return free;
  }

  static constexpr double clearance_reach = 8;  // sizes; a longer search gives a bound that serves more points
  static constexpr double max_move = 0.1;       // of a sweep, in sizes
  static constexpr std::uint8_t none = 255;

  const Frames& frames_;
  const Size& size_;
  const D& domain_;
  VolumeOptions options_;
  Order queue_;
  double rejection_;
  double estimate_ = 0, largest_size_ = 0;
  Proximity proximity_;
  std::vector<Site> sites_;
  VolumeInsertion result_;             // but for what the sites hold
  std::vector<double> clearance_;      // lower bound of the distance to the boundary
  std::vector<index_t> hints_;         // where the frame source found the point
  std::vector<std::uint8_t> moved_;    // since it last proposed
  std::vector<std::uint8_t> awake_;    // may have to move: itself or a lattice neighbour is new or has moved
  std::vector<std::uint8_t> outward_;  // of a seed: the direction that leaves the domain
};

/// The paper's order: smoothest first.
template <FrameSource Frames, detail::SizeCallable Size, Domain D, ProximityFilter Proximity = HashGrid>
using SmoothnessOrderedInserter = VolumeInserter<SmoothnessOrder, Frames, Size, D, Proximity>;

/// The earlier order: first in, first out.
template <FrameSource Frames, detail::SizeCallable Size, Domain D, ProximityFilter Proximity = HashGrid>
using FifoInserter = VolumeInserter<FifoOrder, Frames, Size, D, Proximity>;

/// Fills a domain with points that continue its boundary points along a frame field; see `VolumeInserter`.
///
/// @param seeds   points of the boundary, with normals where there is one.
/// @param frames  frames near the domain.
/// @param size    wished distance between neighbours, host's unit; asked for up to one size outside the domain.
/// @param domain  distance to the boundary, e.g. `SurfaceDomain`.
/// @throws as `VolumeInserter`.
/// @par Complexity   O(n) proposals, each of one or two frame samples and a search; about 300 bytes a point.
template <InsertionOrder Order = SmoothnessOrder, ProximityFilter Proximity = HashGrid, FrameSource Frames,
          detail::SizeCallable Size, Domain D>
VolumeInsertion insert_volume_points(std::span<const BoundarySeed> seeds, const Frames& frames, const Size& size,
                                     const D& domain, const VolumeOptions& options = {}, Order order = Order{}) {
  return VolumeInserter<Order, Frames, Size, D, Proximity>(frames, size, domain, seeds, options, std::move(order))
      .finish();
}

}  // namespace framehex
