// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/distributed/detail/part_holding.hpp"
#include "framehex/field/compute_frame_field.hpp"

#include <numeric>

namespace framehex::distributed::detail {

/// What the surface of the whole mesh asks of its vertices. A surface has so few triangles beside the tetrahedra, and
/// its crosses depend on one another so widely, that the first rank does it alone.
struct WholeBoundary {
  // On the first rank; on all after `share`.
  Surface surface;
  BoundaryFrames frames;
  std::vector<std::int64_t> vertex_ids;  ///< of the surface's vertices
  bool cancelled = false;
};

/// A triangle of the boundary as it is sent.
struct SentTriangle {
  std::int64_t cell;
  std::int64_t face;
  std::array<std::int64_t, 3> vertices;
  std::array<std::array<double, 3>, 3> points;
};

/// Calls `visit(tet, face)` for the facets on the boundary, and between regions, that have a vertex of one's own.
template <class Visit>
void each_boundary_facet(const CurvePart& part, const TetAdjacency& adjacency, const PartHolding& holding,
                         const Visit& visit) {
  for (index_t tet = 0; tet < adjacency.tets.size(); ++tet)
    for (int face = 0; face < 4; ++face) {
      const index_t other = adjacency.neighbours[tet][static_cast<std::size_t>(face)];
      if (other != no_index && (part.regions.empty() || part.regions[tet] >= part.regions[other])) continue;
      const auto t = facet(adjacency.tets[tet], face);
      // Where none is one's own, what lies beyond may only be unknown.
      if (holding.is_own(t[0]) || holding.is_own(t[1]) || holding.is_own(t[2])) visit(tet, face);
    }
}

/// Facets to the first rank, each by the owner of its first vertex.
inline std::vector<SentTriangle> send_triangles(const RowExchange& exchange, const TetAdjacency& adjacency) {
  const CurvePart& part = exchange.part();
  std::vector<std::vector<SentTriangle>> sent(static_cast<std::size_t>(exchange.transport().n_ranks()));
  each_boundary_facet(part, adjacency, PartHolding(exchange), [&](index_t tet, int face) {
    const auto t = facet(adjacency.tets[tet], face);
    if (!exchange.is_own(*std::min_element(t.begin(), t.end()))) return;
    SentTriangle& triangle = sent[0].emplace_back(SentTriangle{part.cell_ids[tet], face, {}, {}});
    for (std::size_t i = 0; i < 3; ++i) {
      const Vector3& p = part.mesh.points[t[i]];
      triangle.vertices[i] = part.vertex_ids[t[i]];
      triangle.points[i] = {p.x(), p.y(), p.z()};
    }
  });
  std::vector<SentTriangle> all = send_joined(exchange.transport(), std::move(sent));
  std::ranges::sort(all, {}, [](const SentTriangle& t) { return std::pair(t.cell, t.face); });
  return all;
}

/// The surface as `extract_boundary` makes it from the whole mesh; numbers of its vertices and cells that leave 32 bits
/// can be named in messages only.
inline BoundarySurface join_triangles(const std::vector<SentTriangle>& triangles, std::vector<std::int64_t>& ids) {
  BoundarySurface boundary;
  std::vector<std::pair<std::int64_t, std::array<double, 3>>> vertices;
  for (const SentTriangle& t : triangles)
    for (std::size_t i = 0; i < 3; ++i) vertices.emplace_back(t.vertices[i], t.points[i]);
  std::sort(vertices.begin(), vertices.end());
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  for (const auto& [id, p] : vertices) {
    ids.push_back(id);
    boundary.vertex_of.push_back(static_cast<index_t>(id));
    boundary.surface.points.emplace_back(p[0], p[1], p[2]);
  }
  for (const SentTriangle& t : triangles) {
    boundary.tet_of.push_back(static_cast<index_t>(t.cell));
    auto& row = boundary.surface.triangles.emplace_back();
    for (std::size_t i = 0; i < 3; ++i)
      row[i] = static_cast<index_t>(std::lower_bound(ids.begin(), ids.end(), t.vertices[i]) - ids.begin());
  }
  return boundary;
}

/// Features, crosses and frames of the whole surface, on the first rank.
///
/// @param options  their observer is this rank's: others' cannot be heard here.
/// @throws invalid_field, invalid_option  as `compute_frame_field`.
inline WholeBoundary make_boundary(const RowExchange& exchange, const TetAdjacency& adjacency,
                                   const MeshFieldOptions& options) {
  WholeBoundary whole;
  const std::vector<SentTriangle> triangles = send_triangles(exchange, adjacency);
  if (exchange.transport().rank() == 0) {
    const BoundarySurface boundary = join_triangles(triangles, whole.vertex_ids);
    if (!whole.vertex_ids.empty() && whole.vertex_ids.back() >= no_index && !options.features.given_edges.empty())
      throw invalid_option("feature edges can be given where vertices are numbered in 32 bits only");
    whole.cancelled = !framehex::detail::frame_boundary(boundary, options, whole.surface, whole.frames);
  }
  std::array<double, 1> going{whole.cancelled ? 0.0 : 1.0};
  exchange.transport().least(going);
  whole.cancelled = going[0] == 0;
  return whole;
}

/// The whole surface for everybody: who looks for nearest points must see it all.
inline void share(const MpiTransport& transport, WholeBoundary& whole) {
  std::vector<std::array<index_t, 3>> triangles;
  if (transport.rank() == 0) triangles = whole.surface.triangles();
  triangles = gathered(transport, triangles);
  std::vector<Vector3> points = gathered(transport, whole.surface.points);
  whole.frames.frames = gathered(transport, whole.frames.frames);
  if (transport.rank() == 0) return;
  whole.surface.points = std::move(points);
  whole.surface.adjacency.triangles = std::move(triangles);
}

/// What the surface asks of a vertex, as it is sent.
struct SentFrame {
  std::array<double, 4> frame;
  std::array<double, 3> axis;
  std::int64_t constraint;
};

/// Frames and constraints for the vertices of one's own, from the first rank; then for the halo, from its owners.
inline void constrain(const RowExchange& exchange, const TetAdjacency& adjacency, const WholeBoundary& whole,
                      std::vector<Quaternion>& frames, std::vector<FrameConstraint>& constraints,
                      std::vector<Vector3>& axes) {
  const PartHolding holding(exchange);
  std::vector<index_t> own;
  each_boundary_facet(exchange.part(), adjacency, holding, [&](index_t tet, int face) {
    for (const index_t v : facet(adjacency.tets[tet], face))
      if (holding.is_own(v)) own.push_back(v);
  });
  std::sort(own.begin(), own.end());
  own.erase(std::unique(own.begin(), own.end()), own.end());
  std::vector<std::vector<std::int64_t>> questions(static_cast<std::size_t>(exchange.transport().n_ranks()));
  for (const index_t v : own) questions[0].push_back(exchange.part().vertex_ids[v]);
  const auto answers = ask<SentFrame>(exchange.transport(), questions, [&](std::int64_t id, int) {
    const auto s = static_cast<std::size_t>(std::ranges::lower_bound(whole.vertex_ids, id) - whole.vertex_ids.begin());
    const Quaternion& q = whole.frames.frames[s];
    const Vector3& axis = whole.frames.axes[s];
    return SentFrame{{q.x(), q.y(), q.z(), q.w()},
                     {axis.x(), axis.y(), axis.z()},
                     static_cast<std::int64_t>(whole.frames.constraints[s])};
  });
  for (std::size_t i = 0; i < own.size(); ++i) {
    const SentFrame& sent = answers[0][i];
    frames[own[i]] = Quaternion(sent.frame[3], sent.frame[0], sent.frame[1], sent.frame[2]);
    axes[own[i]] = Vector3(sent.axis[0], sent.axis[1], sent.axis[2]);
    constraints[own[i]] = static_cast<FrameConstraint>(sent.constraint);
  }
  holding.refresh(std::span(frames));
  holding.refresh(std::span(axes));
  holding.refresh(std::span(constraints));
}

}  // namespace framehex::distributed::detail
