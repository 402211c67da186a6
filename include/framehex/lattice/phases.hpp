// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/lattice/detail/axis_system.hpp"
#include "framehex/lattice/detail/boundary_charts.hpp"

#include <cmath>
#include <limits>
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

/// When the parts of the boundary on which a coordinate is constant are put on whole numbers.
enum class ChartRounding {
  first,  ///< before anything is solved for: phases are whole there
  last    ///< when the jumps between neighbours are known: each part is moved as a whole
};

/// Options of `PhaseSolver`.
struct PhaseOptions {
  double reach = 128;  ///< > 0, sizes: distance over which phases are spread at first; then ever less, to half a size
  double next_reach = 32;   ///< > 0, sizes: the same for solutions that start from the last one
  double tolerance = 1e-3;  ///< of the coordinates
  int max_iterations = 3000;
  int max_roundings = 6;  ///< solutions with fixed jumps, each followed by rounding the jumps anew
  Observer observer = {};

  template <class Options, class Visit>
  static void each_number(Options& o, Visit&& visit) {
    visit("PhaseOptions::reach", o.reach, least_positive, 1e6);
    visit("PhaseOptions::next_reach", o.next_reach, least_positive, 1e6);
    visit("PhaseOptions::tolerance", o.tolerance, least_positive, 1);
    visit("PhaseOptions::max_iterations", o.max_iterations, 0, unbounded);
    visit("PhaseOptions::max_roundings", o.max_roundings, 1, unbounded);
  }
};

/// How a solve for phases went.
struct PhaseReport {
  std::size_t n_pinned = 0;      ///< parts that no boundary holds, of which one value was chosen
  std::size_t n_charts = 0;      ///< parts of the boundary on which a coordinate is constant
  std::size_t n_iterations = 0;  ///< of all solves
  std::size_t n_changed = 0;     ///< jumps that were still changing at the end
  double rms_residual = 0;       ///< of the edges, in steps
  Status status = Status::complete;
};

/// Finds the coordinates of a map to the integer lattice, each up to whole numbers: the phases of a periodic
/// parameterisation.
///
/// Neighbours' phases are to differ by the step along their edge. A complex number of unit length per vertex and axis
/// makes that linear: diffusion over ever shorter distances, each followed by projection to unit length, brings the
/// phases into step. Then the whole jumps between neighbours are rounded and the coordinates solved for as real numbers,
/// until no jump changes.
///
/// An extent of n + 1/2 steps could be rounded up in one half of a body and down in the other. With
/// `ChartRounding::last` the parts of the boundary on which a coordinate is constant stand free between two whole
/// numbers; only at the end, with the jumps kept, these charts are rounded, those nearest to a whole number first, and
/// the map follows: one decision a chart. The price is that the map is bent where it has already found its lines.
///
/// Keeps what serves several solves over the same steps; each starts from the last one.
template <Executor E = SerialExecutor>
class PhaseSolver {
public:
  /// @param steps  per edge, of `lattice_steps` and `project_steps`.
  /// @param whole  per vertex: axes whose coordinate is whole, of `find_boundary_axes`.
  /// @param tangent  per edge: components without a step, of `tangent_edges`.
  /// @param sizes  per vertex, host's unit.
  /// References are kept to all arguments.
  /// @throws invalid_option  when counts do not match.
  PhaseSolver(const LatticeGraph& graph, const std::vector<Vector3>& steps, std::span<const AxisMask> whole,
              std::span<const AxisMask> tangent, std::span<const double> sizes, const PhaseOptions& options = {},
              const E& executor = {})
      : graph_(graph),
        steps_(steps),
        tangent_(tangent),
        charts_(graph, whole, tangent),
        options_(options),
        executor_(executor),
        waves_(graph, masses(graph, sizes)),
        coordinates_(graph, masses(graph, sizes)) {
    if (steps.size() != graph.n_edges() || tangent.size() != steps.size() || whole.size() != graph.n_vertices())
      throw invalid_option("steps and masks are not one for each edge and vertex");
    check_options(options_);
    integrate_along_tree();
    stiffness_ = detail::chart_stiffness(graph, tangent);
    waves_.set_couplings([&](index_t e) { return wave_coupling(e); });
    coordinates_.set_couplings([&](index_t e) { return detail::chart_coupling(graph_, tangent_, e); });
  }

