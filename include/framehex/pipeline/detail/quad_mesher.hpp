// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/geometry/bounding_box.hpp"
#include "framehex/pipeline/detail/curve_limits.hpp"
#include "framehex/pipeline/detail/stopwatch.hpp"
#include "framehex/pipeline/quad_meshing.hpp"
#include "framehex/quads/detail/thin_strips.hpp"
#include "framehex/quads/even_intervals.hpp"
#include "framehex/surface/limited_size.hpp"
#include "framehex/surface/refinement.hpp"
#include "framehex/surface/surface_locator.hpp"

#include <optional>
#include <utility>

namespace framehex::detail {

/// The job of `mesh_planar` and `mesh_shell`, stage by stage; each method leaves what the next ones read.
class QuadMesher {
public:
  QuadMesher(const MatcherRef& matcher, const SizeFieldRef& size, QuadMeshingOptions options)
      : matcher_(matcher), asked_size_(size), size_(size), options_(std::move(options)) {
    options_.improvement.max_deviation = options_.retriangulation.max_deviation;
    options_.curves.added = {};
    options_.surface.complete = {};
    options_.quads.frames = {};
    if (!options_.observer) return;
    for (Observer* observer : {&options_.cross_field.observer, &options_.curves.observer, &options_.surface.observer,
                               &options_.retriangulation.observer, &options_.improvement.observer})
      *observer = options_.observer;
  }

  /// Limits of the size that points inside patches keep besides, not those of curves.
  void limit_inside(std::vector<SizeLimit> limits) { inside_ = std::move(limits); }

  /// Begins with limits that another run has ended with: what it took to come near the input is not looked for again.
  void limit(std::span<const SizeLimit> limits) { size_.add(limits); }

  /// Those that there are now.
  const std::vector<SizeLimit>& limits() const { return size_.limits(); }
  double size_at(const Vector3& p) const { return size_(p); }

  QuadMeshing run(Surface input) {
    input_ = std::move(input);
    diagonal_ = bounding_box(input_.points).diagonal().norm();
    add_corners(input_.features, distinct_bends(input_, size_, options_.bends));
    if (!follow_curves()) return cancelled<QuadMeshing>();
    locator_ = SurfaceLocator(input_);
    carriers_ = FeatureCarriers(input_);
    if (!refine_surface()) return cancelled<QuadMeshing>();
    keep_tips();
    watch_.lap(result_.seconds.preparation);
    if (!make_field()) return cancelled<QuadMeshing>();
    watch_.lap(result_.seconds.field);
    // No cell that is folded is ever handed out: where one is left, the next attempt gives it more room, and the last
    // resort are triangles. Where the input is far from a sound mesh, the next has a smaller size.
    for (int n_folded = 0, n_far = 0, n_coarse = 0; n_folded < most_widenings;) {
      if (!fill_patches()) return cancelled<QuadMeshing>();
      // Few cells for a large body are not worth improving.
      if (result_.mesh.cells.size() < few_cells && n_coarse < usual_shrinkings)
        if (const std::vector<SizeLimit> limits = limits_where_far();
            result_.statistics.deviation > far_off * options_.retriangulation.max_deviation) {
          ++n_coarse;
          shrink(limits);
          continue;
        }
      if (!improve(options_.improvement)) return cancelled<QuadMeshing>();
      watch_.lap(result_.seconds.improvement);
      const std::vector<SizeLimit> limits = limits_where_far();
      if (folded_.empty()) {
        if (limits.empty()) return std::move(result_);
        if (!sound_ || result_.statistics.deviation < sound_->statistics.deviation) sound_ = result_;
        const bool near = sound_->statistics.deviation <= near_enough * options_.retriangulation.max_deviation;
        if (n_far == most_shrinkings || (n_far >= usual_shrinkings && near)) break;
      }
      // Far from the input cells may be folded because there are too few of them.
      if (!limits.empty() && n_far < most_shrinkings) {
        if (++n_far > usual_shrinkings) shrink_margin_ = 0.65;
        shrink(limits);
        continue;
      }
      if (n_folded > 3 && folded_.size() >= folded_before_) break;
      folded_before_ = folded_.size();
      remember_folded();
      // Where wider strips have not helped, curves get other numbers of intervals.
      if (n_folded > 0) shrink(limits_where_folded());
      ++n_folded;
    }
    if (sound_) {
      sound_->seconds = result_.seconds;
      sound_->statistics.n_tried_changes = result_.statistics.n_tried_changes;
      return std::move(*sound_);
    }
    if (!leave_triangles()) return cancelled<QuadMeshing>();
    limits_where_far();
    return std::move(result_);
  }

private:
  static constexpr double halved = 2.5;       ///< triangles whose edges are halved to be short, by those that just are
  static constexpr int most_widenings = 7;    ///< attempts that leave folded cells
  static constexpr int usual_shrinkings = 5;  ///< attempts that are too far from the input, after the first
  static constexpr int most_shrinkings = 12;  ///< the same, where even the nearest is much too far
  static constexpr double near_enough = 1.2;  ///< by the deviation that is wanted: not much too far
  static constexpr double far_off = 2;        ///< the same: much too far
  static constexpr std::size_t few_cells = 1000;
  static constexpr double least_shrink = 0.4;   ///< of the size, where the mesh is too far from the input
  static constexpr int most_curve_rounds = 30;  ///< of shrinking along curves

