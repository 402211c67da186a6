// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/lattice/lattice_regularity.hpp"
#include "framehex/lattice/phases.hpp"

namespace framehex {

/// The singular lines of quarter turns of a field, as a lattice sees them.
///
/// Round such a line the map has a fixed point: the line itself has, across, either whole coordinates, and columns of
/// hexahedra meet at it, or coordinates half way between, and it runs through a column of prisms. "Parity" is 1 in the
/// first case and -1 in the second.
class SingularLines {
public:
  /// One facet through which a line passes.
  struct Facet {
    std::array<index_t, 3> vertices;
    Vector3 centre;  ///< on the line, smoothed
    Vector3 axis;    ///< unit, that of the turn; along the line from its first facet to its last
    bool on_boundary;
  };
  /// One line.
  struct Line {
    index_t first, end;  ///< rows of `facets()`
    double length;       ///< in sizes
    double index;        ///< 1/4 or -1/4
  };

  /// @param scale  per vertex, of `scale_axes`. @param sizes  per vertex.
  /// References are kept to all arguments.
  SingularLines(const LatticeGraph& graph, const std::vector<Vector3>& scale, std::span<const double> sizes)
      : graph_(graph), scale_(scale), sizes_(sizes) {
    const SingularGraph singular = singular_graph(graph.adjacency(), graph.points(), graph.frames());
    for (std::size_t c = 0; c < singular.curves.size(); ++c)
      if (std::abs(singular.curve_index[c]) == 0.25 && singular.curves[c].size() >= 2)
        add_line(singular, singular.curves[c], singular.curve_index[c]);
  }

  const std::vector<Line>& lines() const { return lines_; }
  const std::vector<Facet>& facets() const { return facets_; }
  std::span<const Facet> facets(const Line& line) const {
    return std::span(facets_).subspan(line.first, line.end - line.first);
  }

  /// Coordinates in steps per length at a vertex along an axis of its frame.
  Vector3 rate(index_t vertex, int axis) const {
    return graph_.axes(vertex).col(axis) * (std::exp(scale_[vertex][axis]) / sizes_[vertex]);
  }

  /// Mean cosine of the coordinates across a line, 1 where they are whole and -1 where they are half.
  double parity(const Line& line, std::span<const Vector3> phases) const {
    double sum = 0, n = 0;
    for_each_across(line, [&](const Facet& f, index_t v, int axis) {
      sum += std::cos(2 * std::numbers::pi * (phases[v][axis] - offset(f, v, axis)));
      ++n;
    });
    return n > 0 ? sum / n : 0;
  }

  /// What makes the coordinates across a line whole on it.
  void add_targets(const Line& line, std::span<const AxisMask> fixed, std::vector<PhaseTarget>& targets) const {
    for_each_across(line, [&](const Facet& f, index_t v, int axis) {
      if (fixed[v] >> axis & 1) return;
      targets.push_back({v, static_cast<std::uint8_t>(axis), offset(f, v, axis), sizes_[v]});
    });
  }

private:
  void add_line(const SingularGraph& singular, std::span<const index_t> row, double index) {
    Line line{static_cast<index_t>(facets_.size()), 0, 0, index};
    for (const index_t f : row) {
      const SingularFacet& s = singular.facets[f];
      const AxisMatching& m = axis_matching(s.symmetry);
      const auto& p = graph_.points();
      Facet facet{s.vertices, (p[s.vertices[0]] + p[s.vertices[1]] + p[s.vertices[2]]) / 3, Vector3::Zero(),
                  s.tets[1] == no_index};
      for (std::size_t a = 0; a < 3; ++a)
        if (m.axis[a] == a && m.sign[a] > 0) facet.axis = graph_.axes(s.vertices[0]).col(static_cast<Eigen::Index>(a));
      facets_.push_back(facet);
    }
    line.end = static_cast<index_t>(facets_.size());
    const std::span<Facet> facets = std::span(facets_).subspan(line.first);
    smooth(facets, row.size() > 2 && row.front() == row.back());
    orient(facets);
    for (std::size_t i = 0; i + 1 < facets.size(); ++i)
      line.length += (facets[i + 1].centre - facets[i].centre).norm() / sizes_[facets[i].vertices[0]];
    lines_.push_back(line);
  }

  /// Centres of facets zigzag about the line.
  static void smooth(std::span<Facet> facets, bool closed) {
    const std::size_t n = facets.size();
    std::vector<Vector3> next(n);
    for (int sweep = 0; n >= 3 && sweep < 20; ++sweep) {
      for (std::size_t i = 0; i < n; ++i) next[i] = facets[i].centre;
      for (std::size_t i = 1; i + 1 < n; ++i)
        next[i] = 0.5 * facets[i].centre + 0.25 * (facets[i - 1].centre + facets[i + 1].centre);
      if (closed) next[0] = next[n - 1] = 0.5 * facets[0].centre + 0.25 * (facets[1].centre + facets[n - 2].centre);
      for (std::size_t i = 0; i < n; ++i) facets[i].centre = next[i];
    }
  }

