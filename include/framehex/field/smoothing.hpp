// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/field/detail/visit_schedule.hpp"
#include "framehex/field/detail/whole_mesh.hpp"
#include "framehex/field/frame_measures.hpp"
#include "framehex/observer.hpp"
#include "framehex/option_ranges.hpp"

#include <numeric>

namespace framehex {

/// How much the frame of a neighbour counts.
enum class Diffusivity {
  constant,  ///< all alike
  variable,  ///< little where the neighbour itself is in a rough place: smooth places spread, rough ones do not
};

/// Options of `smooth_frames`.
struct SmoothingOptions {
  Diffusivity diffusivity = Diffusivity::variable;
  double local_tolerance = 5e-3;   ///< > 0; a vertex is settled when its rotation is less (rad)
  double global_tolerance = 3e-2;  ///< > 0; the field has converged when the largest rotation of a sweep is less (rad)
  double smooth_threshold = 0.85;  ///< -1 to 1; smoothness from which a place is smooth (variable diffusivity)
  double rough_weight = 1e-3;      ///< > 0 to 1; of a neighbour below that
  int max_sweeps = 40;             ///< >= 1
  int max_local_iterations = 20;   ///< 1 to 255
  /// One weight per directed edge, in the order of the adjacency's neighbours (as `dirichlet_weights` gives); empty:
  /// 1 each, as in the paper. Multiplies the diffusivity.
  std::span<const double> edge_weights = {};
  Observer observer = {};

  template <class Options, class Visit>
  static void each_number(Options& o, Visit&& visit) {
    visit("SmoothingOptions::local_tolerance", o.local_tolerance, least_positive, unbounded);
    visit("SmoothingOptions::global_tolerance", o.global_tolerance, least_positive, unbounded);
    visit("SmoothingOptions::smooth_threshold", o.smooth_threshold, -1, 1);
    visit("SmoothingOptions::rough_weight", o.rough_weight, least_positive, 1);
    visit("SmoothingOptions::max_sweeps", o.max_sweeps, 1, 1e9);
    visit("SmoothingOptions::max_local_iterations", o.max_local_iterations, 1, 255);
  }
};

/// What happened in one sweep over the free vertices.
struct SweepReport {
  double largest_rotation = 0;  ///< of a vertex, rad
  double local_iterations = 0;  ///< mean over the vertices that were not skipped
  double skipped = 0;           ///< fraction of the free vertices that were skipped
};

/// How `smooth_frames` went.
struct SmoothingReport {
  std::vector<SweepReport> sweeps;
  bool converged = false;            ///< the global tolerance was met
  Status status = Status::complete;  ///< budget_exhausted: `max_sweeps` was reached before

  /// Mean number of local iterations of a vertex that was not skipped, over all sweeps (the paper saw 2.1).
  double mean_local_iterations() const {
    double visits = 0, iterations = 0;
    for (const SweepReport& s : sweeps) {
      visits += 1 - s.skipped;
      iterations += (1 - s.skipped) * s.local_iterations;
    }
    return visits > 0 ? iterations / visits : 0;
  }
};

namespace detail {

/// A smoothing in progress: the field, and what each vertex last did.
template <class E, class Holding>
class FrameSmoother {
public:
  FrameSmoother(const TetAdjacency& adjacency, std::span<Quaternion> frames, std::span<double> smoothness,
                std::span<const FrameConstraint> constraints, std::span<const Vector3> axes,
                const SmoothingOptions& options, const E& executor, const Holding& holding)
      : adjacency_(adjacency),
        ring_(adjacency.vertices_of_vertex),
        frames_(frames),
        smoothness_(smoothness),
        constraints_(constraints),
        axes_(axes),
        options_(options),
        executor_(executor),
        holding_(holding),
        moved_(frames.size(), 0.0),
        iterations_(frames.size(), 0),
        is_due_(frames.size()) {
    for (index_t v = 0; v < frames.size(); ++v)
      if (holding.is_own(v) && constraints[v] != FrameConstraint::fixed && !ring_[v].empty()) free_.push_back(v);
  }

