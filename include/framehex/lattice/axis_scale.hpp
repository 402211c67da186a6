// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/lattice/detail/axis_system.hpp"

#include <cmath>

namespace framehex {

/// Options of `scale_axes`.
struct AxisScaleOptions {
  double longest = 1.25;      ///< >= 1: longest step along an axis, in sizes
  double shortest = 0.7;      ///< 0 to 1: shortest, in sizes
  double smoothness = 0.02;   ///< >= 0: weight of the gradient itself beside what makes the axes integrable
  double conformance = 0.02;  ///< > 0: weight of the size asked for, over `reach` sizes
  double reach = 8;           ///< > 0, sizes
  double tolerance = 1e-3;    ///< of the solution
  int max_iterations = 3000;
  Observer observer = {};

  template <class Options, class Visit>
  static void each_number(Options& o, Visit&& visit) {
    visit("AxisScaleOptions::longest", o.longest, 1, largest_finite);
    visit("AxisScaleOptions::shortest", o.shortest, least_positive, 1);
    visit("AxisScaleOptions::smoothness", o.smoothness, 0, largest_finite);
    visit("AxisScaleOptions::conformance", o.conformance, least_positive, largest_finite);
    visit("AxisScaleOptions::reach", o.reach, least_positive, largest_finite);
    visit("AxisScaleOptions::tolerance", o.tolerance, least_positive, 1);
    visit("AxisScaleOptions::max_iterations", o.max_iterations, 0, unbounded);
  }
};

namespace detail {

/// The equations of `scale_axes`, assembled: an entry an edge and axis.
struct ScaleEquations {
  std::vector<Vector3> diagonal, load;  // per vertex
  std::vector<Vector3> coupling;        // per edge
};

/// Adds the equations of one tetrahedron without a singular line.
inline void add_scale_equations(const LatticeGraph& graph, index_t tet, std::span<const double> log_size,
                                double smoothness, ScaleEquations& out) {
  const auto& t = graph.tets()[tet];
  const auto points = graph.points();
  const double six_volumes = graph.six_volumes(t);
  if (!(six_volumes > 0)) return;
  std::array<Vector3, 4> gradient;  // of the hat functions
  const Vector3 b = points[t[1]] - points[t[0]], c = points[t[2]] - points[t[0]], d = points[t[3]] - points[t[0]];
  gradient[1] = c.cross(d) / six_volumes;
  gradient[2] = d.cross(b) / six_volumes;
  gradient[3] = b.cross(c) / six_volumes;
  gradient[0] = -(gradient[1] + gradient[2] + gradient[3]);
  std::array<AxisMatching, 4> matching;
  for (std::size_t k = 1; k < 4; ++k) matching[k] = graph.matching(t[0], t[k]);
  Vector3 size_gradient = Vector3::Zero();
  for (std::size_t k = 0; k < 4; ++k) size_gradient += log_size[t[k]] * gradient[k];
  const double volume =
      six_volumes / 6 * worth_of_gradients(six_volumes, {points[t[0]], points[t[1]], points[t[2]], points[t[3]]});
  for (std::size_t a = 0; a < 3; ++a) {
    Vector3 curl = Vector3::Zero(), axis = Vector3::Zero();
    for (std::size_t k = 0; k < 4; ++k) {
      const Vector3 e = matching[k].sign[a] * graph.axes(t[k]).col(matching[k].axis[a]);
      curl += gradient[k].cross(e);
      axis += e;
    }
    axis.normalize();
    // (grad s - grad log h) x axis = -curl, but for the twist along the axis, which no scale takes away.
    const Vector3 wanted = size_gradient.cross(axis) - (curl - curl.dot(axis) * axis);
    std::array<Vector3, 4> turned;
    for (std::size_t k = 0; k < 4; ++k) turned[k] = gradient[k].cross(axis);
    for (std::size_t k = 0; k < 4; ++k) {
      const auto i = static_cast<Eigen::Index>(matching[k].axis[a]);
      out.load[t[k]][i] += volume * turned[k].dot(wanted);
      out.diagonal[t[k]][i] += volume * (turned[k].squaredNorm() + smoothness * gradient[k].squaredNorm());
      for (std::size_t l = 0; l < 4; ++l) {
        if (t[l] <= t[k]) continue;
        out.coupling[graph.edge(t[k], t[l])][i] +=
            volume * (turned[k].dot(turned[l]) + smoothness * gradient[k].dot(gradient[l]));
      }
    }
  }
}

}  // namespace detail

/// Finds the lengths of steps along each axis with which a frame field comes nearest to the gradients of a map.
///
/// The axes e of a polar grid are no gradients: circles grow outward. Those of e^s e are, for the right s: this solves
/// grad s x e = -curl e + grad log h x e in least squares over the tetrahedra without a singular line, with small
/// weights for a smooth s near 0.
///
/// @param sizes  n_vertices: wished step, host's unit, > 0.
/// @param scale  receives per vertex and axis the logarithm of the density: a step is size * exp(-scale).
/// @return false when the observer has cancelled.
/// @throws invalid_option  when counts or options are out of range.
/// @par Complexity   O(edges * n^(1/6)); the same for any executor.
/// @par Source       The condition for a foliation's leaves to be level sets; recomputed here, no source known to us.
template <Executor E = SerialExecutor>
bool scale_axes(const LatticeGraph& graph, std::span<const double> sizes, std::vector<Vector3>& scale,
                const AxisScaleOptions& options = {}, const E& executor = {}) {
  if (sizes.size() != graph.n_vertices()) throw invalid_option("there is not one size for each vertex");
  check_options(options);
  const std::size_t n = graph.n_vertices();
  const double low = -std::log(options.longest), high = -std::log(options.shortest);
  std::vector<double> log_size(n), mass(n);
  for (std::size_t v = 0; v < n; ++v) {
    log_size[v] = std::log(sizes[v]);
    const double reach = options.reach * sizes[v];
    mass[v] = graph.volumes()[v] / (reach * reach);
  }
  detail::ScaleEquations equations{std::vector<Vector3>(n, Vector3::Zero()), std::vector<Vector3>(n, Vector3::Zero()),
                                   std::vector<Vector3>(graph.n_edges(), Vector3::Zero())};
  for (index_t tet = 0; tet < graph.tets().size(); ++tet)
    if (!graph.is_singular(tet)) detail::add_scale_equations(graph, tet, log_size, options.smoothness, equations);

  using System = detail::AxisSystem<1>;
  System system(graph, mass);
  system.set_couplings([&](index_t e) { return equations.coupling[e]; });
  System::Values x(n, System::Value::Zero()), load(n);
  const double stiffness = 20;  // of the bounds, against `conformance`
  constexpr int rounds = 3;
  double first = 0;  // residual
  for (int round = 0; round < rounds; ++round) {
    bool outside = round == 0;
    for (index_t v = 0; v < n; ++v) {
      const Vector3 s = System::vector(x[system.row_of(v)]);
      Vector3 diagonal = equations.diagonal[v].array() + options.conformance * mass[v];
      Vector3 right = equations.load[v];
      for (int a = 0; a < 3; ++a) {
        if (s[a] >= low && s[a] <= high) continue;
        outside = outside || s[a] < low - 0.02 || s[a] > high + 0.02;
        diagonal[a] += stiffness * mass[v];
        right[a] += stiffness * mass[v] * (s[a] > high ? high : low);
      }
      system.set_diagonal(v, diagonal);
      load[system.row_of(v)] = System::lanes(right);
    }
    if (!outside) break;
    system.prepare();
    const auto proceed = [&] { return keep_going(options.observer, "lattice", 0.1 * round / rounds); };
    if (!system.solve(x, load, 0, options.tolerance, options.max_iterations, proceed, executor, first)) return false;
    first = std::max(first, system.start());
  }
  scale.resize(n);
  for (index_t v = 0; v < n; ++v) scale[v] = System::vector(x[system.row_of(v)]).cwiseMax(low).cwiseMin(high);
  return true;
}

}  // namespace framehex
