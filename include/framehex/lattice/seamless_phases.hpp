// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/lattice/detail/axis_system.hpp"
#include "framehex/lattice/detail/boundary_charts.hpp"
#include "framehex/lattice/detail/jump_sheets.hpp"
#include "framehex/lattice/detail/nearest_whole.hpp"
#include "framehex/lattice/singular_phases.hpp"

namespace framehex {

/// Options of `solve_seamless_phases`.
struct SeamlessOptions {
  std::size_t most_unknowns = 64;  ///< whole numbers to be chosen; the cost grows with them, and noisy fields have many
  double line_weight = 0.5;        ///< >= 0: of the wish that singular lines lie where the field has them
  double most_bent = 0.05;  ///< 0 to 1: share of the volume in which steps may be far from the size (`bent_volume`)
  double tolerance = 1e-4;
  int max_iterations = 3000;
  Observer observer = {};

  template <class Options, class Visit>
  static void each_number(Options& o, Visit&& visit) {
    visit("SeamlessOptions::most_unknowns", o.most_unknowns, 0, 4096);
    visit("SeamlessOptions::line_weight", o.line_weight, 0, largest_finite);
    visit("SeamlessOptions::most_bent", o.most_bent, 0, 1);
    visit("SeamlessOptions::tolerance", o.tolerance, least_positive, 1);
    visit("SeamlessOptions::max_iterations", o.max_iterations, 0, unbounded);
  }
};

/// How a seamless map was found.
struct SeamlessReport {
  std::size_t n_unknowns = 0;  ///< whole numbers that the field leaves free
  bool solved = false;         ///< false: they are more than were asked for, or the map is bent too much
  double bent_volume = 0;      ///< share of the volume in which a step is longer than 1.8 sizes or shorter than 1/1.8
  double rms_residual = 0;     ///< of the edges, in steps
  Status status = Status::complete;
};

namespace detail {

/// Solves for coordinates and whole numbers.
template <class E>
class SeamlessSolver {
public:
  SeamlessSolver(const LatticeGraph& graph, const std::vector<Vector3>& steps, const SingularLines& lines,
                 const BoundaryAxes& boundary, std::span<const AxisMask> tangent, std::span<const double> sizes,
                 const SeamlessOptions& options, const E& executor)
      : graph_(graph),
        steps_(steps),
        lines_(lines),
        boundary_(boundary),
        tangent_(tangent),
        sizes_(sizes),
        options_(options),
        executor_(executor),
        sheets_(graph),
        values_(3 * graph.n_vertices()),
        is_fixed_(3 * graph.n_vertices(), 0) {}

  SeamlessReport run(std::vector<Vector3>& phases, std::vector<Vector3>& differences) {
    SeamlessReport report;
    report.status = Status::cancelled;
    if (!sheets_.find([this] { return !going(); })) return report;
    make_lines_whole();
    fix_charts();
    report.n_unknowns = sheets_.unknowns.n_free();
    if (report.n_unknowns > options_.most_unknowns) {
      report.status = Status::complete;
      return report;
    }
    if (!going() || !make_terms() || !choose() || !solve(phases)) return report;
    double sum = 0;
    differences.resize(graph_.n_edges());
    for (index_t e = 0; e < graph_.n_edges(); ++e) {
      const auto [v, w] = graph_.edges()[e];
      differences[e] = graph_.matching(e).to_first(phases[w]) - phases[v] - jump(e);
      sum += (differences[e] - steps_[e]).squaredNorm();
    }
    report.rms_residual = std::sqrt(sum / static_cast<double>(std::max<std::size_t>(3 * graph_.n_edges(), 1)));
    report.bent_volume = bent_volume(differences);
    report.solved = report.bent_volume <= options_.most_bent;
    report.status = Status::complete;
    return report;
  }

private:
  using System = AxisSystem<1>;
  static constexpr index_t none = no_index;

