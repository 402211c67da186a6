// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/geometry/size_field.hpp"
#include "framehex/lattice/boundary_axes.hpp"
#include "framehex/observer.hpp"

#include <cmath>

namespace framehex {

/// Steps that the frames ask for along each edge: its length along the axes of its lower end, in sizes.
///
/// The mean of the axes at both ends, each with its scale, over the size at the middle.
///
/// @param scale  per vertex, of `scale_axes`.
/// @return per edge, along the axes of its lower vertex.
template <SizeField Size>
std::vector<Vector3> lattice_steps(const LatticeGraph& graph, std::span<const Vector3> scale, const Size& size) {
  std::vector<Vector3> steps;
  steps.reserve(graph.n_edges());
  const auto points = graph.points();
  for (index_t e = 0; e < graph.n_edges(); ++e) {
    const auto [v, w] = graph.edges()[e];
    const Vector3 edge = points[w] - points[v];
    const double h = detail::checked_size(size, Vector3(0.5 * (points[v] + points[w])));
    const Vector3 here = (graph.axes(v).transpose() * edge).cwiseProduct(Vector3(scale[v].array().exp()));
    const Vector3 there = (graph.axes(w).transpose() * edge).cwiseProduct(Vector3(scale[w].array().exp()));
    steps.push_back((here + graph.matching(e).to_first(there)) / (2 * h));
  }
  return steps;
}

/// Edges that run along the boundary take no step along its normal: those components, one bit an axis, per edge.
inline std::vector<AxisMask> tangent_edges(const LatticeGraph& graph, const Surface& surface,
                                           const BoundaryAxes& boundary, std::span<const index_t> vertex_of = {}) {
  std::vector<AxisMask> result(graph.n_edges(), 0);
  for (std::size_t corner = 0; corner < boundary.normal_axis.size(); ++corner) {
    const std::size_t next = corner % 3 == 2 ? corner - 2 : corner + 1;
    index_t v = surface.triangles()[corner / 3][corner % 3], w = surface.triangles()[next / 3][next % 3];
    if (!vertex_of.empty()) v = vertex_of[v], w = vertex_of[w];
    std::uint8_t at_v = boundary.normal_axis[corner], at_w = boundary.normal_axis[next];
    if (v > w) std::swap(v, w), std::swap(at_v, at_w);
    const index_t e = graph.edge(v, w);
    if (at_v == BoundaryAxes::none || graph.matching(e).axis[at_v] != at_w) continue;
    result[e] |= static_cast<AxisMask>(1 << at_v);
  }
  return result;
}

/// Options of `project_steps`.
struct StepProjectionOptions {
  double stiffness = 300;  ///< >= 0: weight of closure against change; reaches over about its root in edges
  double tolerance = 1e-3;
  int max_iterations = 1500;
  Observer observer = {};

  template <class Options, class Visit>
  static void each_number(Options& o, Visit&& visit) {
    visit("StepProjectionOptions::stiffness", o.stiffness, 0, largest_finite);
    visit("StepProjectionOptions::tolerance", o.tolerance, least_positive, 1);
    visit("StepProjectionOptions::max_iterations", o.max_iterations, 0, unbounded);
  }
};

/// How `project_steps` went.
struct StepProjectionReport {
  double closure_before = 0;  ///< root mean square of the sums round facets, in steps
  double closure_after = 0;
  double change = 0;  ///< root mean square of the change, in steps
  Status status = Status::complete;
};

namespace detail {

/// Softly removes what the steps do not close round facets without a singular line: conjugate gradients on
/// (m + stiffness d^T d) c = -stiffness d^T d steps, in single precision.
template <class E>
class StepProjection {
public:
  StepProjection(const LatticeGraph& graph, std::span<const AxisMask> fixed, const StepProjectionOptions& options,
                 const E& executor)
      : graph_(graph), fixed_(fixed), options_(options), executor_(executor) {
    find_facets();
    double sum = 0;
    for (const double w : graph.weights()) sum += w;
    const double mean = sum / static_cast<double>(std::max<std::size_t>(graph.n_edges(), 1));
    for (const double w : graph.weights()) inertia_.push_back(static_cast<float>(w / mean));
  }

