// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/distributed/detail/remote_boundary.hpp"

namespace framehex::distributed::detail {

/// A part of a field along the curve: what `FrameField` is for the whole.
class FieldPart {
public:
  FieldPart(const RowExchange& exchange, TetAdjacency adjacency)
      : exchange_(exchange),
        holding_(exchange),
        adjacency_(std::move(adjacency)),
        frames_(points().size(), Quaternion::Identity()),
        smoothness_(points().size(), 1.0),
        constraints_(points().size(), FrameConstraint::none),
        axes_(points().size(), Vector3::Zero()) {}

  const TetAdjacency& adjacency() const { return adjacency_; }
  const std::vector<Vector3>& points() const { return exchange_.part().mesh.points; }
  const std::vector<Quaternion>& frames() const { return frames_; }
  const std::vector<double>& smoothness() const { return smoothness_; }
  const std::vector<FrameConstraint>& constraints() const { return constraints_; }
  const std::vector<Vector3>& axes() const { return axes_; }

  void constrain(const WholeBoundary& whole, bool fixed) {
    detail::constrain(exchange_, adjacency_, whole, frames_, constraints_, axes_);
    for (FrameConstraint& c : constraints_)
      if (fixed && c == FrameConstraint::axis) c = FrameConstraint::fixed;
  }

  template <class E>
  void start_nearest(WholeBoundary& whole, const E& executor) {
    share(exchange_.transport(), whole);
    framehex::start_nearest(points(), constraints_, whole.surface, whole.frames, SurfaceLocator(whole.surface.view()),
                            frames_, executor);
    update_smoothness(executor);
  }

  template <class E>
  SmoothingReport smooth(const SmoothingOptions& options, const E& executor) {
    return smooth_frames(adjacency_, frames_, smoothness_, constraints_, axes_, options, executor, holding_);
  }

  template <class E>
  DiffusionReport diffuse(const DiffusionOptions& options, const E& executor) {
    const DiffusionReport report = diffuse_frames(
        adjacency_, std::span<const Vector3>(points()), std::span<Quaternion>(frames_),
        std::span<const FrameConstraint>(constraints_), std::span<const Vector3>(axes_), options, executor, holding_);
    update_smoothness(executor);
    return report;
  }

  /// Loops are few: what lies round them goes to the first rank, which goes through them as through a whole mesh.
  std::size_t remove_small_loops() {
    std::size_t n_removed = 0;
    while (const std::size_t n = remove_once()) n_removed += n;
    if (n_removed > 0) update_smoothness(SerialExecutor{});
    return n_removed;
  }

  void align() {}

private:
  using Edge = std::array<std::int64_t, 2>;

  struct SentVertex {
    std::int64_t id;
    SentFrame frame;
  };
  struct SentCell {
    std::int64_t id;
    std::array<std::int64_t, 4> vertices;
  };
  struct NewFrame {
    std::int64_t id;
    std::array<double, 4> frame;
  };

  template <class E>
  void update_smoothness(const E& executor) {
    smoothness_ = frame_smoothness(adjacency_, frames_, executor);
    holding_.refresh(std::span(smoothness_));
  }

  /// @return how many edges were mended, by all ranks.
  std::size_t remove_once() {
    const CurvePart& part = exchange_.part();
    const auto n_ranks = static_cast<std::size_t>(exchange_.transport().n_ranks());
    std::vector<std::vector<Edge>> edges(n_ranks);
    std::vector<index_t> ends;
    const framehex::detail::LoopRemover remover(adjacency_, frames_, constraints_, axes_);
    for (const auto& [v, w] : remover.candidates()) {
      if (holding_.is_own(v)) edges[0].push_back({part.vertex_ids[v], part.vertex_ids[w]});
      for (const index_t end : {v, w})
        if (holding_.is_own(end)) ends.push_back(end);
    }
    if (holding_.total(static_cast<std::int64_t>(edges[0].size())) == 0) return 0;
    std::vector<std::vector<SentVertex>> vertices(n_ranks);
    std::vector<std::vector<SentCell>> cells(n_ranks);
    collect_round(ends, vertices[0], cells[0]);
    const std::vector<Parcel> arrived = exchange_.transport().exchange(parcels_of(edges, vertices, cells));
    std::vector<NewFrame> changed;
    std::int64_t n_removed = arrived.empty() ? 0 : remove_here(arrived, changed);
    for (const NewFrame& f : gathered(exchange_.transport(), changed)) {
      const index_t v = part.vertex(f.id);
      if (v < part.vertex_ids.size() && part.vertex_ids[v] == f.id)
        frames_[v] = Quaternion(f.frame[3], f.frame[0], f.frame[1], f.frame[2]);
    }
    return static_cast<std::size_t>(holding_.total(n_removed));
  }

