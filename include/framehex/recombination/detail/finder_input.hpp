// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/errors.hpp"
#include "framehex/mesh/validation.hpp"
#include "framehex/recombination/candidates.hpp"
#include "framehex/recombination/detail/vertex_links.hpp"
#include "framehex/recombination/finder_options.hpp"

#include <memory>

namespace framehex::detail {

/// A set of edges, queried by their vertices.
class FeatureEdges {
public:
  FeatureEdges(std::size_t n_vertices, std::span<const std::array<index_t, 2>> edges) {
    if (edges.empty()) return;
    touched_.assign(n_vertices, 0);
    for (const auto& [v, w] : edges) {
      if (v >= n_vertices || w >= n_vertices)
        throw invalid_option("feature edge (" + std::to_string(v) + ", " + std::to_string(w) +
                                 ") refers to a vertex that does not exist",
                             Entity::edge, {v, w});
      edges_.push_back({std::min(v, w), std::max(v, w)});
      touched_[v] = touched_[w] = 1;
    }
    std::sort(edges_.begin(), edges_.end());
  }

  bool empty() const { return edges_.empty(); }
  bool touches(index_t v) const { return !touched_.empty() && touched_[v] != 0; }
  bool contains(index_t v, index_t w) const {
    return touches(v) && touches(w) &&
           std::binary_search(edges_.begin(), edges_.end(), std::array{std::min(v, w), std::max(v, w)});
  }

private:
  std::vector<std::array<index_t, 2>> edges_;
  std::vector<std::uint8_t> touched_;
};

/// What every search over one mesh reads: checked input in flat arrays. Immutable, shared by the threads.
class FinderInput {
public:
  template <TetMesh Mesh>
  FinderInput(const Mesh& mesh, const FinderOptions& options)
      : options_(options),
        points_(),
        owned_(read(mesh, options, points_)),
        adjacency_(options.adjacency != nullptr ? options.adjacency : owned_.get()),
        links_(*adjacency_, most_corners_between + 1 + std::min(options.max_interior_vertices, points_.size())),
        features_(points_.size(), options.feature_edges) {
    const std::size_t n = adjacency_->tets.size();
    if (points_.size() != adjacency_->n_vertices()) throw invalid_option("the adjacency is that of another mesh");
    check_size("regions", options.regions.size(), n);
    check_size("facet_patches", options.facet_patches.size(), n);
    check_size("free_tets", options.free_tets.size(), n);
  }

  const FinderOptions& options() const { return options_; }
  const TetAdjacency& adjacency() const { return *adjacency_; }
  const std::vector<Vector3>& points() const { return points_; }
  const VertexLinks& links() const { return links_; }
  const FeatureEdges& features() const { return features_; }

  /// Whether a facet separates its tetrahedron from the outside or from another region, or lies on a patch.
  bool is_boundary(index_t tet, std::size_t facet) const {
    const index_t next = adjacency_->neighbours[tet][facet];
    return next == no_index || (!options_.regions.empty() && options_.regions[next] != options_.regions[tet]) ||
           patch(tet, facet) != no_index;
  }

  /// Label of the patch that a facet lies on, or `no_index`.
  index_t patch(index_t tet, std::size_t facet) const {
    return options_.facet_patches.empty() ? no_index : options_.facet_patches[tet][facet];
  }

private:
  /// The tetrahedra of a cell lead round a diagonal from one of its triangles to the other past corners that are not on
  /// the quadrilateral: four of a hexahedron, fewer of the others.
  static constexpr std::size_t most_corners_between = 4;

  /// Checks the input, and gives its points as they were then. @return nothing when the options bring an adjacency.
  template <TetMesh Mesh>
  static std::unique_ptr<TetAdjacency> read(const Mesh& mesh, const FinderOptions& options,
                                            std::vector<Vector3>& points) {
    check_options(options);
    const bool is_given = options.adjacency != nullptr;
    if (options.input_check == InputCheck::validate) {
      CheckedTets checked = checked_tets(mesh);
      points = std::move(checked.points);
      return is_given ? nullptr : std::make_unique<TetAdjacency>(std::move(checked.adjacency));
    }
    points = positions(mesh);
    return is_given ? nullptr : std::make_unique<TetAdjacency>(make_adjacency(mesh));
  }

  static void check_size(const char* name, std::size_t size, std::size_t n_tets) {
    if (size != 0 && size != n_tets)
      throw invalid_option(std::string(name) + " has " + std::to_string(size) + " entries for " +
                           std::to_string(n_tets) + " tetrahedra");
  }

  FinderOptions options_;
  std::vector<Vector3> points_;
  std::unique_ptr<TetAdjacency> owned_;
  const TetAdjacency* adjacency_;
  VertexLinks links_;
  FeatureEdges features_;
};

}  // namespace framehex::detail
