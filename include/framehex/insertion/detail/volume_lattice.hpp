// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/geometry/proximity.hpp"
#include "framehex/geometry/size_field.hpp"
#include "framehex/insertion/detail/insertion_checks.hpp"
#include "framehex/insertion/volume_options.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <sstream>
#include <utility>
#include <vector>

namespace framehex::detail {

/// The points of a volume while they come and move, with their lattice links, and the rules about where one may stand.
template <FrameSource Frames, SizeField Size, Domain D, ProximityFilter Proximity>
class VolumeLattice {
public:
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
  using Parents = std::array<Parent, 6>;  ///< along the six directions of the candidate

  /// @param frames, size, domain  kept by reference.
  VolumeLattice(const Frames& frames, const Size& size, const D& domain, double rejection, const VolumeOptions& options)
      : frames_(frames),
        size_(size),
        domain_(domain),
        rejection_(rejection),
        boundary_distance_(options.boundary_distance),
        link_distance_(*options.link_distance),
        proximity_(1.0) {}

  /// Before the first point: sizes are up to `largest`.
  void set_largest_size(double largest) {
    proximity_ = Proximity(largest);
    largest_size_ = largest;
  }

  void reserve(std::size_t n) {
    sites_.reserve(n);
    insertion_.smoothness.reserve(n);
    insertion_.generations.reserve(n);
    insertion_.links.reserve(n);
    clearance_.reserve(n);
    hints_.reserve(n);
    awake_.reserve(n);
  }

  index_t n_points() const { return static_cast<index_t>(sites_.size()); }
  const Site& site(index_t p) const { return sites_[p]; }
  /// A lower bound of the clearance of a place near point p.
  double clearance_from(index_t p, const Vector3& place) const {
    return clearance_[p] - (place - sites_[p].point).norm();
  }
  index_t hint(index_t p) const { return hints_[p]; }
  std::uint8_t& awake(index_t p) { return awake_[p]; }

  /// Neighbours came at other times and lie anywhere in memory: asked for ahead, they are there in time.
  void prefetch_neighbours([[maybe_unused]] index_t p) const {
#if defined(__GNUC__)
    if (!awake_[p]) return;
    for (const index_t q : insertion_.links[p])
      if (q != no_index) __builtin_prefetch(&sites_[q]);
#endif
  }

  /// Links, smoothness, generations and counts; the rest is in the sites until `add_sites`.
  const VolumeInsertion& insertion() const {
    return insertion_;
  }
  VolumeInsertion& insertion() {
    return insertion_;
  }

  /// Adds to a result what the sites hold.
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

  Probe probe(const Vector3& p, index_t hint) const {
    const auto sample = frames_.sample(p, hint);
    const Quaternion frame = sample.frame;
    if (!(std::abs(frame.squaredNorm() - 1) < 1e-6)) not_a_frame(p);
    // The sizes are often those of the frames' own mesh; for others the hint does no harm.
    index_t size_hint = hint;
    return {frame.toRotationMatrix(), frame, sample.smoothness, detail::checked_size(size_, p, size_hint), hint};
  }

  index_t store(const Vector3& p, const Probe& at, index_t generation, double clearance) {
    const auto index = static_cast<index_t>(sites_.size());
    sites_.push_back({p, at.size, at.frame});
    largest_size_ = std::max(largest_size_, at.size);
    insertion_.smoothness.push_back(at.smoothness);
    insertion_.generations.push_back(generation);
    insertion_.links.push_back({no_index, no_index, no_index, no_index, no_index, no_index});
    clearance_.push_back(clearance);
    hints_.push_back(at.hint);
    awake_.push_back(1);
    proximity_.insert(p, at.size);
    return index;
  }

  void move(index_t p, const Vector3& to, const Probe& there, double clearance) {
    sites_[p] = {to, there.size, Quaternion(there.axes)};
    largest_size_ = std::max(largest_size_, there.size);
    insertion_.smoothness[p] = there.smoothness;
    hints_[p] = there.hint;
    clearance_[p] = clearance;
    proximity_.move(p, to, there.size);
  }

