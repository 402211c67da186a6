// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/lattice/detail/axis_system.hpp"

#include <cmath>
#include <numbers>
#include <optional>

namespace framehex {

/// Asks a coordinate of a vertex to be near a value, but for whole numbers.
struct PhaseTarget {
  index_t vertex;
  std::uint8_t axis;
  double phase;
  double weight;  ///< beside those of the edges: length, host's unit
};

struct PhaseOptions {
  double tolerance = 1e-7;  ///< of the first solution: deep inside its amplitudes are small, and their phases count
  int max_iterations = 3000;
  int max_roundings = 6;  ///< solutions with fixed jumps, each followed by rounding the jumps anew
  Observer observer = {};
};

struct PhaseReport {
  std::size_t n_pinned = 0;      ///< parts that no boundary holds, of which one value was chosen
  std::size_t n_iterations = 0;  ///< of all solves
  std::size_t n_changed = 0;     ///< jumps that were still changing at the end
  double rms_residual = 0;       ///< of the edges, in steps
  Status status = Status::complete;
};

/// Finds the coordinates of a map to the integer lattice, each up to whole numbers: the phases of a periodic
/// parameterisation.
///
/// Neighbours' phases are to differ by the step along their edge; axes on the boundary have whole coordinates. A
/// complex number per vertex and axis makes that linear; diffusion with ever shorter steps and projection to unit length
/// spreads the phases where amplitudes are small; at last the whole jumps between neighbours are rounded and the
/// coordinates solved for as real numbers, until no jump changes.
///
/// Keeps what serves several solves over the same steps.
template <Executor E = SerialExecutor>
class PhaseSolver {
public:
  /// @param steps  per edge, of `lattice_steps` and `project_steps`.
  /// @param whole  per vertex: axes whose coordinate is whole, of `find_boundary_axes`.
  /// @param sizes  per vertex, host's unit.
  /// References are kept to all arguments.
  /// @throws invalid_option  when counts do not match.
  PhaseSolver(const LatticeGraph& graph, const std::vector<Vector3>& steps, std::span<const AxisMask> whole,
              std::span<const double> sizes, const PhaseOptions& options = {}, const E& executor = {})
      : graph_(graph),
        steps_(steps),
        fixed_(whole.begin(), whole.end()),
        options_(options),
        executor_(executor),
        waves_(graph, masses(graph, sizes)),
        coordinates_(graph, masses(graph, sizes)) {
    if (steps.size() != graph.n_edges() || whole.size() != graph.n_vertices())
      throw invalid_option("steps and masks are not one for each edge and vertex");
    integrate_along_tree();
    stiffness_.assign(graph.n_vertices(), 0.0);
    for (index_t e = 0; e < graph.n_edges(); ++e)
      for (const index_t v : graph.edges()[e]) stiffness_[v] += graph.weights()[e];
    waves_.set_couplings([&](index_t e) { return wave_coupling(e); });
    coordinates_.set_couplings([&](index_t e) -> Vector3 {
      const AxisMatching& m = graph_.matching(e);
      return -graph_.weights()[e] * Vector3(m.sign[0], m.sign[1], m.sign[2]);
    });
  }

  /// @param phases   receives coordinates per vertex and axis; whole, but for rounding, where `whole` says so.
  /// @param targets  further wishes.
  /// @par Complexity   O(edges * n^(1/6)) or so; results do not depend on the executor.
  PhaseReport solve(std::vector<Vector3>& phases, std::span<const PhaseTarget> targets = {}) {
    PhaseReport report;
    pinned_ = fixed_;
    report.n_pinned = pin_loose_parts(targets);
    set_diagonals(targets);
    if (!solve_waves(phases, targets) || !round_jumps(phases, targets, report)) report.status = Status::cancelled;
    report.n_iterations = waves_.n_iterations() + coordinates_.n_iterations();
    return report;
  }

private:
  using Waves = detail::AxisSystem<2>;
  using Wave = Waves::Value;
  static constexpr double turn = 2 * std::numbers::pi;

  static std::vector<double> masses(const LatticeGraph& graph, std::span<const double> sizes) {
    if (sizes.size() != graph.n_vertices()) throw invalid_option("there is not one size for each vertex");
    std::vector<double> result;
    for (std::size_t v = 0; v < sizes.size(); ++v) result.push_back(graph.volumes()[v] / (sizes[v] * sizes[v]));
    return result;
  }