  SmoothingReport run() {
    SmoothingReport report;
    measure_smoothness();
    const std::int64_t n_free = holding_.total(static_cast<std::int64_t>(free_.size()));
    for (int sweep = 0; sweep < options_.max_sweeps && !report.converged; ++sweep) {
      const std::vector<index_t> order = due_vertices(sweep);
      const bool finished = visit_all(order, sweep);
      report.sweeps.push_back(report_of(order, n_free));
      report.converged = report.sweeps.back().largest_rotation < options_.global_tolerance;
      if (!finished) {
        report.status = Status::cancelled;
        break;
      }
    }
    if (!report.converged && report.status == Status::complete) report.status = Status::budget_exhausted;
    measure_smoothness();
    return report;
  }

private:
  void measure_smoothness() {
    const std::vector<double> values = frame_smoothness(adjacency_, frames_, executor_);
    std::copy(values.begin(), values.end(), smoothness_.begin());
    holding_.refresh(smoothness_);
  }

  /// Vertices that moved in the last sweep and their neighbours, those that moved least first; all in the first sweep.
  std::vector<index_t> due_vertices(int sweep) {
    const auto moves = [&](index_t w) { return moved_[w] > 0; };
    std::fill(is_due_.begin(), is_due_.end(), std::uint8_t{0});
    for (const index_t v : free_) is_due_[v] = sweep == 0 || moves(v) || std::ranges::any_of(ring_[v], moves);
    holding_.refresh(std::span(is_due_));
    std::vector<index_t> order;
    for (index_t v = 0; v < is_due_.size(); ++v)
      if (is_due_[v]) order.push_back(v);
    std::stable_sort(order.begin(), order.end(), [&](index_t v, index_t w) { return moved_[v] < moved_[w]; });
    return order;
  }

  /// Visits the vertices of a sweep, in stages without neighbours. @return false when the observer stops it.
  bool visit_all(std::span<const index_t> order, int sweep) {
    std::fill(moved_.begin(), moved_.end(), 0.0);
    VisitSchedule schedule(ring_, order, [&](index_t v) { return holding_.is_own(v); });
    const auto n_due = static_cast<double>(std::max<std::int64_t>(schedule.n_left(), 1));
    const auto goes_on = [&] {
      const double share = 1 - static_cast<double>(schedule.n_left()) / n_due;
      return keep_going(options_.observer, "smoothing", (sweep + share) / options_.max_sweeps);
    };
    bool going = true;
    std::vector<index_t> visited;
    for (std::int64_t n_left = 1; n_left > 0 && going; n_left = holding_.total(schedule.n_left())) {
      visited.clear();
      while (going && schedule.next_stage()) {
        const std::span<const index_t> members = schedule.stage();
        for_blocks(executor_, members.size(), 256, [&](std::size_t first, std::size_t last) {
          for (std::size_t i = first; i < last; ++i) visit(members[i]);
        });
        visited.insert(visited.end(), members.begin(), members.end());
        if (Holding::is_whole) going = goes_on();
      }
      for (const index_t v : holding_.pass_on(visited, frames_, smoothness_, std::span(moved_))) schedule.arrived(v);
      if (!Holding::is_whole) going = goes_on();
    }
    return going;
  }

  SweepReport report_of(std::span<const index_t> order, std::int64_t n_free) const {
    std::int64_t visits = 0, iterations = 0;
    double largest_rotation = 0;
    for (const index_t v : order) {
      if (!holding_.is_own(v)) continue;
      largest_rotation = std::max(largest_rotation, moved_[v]);
      iterations += iterations_[v];
      ++visits;
    }
    SweepReport report;
    report.largest_rotation = holding_.largest(largest_rotation);
    const auto n_visits = static_cast<double>(holding_.total(visits));
    report.local_iterations = n_visits > 0 ? static_cast<double>(holding_.total(iterations)) / n_visits : 0;
    report.skipped = n_free == 0 ? 0 : 1 - n_visits / static_cast<double>(n_free);
    return report;
  }

  double weight(index_t w, offset_t slot) const {
    double c = options_.edge_weights.empty() ? 1 : options_.edge_weights[slot];
    // On the boundary the frame is known, however rough its surroundings.
    if (options_.diffusivity == Diffusivity::variable && constraints_[w] == FrameConstraint::none &&
        smoothness_[w] < options_.smooth_threshold)
      c *= options_.rough_weight;
    return c;
  }

