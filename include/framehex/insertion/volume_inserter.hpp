// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/geometry/rotation.hpp"
#include "framehex/insertion/detail/run_front.hpp"
#include "framehex/insertion/detail/volume_relaxation.hpp"
#include "framehex/insertion/estimate.hpp"
#include "framehex/insertion/insertion_order.hpp"

#include <algorithm>
#include <array>
#include <span>
#include <vector>

namespace framehex {

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
template <InsertionOrder Order, FrameSource Frames, SizeField Size, Domain D, ProximityFilter Proximity = HashGrid>
class VolumeInserter {
public:
  /// @param frames, size, domain  kept by reference.
  /// @param seeds                 n points on the boundary.
  /// @throws invalid_option       options out of range, or sizes that ask for more than `max_points` points.
  /// @throws invalid_coordinate   a seed that is not finite, by its index.
  /// @throws invalid_field        a size that is not positive and finite, or a frame that is not a unit quaternion.
  VolumeInserter(const Frames& frames, const Size& size, const D& domain, std::span<const BoundarySeed> seeds,
                 VolumeOptions options = {}, Order order = Order{})
      : options_(checked(std::move(options))),
        queue_(std::move(order)),
        domain_(domain),
        lattice_(frames, size, domain, *options_.rejection, options_) {
    check_finite(seeds);
    estimate(seeds, size, domain);
    lattice_.insertion().n_seeds = seeds.size();
    for (const BoundarySeed& seed : seeds) add_seed(seed);
    for (index_t i = 0; i < seeds.size(); ++i) queue_.push(i, lattice_.insertion().smoothness[i], 0);
  }

  /// Adds a point inside that is known already, with links to those before it that lie where the frame expects
  /// neighbours. It stays where it is, and proposes neighbours when its turn comes.
  ///
  /// To be called before the first step.
  /// @return false, and nothing is added, within half a size of another point or 0.4 of the boundary.
  bool add_point(const Vector3& point) {
    const Probe at = lattice_.probe(point, n_given_ > 0 ? lattice_.hint(lattice_.n_points() - 1) : no_index);
    const auto [near, distance] = lattice_.nearest_within_rejection(point, at);
    if (near != no_index && distance < std::min(0.5, *options_.rejection) * at.size) return false;
    const double clearance = domain_.clearance(point, at.size);
    if (clearance < std::min(0.4, options_.boundary_distance) * at.size) return false;
    const Parents parents = lattice_.find_parents(point, at);
    const index_t index = lattice_.store(point, at, 0, clearance);
    for (std::size_t d = 0; d < 6; ++d)
      if (parents[d].point != no_index) lattice_.connect(index, d, parents[d].point, lattice_direction(at.axes, d));
    queue_.push(index, at.smoothness, 0);
    ++n_given_;
    return true;
  }

  /// Lets the next point of the queue propose its neighbours. @return false when there was none.
  bool step() {
    if (queue_.empty()) return false;
    const index_t p = queue_.pop();
    for (std::size_t direction = 0; direction < 6; ++direction)
      if (lattice_.insertion().links[p][direction] == no_index && direction != outward_of(p)) propose(p, direction);
    return true;
  }

  /// Runs to the end, or until the observer or `max_points` stops it. Takes the result out, and with it what `result()`
  /// shows: for an inserter that is done with, `std::move(inserter).finish()`.
  VolumeInsertion finish() && {
    VolumeInsertion& now = lattice_.insertion();
    detail::VolumeRelaxation relaxation(lattice_, now.n_seeds + n_given_, *options_.least_move);
    now.status = detail::run_front(
        {"volume insertion", options_.observer, options_.rounds, options_.sweeps, options_.max_points,
         estimate_ + static_cast<double>(now.n_seeds) + 1},
        [&] { return step(); }, [&] { return lattice_.n_points() - now.n_seeds; }, [&] { relaxation.sweep(); },
        // A point that stayed would propose what was turned down before.
        [&] { relaxation.take_moved([&](index_t p) { queue_.push(p, now.smoothness[p], now.generations[p]); }); });
    lattice_.add_sites(now);
    return std::move(now);
  }