  /// Coordinates along the tree of edges along which the frames are aligned: phases are solved for relative to these,
  /// so that neighbours have nearly equal ones and the solver's aggregates serve.
  void integrate_along_tree() {
    const std::size_t n = graph_.n_vertices();
    tree_.assign(n, Vector3::Zero());
    std::vector<std::uint8_t> reached(n, 0);
    std::vector<index_t> queue;
    for (index_t seed = 0; seed < n; ++seed) {
      if (reached[seed]) continue;
      reached[seed] = 1;
      queue.assign(1, seed);
      for (std::size_t i = 0; i < queue.size(); ++i) {
        const index_t v = queue[i];
        for (const index_t w : graph_.adjacency().vertices_of_vertex[v]) {
          if (reached[w]) continue;
          reached[w] = 1;
          const Vector3 there = tree_[v] + graph_.along(steps_, v, w);
          tree_[w] = graph_.matching(v, w).to_second(there);
          queue.push_back(w);
        }
      }
    }
  }

  /// What is left of a step when coordinates are counted from those along the tree, less its whole part.
  Vector3 gap(index_t e, const std::vector<Vector3>& coordinates) const {
    const auto [v, w] = graph_.edges()[e];
    return graph_.matching(e).to_first(coordinates[w]) - coordinates[v] - steps_[e];
  }

  Wave wave_coupling(index_t e) const {
    const Vector3 angle = turn * gap(e, tree_);
    Wave c;
    c.col(0) = graph_.weights()[e] * angle.array().cos();
    c.col(1) = graph_.weights()[e] * angle.array().sin();
    return c;
  }

  /// Sets of coordinates that hang together but touch no boundary may be shifted as a whole: one of each is pinned.
  std::size_t pin_loose_parts(std::span<const PhaseTarget> targets) {
    const std::size_t n = graph_.n_vertices();
    std::vector<index_t> parent(3 * n);
    for (index_t i = 0; i < parent.size(); ++i) parent[i] = i;
    const auto root = [&](index_t i) {
      while (parent[i] != i) i = parent[i] = parent[parent[i]];
      return i;
    };
    for (index_t e = 0; e < graph_.n_edges(); ++e) {
      const auto [v, w] = graph_.edges()[e];
      for (std::size_t a = 0; a < 3; ++a) {
        const index_t i = root(3 * v + static_cast<index_t>(a)), j = root(3 * w + graph_.matching(e).axis[a]);
        parent[std::max(i, j)] = std::min(i, j);
      }
    }
    std::vector<std::uint8_t> held(3 * n, 0);
    for (index_t v = 0; v < n; ++v)
      for (index_t a = 0; a < 3; ++a)
        if (fixed_[v] >> a & 1) held[root(3 * v + a)] = 1;
    for (const PhaseTarget& target : targets) held[root(3 * target.vertex + target.axis)] = 1;
    std::size_t n_pinned = 0;
    for (index_t i = 0; i < parent.size(); ++i) {
      if (root(i) != i || held[i]) continue;
      pinned_[i / 3] |= static_cast<AxisMask>(1 << i % 3);
      ++n_pinned;
    }
    return n_pinned;
  }

  void set_diagonals(std::span<const PhaseTarget> targets) {
    std::vector<Vector3> diagonal(graph_.n_vertices());
    for (std::size_t v = 0; v < diagonal.size(); ++v) diagonal[v].setConstant(stiffness_[v]);
    for (const PhaseTarget& target : targets) diagonal[target.vertex][target.axis] += target.weight;
    for (index_t v = 0; v < diagonal.size(); ++v) {
      waves_.set_diagonal(v, diagonal[v]);
      waves_.set_fixed(v, pinned_[v]);
      coordinates_.set_diagonal(v, diagonal[v]);
      coordinates_.set_fixed(v, pinned_[v]);
    }
    waves_.prepare();
    coordinates_.prepare();
  }

  auto proceed(double fraction) const {
    return [this, fraction] { return keep_going(options_.observer, "lattice", fraction); };
  }

  static void normalise(Waves::Values& x) {
    for (Wave& z : x)
      for (int a = 0; a < 3; ++a) {
        const double amplitude = z.row(a).norm();
        if (amplitude > 0)
          z.row(a) /= amplitude;
        else
          z.row(a) << 1, 0;
      }
  }

