// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/mesh/mixed_mesh.hpp"
#include "framehex/surface/surface.hpp"

namespace framehex::detail {

/// The triangles of a surface, each with its patch.
inline std::vector<LabelledFace> patch_labels(const Surface& surface) {
  std::vector<LabelledFace> faces;
  for (std::size_t t = 0; t < surface.triangles().size(); ++t) {
    const auto& v = surface.triangles()[t];
    faces.push_back({{v[0], v[1], v[2], no_index}, surface.features.triangle_patch[t]});
  }
  return faces;
}

/// The edges of a surface's feature curves, each with its curve.
inline std::vector<LabelledEdge> curve_labels(const Surface& surface) {
  std::vector<LabelledEdge> edges;
  for (std::size_t curve = 0; curve < surface.features.curves.size(); ++curve) {
    const auto row = surface.features.curves[curve];
    for (std::size_t i = 0; i + 1 < row.size(); ++i)
      edges.push_back({{row[i], row[i + 1]}, static_cast<index_t>(curve)});
  }
  return edges;
}

/// Faces get the host's labels where it has given some. @param given  per triangle of the surface with these features.
inline void name_patches(MixedMesh& mesh, const FeatureGraph& features, std::span<const index_t> given) {
  if (given.empty()) return;
  std::vector<index_t> label(features.n_patches);
  for (std::size_t t = 0; t < given.size(); ++t) label[features.triangle_patch[t]] = given[t];
  for (LabelledFace& face : mesh.faces)
    if (face.label != no_index) face.label = label[face.label];
}

}  // namespace framehex::detail