  StepProjectionReport run(std::vector<Vector3>& steps) {
    for (std::size_t e = 0; e < steps.size(); ++e) freed(e, steps[e]);
    StepProjectionReport report;
    report.closure_before = closure(steps);
    std::vector<Vector> change(steps.size(), Vector::Zero());
    if (!solve(change)) report.status = Status::cancelled;
    double sum = 0;
    for (std::size_t e = 0; e < steps.size(); ++e) {
      steps[e] += change[e].template cast<double>();
      sum += change[e].squaredNorm();
    }
    report.closure_after = closure(steps);
    report.change = std::sqrt(sum / static_cast<double>(std::max<std::size_t>(3 * steps.size(), 1)));
    return report;
  }

private:
  using Vector = Eigen::Vector3f;
  struct Facet {
    std::array<index_t, 3> edges;  // ab, bc, ac of ascending vertices a, b, c
    std::uint8_t symmetry;         // from a to b
  };
  // Which edge of its facet an edge is.
  enum Role : index_t { ab, bc, ac };

  void find_facets() {
    const TetAdjacency& adjacency = graph_.adjacency();
    for (index_t tet = 0; tet < adjacency.tets.size(); ++tet)
      for (int face = 0; face < 4; ++face) {
        if (adjacency.neighbours[tet][static_cast<std::size_t>(face)] < tet) continue;
        const auto v = sorted(facet(adjacency.tets[tet], face));
        if (graph_.is_singular(tet) && !graph_.is_regular(v)) continue;
        const index_t first = graph_.edge(v[0], v[1]);
        facets_.push_back({{first, graph_.edge(v[1], v[2]), graph_.edge(v[0], v[2])},
                           static_cast<std::uint8_t>(graph_.symmetry(first))});
      }
    // As edges are: neighbours near in memory.
    std::sort(facets_.begin(), facets_.end(), [](const Facet& f, const Facet& g) { return f.edges < g.edges; });
    facets_of_edge_ = make_csr(graph_.n_edges(), [&](auto&& put) {
      for (index_t f = 0; f < facets_.size(); ++f)
        for (const Role role : {ab, bc, ac}) put(facets_[f].edges[role], 3 * f + role);
    });
  }

  template <class V>
  void freed(std::size_t e, V& value) const {
    if (fixed_[e] == 0) return;
    for (int a = 0; a < 3; ++a)
      if (fixed_[e] >> a & 1) value[a] = 0;
  }

  template <class V>
  static V round(const Facet& f, const std::vector<V>& x) {
    const V& second = x[f.edges[bc]];
    if (f.symmetry == 0) return x[f.edges[ab]] + second - x[f.edges[ac]];
    return x[f.edges[ab]] + axis_matching(f.symmetry).to_first(second) - x[f.edges[ac]];
  }

  /// d^T d x at edge e, of the sums round facets.
  Vector gathered(std::size_t e) const {
    Vector total = Vector::Zero();
    for (const index_t at : facets_of_edge_[e]) {
      const index_t f = at / 3, role = at - 3 * f;
      const Vector& r = around_[f];
      if (role == ac)
        total -= r;
      else if (role == ab || facets_[f].symmetry == 0)
        total += r;
      else
        total += axis_matching(facets_[f].symmetry).to_second(r);
    }
    return total;
  }

  void go_round(const std::vector<Vector>& x) {
    for_blocks(executor_, facets_.size(), block_size, [&](std::size_t first, std::size_t last) {
      for (std::size_t f = first; f < last; ++f) around_[f] = round(facets_[f], x);
    });
  }

  /// Root mean square; leaves the sums round facets in `around_`.
  double closure(const std::vector<Vector3>& steps) {
    around_.resize(facets_.size());
    const double total = sum(facets_.size(), [&](std::size_t f) {
      const Vector3 r = round(facets_[f], steps);
      around_[f] = r.cast<float>();
      return r.squaredNorm();
    });
    return std::sqrt(total / static_cast<double>(std::max<std::size_t>(3 * facets_.size(), 1)));
  }