  static void orient(std::span<Facet> facets) {
    for (std::size_t i = 0; i < facets.size(); ++i) {
      const Vector3 along =
          i > 0 ? facets[i - 1].axis
                : Vector3(facets[std::min<std::size_t>(1, facets.size() - 1)].centre - facets[0].centre);
      if (facets[i].axis.dot(along) < 0) facets[i].axis = -facets[i].axis;
    }
  }

  double offset(const Facet& f, index_t v, int axis) const {
    return (graph_.points()[v] - f.centre).dot(rate(v, axis));
  }

  /// Calls `visit(facet, vertex, axis)` for the two axes across the line at each vertex of each of its facets.
  template <class Visit>
  void for_each_across(const Line& line, Visit&& visit) const {
    for (const Facet& f : facets(line))
      for (const index_t v : f.vertices) {
        Eigen::Index along = 0;
        (graph_.axes(v).transpose() * f.axis).cwiseAbs().maxCoeff(&along);
        for (int axis = 0; axis < 3; ++axis)
          if (axis != along) visit(f, v, axis);
      }
  }

  const LatticeGraph& graph_;
  const std::vector<Vector3>& scale_;
  std::span<const double> sizes_;
  std::vector<Line> lines_;
  std::vector<Facet> facets_;
};

/// Options of `solve_singular_phases`.
struct SingularPhaseOptions {
  int max_trials = 3;               ///< solves with lines forced to whole coordinates
  double defect_cost = 5;           ///< of a cube of the size through which dislocations pass, in sizes of half line
  double negative_line_cost = 1.7;  ///< of a half line of index -1/4 beside one of 1/4: its column has five sides

  template <class Options, class Visit>
  static void each_number(Options& o, Visit&& visit) {
    visit("SingularPhaseOptions::max_trials", o.max_trials, 0, unbounded);
    visit("SingularPhaseOptions::defect_cost", o.defect_cost, 0, largest_finite);
    visit("SingularPhaseOptions::negative_line_cost", o.negative_line_cost, 0, largest_finite);
  }
};

/// How `solve_singular_phases` went.
struct SingularPhaseReport {
  double n_defects_before = 0;  ///< volume of dislocated tetrahedra in cubes of the size, without forcing
  double n_defects_after = 0;
  std::size_t n_lines = 0;        ///< of quarter turns
  std::size_t n_whole_lines = 0;  ///< with whole coordinates
  double cost = 0;                ///< what was least: cells that are expected to be no hexahedra, in cubes of the size
  ChartRounding charts = ChartRounding::last;  ///< the better one
};

namespace detail {

/// Tries which lines are better forced to whole coordinates.
template <class E>
class SingularPhaseChoice {
public:
  SingularPhaseChoice(const LatticeGraph& graph, const std::vector<Vector3>& steps, const SingularLines& lines,
                      const Surface& surface, const BoundaryAxes& boundary, std::span<const double> sizes,
                      std::span<const index_t> vertex_of, const SingularPhaseOptions& options)
      : graph_(graph),
        steps_(steps),
        lines_(lines),
        surface_(surface),
        boundary_(boundary),
        sizes_(sizes),
        vertex_of_(vertex_of),
        options_(options) {}

  PhaseReport run(PhaseSolver<E>& solver, std::vector<Vector3>& phases, SingularPhaseReport& report) {
    const std::size_t n = lines_.lines().size();
    report.n_lines = n;
    report.cost = std::numeric_limits<double>::max();
    std::vector<std::uint8_t> forced(n, 0);
    std::vector<double> free_parity;
    for (int i = 0; i <= options_.max_trials; ++i) {
      const std::optional<Cost> now = attempt(solver, forced, ChartRounding::last, phases, report);
      if (!now) return best_report_;
      if (i == 0) {
        report.n_defects_before = now->defects;
        free_parity = now->parity;
        forced.assign(n, 1);
        if (targets_of(forced).empty()) break;
      } else if (now->defects == 0 || !release(*now, free_parity, forced)) {
        break;
      }
    }
    if (best_report_.n_charts > 1) attempt(solver, best_forced_, ChartRounding::first, phases, report);
    return best_report_;
  }

private:
  struct Cost {
    double total = 0, defects = 0;
    std::vector<double> parity, defects_near;  // per line
  };

  /// Solves with lines forced to whole coordinates; keeps the solution when it is the cheapest so far. @return its cost;
  /// nothing when cancelled.
  std::optional<Cost> attempt(PhaseSolver<E>& solver, const std::vector<std::uint8_t>& forced, ChartRounding charts,
                              std::vector<Vector3>& phases, SingularPhaseReport& report) {
    std::vector<Vector3> trial;
    const PhaseReport solved = solver.solve(trial, targets_of(forced), charts);
    if (solved.status == Status::cancelled) return cancelled();
    const Cost now = cost(trial);
    if (!solver.going()) return cancelled();
    if (now.total < report.cost) {
      report.cost = now.total;
      report.charts = charts;
      report.n_defects_after = now.defects;
      report.n_whole_lines = static_cast<std::size_t>(
          std::count_if(now.parity.begin(), now.parity.end(), [](double parity) { return parity > 0.3; }));
      best_report_ = solved;
      best_forced_ = forced;
      phases.swap(trial);
    }
    return now;
  }

