// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/errors.hpp"
#include "framehex/io/label_limit.hpp"
#include "framehex/mesh/concepts.hpp"
#include "framehex/mesh/mixed_output.hpp"

#include <Eigen/Core>

/// Meshes as libigl's users hold them: a matrix V of points, one a row, and a matrix of 0-based vertex numbers, one
/// cell a row. Any scalar, integer and storage order. Needs Eigen alone.
namespace framehex {

namespace detail {

/// Two matrices of the host's, by reference.
template <class V, class C, std::size_t Corners>
struct EigenView {
  const V& points;
  const C& cells;

  /// @throws invalid_connectivity  when the numbers of columns are not 3 and `Corners`.
  EigenView(const V& v, const C& c) : points(v), cells(c) {
    if (v.cols() != 3 || c.cols() != static_cast<Eigen::Index>(Corners))
      throw invalid_connectivity("matrices of " + std::to_string(v.cols()) + " and " + std::to_string(c.cols()) +
                                 " columns, not 3 and " + std::to_string(Corners));
  }
  // A temporary, `V * 2.0` say, would be gone before the view is read.
  EigenView(const V&&, const C&) = delete;
  EigenView(const V&, const C&&) = delete;
  EigenView(const V&&, const C&&) = delete;
};

template <class V, class C, std::size_t Corners>
struct eigen_traits {
  using View = EigenView<V, C, Corners>;
  using vertex_type = Eigen::Index;  // there may be more rows than C's scalar can count
  using cell_type = Eigen::Index;
  using scalar_type = typename V::Scalar;

  static auto vertices(const View& mesh) { return std::views::iota(vertex_type{0}, mesh.points.rows()); }
  static auto cells(const View& mesh) { return std::views::iota(cell_type{0}, mesh.cells.rows()); }
  static std::size_t index(const View&, vertex_type v) { return static_cast<std::size_t>(v); }
  static std::array<scalar_type, 3> point(const View& mesh, vertex_type v) {
    return {mesh.points(v, 0), mesh.points(v, 1), mesh.points(v, 2)};
  }
  static std::array<vertex_type, Corners> cell_vertices(const View& mesh, cell_type c) {
    std::array<vertex_type, Corners> corners;
    for (std::size_t i = 0; i < Corners; ++i)
      corners[i] = static_cast<vertex_type>(mesh.cells(c, static_cast<Eigen::Index>(i)));
    return corners;
  }
};

}  // namespace detail

/// V and T as a TetMesh: `recombine(EigenTets(V, T))`. Both must outlive it; temporaries do not compile.
template <class V, class T>
struct EigenTets : detail::EigenView<V, T, 4> {
  using detail::EigenView<V, T, 4>::EigenView;
};
/// Deduces the matrices' types.
template <class V, class T>
EigenTets(const V&, const T&) -> EigenTets<V, T>;

/// V and F as a TriangleMesh. Both must outlive it; temporaries do not compile.
template <class V, class F>
struct EigenTriangles : detail::EigenView<V, F, 3> {
  using detail::EigenView<V, F, 3>::EigenView;
};
/// Deduces the matrices' types.
template <class V, class F>
EigenTriangles(const V&, const F&) -> EigenTriangles<V, F>;

template <class V, class T>
struct mesh_traits<EigenTets<V, T>> : detail::eigen_traits<V, T, 4> {};
template <class V, class F>
struct mesh_traits<EigenTriangles<V, F>> : detail::eigen_traits<V, F, 3> {};

static_assert(TetMesh<EigenTets<Eigen::MatrixXd, Eigen::MatrixXi>>);
static_assert(TriangleMesh<EigenTriangles<Eigen::MatrixXf, Eigen::Matrix<std::int64_t, Eigen::Dynamic, 3>>>);

/// A mixed mesh as matrices, one of cells for each kind.
///
/// `Eigen::MatrixXi H = output.cells(CellKind::hexahedron)` copies; the maps are valid until something is added.
class EigenOutput {
public:
  using vertex_type = int;
  using Points = Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>>;
  using Cells = Eigen::Map<const Eigen::Matrix<int, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>;
  using Labels = Eigen::Map<const Eigen::VectorXi>;

  int add_vertex(const std::array<double, 3>& p) {
    points_.insert(points_.end(), p.begin(), p.end());
    return static_cast<int>(points_.size() / 3) - 1;
  }
  /// @throws io_error  when the label is beyond the greatest `int`.
  void add_cell(CellKind kind, std::span<const int> corners, index_t region) {
    detail::check_label_fits("Eigen", region, detail::greatest_int_label);
    Block& block = blocks_[static_cast<std::size_t>(kind)];
    block.corners.insert(block.corners.end(), corners.begin(), corners.end());
    block.regions.push_back(static_cast<int>(region));
  }

  /// n x 3
  Points points() const { return {points_.data(), static_cast<Eigen::Index>(points_.size() / 3), 3}; }
  /// n x 4, 5, 6 or 8 vertex numbers, corners in the order of geometry/cell_kinds.hpp.
  Cells cells(CellKind kind) const {
    const Block& block = blocks_[static_cast<std::size_t>(kind)];
    return {block.corners.data(), static_cast<Eigen::Index>(block.regions.size()), n_corners(kind)};
  }
  /// Labels of regions, one for each row of `cells(kind)`.
  Labels regions(CellKind kind) const {
    const Block& block = blocks_[static_cast<std::size_t>(kind)];
    return {block.regions.data(), static_cast<Eigen::Index>(block.regions.size())};
  }

private:
  struct Block {
    std::vector<int> corners, regions;
  };
  std::vector<double> points_;
  std::array<Block, 4> blocks_;
};
static_assert(MixedOutput<EigenOutput>);

}  // namespace framehex