  /// weight (sum of coefficients times coordinates - sum of whole numbers - constant)^2.
  struct Term {
    double weight, constant;
    std::array<index_t, 2> nodes;  ///< free ones, or `none`
    std::array<double, 2> coefficients;
    double factor;  ///< of the whole numbers
  };

  /// Round a line of quarter turns nothing is gained along it, and its coordinates across are whole.
  void make_lines_whole() {
    for (const SingularLines::Line& line : lines_.lines()) {
      bool is_whole = false;
      for (const SingularLines::Facet& facet : lines_.facets(line)) {
        const auto turn = sheets_.quarter_turn(facet.vertices);
        if (!turn) continue;
        sheets_.unknowns.set_zero(turn->jump[turn->along]);
        if (std::exchange(is_whole, true)) continue;
        const auto x = static_cast<std::uint8_t>((turn->along + 1) % 3), y = turn->axis[x];
        const index_t at_x = sheets_.unknowns.add(), at_y = sheets_.unknowns.add();
        // jump = turn(u) - u for the coordinates u of the line.
        const auto relate = [&](std::uint8_t a, index_t here, index_t there) {
          const WholeSum gained = sum_of({{here, 1}}, {{there, 1}}, -turn->sign[a]);
          sheets_.unknowns.set_zero(sum_of(turn->jump[a], gained), at_x);
        };
        relate(x, at_x, at_y);
        relate(y, at_y, at_x);
      }
    }
  }

  /// An unknown for each part of the boundary on which a coordinate is constant, but for the first of those that hang
  /// together: that is zero. Where there is no boundary one value is.
  void fix_charts() {
    const AxisSets parts = connected_axes(graph_);
    std::vector<std::uint8_t> is_held(values_.size(), 0);
    std::vector<index_t> queue;
    for (index_t node = 0; node < values_.size(); ++node) {
      if (is_fixed_[node] || !is_whole(node)) continue;
      if (std::exchange(is_held[parts.root(node).first], 1)) values_[node] = {{sheets_.unknowns.add(), 1}};
      is_fixed_[node] = 1;
      queue.assign(1, node);
      for (std::size_t i = 0; i < queue.size(); ++i) spread_chart(queue[i], queue);
    }
    for (index_t node = 0; node < values_.size(); ++node)
      if (parts.root(node).first == node && !is_held[node]) is_fixed_[node] = 1;
    for (WholeSum& value : values_) value = sheets_.unknowns.reduced(value);
  }

  bool going() const { return keep_going(options_.observer, "lattice", 0.6); }

  bool is_whole(index_t node) const { return (boundary_.whole[node / 3] >> node % 3 & 1) != 0; }

  void spread_chart(index_t node, std::vector<index_t>& queue) {
    const index_t v = node / 3, a = node % 3;
    for (const index_t w : graph_.adjacency().vertices_of_vertex[v]) {
      const AxisMatching& m = graph_.matching(v, w);
      const index_t there = 3 * w + m.axis[a];
      const AxisMask tangent = tangent_[graph_.edge(v, w)];
      if ((tangent >> (v < w ? a : m.axis[a]) & 1) == 0 || !is_whole(there)) continue;
      const WholeSum value = sum_of({}, sum_of(values_[node], sheets_.along(v, w)[a]), m.sign[a]);
      if (is_fixed_[there]) {
        sheets_.unknowns.set_zero(sum_of(value, values_[there], -1));
      } else {
        values_[there] = value;
        is_fixed_[there] = 1;
        queue.push_back(there);
      }
    }
  }

