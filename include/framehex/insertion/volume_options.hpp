// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/insertion/lattice_links.hpp"
#include "framehex/observer.hpp"
#include "framehex/option_ranges.hpp"
#include "framehex/surface/surface_locator.hpp"

#include <concepts>
#include <functional>
#include <optional>
#include <vector>

namespace framehex {

/// Frames in space, as `FrameField` gives them: `sample(p, hint)` returns `.frame` (unit Quaternion) and `.smoothness`
/// at any point near the domain; `hint` is where the caller's last search ended (`no_index` at first) and is updated.
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

/// How the frame of a new point follows from those of its parents.
enum class ParentAveraging {
  none,    ///< a point stays where its first parent put it
  parents  ///< it moves to the mean of the positions that all points present predict for it
};

/// Options of `insert_volume_points`.
struct VolumeOptions {
  std::optional<double> rejection =
      std::nullopt;  ///< 0.05 to 0.95: least distance in the infinity norm, in sizes; empty: the order's own
  double boundary_distance = 0.5;  ///< 1e-3 to 2: least distance to the boundary, in sizes
  /// At most `rejection`: a proposal this near to a point (in sizes, infinity norm) is that point. Empty: 0.35, or
  /// `rejection` where that is less.
  std::optional<double> link_distance = std::nullopt;
  ParentAveraging averaging = ParentAveraging::parents;
  index_t rounds = 3;  ///< how often the points are relaxed, and those that moved propose again
  index_t sweeps =
      5;  ///< of a relaxation: each moves every point towards the mean of what its lattice neighbours predict
  /// Of a sweep, in sizes, 1e-9 to 1: a point off by less stays; most of the cost of a relaxation. Empty: the order's
  /// own.
  std::optional<double> least_move = std::nullopt;
  /// Asked of places where a point may stand: false where those added are all that is wanted. Empty: true.
  std::function<bool(const Vector3&)> wanted = {};
  std::size_t max_points = 5'000'000;  ///< refuse sizes that ask for more; stop when there are more
  Observer observer = {};

  template <class Options, class Visit>
  static void each_number(Options& o, Visit&& visit) {
    visit("VolumeOptions::rejection", o.rejection, 0.05, 0.95);
    visit("VolumeOptions::boundary_distance", o.boundary_distance, 1e-3, 2);
    visit("VolumeOptions::link_distance", o.link_distance, 0, 0.95);
    visit("VolumeOptions::rounds", o.rounds, 0, unbounded);
    visit("VolumeOptions::sweeps", o.sweeps, 0, unbounded);
    visit("VolumeOptions::least_move", o.least_move, 1e-9, 1);
    visit("VolumeOptions::max_points", o.max_points, 0, unbounded);
  }
};

/// Counts of `insert_volume_points`.
struct VolumeStatistics {
  std::size_t proposals = 0;       ///< positions computed
  std::size_t linked = 0;          ///< were a point already
  std::size_t too_near_point = 0;  ///< rejected, and not linked
  std::size_t too_near_boundary = 0;
  std::size_t unwanted = 0;
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

}  // namespace framehex