  std::nullopt_t cancelled() {
    best_report_.status = Status::cancelled;
    return std::nullopt;
  }

  std::vector<PhaseTarget> targets_of(std::span<const std::uint8_t> forced) const {
    std::vector<PhaseTarget> targets;
    for (std::size_t l = 0; l < forced.size(); ++l)
      if (forced[l]) lines_.add_targets(lines_.lines()[l], boundary_.whole, targets);
    return targets;
  }

  double weight(const SingularLines::Line& line) const {
    return line.length * (line.index > 0 ? 1 : options_.negative_line_cost);
  }

  Cost cost(const std::vector<Vector3>& phases) {
    const LatticeMap map(graph_, steps_, phases);
    Cost result;
    result.defects_near.assign(lines_.lines().size(), 0);
    for (index_t tet = 0; tet < graph_.tets().size(); ++tet) {
      const auto& t = graph_.tets()[tet];
      if (graph_.is_singular(tet) || map.unwrapped(t)) continue;
      const double h = sizes_[t[0]], volume = graph_.six_volumes(t) / (6 * h * h * h);
      result.defects += volume;
      if (nearest_line_.empty()) find_nearest_lines();
      if (nearest_line_[t[0]] != no_index) result.defects_near[nearest_line_[t[0]]] += volume;
    }
    const LatticeRegularity regularity(map, surface_, boundary_, sizes_, vertex_of_);
    result.total = options_.defect_cost * result.defects + regularity.irregular_area();
    for (const SingularLines::Line& line : lines_.lines()) {
      const double parity = lines_.parity(line, phases);
      result.parity.push_back(parity);
      result.total += weight(line) * std::min(1.0, 2 * (1 - parity));
    }
    return result;
  }

  /// Lets go of the lines that cost more in dislocations than they would as columns of prisms. @return any?
  bool release(const Cost& now, std::span<const double> free_parity, std::vector<std::uint8_t>& forced) const {
    bool any = false;
    for (std::size_t l = 0; l < forced.size(); ++l) {
      if (!forced[l] || free_parity[l] >= 0.3) continue;
      if (options_.defect_cost * now.defects_near[l] <= weight(lines_.lines()[l])) continue;
      forced[l] = 0;
      any = true;
    }
    return any;
  }

  /// Line reached in fewest edges from each vertex.
  void find_nearest_lines() {
    nearest_line_.assign(graph_.n_vertices(), no_index);
    std::vector<index_t> queue;
    for (index_t l = 0; l < lines_.lines().size(); ++l)
      for (const auto& facet : lines_.facets(lines_.lines()[l]))
        for (const index_t v : facet.vertices)
          if (nearest_line_[v] == no_index) nearest_line_[v] = l, queue.push_back(v);
    for (std::size_t i = 0; i < queue.size(); ++i)
      for (const index_t w : graph_.adjacency().vertices_of_vertex[queue[i]])
        if (nearest_line_[w] == no_index) nearest_line_[w] = nearest_line_[queue[i]], queue.push_back(w);
  }

  const LatticeGraph& graph_;
  const std::vector<Vector3>& steps_;
  const SingularLines& lines_;
  const Surface& surface_;
  const BoundaryAxes& boundary_;
  std::span<const double> sizes_;
  std::span<const index_t> vertex_of_;
  const SingularPhaseOptions& options_;
  PhaseReport best_report_;
  std::vector<std::uint8_t> best_forced_;
  std::vector<index_t> nearest_line_;
};

}  // namespace detail

/// Solves for phases with those singular lines on whole coordinates for which that costs least.
///
/// Tried are none, all, and then fewer and fewer: those go that bring more dislocations near them than the column of
/// prisms of a line left half way. Then the cheapest is tried with charts rounded first, and the cheaper kept. The cost
/// is the number of cells that are likely to be no hexahedra: dislocated volume, length of half lines, and the area of
/// the boundary where the map is not regular.
///
/// @param surface, boundary, sizes, vertex_of  as of the other steps.
/// @par Complexity   that of `solver`, up to 2 + max_trials times.
template <class E>
PhaseReport solve_singular_phases(PhaseSolver<E>& solver, const LatticeGraph& graph, const std::vector<Vector3>& steps,
                                  const SingularLines& lines, const Surface& surface, const BoundaryAxes& boundary,
                                  std::span<const double> sizes, std::vector<Vector3>& phases,
                                  SingularPhaseReport& report, const SingularPhaseOptions& options = {},
                                  std::span<const index_t> vertex_of = {}) {
  check_options(options);
  return detail::SingularPhaseChoice<E>(graph, steps, lines, surface, boundary, sizes, vertex_of, options)
      .run(solver, phases, report);
}

}  // namespace framehex