  /// Links p along its `direction` with q, along that axis of q which points back.
  bool connect(index_t p, std::size_t direction, index_t q, const Vector3& along) {
    const std::size_t back = nearest_direction(sites_[q].frame.toRotationMatrix(), -along);
    if (!detail::connect(insertion_.links, p, direction, q, back)) return false;
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
    const double step = (candidate - sites_[p].point).norm(), needed = boundary_distance_ * size;
    // Balls round both ends that cover the step, nearly: it does not jump across a gap.
    const auto covered = [&] { return clearance_[p] + clearance >= 0.9 * step; };
    if (clearance >= needed && covered()) return true;
    clearance = domain_.clearance(candidate, clearance_reach * size);
    if (clearance < needed) return false;
    return covered() || domain_.clearance(0.5 * (candidate + sites_[p].point), size) > 0;
  }

  /// For each axis direction of the candidate the present point that the lattice expects there, within `link_distance`.
  Parents find_parents(const Vector3& candidate, const Probe& at) const {
    Parents parents;
    const double tolerance = link_distance_;
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

  /// Where q expects its neighbour from which it lies in direction `out`, by the mean of the axes at both ends: second
  /// order, as the midpoint rule.
  Vector3 predicted_from(index_t q, const Vector3& out, double size) const {
    const Eigen::Matrix3d axes = sites_[q].frame.toRotationMatrix();
    const Vector3 along = (lattice_direction(axes, nearest_direction(axes, -out)) - out).normalized();
    return sites_[q].point + 0.5 * (size + sites_[q].size) * along;
  }

  /// The rule, in the frame and size of the point and in those of every neighbour, which may be larger and farther
  /// away: however two frames are turned, the infinity norm of one is at least the length over the root of 3.
  bool may_move(index_t p, const Vector3& to, const Probe& there) const {
    const double least = rejection_ * there.size;
    const Vector3 half = Vector3::Constant(std::numbers::sqrt3 * least);
    bool free = true;
    const auto forbids = [&](index_t q, const Vector3& point) {
      const Vector3 offset = point - to;
      const double reach = rejection_ * std::max(there.size, sites_[q].size);
      if (!free || q == p || offset.squaredNorm() >= 3 * reach * reach) return;
      free = frame_infinity_norm(there.axes, offset) >= least &&
             frame_infinity_norm(sites_[q].frame.toRotationMatrix(), offset) >= rejection_ * sites_[q].size;
    };
    proximity_.for_each_in_box(to - half, to + half, forbids);
    if (free && largest_size_ > there.size) proximity_.for_each_reaching(to, std::numbers::sqrt3 * rejection_, forbids);
    return free;
  }

private:
  [[noreturn]] static void not_a_frame(const Vector3& p) {
    std::ostringstream message;
    message << "the frame at (" << p.x() << ", " << p.y() << ", " << p.z() << ") is not a unit quaternion";
    throw invalid_field(message.str());
  }

  /// Is a point with these coordinates too far from every axis to be the neighbour along it? Its prediction turns by
  /// half of the angle between its axis and the candidate's, which is at most 54.8 degrees.
  static bool beside_axes(const Vector3& local, double tolerance, double step) {
    const double middle = local.sum() - local.maxCoeff() - local.minCoeff();
    return middle >= tolerance + 0.475 * step;
  }

  static constexpr double clearance_reach = 8;  // sizes; a longer search gives a bound that serves more points

  const Frames& frames_;
  const Size& size_;
  const D& domain_;
  double rejection_, boundary_distance_, link_distance_;
  double largest_size_ = 0;
  Proximity proximity_;
  std::vector<Site> sites_;
  VolumeInsertion insertion_;        // but for what the sites hold
  std::vector<double> clearance_;    // lower bound of the distance to the boundary
  std::vector<index_t> hints_;       // where the frame source found the point
  std::vector<std::uint8_t> awake_;  // may have to move: itself or a lattice neighbour is new or has moved
};

}  // namespace framehex::detail
