// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/lattice/axis_scale.hpp"
#include "framehex/lattice/lattice_points.hpp"
#include "framehex/lattice/lattice_steps.hpp"
#include "framehex/lattice/phases.hpp"
#include "framehex/lattice/seamless_phases.hpp"

namespace framehex {

/// How the coordinates of a lattice are found.
enum class LatticeMapping {
  phases,   ///< up to whole numbers, which are rounded one by one (`solve_singular_phases`)
  seamless  ///< with all whole numbers at once (`solve_seamless_phases`) where the field leaves few free; else phases
};

/// Options of `place_lattice`.
struct LatticeOptions {
  LatticeMapping mapping = LatticeMapping::seamless;
  AxisScaleOptions scale = {};
  StepProjectionOptions projection = {};
  PhaseOptions phases = {};
  SingularPhaseOptions singular = {};
  SeamlessOptions seamless = {};
  double step_factor = 1;  ///< > 0: steps in sizes, on the whole
  Observer observer = {};  ///< replaces those of the steps when set

  template <class Options, class Visit>
  static void each_number(Options& o, Visit&& visit) {
    AxisScaleOptions::each_number(o.scale, visit);
    StepProjectionOptions::each_number(o.projection, visit);
    PhaseOptions::each_number(o.phases, visit);
    SingularPhaseOptions::each_number(o.singular, visit);
    SeamlessOptions::each_number(o.seamless, visit);
    visit("LatticeOptions::step_factor", o.step_factor, least_positive, largest_finite);
  }
};

/// How `place_lattice` went.
struct LatticeReport {
  StepProjectionReport projection;
  PhaseReport phases;
  SingularPhaseReport singular;
  SeamlessReport seamless;
  LatticeMapping mapping = LatticeMapping::phases;  ///< that of the points
  Status status = Status::complete;
};

/// Places the points of a lattice that is in step everywhere, by a periodic parameterisation of the whole volume: scale
/// of the axes, steps along edges and their projection, phases, singular lines, points with whole coordinates.
///
/// @param adjacency, points, frames  tetrahedral mesh and a unit quaternion per vertex.
/// @param surface    its boundary.
/// @param size       wished step at a point, host's unit, > 0.
/// @param report     receives what the steps found, when given.
/// @param vertex_of  surface vertex -> vertex of the mesh; empty: the same number.
/// @return nothing when cancelled.
/// @throws invalid_option, invalid_field  as the steps.
/// @par Complexity   O(n^(7/6)) or so for n tetrahedra, about 700 bytes each; the same for any executor.
/// @par Source       Ray, Li, Levy, Sheffer, Alliez, ACM Trans. Graph. 25 (2006), for the phases; Sokolov, Ray,
///                   Untereiner, Levy, ACM Trans. Graph. 35 (2016), for volumes. Departs: scale per axis and projection
///                   of the steps before, which make them integrable; rounding after.
template <SizeField Size, Executor E = SerialExecutor>
LatticePoints place_lattice(const TetAdjacency& adjacency, std::span<const Vector3> points,
                            std::span<const Quaternion> frames, const Surface& surface, const Size& size,
                            LatticeOptions options = {}, const E& executor = {}, LatticeReport* report = nullptr,
                            std::span<const index_t> vertex_of = {}) {
  check_options(options);
  if (options.observer)
    options.scale.observer = options.projection.observer = options.phases.observer = options.seamless.observer =
        options.observer;
  LatticeReport unused;
  LatticeReport& r = report ? *report : unused;
  const auto scaled_size = [&](const Vector3& p) { return options.step_factor * detail::checked_size(size, p); };
  std::vector<double> sizes;
  sizes.reserve(points.size());
  for (const Vector3& p : points) sizes.push_back(scaled_size(p));

  const auto going = [&](double fraction) { return keep_going(options.observer, "lattice", fraction); };
  r.status = Status::cancelled;
  const LatticeGraph graph(adjacency, points, frames);
  if (!going(0)) return {};
  const BoundaryAxes boundary = find_boundary_axes(graph, surface, vertex_of);
  std::vector<Vector3> scale;
  if (!scale_axes(graph, sizes, scale, options.scale, executor)) return {};
  std::vector<Vector3> steps = lattice_steps(graph, scale, scaled_size);
  if (!going(0.1)) return {};
  const std::vector<AxisMask> tangent = tangent_edges(graph, surface, boundary, vertex_of);
  r.projection = project_steps(graph, steps, tangent, options.projection, executor);
  if (r.projection.status == Status::cancelled) return {};
  if (!going(0.5)) return {};
  const SingularLines lines(graph, scale, sizes);
  std::vector<Vector3> phases, differences;
  if (options.mapping == LatticeMapping::seamless) {
    r.seamless = solve_seamless_phases(graph, steps, lines, boundary, tangent, sizes, phases, differences,
                                       options.seamless, executor);
    if (r.seamless.status == Status::cancelled) return {};
    if (r.seamless.solved) r.mapping = LatticeMapping::seamless, steps = std::move(differences);
  }
  if (r.mapping == LatticeMapping::phases) {
    PhaseSolver<E> solver(graph, steps, boundary.whole, tangent, sizes, options.phases, executor);
    r.phases = solve_singular_phases(solver, graph, steps, lines, surface, boundary, sizes, phases, r.singular,
                                     options.singular, vertex_of);
    if (r.phases.status == Status::cancelled) return {};
  }
  const SingularPoints singular =
      find_singular_points(graph, lines, phases, surface, sizes, r.mapping == LatticeMapping::seamless);
  if (!going(1)) return {};
  r.status = Status::complete;
  return extract_lattice_points(LatticeMap(graph, steps, phases), surface, boundary, sizes, singular, vertex_of);
}

}  // namespace framehex