  bool solve_waves(std::vector<Vector3>& phases, std::span<const PhaseTarget> targets) {
    const std::size_t n = graph_.n_vertices();
    Waves::Values x(n, Wave::Zero()), load(n, Wave::Zero()), source(n);
    for (index_t v = 0; v < n; ++v)
      for (int a = 0; a < 3; ++a)
        if (pinned_[v] >> a & 1)
          x[waves_.row_of(v)].row(a) << std::cos(turn * tree_[v][a]), -std::sin(turn * tree_[v][a]);
    for (const PhaseTarget& t : targets) {
      const double angle = turn * (t.phase - tree_[t.vertex][t.axis]);
      load[waves_.row_of(t.vertex)].row(t.axis) += t.weight * Eigen::RowVector2d(std::cos(angle), std::sin(angle));
    }
    if (!waves_.solve(x, load, 0, options_.tolerance, options_.max_iterations, proceed(0.6), executor_)) return false;
    normalise(x);
    double done = 0.7;
    for (const double time : {64., 32., 16., 8., 4., 2., 1., 1.}) {  // quarters of the size's square
      const double factor = 4 / time;
      for (std::size_t row = 0; row < n; ++row) source[row] = load[row] + factor * waves_.mass(row) * x[row];
      if (!waves_.solve(x, source, factor, 1e-4, options_.max_iterations, proceed(done), executor_)) return false;
      normalise(x);
      done += 0.02;
    }
    phases.resize(n);
    for (index_t v = 0; v < n; ++v)
      for (int a = 0; a < 3; ++a) {
        const Wave& z = x[waves_.row_of(v)];
        const double u = tree_[v][a] + std::atan2(z(a, 1), z(a, 0)) / turn;
        phases[v][a] = pinned_[v] >> a & 1 ? std::round(u) : u;
      }
    return true;
  }

  static Vector3 rounded(const Vector3& x) { return x.array().round(); }

  bool round_jumps(std::vector<Vector3>& phases, std::span<const PhaseTarget> targets, PhaseReport& report) {
    const std::size_t n = graph_.n_vertices();
    std::vector<Vector3> jumps(graph_.n_edges()), load(n), x(n);
    const auto round_all = [&] {
      std::size_t n_changed = 0;
      for (index_t e = 0; e < jumps.size(); ++e) {
        const Vector3 jump = rounded(gap(e, phases));
        if (jump != jumps[e]) ++n_changed;
        jumps[e] = jump;
      }
      return n_changed;
    };
    round_all();
    for (int rounding = 0; rounding < options_.max_roundings; ++rounding) {
      std::fill(load.begin(), load.end(), Vector3::Zero());
      for (index_t e = 0; e < jumps.size(); ++e) {
        const auto [v, w] = graph_.edges()[e];
        const Vector3 pull = graph_.weights()[e] * (steps_[e] + jumps[e]);
        load[coordinates_.row_of(v)] -= pull;
        load[coordinates_.row_of(w)] += graph_.matching(e).to_second(pull);
      }
      for (const PhaseTarget& t : targets) {
        const double whole = std::round(phases[t.vertex][t.axis] - t.phase);
        load[coordinates_.row_of(t.vertex)][t.axis] += t.weight * (t.phase + whole);
      }
      for (index_t v = 0; v < n; ++v) x[coordinates_.row_of(v)] = phases[v];
      const double done = 0.86 + 0.02 * rounding;
      if (!coordinates_.solve(x, load, 0, 1e-7, options_.max_iterations, proceed(done), executor_)) return false;
      for (index_t v = 0; v < n; ++v) phases[v] = x[coordinates_.row_of(v)];
      report.n_changed = round_all();
      if (report.n_changed == 0) break;
    }
    double sum = 0;
    for (index_t e = 0; e < jumps.size(); ++e) sum += (gap(e, phases) - jumps[e]).squaredNorm();
    report.rms_residual = std::sqrt(sum / static_cast<double>(std::max<std::size_t>(3 * jumps.size(), 1)));
    return true;
  }

  const LatticeGraph& graph_;
  const std::vector<Vector3>& steps_;
  std::vector<AxisMask> fixed_, pinned_;
  PhaseOptions options_;
  const E& executor_;
  std::vector<Vector3> tree_;
  std::vector<double> stiffness_;
  Waves waves_;
  detail::AxisSystem<1> coordinates_;
};

}  // namespace framehex