  /// Makes the size smaller where the sides of curves would be too far from them. Bends that stand out at that size are
  /// corners then. @return false when told to stop.
  bool follow_curves() {
    const double tolerance = options_.retriangulation.max_deviation * diagonal_;
    if (!std::isfinite(tolerance)) return true;
    for (int round = 0; round < most_curve_rounds; ++round) {
      const CurveInsertion curves = insert_curve_points(input_, size_, options_.curves);
      if (curves.status == Status::cancelled) return false;
      const std::vector<SizeLimit> limits = limits_of_curves(input_, curves, asked_size_, size_, tolerance);
      if (limits.empty()) break;
      size_.add(limits);
      add_corners(input_.features, distinct_bends(input_, size_, options_.bends));
    }
    const CurveInsertion curves = insert_curve_points(input_, size_, options_.curves);
    if (curves.status == Status::cancelled) return false;
    size_.add(limits_beside_short_curves(input_, curves, size_));
    result_.statistics.n_shrunk_places = size_.limits().size();
    return true;
  }

  /// @return false when told to stop.
  bool fill_patches() {
    if (!going("surface insertion") || !sample_surface()) return false;
    watch_.lap(result_.seconds.insertion);
    if (!retriangulate_surface()) return false;
    watch_.lap(result_.seconds.triangulation);
    if (!going("quadrangulation")) return false;
    join_triangles();
    watch_.lap(result_.seconds.quadrangulation);
    return true;
  }

  /// Tips that stand out at the size as it is become corners.
  void keep_tips() {
    const std::vector<index_t> tips = distinct_tips(input_, size_, options_.tips);
    add_tips(input_.features, tips);
    add_tips(result_.background.features, tips);  // the input's vertices keep their numbers
  }

  void shrink(const std::vector<SizeLimit>& limits) {
    size_.add(limits);
    keep_tips();
    result_.statistics.n_shrunk_places = size_.limits().size();
  }

  /// Joins no triangles but those that make a convex quadrilateral and share an edge, and keeps cells so.
  bool leave_triangles() {
    folded_places_.clear();
    options_.quads.goal = QuadGoal::pairs;
    QuadImprovementOptions improvement = options_.improvement;
    improvement.rounds = improvement.sweeps = 0;  // to find out what is folded
    if (!sample_surface()) return false;
    watch_.lap(result_.seconds.insertion);
    if (!retriangulate_surface()) return false;
    watch_.lap(result_.seconds.triangulation);
    join_triangles();
    watch_.lap(result_.seconds.quadrangulation);
    if (!improve(improvement)) return false;
    split_folded();
    if (options_.improvement.scope != QuadImprovementScope::folded) improvement = options_.improvement;
    improvement.scope = QuadImprovementScope::sound;
    if (!improve(improvement)) return false;
    if (!folded_.empty()) refuse();
    result_.statistics.n_left_triangles = result_.mesh.n_triangles();
    watch_.lap(result_.seconds.improvement);
    return true;
  }

