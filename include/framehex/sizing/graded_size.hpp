// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/option_ranges.hpp"
#include "framehex/sizing/size_source.hpp"
#include "framehex/surface/detail/box_tree.hpp"

#include <optional>

namespace framehex {

/// Bounds of a `GradedSize`, in the host's unit.
struct GradedSizeOptions {
  double most = unbounded;  ///< > 0: the size where nothing smaller is wanted
  double least = 0;         ///< >= 0, not above `most`: nothing is smaller, whoever wants it
  double growth = 0.3;      ///< > 0, dimensionless: the size grows by so much of the distance; 0.3 is moderate

  template <class Options, class Visit>
  static void each_number(Options& o, Visit&& visit) {
    visit("GradedSizeOptions::most", o.most, least_positive, unbounded);
    visit("GradedSizeOptions::least", o.least, 0, o.most);
    visit("GradedSizeOptions::growth", o.growth, 1e-3, 1e3);
  }
};

/// One size field of all that is wanted: sizes on triangles, sizes on the vertices of a tetrahedral mesh, and bounds.
///
/// At p it is the least of `most`, the field of the mesh, and for every source the length at its point nearest to p +
/// growth * the distance; and at least `least`. It therefore grows by no more than `growth` of a distance, but for what the
/// mesh's own field does between its vertices and sources whose own lengths grow faster.
///
/// Copies share nothing. Safe to call from several threads at once.
/// @par Complexity   O(n log n) to build for n sources, about 200 bytes each; O(log n) a query where few of them matter.
/// @par Source       The greatest function below the wishes whose slope is bounded: P.-O. Persson, Mesh size functions for
///                   implicit geometries and PDE-based gradient limiting, Eng. Comput. 22 (2006) 95-109. Departs: taken
///                   from its closed form for straight distances, min over y of (h(y) + growth |x - y|), by a search,
///                   instead of by solving for it on a grid.
class GradedSize {
public:
  /// @param sources  in any order. @param field  of a mesh, limited by its maker.
  /// @throws invalid_option  for a number out of its range, and when nothing bounds the size from above; invalid_field
  ///         with the source (as triangle) whose lengths are not positive.
  explicit GradedSize(const GradedSizeOptions& options, std::vector<SizeSource> sources = {},
                      std::optional<VertexSizeField> field = {})
      : options_(options), field_(std::move(field)) {
    check_options(options);
    if (std::isinf(options.most) && !field_) throw invalid_option("no size bounds the others from above");
    for (index_t s = 0; s < sources.size(); ++s)
      for (const double length : sources[s].lengths)
        if (!(length > 0))
          throw invalid_field("the size of source " + std::to_string(s) + " is not positive", Entity::triangle, {s});
    std::erase_if(sources, [&](const SizeSource& source) { return !(least_of(source) < options_.most); });
    build(sources);
  }

  const GradedSizeOptions& options() const { return options_; }

  /// How many sources are smaller than `most` somewhere.
  std::size_t n_sources() const { return sources_.size(); }

  double operator()(const Vector3& p) const {
    index_t hint = no_index;
    return sample(p, hint);
  }

  /// @param tet_hint  a tetrahedron of the field's mesh near p, or `no_index`; receives that of p.
  double sample(const Vector3& p, index_t& tet_hint) const {
    double size = options_.most;
    if (field_) size = std::min(size, field_->sample(p, tet_hint));
    return std::max(options_.least, sources_.empty() ? size : least_at(p, size));
  }

private:
  static double least_of(const SizeSource& source) {
    return std::min({source.lengths[0], source.lengths[1], source.lengths[2]});
  }

  void build(const std::vector<SizeSource>& sources) {
    std::vector<detail::BoxTree::Bounds> boxes;
    boxes.reserve(sources.size());
    for (const SizeSource& s : sources)
      boxes.push_back(detail::triangle_bounds(s.corners[0], s.corners[1], s.corners[2]));
    tree_ = detail::BoxTree(boxes);
    sources_.reserve(sources.size());
    for (const index_t item : tree_.order()) sources_.push_back(sources[item]);
    // Children stand behind their parents.
    least_.resize(tree_.nodes().size());
    for (std::size_t i = least_.size(); i-- > 0;) {
      const detail::BoxTree::Node& node = tree_.nodes()[i];
      if (node.count == 0) {
        least_[i] = std::min(least_[i + 1], least_[node.first]);
        continue;
      }
      least_[i] = unbounded;
      for (index_t k = node.first; k < node.first + node.count; ++k)
        least_[i] = std::min(least_[i], least_of(sources_[k]));
    }
  }

  /// No source of a node wants less than this at p.
  double bound(index_t node, const Vector3& p) const {
    return least_[node] + options_.growth * std::sqrt(tree_.nodes()[node].bounds.squared_distance(p));
  }

  double wanted(const SizeSource& source, const Vector3& p) const {
    const TrianglePoint nearest = nearest_on_triangle(p, source.corners[0], source.corners[1], source.corners[2]);
    double length = 0;
    for (int i = 0; i < 3; ++i) {
      const double weight = nearest.barycentric[i];
      if (weight > 0) length += weight * source.lengths[static_cast<std::size_t>(i)];
    }
    return length + options_.growth * std::sqrt(nearest.squared_distance);
  }

  /// Branch and bound, the more promising child first.
  double least_at(const Vector3& p, double size) const {
    struct Entry {
      index_t node;
      double bound;
    };
    std::array<Entry, 64> stack;
    std::size_t depth = 0;
    stack[depth++] = {0, bound(0, p)};
    while (depth > 0) {
      const Entry entry = stack[--depth];
      // What is wanted below `least` makes no difference.
      if (std::max(entry.bound, options_.least) >= size) continue;
      const detail::BoxTree::Node& node = tree_.nodes()[entry.node];
      if (node.count > 0) {
        for (index_t k = node.first; k < node.first + node.count; ++k) size = std::min(size, wanted(sources_[k], p));
        continue;
      }
      Entry near{entry.node + 1, bound(entry.node + 1, p)}, far{node.first, bound(node.first, p)};
      if (far.bound < near.bound) std::swap(near, far);
      stack[depth++] = far;
      stack[depth++] = near;
    }
    return size;
  }

  GradedSizeOptions options_;
  std::optional<VertexSizeField> field_;
  detail::BoxTree tree_;
  std::vector<SizeSource> sources_;  // in the order of the tree's leaves
  std::vector<double> least_;        // by node: of its sources' lengths
};

static_assert(SizeField<GradedSize>);

}  // namespace framehex
