// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/insertion/volume_options.hpp"
#include "framehex/option_ranges.hpp"
#include "framehex/surface/surface_sample.hpp"

#include <span>

namespace framehex {

/// Options of `insert_surface_points`.
struct SurfaceOptions {
  std::optional<double> rejection = std::nullopt;  ///< 0.05 to 0.95: least distance in the infinity norm of the local
                                                   ///< cross, in sizes; empty: the order's own
  double boundary_distance = 0.5;                  ///< 1e-3 to 2: least distance to feature curves, in sizes
  /// At most `rejection`: a proposal this near to a sample (in sizes, infinity norm) is that sample. Empty: 0.35, or
  /// `rejection` where that is less.
  std::optional<double> link_distance = std::nullopt;
  ParentAveraging averaging = ParentAveraging::parents;
  index_t rounds = 3;  ///< how often the samples are relaxed and then propose again
  index_t sweeps =
      5;  ///< of a relaxation: each moves every sample towards the mean of what its lattice neighbours predict
  /// Per triangle, or empty: 1 where the samples added are all that is wanted, and proposals are dropped.
  std::span<const std::uint8_t> complete = {};
  std::size_t max_points = 5'000'000;  ///< refuse sizes that ask for more; stop when there are more
  Observer observer = {};

  template <class Options, class Visit>
  static void each_number(Options& o, Visit&& visit) {
    visit("SurfaceOptions::rejection", o.rejection, 0.05, 0.95);
    visit("SurfaceOptions::boundary_distance", o.boundary_distance, 1e-3, 2);
    visit("SurfaceOptions::link_distance", o.link_distance, 0, 0.95);
    visit("SurfaceOptions::rounds", o.rounds, 0, unbounded);
    visit("SurfaceOptions::sweeps", o.sweeps, 0, unbounded);
    visit("SurfaceOptions::max_points", o.max_points, 0, unbounded);
  }
};

/// Counts of `insert_surface_points`.
struct SurfaceStatistics {
  std::size_t proposals = 0;       ///< positions computed
  std::size_t linked = 0;          ///< were a sample already
  std::size_t too_near_point = 0;  ///< rejected, and not linked
  std::size_t too_near_curve = 0;  ///< beyond a feature curve, or too near to one
  std::size_t complete = 0;        ///< where no more samples are wanted
  std::size_t seeds = 0;           ///< samples put on patches without a curve
};

/// Samples of a surface, with the lattice they form.
struct SurfaceInsertion {
  std::vector<SurfaceSample>
      samples;  ///< those of corners and curves as given, then the new ones in the order of insertion
  std::size_t n_curve_samples = 0;  ///< how many are of corners and curves
  std::vector<Quaternion>
      frames;  ///< z is the outward normal (of the first triangle, at corners and curves), x and y the cross
  std::vector<double> sizes, smoothness;
  LatticeLinks<4> links;  ///< of corner and curve samples: in no order, along the curves first
  SurfaceStatistics statistics;
  Status status = Status::complete;

  /// Seeds of the volume stage: normals where there is one.
  std::vector<BoundarySeed> seeds() const {
    std::vector<BoundarySeed> result;
    result.reserve(samples.size());
    for (std::size_t i = 0; i < samples.size(); ++i)
      result.push_back(
          {samples[i].point, i < n_curve_samples ? Vector3::Zero() : Vector3(frames[i] * Vector3::UnitZ())});
    return result;
  }
};

}  // namespace framehex