  /// Back to the two triangles that a quadrilateral was joined of.
  void split_folded() {
    QuadMesh& mesh = result_.mesh;
    for (const index_t cell : folded_) {
      const QuadMesh::Cell c = mesh.cells[cell];
      if (c[3] == no_index) continue;
      mesh.cells[cell] = {c[0], c[1], c[2], no_index};
      mesh.cells.push_back({c[0], c[2], c[3], no_index});
      mesh.patches.push_back(index_t{mesh.patches[cell]});
    }
  }

  bool going(std::string_view stage) const { return keep_going(options_.observer, stage, 0); }

  /// Triangles no longer than the mean size, unless that makes too many: crosses are one a triangle.
  bool refine_surface() {
    const double n_points = estimate_surface_points(input_, size_).n_points;
    check_estimate("surface", n_points, options_.surface.max_points);
    double sum = 0;
    index_t hint = no_index;
    for (const Vector3& p : input_.points) sum += checked_size(size_, p, hint);
    const double n_triangles = halved * 2 * n_points;
    const double coarser = std::sqrt(std::max(1.0, n_triangles / options_.max_field_triangles));
    const double edge = coarser * sum / static_cast<double>(input_.points.size());
    RefinedSurface refined =
        refine(input_, [edge](const Vector3&) { return edge; }, {.locator = &locator_, .observer = options_.observer});
    if (refined.status == Status::cancelled) return false;
    result_.background = std::move(refined.surface);
    result_.statistics.n_feature_curves = input_.features.curves.size();
    result_.statistics.n_patches = input_.features.n_patches;
    return true;
  }

  bool make_field() {
    result_.cross_field = compute_cross_field(result_.background, options_.cross_field);
    result_.statistics.n_singularities = result_.cross_field.singularities.size();
    return result_.cross_field.status != Status::cancelled;
  }

  bool sample_surface() {
    const Surface& surface = result_.background;
    CurveInsertion curves = insert_curve_points(surface, size_, options_.curves);
    if (curves.status == Status::cancelled) return false;
    const std::vector<index_t> longer = curves_to_lengthen(surface, curves.n_intervals);
    if (!longer.empty()) {
      std::vector<index_t> added(curves.n_intervals.size(), 0);
      for (const index_t c : longer) added[c] = 1;
      CurveOptions options = options_.curves;
      options.added = added;
      curves = insert_curve_points(surface, size_, options);
      if (curves.status == Status::cancelled) return false;
    }
    result_.statistics.lengthened_curves = longer;
    LimitedSize<SizeFieldRef> size = size_;
    if (!inside_.empty()) size.add(inside_);
    const auto insert = [&](auto order) {
      return insert_surface_points(surface, result_.cross_field.frames, result_.cross_field.smoothness, curves, size,
                                   options_.surface, order);
    };
    samples_ = options_.order == FrontOrder::fifo ? insert(FifoOrder{}) : insert(SmoothnessOrder{});
    result_.statistics.n_points = samples_.samples.size();
    return samples_.status != Status::cancelled;
  }

  bool retriangulate_surface() {
    Retriangulation again = retriangulate(result_.background, samples_.samples, options_.retriangulation);
    if (again.status == Status::cancelled) return false;
    result_.statistics.n_unremoved_vertices = again.n_unremoved;
    result_.statistics.n_added_vertices = again.n_added;
    surface_ = std::move(again.surface);
    widen_thin_strips();
    // Vertices that were added or had to stay may have made a patch odd again.
    result_.statistics.n_split_edges = 0;
    std::vector<index_t> n_intervals;
    for (std::size_t c = 0; c < surface_.features.curves.size(); ++c)
      n_intervals.push_back(static_cast<index_t>(surface_.features.curves[c].size() - 1));
    for (const index_t curve : curves_to_lengthen(surface_, n_intervals)) {
      halve_longest_edge(surface_, curve);
      ++result_.statistics.n_split_edges;
    }
    result_.statistics.n_triangles = surface_.triangles().size();
    return true;
  }