  /// Mean rotation that takes the frame of `v` to those of its neighbours.
  Vector3 mean_rotation(index_t v) const {
    Vector3 sum = Vector3::Zero();
    double total = 0;
    for (offset_t s = ring_.offsets[v]; s < ring_.offsets[v + 1]; ++s) {
      const double c = weight(ring_.values[s], s);
      sum += c * CubeRotationGroup<>::rotation_vector(frames_[v], frames_[ring_.values[s]]);
      total += c;
    }
    if (total > 0) sum /= total;
    if (constraints_[v] == FrameConstraint::axis) sum = axes_[v] * axes_[v].dot(sum);
    return sum;
  }

  void visit(index_t v) {
    const Quaternion start = frames_[v];
    std::uint8_t done = 0;
    while (done < options_.max_local_iterations) {
      ++done;
      const Vector3 rotation = mean_rotation(v);
      if (rotation.norm() < options_.local_tolerance) break;
      frames_[v] = (CubeRotationGroup<>::exponential(rotation) * frames_[v]).normalized();
    }
    iterations_[v] = done;
    moved_[v] = done == 1 ? 0 : CubeRotationGroup<>::angle(start, frames_[v]);
    smoothness_[v] = vertex_smoothness(v, ring_[v], frames_);
  }

  const TetAdjacency& adjacency_;
  const Csr<index_t>& ring_;
  std::span<Quaternion> frames_;
  std::span<double> smoothness_;
  std::span<const FrameConstraint> constraints_;
  std::span<const Vector3> axes_;
  const SmoothingOptions& options_;
  const E& executor_;
  const Holding& holding_;
  std::vector<index_t> free_;
  std::vector<double> moved_;             ///< rotation of the last visit, rad
  std::vector<std::uint8_t> iterations_;  ///< of the last visit; 0: skipped
  std::vector<std::uint8_t> is_due_;
};

}  // namespace detail

/// Smooths a field by turning each free frame to the mean of its neighbours', over and over.
///
/// Sweeps visit the vertices that moved least in the sweep before first; a vertex is skipped when neither it nor any
/// neighbour moved in that sweep. Neither makes nor removes singular lines: the start decides.
///
/// @param frames       n_vertices unit quaternions, changed in place.
/// @param smoothness   n_vertices values, brought up to date for every vertex.
/// @param constraints  fixed frames stay; those with an axis turn about it only (the axis in `axes` and in the frame).
/// @param executor     the visits of a sweep are grouped into stages without neighbours (a colouring that follows the
///                     order of visits), so the result is to the bit that of the serial order for any executor.
/// @tparam Holding     of the vertices: those of one's own are visited, and the halo's brought up to date.
/// @return what each sweep did; `cancelled` leaves a valid field.
/// @throws invalid_option  when a tolerance or a cap is not positive, or a count does not match.
/// @par Complexity   O(edges) a sweep.
/// @par Source       The paper, section 3.3, equations (2) to (5). Departs: the rotation is the mean and not the sum
///                   (which overshoots); neighbours with a constraint always have weight 1; sweeps and local iterations
///                   are capped.
template <Executor E = SerialExecutor, class Holding = detail::WholeMesh>
SmoothingReport smooth_frames(const TetAdjacency& adjacency, std::span<Quaternion> frames, std::span<double> smoothness,
                              std::span<const FrameConstraint> constraints, std::span<const Vector3> axes,
                              const SmoothingOptions& options = {}, const E& executor = {},
                              const Holding& holding = {}) {
  const std::size_t n = frames.size();
  check_options(options);
  if (smoothness.size() != n || constraints.size() != n || axes.size() != n || adjacency.n_vertices() != n ||
      (!options.edge_weights.empty() && options.edge_weights.size() != adjacency.vertices_of_vertex.values.size()))
    throw invalid_option("frames, constraints and weights are not those of one mesh");
  return detail::FrameSmoother(adjacency, frames, smoothness, constraints, axes, options, executor, holding).run();
}

#ifdef FRAMEHEX_COMPILED
extern template SmoothingReport smooth_frames(const TetAdjacency&, std::span<Quaternion>, std::span<double>,
                                              std::span<const FrameConstraint>, std::span<const Vector3>,
                                              const SmoothingOptions&, const ExecutorRef&, const detail::WholeMesh&);
#endif

}  // namespace framehex