  /// @return false when cancelled.
  bool make_terms() {
    for (index_t e = 0; e < graph_.n_edges(); ++e) {
      if (e % 8192 == 0 && !going()) return false;
      const auto [v, w] = graph_.edges()[e];
      const AxisMatching& m = graph_.matching(e);
      const Vector3 weights = chart_weights(graph_, tangent_, e);
      const JumpSheets::Jump jump = sheets_.along(v, w);
      for (int a = 0; a < 3; ++a) {
        const auto i = static_cast<std::size_t>(a);
        const index_t here = 3 * v + static_cast<index_t>(a), there = 3 * w + m.axis[i];
        Term term{weights[a], steps_[e][a], {here, there}, {-1, static_cast<double>(m.sign[i])}, 1};
        WholeSum whole = jump[i];
        for (std::size_t k = 0; k < 2; ++k) {
          const index_t node = term.nodes[k];
          if (!is_fixed_[node]) continue;
          whole = sum_of(whole, values_[node], -static_cast<int>(term.coefficients[k]));
          term.nodes[k] = none;
        }
        add(term, whole);
      }
    }
    for (const SingularLines::Line& line : lines_.lines())
      for (const SingularLines::Facet& facet : lines_.facets(line)) wish_line(facet);
    return true;
  }

  /// Wishes that the coordinates across at the corners of a facet be those of the line and the way from there.
  void wish_line(const SingularLines::Facet& facet) {
    for (std::size_t i = 0; i < 3 && options_.line_weight > 0; ++i) {
      const auto& v = facet.vertices;
      const auto turn = sheets_.quarter_turn({v[i], v[(i + 1) % 3], v[(i + 2) % 3]});
      if (!turn) continue;
      for (const int step : {1, 2}) {
        const auto a = static_cast<std::uint8_t>((turn->along + step) % 3);
        const index_t node = 3 * v[i] + a;
        if (is_fixed_[node]) continue;
        const double offset = (graph_.points()[v[i]] - facet.centre).dot(lines_.rate(v[i], a));
        add({options_.line_weight * sizes_[v[i]], offset, {node, none}, {1, 0}, -0.5}, turn->twice_fixed(a));
      }
    }
  }

  void add(const Term& term, const WholeSum& whole) {
    terms_.push_back(term);
    for (const auto& [unknown, coefficient] : sheets_.unknowns.reduced(whole))
      whole_.values.push_back({number(unknown), coefficient});
    whole_.end_row();
  }

  index_t number(index_t unknown) {
    if (unknown >= number_of_.size()) number_of_.resize(unknown + 1, none);
    if (number_of_[unknown] == none) number_of_[unknown] = n_unknowns_++;
    return number_of_[unknown];
  }

  /// What whole numbers x add to the right side of the equations for the coordinates: for the constants alone, x empty
  /// and `constant` 1.
  std::vector<Vector3> load(const Eigen::VectorXd& x, double constant) const {
    std::vector<Vector3> result(graph_.n_vertices(), Vector3::Zero());
    for (std::size_t t = 0; t < terms_.size(); ++t) {
      const Term& term = terms_[t];
      const double wanted = constant * term.constant + whole(t, x);
      if (wanted == 0) continue;
      for (std::size_t k = 0; k < 2; ++k)
        if (term.nodes[k] != none)
          result[term.nodes[k] / 3][term.nodes[k] % 3] += term.weight * term.coefficients[k] * wanted;
    }
    return result;
  }

  double whole(std::size_t t, const Eigen::VectorXd& x) const {
    double sum = 0;
    if (x.size() > 0)
      for (const auto& [i, coefficient] : whole_[t]) sum += terms_[t].factor * coefficient * x[i];
    return sum;
  }

  void make_system() {
    std::vector<double> masses(graph_.n_vertices(), 0);
    system_.emplace(graph_, masses);
    std::vector<Vector3> diagonal = chart_stiffness(graph_, tangent_);
    for (std::size_t t = 3 * graph_.n_edges(); t < terms_.size(); ++t)
      diagonal[terms_[t].nodes[0] / 3][terms_[t].nodes[0] % 3] += terms_[t].weight;
    system_->set_couplings([&](index_t e) { return chart_coupling(graph_, tangent_, e); });
    for (index_t v = 0; v < diagonal.size(); ++v) {
      system_->set_diagonal(v, diagonal[v]);
      AxisMask fixed = 0;
      for (int a = 0; a < 3; ++a)
        if (is_fixed_[3 * v + static_cast<index_t>(a)]) fixed |= static_cast<AxisMask>(1 << a);
      system_->set_fixed(v, fixed);
    }
    system_->prepare();
  }

