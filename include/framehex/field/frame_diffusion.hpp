// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/field/detail/laplace_solver.hpp"
#include "framehex/field/quartic_frame.hpp"
#include "framehex/option_ranges.hpp"

namespace framehex {

/// What the diffusion starts from.
enum class DiffusionStart {
  harmonic,  ///< the smoothest coefficients under the constraints, whatever the frames were
  current,   ///< the frames as they are
};

/// Options of `diffuse_frames`.
struct DiffusionOptions {
  DiffusionStart start = DiffusionStart::harmonic;
  int max_steps = 20;  ///< >= 0; of diffusion and projection after the start; 0: the start only
  double time_factor =
      200;                  ///< > 0; step k lasts time_factor / (k^3 lambda), lambda the first eigenvalue of the domain
  double settled = 1e-3;    ///< >= 0; ends when the root mean square of the change of a short step is less (rad)
  double tolerance = 1e-3;  ///< > 0 to 1; of the linear solves, root mean square relative to the coefficients' length
  Observer observer = {};

  template <class Options, class Visit>
  static void each_number(Options& o, Visit&& visit) {
    visit("DiffusionOptions::max_steps", o.max_steps, 0, 1e9);
    visit("DiffusionOptions::time_factor", o.time_factor, least_positive, largest_finite);
    visit("DiffusionOptions::settled", o.settled, 0, unbounded);
    visit("DiffusionOptions::tolerance", o.tolerance, least_positive, 1);
  }
};

/// How `diffuse_frames` went.
struct DiffusionReport {
  int steps = 0;                     ///< of diffusion and projection
  double last_change = 0;            ///< root mean square of the last, rad
  Status status = Status::complete;  ///< budget_exhausted: `max_steps` without settling
};

namespace detail {

/// The field as nine coefficients per vertex, under its constraints; numbered by the rows of the Laplacian.
template <class E, class Holding>
class FrameDiffusion {
  using Coefficients = Eigen::Matrix<float, 9, 1>;

public:
  FrameDiffusion(const TetAdjacency& adjacency, std::span<const Vector3> points, std::span<Quaternion> frames,
                 std::span<const FrameConstraint> constraints, std::span<const Vector3> axes,
                 const DiffusionOptions& options, const E& executor, const Holding& holding)
      : system_(adjacency, points, holding),
        aggregates_(system_, [&](std::size_t row) { return freedom(constraints[system_.order[row]]); }),
        frames_(frames),
        constraints_(constraints),
        axes_(axes),
        options_(options),
        executor_(executor),
        values_(frames.size(), Coefficients::Zero()),
        source_(system_.n_own()),
        slot_(system_.n_own(), no_index) {
    for (std::size_t row = 0; row < slot_.size(); ++row) {
      const index_t v = system_.order[row];
      if (constraints[v] != FrameConstraint::axis) continue;
      slot_[row] = static_cast<index_t>(circles_.size());
      circles_.emplace_back(frames[v], axes[v]);
    }
  }

  DiffusionReport run() {
    DiffusionReport report;
    report.status = Status::cancelled;
    const auto eigenvalue = first_eigenvalue(
        system_, constraints_, [this](int) { return keep_going(options_.observer, "frame field", 0); }, executor_);
    if (!eigenvalue) return report;
    eigenvalue_ = *eigenvalue;
    encode();
    std::copy(source_.begin(), source_.end(), values_.begin());
    if (options_.start == DiffusionStart::harmonic) {
      if (!solve(0, 0, 0.4)) return report;
      report.last_change = project(DiffusionStart::harmonic, 0.4);
      if (cancelled_) return report;
    }
    bool settled = false;
    for (int k = 1; k <= options_.max_steps && !settled; ++k) {
      encode();
      const double time = options_.time_factor / (k * k * k * eigenvalue_);
      const double share = 0.6 / options_.max_steps;
      if (!solve(1 / time, 0.4 + share * (k - 1), 0.4 + share * k)) return report;
      report.last_change = project(DiffusionStart::current, 0.4 + share * k);
      if (cancelled_) return report;
      report.steps = k;
      // A step longer than 1 / lambda gives the harmonic coefficients again, whatever the field was: that it changes
      // nothing says nothing of the next.
      settled = options_.time_factor < k * k * k && report.last_change < options_.settled;
    }
    report.status = settled || options_.max_steps == 0 ? Status::complete : Status::budget_exhausted;
    return report;
  }

private:
  /// Share of the nine coefficients that a constraint leaves free.
  static double freedom(FrameConstraint constraint) {
    return constraint == FrameConstraint::fixed ? 0 : constraint == FrameConstraint::axis ? 2. / 9 : 1;
  }

  /// The frames as the source of the next solve, which starts from the values of the last: they are nearer.
  void encode() {
    for_blocks(executor_, source_.size(), block_size, [&](std::size_t first, std::size_t last) {
      for (std::size_t row = first; row < last; ++row)
        source_[row] = frame_quartic(frames_[system_.order[row]]).template cast<float>();
    });
  }

