// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/field/laplace_solver.hpp"
#include "framehex/field/quartic_frame.hpp"

namespace framehex {

struct DiffusionOptions {
  int max_steps = 12;       ///< of diffusion and projection after the harmonic start
  double tolerance = 1e-4;  ///< relative, of the linear solves
  double time_factor = 50;  ///< step k lasts time_factor / (k^3 lambda), lambda the first eigenvalue
  double settled = 1e-3;    ///< stops when the mean change of a step falls below (rad, root mean square)
  Observer observer = {};
};

struct DiffusionReport {
  int steps = 0;
  Status status = Status::complete;
};

namespace detail {

/// The field as nine coefficients per vertex, under its constraints.
template <class E>
class FrameDiffusion {
public:
  FrameDiffusion(const TetAdjacency& adjacency, std::span<const Vector3> points, std::span<Quaternion> frames,
                 std::span<const FrameConstraint> constraints, std::span<const Vector3> axes,
                 const DiffusionOptions& options, const E& executor)
      : system_(adjacency, points),
        frames_(frames),
        constraints_(constraints),
        axes_(axes),
        options_(options),
        executor_(executor),
        values_(frames.size()) {
    slot_.assign(frames.size(), no_index);
    for (std::size_t v = 0; v < frames.size(); ++v)
      if (constraints[v] == FrameConstraint::axis) {
        slot_[v] = static_cast<index_t>(circles_.size());
        circles_.emplace_back(frames[v], axes[v]);
      }
  }

  /// Least Dirichlet energy of the coefficients under the constraints, then the nearest frames.
  bool harmonic() {
    encode();
    if (!solve(0, 0, 0.5)) return false;
    return project(true) >= 0;
  }

  DiffusionReport diffuse() {
    DiffusionReport report;
    const double eigenvalue = first_eigenvalue(system_, constraints_, executor_);
    for (int k = 1; k <= options_.max_steps; ++k) {
      encode();
      const double time = options_.time_factor / (k * k * k * eigenvalue);
      if (!solve(1 / time, 0.5 + 0.5 * (k - 1) / options_.max_steps, 0.5 + 0.5 * k / options_.max_steps)) {
        report.status = Status::cancelled;
        return report;
      }
      const double change = project(false);
      report.steps = k;
      if (change < options_.settled) break;
    }
    return report;
  }

private:
  void encode() {
    for_blocks(executor_, values_.size(), block_size, [&](std::size_t first, std::size_t last) {
      for (std::size_t v = first; v < last; ++v) values_[v] = frame_quartic(frames_[v]);
    });
  }

  bool solve(double mass_factor, double progress_from, double progress_to) {
    const std::vector<Quartic> source = mass_factor > 0 ? values_ : std::vector<Quartic>{};
    const auto load = [&](std::size_t v) -> Quartic {
      return mass_factor > 0 ? Quartic(mass_factor * system_.masses[v] * source[v]) : Quartic(Quartic::Zero());
    };
    const auto restrict = [&](std::size_t v, Quartic& value) {
      if (constraints_[v] == FrameConstraint::fixed) {
        value.setZero();
      } else if (constraints_[v] == FrameConstraint::axis) {
        const AxisQuartics& c = circles_[slot_[v]];
        // cosine and sine have the squared length 5/12.
        value = c.cosine * (c.cosine.dot(value) * 2.4) + c.sine * (c.sine.dot(value) * 2.4);
      }
    };
    const auto proceed = [&](int iteration) {
      const double within = 1 - 1 / (1 + iteration / 50.0);
      return keep_going(options_.observer, "frame field", progress_from + within * (progress_to - progress_from));
    };
    return solve_laplace(system_, values_, load, restrict, proceed,
                         {.mass_factor = mass_factor, .tolerance = options_.tolerance},
                         executor_) != SolveStatus::cancelled;
  }

  /// Nearest frames of the coefficients. @return the root mean square of the change, rad.
  double project(bool anew) {
    std::vector<double> changes(values_.size(), 0.0);
    for_blocks(executor_, values_.size(), block_size, [&](std::size_t first, std::size_t last) {
      for (std::size_t v = first; v < last; ++v) {
        if (constraints_[v] == FrameConstraint::fixed) continue;
        const Quaternion before = frames_[v];
        if (constraints_[v] == FrameConstraint::axis)
          frames_[v] = circles_[slot_[v]].nearest(values_[v], axes_[v]);
        else
          frames_[v] = anew ? nearest_frame(values_[v]) : nearest_frame(values_[v], before);
        changes[v] = CubeRotationGroup<>::angle(before, frames_[v]);
      }
    });
    double sum = 0, mass = 0;
    for (std::size_t v = 0; v < changes.size(); ++v) {
      sum += system_.masses[v] * changes[v] * changes[v];
      mass += system_.masses[v];
    }
    return mass > 0 ? std::sqrt(sum / mass) : 0;
  }

  LaplaceSystem system_;
  std::span<Quaternion> frames_;
  std::span<const FrameConstraint> constraints_;
  std::span<const Vector3> axes_;
  const DiffusionOptions& options_;
  const E& executor_;
  std::vector<Quartic> values_;
  std::vector<index_t> slot_;          ///< vertex -> circle
  std::vector<AxisQuartics> circles_;  ///< of the vertices with an axis
};

}  // namespace detail

}  // namespace framehex