  /// Coordinates, zero where they are fixed. @return false when cancelled.
  bool coordinates(const std::vector<Vector3>& right, std::vector<Vector3>& result) {
    System::Values x(right.size(), System::Value::Zero()), rows(right.size());
    for (index_t v = 0; v < right.size(); ++v) rows[system_->row_of(v)] = System::lanes(right[v]);
    const auto proceed = [this] { return going(); };
    if (!system_->solve(x, rows, 0, options_.tolerance, options_.max_iterations, proceed, executor_)) return false;
    result.resize(right.size());
    for (index_t v = 0; v < right.size(); ++v) result[v] = System::vector(x[system_->row_of(v)]);
    return true;
  }

  /// Puts the coordinates at their best, so that a quadratic function of the whole numbers alone is left, and chooses
  /// these.
  bool choose() {
    make_system();
    const auto n = static_cast<Eigen::Index>(n_unknowns_);
    Eigen::MatrixXd a = Eigen::MatrixXd::Zero(n, n);
    Eigen::VectorXd b = Eigen::VectorXd::Zero(n), column(n);
    std::vector<Vector3> u;
    for (Eigen::Index i = -1; i < n; ++i) {
      const Eigen::VectorXd x = i < 0 ? Eigen::VectorXd() : Eigen::VectorXd(Eigen::VectorXd::Unit(n, i));
      const double constant = i < 0 ? 1 : 0;
      if (!coordinates(load(x, constant), u)) return false;
      column.setZero();
      for (std::size_t t = 0; t < terms_.size(); ++t) {
        if (whole_[t].empty()) continue;
        const double miss = constant * terms_[t].constant + whole(t, x) - reached(terms_[t], u);
        for (const auto& [j, coefficient] : whole_[t])
          column[j] += terms_[t].weight * terms_[t].factor * coefficient * miss;
      }
      if (i < 0)
        b = -column;
      else
        a.col(i) = column;
    }
    a = 0.5 * (a + a.transpose()).eval();
    a.diagonal().array() += 1e-7 * (n > 0 ? a.diagonal().maxCoeff() : 0);  // the solutions are not exact
    chosen_ = nearest_whole(a, b);
    return true;
  }

  static double reached(const Term& term, const std::vector<Vector3>& u) {
    double sum = 0;
    for (std::size_t k = 0; k < 2; ++k)
      if (term.nodes[k] != none) sum += term.coefficients[k] * u[term.nodes[k] / 3][term.nodes[k] % 3];
    return sum;
  }

  double chosen(const WholeSum& sum) {
    double result = 0;
    for (const auto& [unknown, coefficient] : sheets_.unknowns.reduced(sum))
      result += coefficient * chosen_[number_of_[unknown]];
    return result;
  }
  Vector3 jump(index_t e) {
    const JumpSheets::Jump jump = sheets_.along(graph_.edges()[e][0], graph_.edges()[e][1]);
    return {chosen(jump[0]), chosen(jump[1]), chosen(jump[2])};
  }

  /// With the whole numbers that were chosen: once, and once for what single numbers have left.
  bool solve(std::vector<Vector3>& phases) {
    std::vector<Vector3> right = load(chosen_, 1), correction;
    phases.assign(graph_.n_vertices(), Vector3::Zero());
    for (int pass = 0; pass < 2; ++pass) {
      if (!coordinates(right, correction)) return false;
      for (std::size_t v = 0; v < phases.size(); ++v) phases[v] += correction[v];
      right.assign(phases.size(), Vector3::Zero());
      for (std::size_t t = 0; pass == 0 && t < terms_.size(); ++t) {
        const Term& term = terms_[t];
        const double miss = term.weight * (term.constant + whole(t, chosen_) - reached(term, phases));
        for (std::size_t k = 0; k < 2; ++k)
          if (term.nodes[k] != none) right[term.nodes[k] / 3][term.nodes[k] % 3] += term.coefficients[k] * miss;
      }
    }
    for (index_t node = 0; node < values_.size(); ++node)
      if (is_fixed_[node]) phases[node / 3][node % 3] = chosen(values_[node]);
    return true;
  }

