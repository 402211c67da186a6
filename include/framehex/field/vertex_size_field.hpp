// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/field/detail/laplace_solver.hpp"
#include "framehex/field/tet_locator.hpp"
#include "framehex/geometry/size_field.hpp"

#include <memory>
#include <queue>

namespace framehex {

/// Lowers sizes until none exceeds a neighbour's by more than `growth` times their distance.
///
/// @param neighbours  of each vertex, of any mesh. @param sizes  n_vertices lengths, changed in place.
/// @param growth      dimensionless, >= 0; 0.3 is moderate.
/// @throws invalid_field   with the vertex whose size is not positive and finite; invalid_option for the growth.
/// @par Complexity   O(edges log n).
/// @par Source       H. Borouchaki, F. Hecht, P. J. Frey, Mesh gradation control, Int. J. Numer. Meth. Eng. 43 (1998)
///                   1143-1165. Departs: in the order of sizes, as Dijkstra's shortest paths, so that each vertex is
///                   settled once.
inline void limit_gradation(const Csr<index_t>& neighbours, std::span<const Vector3> points, std::span<double> sizes,
                            double growth) {
  if (!(growth >= 0)) throw invalid_option("the growth of sizes must not be negative");
  using Entry = std::pair<double, index_t>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  for (index_t v = 0; v < sizes.size(); ++v) {
    if (!(sizes[v] > 0) || !std::isfinite(sizes[v]))
      throw invalid_field("the size of vertex " + std::to_string(v) + " is not positive and finite", Entity::vertex,
                          {v});
    queue.emplace(sizes[v], v);
  }
  while (!queue.empty()) {
    const auto [size, v] = queue.top();
    queue.pop();
    if (size > sizes[v]) continue;
    for (const index_t w : neighbours[v]) {
      const double most = size + growth * (points[w] - points[v]).norm();
      if (sizes[w] <= most) continue;
      sizes[w] = most;
      queue.emplace(most, w);
    }
  }
}

/// The same along the edges of tetrahedra.
inline void limit_gradation(const TetAdjacency& adjacency, std::span<const Vector3> points, std::span<double> sizes,
                            double growth) {
  limit_gradation(adjacency.vertices_of_vertex, points, sizes, growth);
}

/// Fills in unknown sizes so that the whole is harmonic: as smooth as the known ones allow, and between them.
///
/// @param sizes  n_vertices lengths; a NaN is unknown. Parts of the mesh with no known size get the least of all.
/// @throws invalid_field   with the vertex whose size is known but not positive and finite, or when none is known.
/// @par Complexity   O(edges * n^(1/6)).
template <Executor E = SerialExecutor>
void extend_sizes(const TetAdjacency& adjacency, std::span<const Vector3> points, std::span<double> sizes,
                  const E& executor = {}) {
  using Value = Eigen::Matrix<double, 1, 1>;
  double least = std::numeric_limits<double>::infinity(), greatest = 0;
  for (std::size_t v = 0; v < sizes.size(); ++v) {
    if (std::isnan(sizes[v])) continue;
    if (!(sizes[v] > 0) || !std::isfinite(sizes[v]))
      throw invalid_field("the size of vertex " + std::to_string(v) + " is not positive and finite", Entity::vertex,
                          {v});
    least = std::min(least, sizes[v]);
    greatest = std::max(greatest, sizes[v]);
  }
  if (sizes.empty()) return;
  if (!(greatest > 0)) throw invalid_field("no vertex has a size");
  const detail::LaplaceSystem<> system(adjacency, points);
  std::vector<Value> x(sizes.size());
  for (std::size_t row = 0; row < x.size(); ++row) {
    const double size = sizes[system.order[row]];
    x[row][0] = std::isnan(size) ? least : size;
  }
  const auto load = [](std::size_t) { return Value(0.0); };
  const auto restrict = [&](std::size_t row, Value& value) {
    if (!std::isnan(sizes[system.order[row]])) value.setZero();
  };
  const detail::RowAggregates aggregates(
      system, [&](std::size_t row) { return std::isnan(sizes[system.order[row]]) ? 1. : 0.; });
  detail::solve_laplace(
      system, aggregates, x, load, restrict, [](int) { return true; }, {.tolerance = 1e-8}, executor);
  for (std::size_t row = 0; row < x.size(); ++row) {
    double& size = sizes[system.order[row]];
    if (std::isnan(size)) size = std::clamp(x[row][0], least, greatest);
  }
}

/// Sizes at the vertices of a mesh, linear in between.
///
/// Copies share the geometry. Safe to call from several threads at once.
class VertexSizeField {
public:
  /// @param locator  of the mesh; `FrameField` can share its own. @param sizes  n_vertices lengths, all > 0 and finite.
  /// @throws invalid_option  when the counts do not match; invalid_field  with the vertex.
  VertexSizeField(std::shared_ptr<const TetLocator> locator, std::vector<double> sizes)
      : locator_(std::move(locator)), sizes_(std::move(sizes)) {
    if (sizes_.size() != locator_->points().size()) throw invalid_option("there must be one size per vertex");
    for (std::size_t v = 0; v < sizes_.size(); ++v)
      if (!(sizes_[v] > 0) || !std::isfinite(sizes_[v]))
        throw invalid_field("the size of vertex " + std::to_string(v) + " is not positive and finite", Entity::vertex,
                            {v});
  }

  const std::vector<double>& sizes() const { return sizes_; }

  /// @param tet_hint  as in `FrameField::sample`. @return outside the mesh: that of a boundary point near `p`.
  double sample(const Vector3& p, index_t& tet_hint) const {
    const TetLocation at = locator_->locate(p, tet_hint);
    if (at.tet == no_index) return sizes_.empty() ? 1 : sizes_.front();
    tet_hint = at.tet;
    double size = 0;
    for (std::size_t i = 0; i < 4; ++i) size += at.barycentric[i] * sizes_[locator_->adjacency().tets[at.tet][i]];
    return size;
  }

  double operator()(const Vector3& p) const {
    index_t hint = no_index;
    return sample(p, hint);
  }

private:
  std::shared_ptr<const TetLocator> locator_;
  std::vector<double> sizes_;
};

/// Size field of a mesh from sizes at some of its vertices: extended harmonically, then limited.
///
/// @param sizes  n_vertices lengths; a NaN is unknown. @param growth  see `limit_gradation`.
template <Executor E = SerialExecutor>
VertexSizeField make_size_field(std::shared_ptr<const TetLocator> locator, std::vector<double> sizes, double growth,
                                const E& executor = {}) {
  if (sizes.size() != locator->points().size()) throw invalid_option("there must be one size per vertex");
  extend_sizes(locator->adjacency(), locator->points(), sizes, executor);
  limit_gradation(locator->adjacency(), locator->points(), sizes, growth);
  return VertexSizeField(std::move(locator), std::move(sizes));
}

static_assert(SizeField<ConstantSize> && SizeField<VertexSizeField>);

}  // namespace framehex