  /// @param phases   receives coordinates per vertex and axis; whole, but for rounding, where `whole` says so.
  /// @param targets  further wishes.
  /// @par Complexity   O(edges * n^(1/6)) or so; results do not depend on the executor.
  PhaseReport solve(std::vector<Vector3>& phases, std::span<const PhaseTarget> targets = {},
                    ChartRounding charts = ChartRounding::last) {
    PhaseReport report;
    report.n_charts = charts_.charts.size();
    report.n_pinned = pin_parts(targets, charts);
    set_diagonals(targets);
    scale_ = 0;
    if (!solve_waves(phases, targets) || !round_jumps(phases, targets, report) || !round_charts(phases, targets) ||
        !solve_coordinates(phases, targets, options_.tolerance, 0.99))
      report.status = Status::cancelled;
    else
      report.rms_residual = rms_residual(phases);
    report.n_iterations = waves_.n_iterations() + coordinates_.n_iterations();
    return report;
  }

  /// For those who work between two solves. @return false when the observer has cancelled.
  bool going() { return proceed(0)(); }

private:
  using Waves = detail::AxisSystem<2>;
  using Wave = Waves::Value;
  using Reals = detail::AxisSystem<1>;
  static constexpr double turn = 2 * std::numbers::pi;
  static constexpr double rough = 1e-2;  // tolerance of solutions that are only rounded

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

  Waves::Entry wave_coupling(index_t e) const {
    const Vector3 angle = turn * gap(e, tree_);
    Waves::Entry c;
    c.col(0) = -weight(e).array() * angle.array().cos();
    c.col(1) = -weight(e).array() * angle.array().sin();
    return c;
  }

  Vector3 weight(index_t e) const { return detail::chart_weights(graph_, tangent_, e); }

  /// Sets of coordinates that hang together may be shifted as a whole: of each the largest chart is put on 0, or one
  /// value where there is none. @return number of the latter.
  std::size_t pin_parts(std::span<const PhaseTarget> targets, ChartRounding charts) {
    const std::size_t n = graph_.n_vertices();
    const detail::AxisSets parts = detail::connected_axes(graph_);
    std::vector<index_t> largest(3 * n, no_index);  // chart of each part, by its root
    chart_is_fixed_.assign(charts_.charts.size(), 0);
    for (index_t c = 0; c < charts_.charts.size(); ++c) {
      index_t& best = largest[parts.root(charts_.charts[c][0].node).first];
      if (best == no_index || charts_.charts[c].size() > charts_.charts[best].size()) best = c;
    }
    std::vector<std::uint8_t> held(3 * n, 0);
    for (const PhaseTarget& target : targets) held[parts.root(3 * target.vertex + target.axis).first] = 1;
    pinned_.assign(n, 0);
    if (charts == ChartRounding::first)
      for (index_t c = 0; c < charts_.charts.size(); ++c) fix(c);
    std::size_t n_pinned = 0;
    for (index_t i = 0; i < 3 * n; ++i) {
      if (parts.root(i).first != i) continue;
      if (largest[i] != no_index) {
        if (charts == ChartRounding::last) fix(largest[i]);
      } else if (!held[i]) {
        pinned_[i / 3] |= static_cast<AxisMask>(1 << i % 3);
        ++n_pinned;
      }
    }
    return n_pinned;
  }

  void fix(index_t chart) {
    chart_is_fixed_[chart] = 1;
    for (const auto& member : charts_.charts[chart])
      pinned_[member.node / 3] |= static_cast<AxisMask>(1 << member.node % 3);
  }