  /// Strips of one triangle's width, where an attempt has left folded cells, become two cells wide: a corner that is
  /// sharp, and curves that meet there, need vertices between them.
  void widen_thin_strips() {
    if (folded_places_.empty()) return;
    const std::vector<EdgeHalver::Edge> across = edges_across_strips(surface_, folded_places_);
    EdgeHalver(surface_).run(across);
    result_.statistics.n_widened_edges = across.size();
  }

  void join_triangles() {
    const std::vector<Quaternion> frames = triangle_frames();
    QuadrangulationOptions options = options_.quads;
    options.frames = frames;
    samples_ = {};
    Quadrangulation quads = quadrangulate(surface_, matcher_, options);
    surface_ = {};
    result_.statistics.n_opened_vertices = quads.copied.size();
    result_.mesh = std::move(quads.mesh);
  }

  /// Of each triangle: the cross of a sample inside a patch, or along its longest edge where it has none.
  std::vector<Quaternion> triangle_frames() const {
    std::vector<Quaternion> frames;
    for (const auto& t : surface_.triangles()) {
      index_t inside = no_index;
      for (const index_t v : t)
        if (inside == no_index && v < samples_.samples.size() && samples_.samples[v].kind == SampleKind::surface)
          inside = v;
      frames.push_back(inside != no_index ? samples_.frames[inside] : edge_frame(t));
    }
    return frames;
  }

  Quaternion edge_frame(const std::array<index_t, 3>& t) const {
    Eigen::Matrix3d axes;
    Vector3 x = Vector3::Zero();
    for (std::size_t i = 0; i < 3; ++i) {
      const Vector3 edge = surface_.points[t[(i + 1) % 3]] - surface_.points[t[i]];
      if (edge.squaredNorm() > x.squaredNorm()) x = edge;
    }
    const Vector3 a = surface_.points[t[1]] - surface_.points[t[0]], b = surface_.points[t[2]] - surface_.points[t[0]];
    const Vector3 normal = a.cross(b);
    if (!(normal.norm() > 0)) return Quaternion::Identity();
    axes.col(0) = x.normalized();
    axes.col(2) = normal.normalized();
    axes.col(1) = axes.col(2).cross(axes.col(0));
    return Quaternion(axes).normalized();
  }

  bool improve(const QuadImprovementOptions& options) {
    QuadImprovement improved = improve_quads(result_.mesh, carriers_, options);
    if (improved.status != Status::complete) return false;
    result_.mesh = std::move(improved.mesh);
    folded_ = std::move(improved.folded);
    result_.statistics.n_unfolded = improved.n_folded_given;
    result_.statistics.n_tried_changes += improved.n_tried;
    return true;
  }

  Vector3 centre(index_t cell) const {
    const QuadMesh::Cell& corners = result_.mesh.cells[cell];
    Vector3 sum = Vector3::Zero();
    const std::size_t n = QuadMesh::n_corners(corners);
    for (std::size_t i = 0; i < n; ++i) sum += result_.mesh.points[corners[i]];
    return sum / static_cast<double>(n);
  }