  bool solve(double mass_factor, double progress_from, double progress_to) {
    const double squares = sum_of_rows(
        system_, executor_, [&](std::size_t row) { return system_.masses[row] * source_[row].squaredNorm(); });
    const auto load = [&](std::size_t row) -> Coefficients {
      if (mass_factor == 0) return Coefficients::Zero();
      return static_cast<float>(mass_factor * system_.masses[row]) * source_[row];
    };
    const auto restrict = [&](std::size_t row, Coefficients& value) {
      const FrameConstraint constraint = constraints_[system_.order[row]];
      if (constraint == FrameConstraint::fixed) {
        value.setZero();
      } else if (constraint == FrameConstraint::axis) {
        const AxisQuartics& c = circles_[slot_[row]];
        const Quartic wide = value.template cast<double>();
        // cosine and sine have the squared length 5/12.
        value = (c.cosine * (c.cosine.dot(wide) * 2.4) + c.sine * (c.sine.dot(wide) * 2.4)).template cast<float>();
      }
    };
    const auto proceed = [&](int iteration) {
      const double within = 1 - 1 / (1 + iteration / 50.0);
      return keep_going(options_.observer, "frame field", progress_from + within * (progress_to - progress_from));
    };
    return solve_laplace(system_, aggregates_, values_, load, restrict, proceed,
                         {.mass_factor = mass_factor,
                          .tolerance = options_.tolerance,
                          .energy = (eigenvalue_ + mass_factor) * squares},
                         executor_) != SolveStatus::cancelled;
  }

  /// Nearest frames of the coefficients. @return the root mean square of the change, rad.
  double project(DiffusionStart start, double progress) {
    const StoppableExecutor heard(executor_, [&] {
      // Shared observers are asked by all holders at once, which are not equally often here.
      if (Holding::is_whole) cancelled_ = !keep_going(options_.observer, "frame field", progress);
      return cancelled_;
    });
    std::vector<double> changes(source_.size(), 0.0);
    for_blocks(heard, source_.size(), block_size, [&](std::size_t first, std::size_t last) {
      for (std::size_t row = first; row < last; ++row) {
        const index_t v = system_.order[row];
        if (constraints_[v] == FrameConstraint::fixed) continue;
        const Quaternion before = frames_[v];
        const Quartic q = values_[row].template cast<double>();
        if (constraints_[v] == FrameConstraint::axis)
          frames_[v] = circles_[slot_[row]].nearest(q, axes_[v]);
        else
          frames_[v] = start == DiffusionStart::harmonic ? nearest_frame(q) : nearest_frame(q, before);
        changes[row] = CubeRotationGroup<>::angle(before, frames_[v]);
      }
    });
    const auto squared = [&](std::size_t row) { return system_.masses[row] * changes[row] * changes[row]; };
    const double sum = sum_of_rows(system_, executor_, squared);
    const double mass = sum_of_rows(system_, executor_, [&](std::size_t row) { return system_.masses[row]; });
    return mass > 0 ? std::sqrt(sum / mass) : 0;
  }

  LaplaceSystem<Holding> system_;
  RowAggregates aggregates_;
  std::span<Quaternion> frames_;
  std::span<const FrameConstraint> constraints_;
  std::span<const Vector3> axes_;
  const DiffusionOptions& options_;
  const E& executor_;
  double eigenvalue_ = 0;   ///< the first of the domain
  bool cancelled_ = false;  ///< in a projection
  std::vector<Coefficients> values_, source_;
  std::vector<index_t> slot_;          ///< row -> circle
  std::vector<AxisQuartics> circles_;  ///< of the vertices with an axis
};

}  // namespace detail

/// Finds the field of few singular lines: the smoothest harmonic quartics under the constraints, the nearest frame of
/// each, then rounds of diffusion and projection with ever shorter steps.
///
/// @param points, frames, constraints, axes  n_vertices each; frames are changed in place. A frame whose constraint is
///                     an axis must have it, exactly, among its own.
/// @param executor     results do not depend on it.
/// @return cancelled leaves a valid field, that of the last step or between it and the next.
/// @throws invalid_option  when a number is negative or counts do not match.
/// @par Complexity   O(edges * n^(1/6)) for the start, O(edges) per step, at small constants; about 250 bytes a vertex
///                   and 16 an edge. No matrix is stored or factorised.
/// @par Source       Ray, Sokolov, Levy, ACM Trans. Graph. 35 (2016) 233, for the start; Palmer, Bommes, Solomon, ACM
///                   Trans. Graph. 39 (2020), section 5 (modified Merriman-Bence-Osher), for the steps. Departs:
///                   conjugate gradients on the constrained subspace instead of a factorisation, which at a million
///                   tetrahedra takes several gigabytes.
///
/// @tparam Holding     of the vertices; those of one's own are changed, and the halo's brought up to date.
template <Executor E = SerialExecutor, class Holding = detail::WholeMesh>
DiffusionReport diffuse_frames(const TetAdjacency& adjacency, std::span<const Vector3> points,
                               std::span<Quaternion> frames, std::span<const FrameConstraint> constraints,
                               std::span<const Vector3> axes, const DiffusionOptions& options = {},
                               const E& executor = {}, const Holding& holding = {}) {
  check_options(options);
  const std::size_t n = adjacency.n_vertices();
  if (points.size() != n || frames.size() != n || constraints.size() != n || axes.size() != n)
    throw invalid_option("frames and constraints are not those of one mesh");
  detail::FrameDiffusion<E, Holding> diffusion(adjacency, points, frames, constraints, axes, options, executor,
                                               holding);
  const DiffusionReport report = diffusion.run();
  holding.refresh(frames);
  return report;
}

#ifdef FRAMEHEX_COMPILED
extern template DiffusionReport diffuse_frames(const TetAdjacency&, std::span<const Vector3>, std::span<Quaternion>,
                                               std::span<const FrameConstraint>, std::span<const Vector3>,
                                               const DiffusionOptions&, const ExecutorRef&, const detail::WholeMesh&);
#endif

}  // namespace framehex
