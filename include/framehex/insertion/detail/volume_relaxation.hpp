// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/insertion/detail/volume_lattice.hpp"

#include <cstdint>
#include <vector>

namespace framehex::detail {

/// Moves the points of a lattice to where their lattice neighbours expect them.
template <class Lattice>
class VolumeRelaxation {
public:
  /// @param n_fixed  points that stay: the first ones.
  VolumeRelaxation(Lattice& lattice, std::size_t n_fixed, double least_move)
      : lattice_(lattice), n_fixed_(static_cast<index_t>(n_fixed)), least_move_(least_move) {}

  /// Calls `visit(p)` for each point that has moved since the last call.
  template <class Visit>
  void take_moved(Visit&& visit) {
    for (index_t p = 0; p < moved_.size(); ++p)
      if (moved_[p]) visit(p);
    moved_.assign(moved_.size(), 0);
  }

  /// One sweep: each point in turn goes to the mean of what its lattice neighbours predict, a tenth of the size at
  /// most, and only where it may stand. Points that stand well, or were in the way of nothing that moved, rest.
  void sweep() {
    moved_.resize(lattice_.n_points(), 0);
    const auto& links = lattice_.insertion().links;
    for (index_t p = n_fixed_; p < lattice_.n_points(); ++p) {
      if (p + prefetch_distance < lattice_.n_points()) lattice_.prefetch_neighbours(p + prefetch_distance);
      if (!lattice_.awake(p)) continue;
      lattice_.awake(p) = 0;
      const auto& site = lattice_.site(p);
      Vector3 sum = Vector3::Zero();
      double n = 0;
      const Eigen::Matrix3d axes = site.frame.toRotationMatrix();
      for (std::size_t d = 0; d < 6; ++d) {
        const index_t q = links[p][d];
        if (q == no_index) continue;
        sum += lattice_.predicted_from(q, lattice_direction(axes, d), site.size);
        ++n;
      }
      if (n < 2) continue;
      Vector3 move = sum / n - site.point;
      const double longest = max_move * site.size, length = move.norm();
      if (length < least_move_ * site.size) continue;
      if (length > longest) move *= longest / length;
      if (!move_to(p, site.point + move, axes)) continue;
      lattice_.awake(p) = 1;
      for (const index_t q : links[p])
        if (q != no_index) lattice_.awake(q) = 1;
    }
  }

private:
  bool move_to(index_t p, const Vector3& to, const Eigen::Matrix3d& axes) {
    auto there = lattice_.probe(to, lattice_.hint(p));
    there.axes = renumbered(there.axes, axes);  // links keep their directions
    double clearance = lattice_.clearance_from(p, to);
    if (!lattice_.may_move(p, to, there) || !lattice_.admissible(p, to, there.size, clearance)) return false;
    lattice_.move(p, to, there, clearance);
    moved_[p] = 1;
    return true;
  }

  static constexpr double max_move = 0.1;  // of a sweep, in sizes
  static constexpr index_t prefetch_distance = 4;

  Lattice& lattice_;
  index_t n_fixed_;
  double least_move_;
  std::vector<std::uint8_t> moved_;  // since last taken
};

}  // namespace framehex::detail
