// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/surface/detail/sample_insertion.hpp"
#include "framehex/surface/detail/vertex_removal.hpp"

namespace framehex {

/// A surface whose vertices are chosen samples.
struct Retriangulation {
  IndexedTriangleMesh surface;  ///< vertices: the samples in their order, then what could not be removed
  FeatureGraph features;        ///< of `surface`; the corners, curves and patches of the input
  std::size_t n_unremoved = 0;  ///< input vertices that are no samples and had to stay
};

/// What a retriangulation may do.
struct RetriangulationOptions {
  double max_bend = 60 * std::numbers::pi / 180;  ///< rad; a new triangle's normal from the input's nearby
};

namespace detail {

class Retriangulator {
public:
  Retriangulator(const IndexedTriangleMesh& input, const FeatureGraph& features, std::span<const SurfaceSample> samples,
                 const RetriangulationOptions& options)
      : adjacency_(make_adjacency(input)),
        features_(features),
        samples_(samples),
        options_(options),
        surface_(input, adjacency_, features),
        normals_(surface_, adjacency_),
        inserter_(surface_, normals_, features, samples) {}

  Retriangulation run() {
    inserter_.run();
    VertexRemover remover(surface_, normals_);
    remover.flipper().push_all();
    remover.flipper().run(DelaunayFlipper::Scope::within_patches);
    remove_unwanted(remover);
    return result();
  }

private:
  /// Vertices inside patches first: those on curves would otherwise have to step over them.
  void remove_unwanted(VertexRemover& remover) {
    std::vector<index_t> inside, on_curves;
    std::vector<char> corner(surface_.points.size(), 0);
    for (const index_t v : features_.corners) corner[v] = 1;
    for (index_t v = 0; v < features_input_size(); ++v) {
      if (inserter_.sample_of_vertex()[v] != no_index || corner[v] || surface_.half_edge_of[v] == no_index) continue;
      (remover.feature_valence(v) == 0 ? inside : on_curves).push_back(v);
    }
    const double upright = std::cos(options_.max_bend);
    for (const VertexRemover::Limits& limits :
         {VertexRemover::Limits{std::max(0.8, upright), 0.05}, VertexRemover::Limits{upright, 1e-2},
          VertexRemover::Limits{upright, 1e-3}, VertexRemover::Limits{upright / 2, 1e-3}}) {
      for (std::size_t before = no_index; inside.size() + on_curves.size() < before;) {
        before = inside.size() + on_curves.size();
        remover.run(inside, limits);
        remover.run(on_curves, limits);
      }
    }
    remover.flipper().push_all();
    remover.flipper().run(DelaunayFlipper::Scope::within_patches);
  }

  index_t features_input_size() const { return static_cast<index_t>(adjacency_.n_vertices()); }

  Retriangulation result() const {
    Retriangulation r;
    std::vector<index_t> new_index(surface_.points.size(), no_index);
    for (const SurfaceSample& s : samples_) r.surface.points.push_back(s.point);
    for (index_t i = 0; i < samples_.size(); ++i) new_index[inserter_.vertex_of_sample()[i]] = i;
    for (index_t v = 0; v < surface_.points.size(); ++v) {
      if (new_index[v] != no_index || surface_.half_edge_of[v] == no_index) continue;
      new_index[v] = static_cast<index_t>(r.surface.points.size());
      r.surface.points.push_back(surface_.points[v]);
      ++r.n_unremoved;
    }
    for (index_t t = 0; t < surface_.n_triangles(); ++t) {
      if (!surface_.alive(t)) continue;
      const auto& v = surface_.corners[t];
      r.surface.triangles.push_back({new_index[v[0]], new_index[v[1]], new_index[v[2]]});
      r.features.triangle_patch.push_back(surface_.patch[t]);
      for (index_t h = 3 * t; h < 3 * t + 3; ++h) r.features.is_feature.push_back(surface_.feature[h]);
    }
    r.features.n_patches = features_.n_patches;
    for (const index_t v : features_.corners)
      if (new_index[v] != no_index) r.features.corners.push_back(new_index[v]);
    std::sort(r.features.corners.begin(), r.features.corners.end());
    for (std::size_t c = 0; c < inserter_.curves().size(); ++c) append_curve(inserter_.curves()[c], new_index, r);
    return r;
  }

  void append_curve(std::span<const index_t> chain, const std::vector<index_t>& new_index, Retriangulation& r) const {
    auto& values = r.features.curves.values;
    const std::size_t begin = values.size();
    const bool closed = chain.front() == chain.back();
    for (std::size_t i = 0; i + (closed ? 1 : 0) < chain.size(); ++i)
      if (new_index[chain[i]] != no_index) values.push_back(new_index[chain[i]]);
    if (closed && values.size() > begin) values.push_back(values[begin]);
    r.features.curves.end_row();
  }

  TriangleAdjacency adjacency_;
  const FeatureGraph& features_;
  std::span<const SurfaceSample> samples_;
  RetriangulationOptions options_;
  EditableSurface surface_;
  SectorNormals normals_;
  SampleInserter inserter_;
};

}  // namespace detail

/// Triangulates a surface anew through exactly the given samples.
///
/// The samples are inserted into the input triangulation, edges are flipped until it is Delaunay, and every vertex that
/// is not a sample is collapsed into a neighbour, with flips in between. Features are never crossed, triangles never
/// bent away from the input's normals by more than `options.max_bend`.
///
/// @param surface   closed (or with rims), edge-manifold, oriented outward.
/// @param features  of `surface`. Every corner should be a sample; one that is not stays as an unremoved vertex.
/// @param samples   in any order, no two the same point; each closed curve needs three, each corner itself.
/// @return samples as vertices 0 to n-1 at their exact positions, then the input vertices that could not be removed.
/// @throws invalid_coordinate, invalid_connectivity  with the index of a sample that is not finite or refers to no
/// entity;
///         invalid_option with two samples in one place; nonmanifold.
/// @par Complexity   O(n log n) for n vertices and samples evenly spread; about 1 kB each.
/// @par Determinism  The same everywhere up to rounding.
inline Retriangulation retriangulate(const IndexedTriangleMesh& surface, const FeatureGraph& features,
                                     std::span<const SurfaceSample> samples,
                                     const RetriangulationOptions& options = {}) {
  return detail::Retriangulator(surface, features, samples, options).run();
}

}  // namespace framehex