  /// What there is so far, in O(n).
  VolumeInsertion result() const {
    VolumeInsertion result = lattice_.insertion();
    lattice_.add_sites(result);
    return result;
  }

private:
  using Lattice = detail::VolumeLattice<Frames, Size, D, Proximity>;
  using Probe = typename Lattice::Probe;
  using Parents = typename Lattice::Parents;

  /// The options with the order's own filled in.
  static VolumeOptions checked(VolumeOptions options) {
    check_options(options);
    if (!options.rejection) options.rejection = Order::default_rejection;
    if (!options.link_distance) options.link_distance = std::min(0.35, *options.rejection);
    detail::check_link_distance(*options.link_distance, *options.rejection);
    if (!options.least_move) options.least_move = detail::least_move<Order>();
    return options;
  }

  static void check_finite(std::span<const BoundarySeed> seeds) {
    for (std::size_t i = 0; i < seeds.size(); ++i)
      if (!seeds[i].point.allFinite() || !seeds[i].normal.allFinite())
        throw invalid_coordinate("boundary seed " + std::to_string(i) + " has a coordinate that is not finite",
                                 Entity::vertex, {i});
  }

  /// Number of points to be expected, and the largest size, from a grid over the bounding box.
  void estimate(std::span<const BoundarySeed> seeds, const Size& size, const D& domain) {
    if (seeds.empty()) return;
    Vector3 low = seeds[0].point, high = low;
    double largest = 0;
    for (const BoundarySeed& seed : seeds) {
      low = low.cwiseMin(seed.point);
      high = high.cwiseMax(seed.point);
      largest = std::max(largest, detail::checked_size(size, seed.point));
    }
    const PointEstimate inside = estimate_volume_points(low, high, domain, size);
    estimate_ = inside.n_points;
    detail::check_estimate("volume", estimate_, options_.max_points);
    lattice_.set_largest_size(std::max(largest, inside.largest_size));
    lattice_.reserve(seeds.size() + static_cast<std::size_t>(1.1 * estimate_));
  }

  void add_seed(const BoundarySeed& seed) {
    Probe at = lattice_.probe(seed.point, no_index);
    std::uint8_t outward = none;
    if (!seed.normal.isZero()) {
      // The field is interpolated, the normal is not: put the nearest axis on it.
      const std::size_t direction = nearest_direction(at.axes, seed.normal);
      const Vector3 axis = lattice_direction(at.axes, direction);
      at.frame = (rotation_between(axis, seed.normal) * at.frame).normalized();
      at.axes = at.frame.toRotationMatrix();
      outward = static_cast<std::uint8_t>(direction);
    }
    outward_.push_back(outward);
    lattice_.store(seed.point, at, 0, 0);
  }

  std::size_t outward_of(index_t p) const { return p < outward_.size() ? outward_[p] : std::size_t{none}; }