  void set_diagonals(std::span<const PhaseTarget> targets) {
    std::vector<Vector3> diagonal(graph_.n_vertices());
    for (std::size_t v = 0; v < diagonal.size(); ++v) diagonal[v] = stiffness_[v];
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

  auto proceed(double fraction) {
    furthest_ = std::max(furthest_, fraction);  // of several solves the later ones have come no less far
    return [this] { return keep_going(options_.observer, "lattice", furthest_); };
  }

  void normalise() {
    for (Wave& z : x_)
      for (int a = 0; a < 3; ++a) {
        const float amplitude = z.row(a).matrix().norm();
        if (amplitude > 0)
          z.row(a) /= amplitude;
        else
          z.row(a) << 1, 0;
      }
  }

  /// Spreads the phases over ever shorter distances from all values at once, each of unit length: amplitudes do not
  /// count, wherever phases disagree.
  bool solve_waves(std::vector<Vector3>& phases, std::span<const PhaseTarget> targets) {
    const std::size_t n = graph_.n_vertices();
    const bool first = x_.empty();
    Waves::Values load(n, Wave::Zero()), source(n);
    if (first) {
      x_.assign(n, Wave::Zero());
      for (Wave& z : x_) z.col(0) << 1, 1, 1, 0;
    }
    for (index_t v = 0; v < n; ++v)
      for (int a = 0; a < 3; ++a)
        if (pinned_[v] >> a & 1) x_[waves_.row_of(v)].row(a) = wave(-tree_[v][a]);
    for (const PhaseTarget& t : targets)
      load[waves_.row_of(t.vertex)].row(t.axis) +=
          static_cast<float>(t.weight) * wave(t.phase - tree_[t.vertex][t.axis]);
    constexpr double wave_tolerance = 3e-3;
    double done = 0.6;
    for (double reach = first ? options_.reach : options_.next_reach; reach >= 0.5; reach /= 4) {
      const double factor = 1 / (reach * reach);
      for (std::size_t row = 0; row < n; ++row)
        source[row] = load[row] + static_cast<float>(factor) * waves_.mass(row) * x_[row];
      if (!waves_.solve(x_, source, factor, wave_tolerance, options_.max_iterations, proceed(done), executor_))
        return false;
      normalise();
      done += 0.04;
    }
    phases.resize(n);
    for (index_t v = 0; v < n; ++v)
      for (int a = 0; a < 3; ++a) {
        const Wave& z = x_[waves_.row_of(v)];
        const double u = tree_[v][a] + std::atan2(z(a, 1), z(a, 0)) / turn;
        phases[v][a] = pinned_[v] >> a & 1 ? std::round(u) : u;
      }
    return true;
  }

  static Eigen::Array<float, 1, 2> wave(double phase) {
    return {static_cast<float>(std::cos(turn * phase)), static_cast<float>(std::sin(turn * phase))};
  }

  /// Solves for the coordinates with the jumps as they are, by a correction.
  bool solve_coordinates(std::vector<Vector3>& phases, std::span<const PhaseTarget> targets, double tolerance,
                         double done) {
    const std::size_t n = graph_.n_vertices();
    std::vector<Vector3> pull(n, Vector3::Zero());
    for (index_t e = 0; e < jumps_.size(); ++e) {
      const auto [v, w] = graph_.edges()[e];
      const Vector3 force = weight(e).cwiseProduct(gap(e, phases) - jumps_[e]);
      pull[v] += force;
      pull[w] -= graph_.matching(e).to_second(force);
    }
    for (const PhaseTarget& t : targets) {
      const double miss = t.phase - phases[t.vertex][t.axis];
      pull[t.vertex][t.axis] += t.weight * (miss - std::round(miss));
    }
    Reals::Values x(n, Reals::Value::Zero()), load(n);
    for (index_t v = 0; v < n; ++v) load[coordinates_.row_of(v)] = Reals::lanes(pull[v]);
    if (!coordinates_.solve(x, load, 0, tolerance, options_.max_iterations, proceed(done), executor_, scale_))
      return false;
    scale_ = std::max(scale_, coordinates_.start());
    for (index_t v = 0; v < n; ++v) phases[v] += Reals::vector(x[coordinates_.row_of(v)]);
    return true;
  }

  bool round_jumps(std::vector<Vector3>& phases, std::span<const PhaseTarget> targets, PhaseReport& report) {
    jumps_.resize(graph_.n_edges());
    const auto round_all = [&] {
      std::size_t n_changed = 0;
      for (index_t e = 0; e < jumps_.size(); ++e) {
        const Vector3 jump = gap(e, phases).array().round();
        if (jump != jumps_[e]) ++n_changed;
        jumps_[e] = jump;
      }
      return n_changed;
    };
    round_all();
    for (int rounding = 0; rounding < options_.max_roundings; ++rounding) {
      if (!solve_coordinates(phases, targets, rough, 0.86 + 0.02 * rounding)) return false;
      report.n_changed = round_all();
      if (report.n_changed == 0) break;
    }
    return true;
  }

  double rms_residual(const std::vector<Vector3>& phases) const {
    double sum = 0;
    for (index_t e = 0; e < jumps_.size(); ++e) sum += (gap(e, phases) - jumps_[e]).squaredNorm();
    return std::sqrt(sum / static_cast<double>(std::max<std::size_t>(3 * jumps_.size(), 1)));
  }

  using Members = std::span<const detail::BoundaryCharts::Member>;

  double coordinate(const std::vector<Vector3>& phases, const detail::BoundaryCharts::Member& member) const {
    const double u = phases[member.node / 3][member.node % 3];
    return member.against ? -u : u;
  }

  /// How far a chart is above the nearest whole number. Across cuts its members differ by whole numbers.
  double excess(const std::vector<Vector3>& phases, Members chart) const {
    const double first = coordinate(phases, chart[0]);
    double sum = 0;
    for (const auto& member : chart) {
      const double difference = coordinate(phases, member) - first;
      sum += difference - std::round(difference);
    }
    const double mean = first + sum / static_cast<double>(chart.size());
    return mean - std::round(mean);
  }

  /// Moves charts to whole numbers, those nearest to one first; the others answer before their turn comes.
  bool round_charts(std::vector<Vector3>& phases, std::span<const PhaseTarget> targets) {
    constexpr double batch = 0.25, margin = 0.05;  // steps: clear cases at once, then those that are much alike
    const std::size_t n_charts = charts_.charts.size();
    std::vector<double> excesses(n_charts);
    while (true) {  // each time at least the chart nearest to a whole number is fixed
      double least = 1;
      for (index_t c = 0; c < n_charts; ++c) {
        if (chart_is_fixed_[c]) continue;
        excesses[c] = excess(phases, charts_.charts[c]);
        least = std::min(least, std::abs(excesses[c]));
      }
      if (least == 1) return true;
      for (index_t c = 0; c < n_charts; ++c) {
        if (chart_is_fixed_[c] || std::abs(excesses[c]) > std::max(batch, least + margin)) continue;
        fix(c);
        for (const auto& member : charts_.charts[c]) {
          double& u = phases[member.node / 3][member.node % 3];
          u = std::round(u - (member.against ? -excesses[c] : excesses[c]));
        }
      }
      for (index_t v = 0; v < pinned_.size(); ++v) coordinates_.set_fixed(v, pinned_[v]);
      coordinates_.prepare();
      if (!solve_coordinates(phases, targets, rough, 0.98)) return false;
    }
  }

  const LatticeGraph& graph_;
  const std::vector<Vector3>& steps_;
  std::span<const AxisMask> tangent_;
  detail::BoundaryCharts charts_;
  std::vector<std::uint8_t> chart_is_fixed_;
  std::vector<AxisMask> pinned_;
  double furthest_ = 0;
  double scale_ = 0;  // of the residuals: the largest at the start of a solution
  PhaseOptions options_;
  const E& executor_;
  std::vector<Vector3> tree_;
  std::vector<Vector3> stiffness_, jumps_;
  Waves waves_;
  Reals coordinates_;
  Waves::Values x_;  // of the last solution
};

}  // namespace framehex