  /// A body that tapers has as many layers at its thick end as at its thin one, unless something ends between.
  double bent_volume(const std::vector<Vector3>& differences) const {
    constexpr double most = 1.8;
    double bent = 0, all = 0;
    for (index_t tet = 0; tet < graph_.tets().size(); ++tet) {
      const auto& t = graph_.tets()[tet];
      const double volume = graph_.six_volumes(t);
      all += volume;
      if (graph_.is_singular(tet) || !(volume > 0)) continue;
      Eigen::Matrix3d ways, coordinates;
      for (int i = 0; i < 3; ++i) {
        const index_t w = t[static_cast<std::size_t>(i) + 1];
        ways.col(i) = graph_.points()[w] - graph_.points()[t[0]];
        coordinates.col(i) = graph_.along(differences, t[0], w);
      }
      const Eigen::Array3d rates = sizes_[t[0]] * (coordinates * ways.inverse()).rowwise().norm().array();
      if (rates.minCoeff() < 1 / most || rates.maxCoeff() > most) bent += volume;
    }
    return all > 0 ? bent / all : 0;
  }

  const LatticeGraph& graph_;
  const std::vector<Vector3>& steps_;
  const SingularLines& lines_;
  const BoundaryAxes& boundary_;
  std::span<const AxisMask> tangent_;
  std::span<const double> sizes_;
  const SeamlessOptions& options_;
  const E& executor_;
  JumpSheets sheets_;
  std::vector<WholeSum> values_;        // of nodes (3 v + a) that are fixed
  std::vector<std::uint8_t> is_fixed_;  // nodes whose coordinate is whole
  std::vector<Term> terms_;             // three an edge, then those of lines
  Csr<std::pair<index_t, int>> whole_;  // of each term
  std::vector<index_t> number_of_;      // of unknowns that are left
  index_t n_unknowns_ = 0;
  std::optional<System> system_;
  Eigen::VectorXd chosen_;
};

}  // namespace detail

/// Finds a map without dislocations: the coordinates of neighbours differ by their steps and by whole numbers that add
/// up to nothing round every facet through which no singular line passes.
///
/// Which whole numbers these can be is known from the field alone: one for each axis of a sheet between singular lines,
/// and one for each part of the boundary on which a coordinate is constant. Lines of quarter turns are to have whole
/// coordinates across. Coordinates are linear in the whole numbers, and what the edges miss of their steps is quadratic:
/// it is made small for all whole numbers at once. Phases are what `solve_singular_phases` finds instead, one jump after
/// the other; that may leave dislocations where this bends the map, and the other way round.
///
/// @param steps        per edge, of `project_steps`.
/// @param phases       receives the coordinates per vertex and axis.
/// @param differences  receives per edge how the coordinates differ: steps for which the map has no dislocation.
/// @return neither of use when there are more whole numbers than `most_unknowns`, when the map is bent too much, or when
///         cancelled.
/// @par Complexity   O(edges^(7/6)) or so for each whole number; some 400 bytes an edge. The same for any executor.
/// @par Source       Nieser, Reitebuch, Polthier, Comput. Graph. Forum 30 (2011), for maps of this kind. Departs: frames
///                   at vertices, steps given, all whole numbers in one quadratic function.
template <Executor E = SerialExecutor>
SeamlessReport solve_seamless_phases(const LatticeGraph& graph, const std::vector<Vector3>& steps,
                                     const SingularLines& lines, const BoundaryAxes& boundary,
                                     std::span<const AxisMask> tangent, std::span<const double> sizes,
                                     std::vector<Vector3>& phases, std::vector<Vector3>& differences,
                                     const SeamlessOptions& options = {}, const E& executor = {}) {
  check_options(options);
  return detail::SeamlessSolver<E>(graph, steps, lines, boundary, tangent, sizes, options, executor)
      .run(phases, differences);
}

}  // namespace framehex