  void propose(index_t p, std::size_t direction) {
    VolumeStatistics& statistics = lattice_.insertion().statistics;
    ++statistics.proposals;
    const Vector3 origin = lattice_.site(p).point;
    const double step = lattice_.site(p).size;
    const Vector3 start = lattice_direction(lattice_.site(p).frame.toRotationMatrix(), direction);
    const Probe half = lattice_.probe(origin + 0.5 * step * start, lattice_.hint(p));
    const Vector3 middle = lattice_direction(half.axes, nearest_direction(half.axes, start));
    Vector3 candidate = origin + half.size * middle;
    Probe at = lattice_.probe(candidate, half.hint);

    const auto [near, distance] = lattice_.nearest_within_rejection(candidate, at);
    if (near != no_index) {
      const bool same = distance < *options_.link_distance * at.size && near != p;
      if (same && lattice_.connect(p, direction, near, middle))
        ++statistics.linked;
      else
        ++statistics.too_near_point;
      return;
    }
    const Parents parents = lattice_.find_parents(candidate, at);
    double clearance = lattice_.clearance_from(p, candidate);
    for (const auto& parent : parents)
      if (parent.point != no_index) clearance = std::max(clearance, lattice_.clearance_from(parent.point, candidate));
    if (!lattice_.admissible(p, candidate, at.size, clearance)) {
      ++statistics.too_near_boundary;
      return;
    }
    if (options_.wanted && !options_.wanted(candidate)) {
      ++statistics.unwanted;
      return;
    }
    if (options_.averaging == ParentAveraging::parents) average(p, parents, candidate, at, clearance);

    const index_t generation = lattice_.insertion().generations[p] + 1;
    const index_t index = lattice_.store(candidate, at, generation, clearance);
    detail::connect(lattice_.insertion().links, p, direction, index, nearest_direction(at.axes, -middle));
    for (std::size_t d = 0; d < 6; ++d)
      if (parents[d].point != no_index) lattice_.connect(index, d, parents[d].point, lattice_direction(at.axes, d));
    queue_.push(index, at.smoothness, generation);
  }

  /// Moves a candidate to the mean of its parents' predictions where it may stand.
  void average(index_t p, const Parents& parents, Vector3& candidate, Probe& at, double& clearance) const {
    Vector3 sum = candidate;
    double n = 1;
    for (const auto& parent : parents) {
      if (parent.point == no_index || parent.point == p) continue;
      sum += parent.prediction;
      ++n;
    }
    const Vector3 mean = sum / n;
    if ((mean - candidate).norm() < 1e-9 * at.size) return;
    const Probe there = lattice_.probe(mean, at.hint);
    if (lattice_.nearest_within_rejection(mean, there).first != no_index) return;
    double bound = clearance - (mean - candidate).norm();
    if (!lattice_.admissible(p, mean, there.size, bound)) return;
    candidate = mean;
    at = there;
    clearance = bound;
  }

  static constexpr std::uint8_t none = 255;

  VolumeOptions options_;
  Order queue_;
  const D& domain_;
  double estimate_ = 0;
  Lattice lattice_;
  std::size_t n_given_ = 0;            // by add_point
  std::vector<std::uint8_t> outward_;  // of a seed: the direction that leaves the domain
};

/// The paper's order: smoothest first.
template <FrameSource Frames, SizeField Size, Domain D, ProximityFilter Proximity = HashGrid>
using SmoothnessOrderedInserter = VolumeInserter<SmoothnessOrder, Frames, Size, D, Proximity>;

/// The earlier order: first in, first out.
template <FrameSource Frames, SizeField Size, Domain D, ProximityFilter Proximity = HashGrid>
using FifoInserter = VolumeInserter<FifoOrder, Frames, Size, D, Proximity>;

/// Fills a domain with points that continue its boundary points along a frame field; see `VolumeInserter`.
///
/// @param seeds   points of the boundary, with normals where there is one.
/// @param frames  frames near the domain.
/// @param size    wished distance between neighbours, host's unit; asked for up to one size outside the domain.
/// @param domain  distance to the boundary, e.g. `SurfaceDomain`.
/// @throws as `VolumeInserter`.
/// @par Complexity   O(n) proposals, each of one or two frame samples and a search; about 220 bytes a point.
template <InsertionOrder Order = SmoothnessOrder, ProximityFilter Proximity = HashGrid, FrameSource Frames,
          SizeField Size, Domain D>
VolumeInsertion insert_volume_points(std::span<const BoundarySeed> seeds, const Frames& frames, const Size& size,
                                     const D& domain, const VolumeOptions& options = {}, Order order = Order{}) {
  return VolumeInserter<Order, Frames, Size, D, Proximity>(frames, size, domain, seeds, options, std::move(order))
      .finish();
}

}  // namespace framehex