  /// Lengths that bring mesh and input nearer to each other, where they are farther apart than is allowed: curves from
  /// the sides along them, vertices of the background from the mesh, the middles of cells and of their edges from the
  /// input.
  std::vector<SizeLimit> limits_where_far() {
    const double tolerance = options_.retriangulation.max_deviation * diagonal_;
    double& farthest = result_.statistics.deviation = 0;
    std::vector<SizeLimit> limits;
    const auto add = [&](const Vector3& p, double distance) {
      farthest = std::max(farthest, distance / diagonal_);
      if (distance <= tolerance) return;
      // Of a curved surface chords are off by the square of their length.
      const double ratio = std::max(least_shrink, shrink_margin_ * std::sqrt(tolerance / distance));
      limits.push_back({p, ratio * std::min(size_(p), diagonal_)});
    };
    for (const LabelledEdge& edge : result_.mesh.edges) {
      const auto& p = result_.mesh.points;
      const auto far = carriers_.farthest_from_chord(edge.label, p[edge.vertices[0]], p[edge.vertices[1]]);
      add(far.point, far.distance);
    }
    if (bounding_box(input_.points).sizes().minCoeff() == 0) return limits;  // all lies in a plane
    IndexedTriangleMesh mesh{result_.mesh.points, {}};
    for (index_t q = 0; q < result_.mesh.cells.size(); ++q) {
      const QuadMesh::Cell& c = result_.mesh.cells[q];
      mesh.triangles.push_back({c[0], c[1], c[2]});
      if (c[3] != no_index) mesh.triangles.push_back({c[0], c[2], c[3]});
      const Vector3 middle = centre(q);
      double radius = 0;
      for (std::size_t i = 0; i < QuadMesh::n_corners(c); ++i)
        radius = std::max(radius, (mesh.points[c[i]] - middle).norm());
      if (radius <= tolerance) continue;  // its corners are on the input
      add(middle, locator_.nearest(middle).distance);
      for (std::size_t i = 0, n = QuadMesh::n_corners(c); i < n; ++i) {
        const Vector3 p = (mesh.points[c[i]] + mesh.points[c[(i + 1) % n]]) / 2;
        add(p, locator_.nearest(p).distance);
      }
    }
    const SurfaceLocator to_mesh(mesh);
    const Surface& surface = result_.background;
    for (index_t v = 0; v < surface.points.size(); ++v)
      if (!surface.adjacency.triangles_of_vertex[v].empty())
        add(surface.points[v], to_mesh.nearest(surface.points[v]).distance);
    return limits;
  }

  /// Half the longest side of each folded cell.
  std::vector<SizeLimit> limits_where_folded() const {
    std::vector<SizeLimit> limits;
    for (const index_t q : folded_) {
      const QuadMesh::Cell& c = result_.mesh.cells[q];
      double longest = 0;
      for (std::size_t i = 0, n = QuadMesh::n_corners(c); i < n; ++i)
        longest = std::max(longest, (result_.mesh.points[c[(i + 1) % n]] - result_.mesh.points[c[i]]).norm());
      limits.push_back({centre(q), longest / 2});
    }
    return limits;
  }

  void remember_folded() {
    for (const index_t cell : folded_) folded_places_.push_back(centre(cell));
  }

  [[noreturn]] void refuse() const {
    const auto& near = input_.triangles()[locator_.nearest(centre(folded_.front())).triangle];
    throw invalid_surface("no cell of this size fits between vertices " + std::to_string(near[0]) + ", " +
                              std::to_string(near[1]) + " and " + std::to_string(near[2]) +
                              ": the domain is too thin, or turns too much, for the size there",
                          Entity::vertex, {near[0], near[1], near[2]});
  }

  const MatcherRef& matcher_;
  const SizeFieldRef& asked_size_;
  LimitedSize<SizeFieldRef> size_;
  QuadMeshingOptions options_;
  std::vector<SizeLimit> inside_;

  Stopwatch watch_;
  QuadMeshing result_;
  std::optional<QuadMeshing> sound_;  // of the attempt without folded cells that was nearest to the input
  Surface input_;
  SurfaceLocator locator_;    // of the input
  FeatureCarriers carriers_;  // the same
  double diagonal_ = 0;       // of the box round it
  Surface surface_;           // through the samples
  SurfaceInsertion samples_;
  double shrink_margin_ = 0.8;          // to a size that would just do
  std::vector<index_t> folded_;         // cells of the last attempt
  std::size_t folded_before_ = 0;       // number of those of the one before
  std::vector<Vector3> folded_places_;  // of all attempts
};

}  // namespace framehex::detail
