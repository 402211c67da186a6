// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/distributed/detail/field_part.hpp"

namespace framehex::distributed {

/// A field at the vertices of a host's part, in the host's order; those of other owners too.
struct DistributedField {
  std::vector<Quaternion> frames;            ///< unit
  std::vector<double> smoothness;            ///< see `frame_smoothness`
  std::vector<FrameConstraint> constraints;  ///< what the boundary asks
  std::vector<Vector3> axes;                 ///< where it asks for an axis
  FieldReport report;                        ///< the same on all ranks
};

namespace detail {

/// Adjacency of what lies along the curve here; that facets have two cells at most can be seen here only.
inline TetAdjacency checked_adjacency(const CurvePart& part) {
  try {
    return validated_adjacency(part.mesh);
  } catch (const nonmanifold& e) {
    std::string names;
    for (const std::size_t i : e.indices())
      names += " " + std::to_string(e.entity() == Entity::cell ? part.cell_ids[i] : part.vertex_ids[i]);
    throw nonmanifold("cells of several ranks overlap, or share a facet with two others, at " +
                          std::string(e.entity() == Entity::cell ? "cells" : "vertices") + names + " of the whole mesh",
                      Entity::none, {});
  }
}

/// What the holders of rows have, for the vertices of the host's part.
inline void return_field(const MpiTransport& transport, const CurvePart& part, const std::vector<std::int64_t>& rows,
                         const RowExchange& exchange, const FieldPart& field, DistributedField& result) {
  struct Answer {
    SentFrame frame;
    double smoothness;
  };
  std::vector<std::vector<std::int64_t>> questions(static_cast<std::size_t>(transport.n_ranks()));
  for (const std::int64_t row : rows) questions[static_cast<std::size_t>(part.rank_of(row))].push_back(row);
  const auto answers = ask<Answer>(transport, questions, [&](std::int64_t row, int) {
    const index_t v = exchange.order()[static_cast<std::size_t>(row - exchange.first_row())];
    const Quaternion& q = field.frames()[v];
    const Vector3& axis = field.axes()[v];
    return Answer{{{q.x(), q.y(), q.z(), q.w()},
                   {axis.x(), axis.y(), axis.z()},
                   static_cast<std::int64_t>(field.constraints()[v])},
                  field.smoothness()[v]};
  });
  std::vector<std::size_t> next(questions.size(), 0);
  for (const std::int64_t row : rows) {
    const auto rank = static_cast<std::size_t>(part.rank_of(row));
    const Answer& a = answers[rank][next[rank]++];
    result.frames.emplace_back(a.frame.frame[3], a.frame.frame[0], a.frame.frame[1], a.frame.frame[2]);
    result.axes.emplace_back(a.frame.axis[0], a.frame.axis[1], a.frame.axis[2]);
    result.constraints.push_back(static_cast<FrameConstraint>(a.frame.constraint));
    result.smoothness.push_back(a.smoothness);
  }
}

template <DistributedTetMesh M, class E>
DistributedField field_of(const M& mesh, const MpiTransport& transport, MeshFieldOptions options, const E& executor) {
  check_options(options);
  const IndexedPart host = validated_part(mesh, transport);
  const bool has_regions = any_rank(transport, !options.regions.empty());
  if (has_regions && options.regions.size() != host.mesh.tets.size())
    throw invalid_option("there are " + std::to_string(options.regions.size()) + " region labels for " +
                         std::to_string(host.mesh.tets.size()) + " tetrahedra");
  CurveDistributor distributor(transport, host, options.regions, has_regions);
  const CurvePart part = distributor.run();
  const RowExchange exchange(transport, part);
  FieldPart field(exchange, checked_adjacency(part));
  transport.agree();

  DistributedField result;
  WholeBoundary boundary = make_boundary(exchange, field.adjacency(), options);
  result.report.status = Status::cancelled;
  if (!boundary.cancelled) {
    FieldOptions& course = options.field;
    course.observer = shared_observer(transport, course.observer);
    course.diffusion.observer = course.smoothing.observer = course.polish.observer = {};
    course.smoothing.edge_weights = course.polish.edge_weights = {};
    field.constrain(boundary, framehex::detail::keeps_crosses(course));
    if (framehex::detail::needs_start(course)) field.start_nearest(boundary, executor);
    result.report = framehex::detail::run_method(field, course, executor);
  }
  return_field(transport, part, distributor.rows(), exchange, field, result);
  return result;
}

}  // namespace detail

/// The field of a distributed mesh: that of `framehex::compute_frame_field` for the whole mesh with its vertices and cells
/// in the order of their global numbers, on any number of ranks; a frame may come as another of its 24 forms. Collective.
///
/// Vertices are dealt out anew for this, in stretches of a space-filling curve, whatever the host's parts are. The
/// surface alone comes together on the first rank, which finds its features and crosses, as do the surroundings of small
/// singular loops; `nearest` and `smoothed`, which look for nearest points, need it on all.
///
/// @param options  the same on all ranks but for `regions`, one label for each cell of this rank, and `field.observer`,
///                 of which every rank may have one (see `shared_observer`); `features.given_edges` are in global numbers,
///                 and on the first rank. `vertex_of`, and observers and weights of the stages, are not looked at.
/// @throws remote_error  on all ranks, for what `validate` and `framehex::compute_frame_field` refuse on one.
/// @par Complexity   As the serial call on a rank's share, and for the first rank the cross field of the surface. An
///                   iteration of the linear solves sends the frames at a part's border to its neighbours.
/// @par Determinism  The same to the last bit for any number of ranks and threads.
template <DistributedTetMesh M, Executor E = SerialExecutor>
DistributedField compute_frame_field(const M& mesh, const MpiTransport& transport, const MeshFieldOptions& options = {},
                                     const E& executor = {}) {
  return run_collectively(transport, [&] { return detail::field_of(mesh, transport, options, executor); });
}

}  // namespace framehex::distributed