  float stiffness() const { return static_cast<float>(options_.stiffness); }
  float diagonal(std::size_t e) const {
    return inertia_[e] + stiffness() * static_cast<float>(facets_of_edge_.offsets[e + 1] - facets_of_edge_.offsets[e]);
  }

  /// @pre `around_` holds the sums of the steps.
  bool solve(std::vector<Vector>& x) {
    const std::size_t n = x.size();
    std::vector<Vector> residual(n), direction(n), image(n);
    double rho = sum(n, [&](std::size_t e) {
      residual[e] = -stiffness() * gathered(e);
      freed(e, residual[e]);
      direction[e] = residual[e] / diagonal(e);
      return static_cast<double>(residual[e].dot(direction[e]));
    });
    const double start = rho, target = options_.tolerance * options_.tolerance * rho;
    for (int iteration = 0; iteration < options_.max_iterations && rho > target; ++iteration) {
      if (iteration % 8 == 0 && !keep_going(options_.observer, "lattice", progress(rho, start))) return false;
      go_round(direction);
      const double curvature = sum(n, [&](std::size_t e) {
        image[e] = inertia_[e] * direction[e] + stiffness() * gathered(e);
        freed(e, image[e]);
        return static_cast<double>(image[e].dot(direction[e]));
      });
      if (!(curvature > 0)) break;
      const auto alpha = static_cast<float>(rho / curvature);
      const double next = sum(n, [&](std::size_t e) {
        x[e] += alpha * direction[e];
        residual[e] -= alpha * image[e];
        return static_cast<double>(residual[e].squaredNorm() / diagonal(e));
      });
      const auto beta = static_cast<float>(next / rho);
      for_blocks(executor_, n, block_size, [&](std::size_t first, std::size_t last) {
        for (std::size_t e = first; e < last; ++e) direction[e] = residual[e] / diagonal(e) + beta * direction[e];
      });
      rho = next;
    }
    return true;
  }

  double progress(double rho, double start) {
    const double done = std::log(start / rho) / std::log(1 / (options_.tolerance * options_.tolerance));
    furthest_ = std::max(furthest_, std::clamp(done, 0.0, 1.0));
    return 0.1 + 0.4 * furthest_;
  }

  template <class Term>
  double sum(std::size_t n, const Term& term) {
    return sum_by_blocks(executor_, n, block_size, partial_, term);
  }

  const LatticeGraph& graph_;
  std::span<const AxisMask> fixed_;
  const StepProjectionOptions& options_;
  const E& executor_;
  std::vector<float> inertia_;  // the edges' weights over their mean
  double furthest_ = 0;
  std::vector<Facet> facets_;
  Csr<index_t> facets_of_edge_;  // three times the facet, plus the edge's role in it
  std::vector<Vector> around_;
  std::vector<double> partial_;
};

}  // namespace detail

/// Changes steps as little as possible so that they add up to nothing round every facet but the singular ones: a soft
/// Hodge projection, after which lattices meet in step.
///
/// Minimises sum m |c|^2 + stiffness sum |d (steps + c)|^2, m the edges' weights over their mean.
///
/// @param steps  per edge, changed in place.
/// @param fixed  per edge: components that become and stay zero (see `tangent_edges`).
/// @throws invalid_option  when counts or options are out of range.
/// @par Complexity   O(facets) an iteration, some hundred iterations for any mesh; about 100 bytes a facet and 100 an
///                   edge. The same for any executor.
template <Executor E = SerialExecutor>
StepProjectionReport project_steps(const LatticeGraph& graph, std::vector<Vector3>& steps,
                                   std::span<const AxisMask> fixed, const StepProjectionOptions& options = {},
                                   const E& executor = {}) {
  if (steps.size() != graph.n_edges() || fixed.size() != steps.size())
    throw invalid_option("steps and masks are not one for each edge");
  check_options(options);
  return detail::StepProjection<E>(graph, fixed, options, executor).run(steps);
}

}  // namespace framehex
