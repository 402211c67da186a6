// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/pipeline/detail/stopwatch.hpp"
#include "framehex/pipeline/quad_meshing.hpp"
#include "framehex/quads/even_intervals.hpp"
#include "framehex/surface/refinement.hpp"

#include <utility>

namespace framehex::detail {

/// The job of `mesh_planar` and `mesh_shell`, stage by stage; each method leaves what the next ones read.
template <Matcher Match, SizeField Size>
class QuadMesher {
public:
  QuadMesher(const Match& matcher, const Size& size, QuadMeshingOptions options)
      : matcher_(matcher), size_(size), options_(std::move(options)) {
    options_.curves.added = {};
    options_.surface.complete = {};
    if (options_.observer) options_.surface.observer = options_.observer;
  }

  QuadMeshing run(Surface input) {
    input_ = std::move(input);
    locator_ = SurfaceLocator(input_);
    refine_surface();
    watch_.lap(result_.seconds.preparation);
    if (!going("cross field")) return cancelled();
    make_field();
    watch_.lap(result_.seconds.field);
    if (!going("surface insertion") || !sample_surface()) return cancelled();
    watch_.lap(result_.seconds.insertion);
    if (!going("retriangulation")) return cancelled();
    retriangulate_surface();
    watch_.lap(result_.seconds.triangulation);
    if (!going("quadrangulation")) return cancelled();
    join_triangles();
    watch_.lap(result_.seconds.quadrangulation);
    result_.mesh = improve_quads(result_.mesh, FeatureCarriers(input_), options_.improvement).mesh;
    watch_.lap(result_.seconds.improvement);
    return std::move(result_);
  }

private:
  QuadMeshing cancelled() const {
    QuadMeshing nothing;
    nothing.status = Status::cancelled;
    return nothing;
  }

  bool going(std::string_view stage) const { return keep_going(options_.observer, stage, 0); }

  /// Triangles no longer than the mean size: crosses are one a triangle.
  void refine_surface() {
    check_estimate("surface", estimate_surface_points(input_, size_).n_points, options_.surface.max_points);
    double sum = 0;
    index_t hint = no_index;
    for (const Vector3& p : input_.points) sum += checked_size(size_, p, hint);
    const double edge = sum / static_cast<double>(input_.points.size());
    surface_ = refine(input_, [edge](const Vector3&) { return edge; }, {.locator = &locator_}).surface;
    result_.statistics.n_feature_curves = surface_.features.curves.size();
    result_.statistics.n_patches = surface_.features.n_patches;
  }

  void make_field() {
    cross_field_ = compute_cross_field(surface_, options_.cross_field);
    result_.statistics.n_singularities = cross_field_.singularities.size();
  }

  bool sample_surface() {
    CurveInsertion curves = insert_curve_points(surface_, size_, options_.curves);
    const std::vector<index_t> longer = curves_to_lengthen(surface_, curves.n_intervals);
    if (!longer.empty()) {
      std::vector<index_t> added(curves.n_intervals.size(), 0);
      for (const index_t c : longer) added[c] = 1;
      CurveOptions options = options_.curves;
      options.added = added;
      curves = insert_curve_points(surface_, size_, options);
    }
    result_.statistics.lengthened_curves = longer;
    const auto insert = [&](auto order) {
      return insert_surface_points(surface_, cross_field_.frames, cross_field_.smoothness, curves, size_,
                                   options_.surface, order);
    };
    samples_ = options_.order == FrontOrder::fifo ? insert(FifoOrder{}) : insert(SmoothnessOrder{});
    result_.statistics.n_points = samples_.samples.size();
    return samples_.status != Status::cancelled;
  }

  void retriangulate_surface() {
    Retriangulation again = retriangulate(surface_, samples_.samples, options_.retriangulation);
    result_.statistics.n_unremoved_vertices = again.n_unremoved;
    result_.statistics.n_added_vertices = again.n_added;
    surface_ = std::move(again.surface);
    result_.statistics.n_triangles = surface_.triangles().size();
  }

  void join_triangles() {
    Quadrangulation quads = quadrangulate(surface_, matcher_, options_.quads);
    result_.statistics.n_opened_vertices = quads.copied.size();
    result_.mesh = std::move(quads.mesh);
  }

  const Match& matcher_;
  const Size& size_;
  QuadMeshingOptions options_;

  Stopwatch watch_;
  QuadMeshing result_;
  Surface input_;
  SurfaceLocator locator_;  // of the input
  Surface surface_;         // the input with short edges, then its new triangulation
  SurfaceCrossField cross_field_;
  SurfaceInsertion samples_;
};

}  // namespace framehex::detail