  /// The tetrahedra round some vertices, with what is known at their corners.
  void collect_round(std::vector<index_t>& ends, std::vector<SentVertex>& vertices,
                     std::vector<SentCell>& cells) const {
    const CurvePart& part = exchange_.part();
    std::vector<index_t> tets, corners;
    for (const index_t v : ends) {
      const auto round = adjacency_.tets_of_vertex[v];
      tets.insert(tets.end(), round.begin(), round.end());
    }
    std::sort(tets.begin(), tets.end());
    tets.erase(std::unique(tets.begin(), tets.end()), tets.end());
    for (const index_t tet : tets) {
      SentCell& cell = cells.emplace_back(SentCell{part.cell_ids[tet], {}});
      for (std::size_t i = 0; i < 4; ++i) {
        cell.vertices[i] = part.vertex_ids[adjacency_.tets[tet][i]];
        corners.push_back(adjacency_.tets[tet][i]);
      }
    }
    std::sort(corners.begin(), corners.end());
    corners.erase(std::unique(corners.begin(), corners.end()), corners.end());
    for (const index_t v : corners)
      vertices.push_back({part.vertex_ids[v],
                          {{frames_[v].x(), frames_[v].y(), frames_[v].z(), frames_[v].w()},
                           {axes_[v].x(), axes_[v].y(), axes_[v].z()},
                           static_cast<std::int64_t>(constraints_[v])}});
  }

  /// On the first rank. Both stand in the order of the whole mesh, in which the serial removal looks at them too.
  static std::int64_t remove_here(const std::vector<Parcel>& arrived, std::vector<NewFrame>& changed) {
    std::vector<Edge> edges;
    std::vector<SentVertex> vertices;
    std::vector<SentCell> cells;
    for (const Parcel& p : arrived) {
      Unpacker in(p.bytes);
      const auto append = [](auto& all, const auto& some) { all.insert(all.end(), some.begin(), some.end()); };
      append(edges, in.take<Edge>());
      append(vertices, in.take<SentVertex>());
      append(cells, in.take<SentCell>());
    }
    std::sort(edges.begin(), edges.end());
    const auto sort_once = [](auto& all, auto member) {
      std::ranges::sort(all, {}, member);
      const auto repeated = std::ranges::unique(all, {}, member);
      all.erase(repeated.begin(), repeated.end());
    };
    sort_once(vertices, &SentVertex::id);
    sort_once(cells, &SentCell::id);
    const auto number = [&](std::int64_t id) {
      return static_cast<index_t>(std::ranges::lower_bound(vertices, id, {}, &SentVertex::id) - vertices.begin());
    };
    IndexedTetMesh mesh{std::vector<Vector3>(vertices.size(), Vector3::Zero()), {}};
    for (const SentCell& c : cells)
      mesh.tets.push_back({number(c.vertices[0]), number(c.vertices[1]), number(c.vertices[2]), number(c.vertices[3])});
    std::vector<Quaternion> frames;
    std::vector<FrameConstraint> constraints;
    std::vector<Vector3> axes;
    for (const SentVertex& v : vertices) {
      frames.emplace_back(v.frame.frame[3], v.frame.frame[0], v.frame.frame[1], v.frame.frame[2]);
      constraints.push_back(static_cast<FrameConstraint>(v.frame.constraint));
      axes.emplace_back(v.frame.axis[0], v.frame.axis[1], v.frame.axis[2]);
    }
    const TetAdjacency adjacency = make_adjacency(mesh);
    framehex::detail::LoopRemover remover(adjacency, frames, constraints, axes);
    std::int64_t n_removed = 0;
    for (const Edge& edge : edges) {
      const std::array<index_t, 2> ends{number(edge[0]), number(edge[1])};
      if (!remover.remove_at(ends)) continue;
      ++n_removed;
      for (const index_t v : ends) {
        const Quaternion& q = frames[v];
        changed.push_back({vertices[v].id, {q.x(), q.y(), q.z(), q.w()}});
      }
    }
    return n_removed;
  }

  const RowExchange& exchange_;
  PartHolding holding_;
  TetAdjacency adjacency_;
  std::vector<Quaternion> frames_;
  std::vector<double> smoothness_;
  std::vector<FrameConstraint> constraints_;
  std::vector<Vector3> axes_;
};

}  // namespace framehex::distributed::detail
