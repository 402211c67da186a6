// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/geometry/bounding_box.hpp"
#include "framehex/surface/detail/sample_insertion.hpp"
#include "framehex/surface/detail/surface_fit.hpp"
#include "framehex/surface/detail/vertex_removal.hpp"
#include "framehex/surface/retriangulation.hpp"

namespace framehex {

namespace detail {

class Retriangulator {
public:
  Retriangulator(const Surface& input, std::span<const SurfaceSample> samples, const RetriangulationOptions& options)
      : features_(input.features),
        n_input_vertices_(static_cast<index_t>(input.points.size())),
        samples_(samples),
        pulse_(options.observer, "retriangulation"),
        options_(options),
        diagonal_(bounding_box(input.points).diagonal().norm()),
        surface_(input),
        normals_(surface_, input.adjacency),
        chains_(input.points, features_.curves),
        inserter_(surface_, normals_, features_, samples, chains_, pulse_) {}

  Retriangulation run() {
    pulse_.report(0);
    inserter_.run();
    pulse_.report(0.4);
    VertexRemover remover(surface_, normals_, pulse_);
    remover.flipper().push_all();
    remover.flipper().run(DelaunayFlipper::Scope::within_patches);
    remove_unwanted(remover);
    chains_.drop_dead([&](index_t v) { return surface_.half_edge_of[v] != no_index; });
    pulse_.report(0.7);
    first_added_ = static_cast<index_t>(surface_.points.size());
    const double tolerance = options_.max_deviation * diagonal_;
    if (std::isfinite(tolerance))
      SurfaceFit(surface_, normals_, remover.flipper(), features_, tolerance, pulse_).run(fit_rounds);
    pulse_.report(0.8);
    std::vector<std::array<index_t, 2>> crossings;
    if (options_.repair_rounds >= 0)
      crossings = SurfaceRepair(surface_, normals_, chains_, remover.flipper(), pulse_).run(options_.repair_rounds);
    if (!pulse_.report(1)) return cancelled<Retriangulation>();
    Retriangulation r = result();
    r.crossings = std::move(crossings);
    return r;
  }

private:
  static constexpr int fit_rounds = 12;

  /// Vertices inside patches first: those on curves would otherwise have to step over them.
  void remove_unwanted(VertexRemover& remover) {
    std::vector<index_t> inside, on_curves;
    std::vector<char> corner(surface_.points.size(), 0);
    for (const index_t v : features_.corners) corner[v] = 1;
    for (index_t v = 0; v < n_input_vertices_; ++v) {
      if (inserter_.sample_of_vertex()[v] != no_index || corner[v] || surface_.half_edge_of[v] == no_index) continue;
      (remover.feature_valence(v) == 0 ? inside : on_curves).push_back(v);
    }
    const double upright = std::cos(options_.max_bend);
    std::vector<VertexRemover::Limits> passes{
        {std::max(0.8, upright), 0.05}, {upright, 1e-2}, {upright, 1e-3}, {upright / 2, 1e-3}, {0.05, 1e-4}};
    if (options_.least_shape < passes.back().shape) passes.push_back({passes.back().upright, options_.least_shape});
    for (const VertexRemover::Limits& limits : passes) {
      for (std::size_t before = no_index; inside.size() + on_curves.size() < before;) {
        before = inside.size() + on_curves.size();
        remover.run(inside, limits);
        remover.run(on_curves, limits);
      }
    }
    remover.flipper().push_all();
    remover.flipper().run(DelaunayFlipper::Scope::within_patches);
  }

  Retriangulation result() const {
    Retriangulation r;
    std::vector<index_t> new_index(surface_.points.size(), no_index);
    std::vector<Vector3>& points = r.surface.points;
    FeatureGraph& features = r.surface.features;
    std::vector<std::array<index_t, 3>> triangles;
    for (const SurfaceSample& s : samples_) points.push_back(s.point);
    for (index_t i = 0; i < samples_.size(); ++i)
      surface_.for_each_copy(inserter_.vertex_of_sample()[i], [&](index_t copy) { new_index[copy] = i; });
    for (index_t v = 0; v < surface_.points.size(); ++v) {
      if (new_index[v] != no_index || surface_.half_edge_of[v] == no_index) continue;
      surface_.for_each_copy(v, [&](index_t copy) { new_index[copy] = static_cast<index_t>(points.size()); });
      points.push_back(surface_.points[v]);
      ++(v < first_added_ ? r.n_unremoved : r.n_added);
    }
    for (index_t t = 0; t < surface_.n_triangles(); ++t) {
      if (!surface_.alive(t)) continue;
      const auto& v = surface_.corners[t];
      triangles.push_back({new_index[v[0]], new_index[v[1]], new_index[v[2]]});
      features.triangle_patch.push_back(surface_.patch[t]);
      for (index_t h = 3 * t; h < 3 * t + 3; ++h) features.is_feature.push_back(surface_.feature[h]);
    }
    features.n_patches = features_.n_patches;
    for (const index_t v : features_.corners)
      if (new_index[v] != no_index) features.corners.push_back(new_index[v]);
    std::sort(features.corners.begin(), features.corners.end());
    for (std::size_t c = 0; c < chains_.size(); ++c) {
      for (const auto& link : chains_.row(c)) features.curves.values.push_back(new_index[link.vertex]);
      features.curves.end_row();
    }
    r.surface.adjacency = make_adjacency(TriangleView{points, triangles}, Junctions::open);
    return r;
  }

  const FeatureGraph& features_;
  index_t n_input_vertices_;
  std::span<const SurfaceSample> samples_;
  Pulse pulse_;
  const RetriangulationOptions& options_;
  double diagonal_;  // of the box round the input
  EditableSurface surface_;
  SectorNormals normals_;
  CurveChains chains_;
  SampleInserter inserter_;
  index_t first_added_ = no_index;
};

}  // namespace detail

FRAMEHEX_INLINE Retriangulation retriangulate(const Surface& surface, std::span<const SurfaceSample> samples,
                                              const RetriangulationOptions& options) {
  check_options(options);
  return detail::Retriangulator(surface, samples, options).run();
}

}  // namespace framehex
