// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/errors.hpp"
#include "framehex/geometry/quality.hpp"
#include "framehex/io/label_arrays.hpp"
#include "framehex/io/vtk_cells.hpp"
#include "framehex/mesh/indexed_mesh.hpp"
#include "framehex/mesh/mixed_mesh.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <tuple>

namespace framehex {

/// A name of a label, as a file tells it.
struct LabelName {
  int dimension;
  std::int64_t group, label;
  std::string name;
};

/// Labels as a file tells them, for those who number them together with those of other files.
struct RawLabels {
  std::vector<std::int64_t> cells;  ///< by cell of the volume
  std::vector<LabelName> names;
};

namespace detail {

/// Labels as they are counted here, from 0: as in the file but for the usual first number, or by rank where some are out
/// of the usual range.
class LabelNumbers {
public:
  LabelNumbers(std::vector<std::int64_t> raw, std::int64_t first) : first_(first), values_(std::move(raw)) {
    usual_ = std::all_of(values_.begin(), values_.end(),
                         [&](std::int64_t l) { return l >= first && l - first < std::int64_t{1} << 31; });
    std::sort(values_.begin(), values_.end());
    values_.erase(std::unique(values_.begin(), values_.end()), values_.end());
  }

  bool contains(std::int64_t raw) const { return std::binary_search(values_.begin(), values_.end(), raw); }
  index_t operator()(std::int64_t raw) const {
    if (usual_) return static_cast<index_t>(raw - first_);
    return static_cast<index_t>(std::lower_bound(values_.begin(), values_.end(), raw) - values_.begin());
  }

private:
  std::int64_t first_;
  std::vector<std::int64_t> values_;  // ascending
  bool usual_;
};

/// The groups that the names of a mesh's labels make; names of labels that it has not are left out.
///
/// @param names   each once. @param number  of the labels, by dimension. @param first_label  the smallest usual group.
inline std::vector<LabelGroup> groups_of(std::vector<LabelName> names, const std::array<LabelNumbers, 4>& number,
                                         std::int64_t first_label) {
  std::stable_sort(names.begin(), names.end(), [](const LabelName& a, const LabelName& b) {
    return std::tie(a.dimension, a.group, a.label) < std::tie(b.dimension, b.group, b.label);
  });
  std::vector<std::int64_t> numbers;
  for (const LabelName& name : names) numbers.push_back(name.group);
  const LabelNumbers group_number(numbers, first_label);
  std::vector<LabelGroup> groups;
  for (const LabelName& name : names) {
    const LabelNumbers& label = number[static_cast<std::size_t>(name.dimension)];
    if (!label.contains(name.label)) continue;
    const index_t group = group_number(name.group);
    if (groups.empty() || groups.back().dimension != name.dimension || groups.back().number != group)
      groups.push_back({name.dimension, group, name.name, {}});
    groups.back().labels.push_back(label(name.label));
  }
  return groups;
}

/// Voxels and pixels count corners along x first, then y, then z.
template <std::size_t N>
std::array<std::int64_t, N> turned(std::span<const std::int64_t> corners) {
  constexpr std::array<std::size_t, 8> order{0, 1, 3, 2, 4, 5, 7, 6};
  std::array<std::int64_t, N> ours{};
  for (std::size_t i = 0; i < N; ++i) ours[i] = corners[order[i]];
  return ours;
}

/// Adds a cell to a builder by VTK's type, of a polygonal line each of its lines; vertices are passed over.
/// @param name  of the file, for errors.
template <class Builder>
void add_vtk_cell(Builder& builder, const std::string& name, std::int64_t type, std::span<const std::int64_t> corners,
                  std::int64_t label, std::size_t number) {
  const auto expect = [&](std::size_t n) {
    if (corners.size() != n)
      throw io_error(name + ": cell " + std::to_string(number) + " of VTK type " + std::to_string(type) + " has " +
                         std::to_string(corners.size()) + " corners",
                     Entity::cell, {number});
  };
  switch (type) {
    case vtk::vertex:
    case vtk::poly_vertex: return;
    case vtk::poly_line:
      for (std::size_t i = 1; i < corners.size(); ++i) builder.add(1, {}, corners.subspan(i - 1, 2), label, number);
      return;
    case vtk::line: expect(2); return builder.add(1, {}, corners, label, number);
    case vtk::triangle: expect(3); return builder.add(2, {}, corners, label, number);
    case vtk::quad: expect(4); return builder.add(2, {}, corners, label, number);
    case vtk::pixel: expect(4); return builder.add(2, {}, turned<4>(corners), label, number);
    case vtk::voxel: expect(8); return builder.add(3, CellKind::hexahedron, turned<8>(corners), label, number);
    default: break;
  }
  for (const CellKind kind : all_cell_kinds)
    if (type == vtk::cell_type(kind)) {
      const auto n = static_cast<std::size_t>(n_corners(kind));
      expect(n);
      std::array<std::int64_t, 8> ours{};
      for (std::size_t i = 0; i < n; ++i) ours[i] = corners[vtk::corner(kind, i)];
      return builder.add(3, kind, std::span(ours).first(n), label, number);
    }
  throw io_error(name + ": cell " + std::to_string(number) + " is of VTK type " + std::to_string(type) +
                     "; tetrahedra, pyramids, prisms, hexahedra, triangles, quadrilaterals and lines are read",
                 Entity::cell, {number});
}

/// Of a cell with a vertex that the file has not.
[[noreturn]] inline void throw_missing_vertex(const std::string& name, std::size_t cell, std::int64_t vertex,
                                              std::size_t n_points) {
  throw invalid_connectivity(name + ": cell " + std::to_string(cell) + " refers to vertex " + std::to_string(vertex) +
                                 " of " + std::to_string(n_points),
                             Entity::cell, {cell});
}

[[noreturn]] inline void throw_not_finite(const std::string& name, std::size_t vertex) {
  throw invalid_coordinate(name + ": vertex " + std::to_string(vertex) + " has a coordinate that is not finite",
                           Entity::vertex, {vertex});
}

/// Gathers what a reader finds, and checks it: indices in range, coordinates finite.
class MeshBuilder {
public:
  /// @param name        of the file, for errors.
  /// @param first_label the smallest usual label of the format: 0 or 1.
  MeshBuilder(std::string name, std::int64_t first_label) : name_(std::move(name)), first_label_(first_label) {}

  static constexpr bool takes_numbers = false;  ///< points are counted, not told their numbers

  void add_point(double x, double y, double z) { mesh_.points.emplace_back(x, y, z); }
  std::size_t n_points() const { return mesh_.points.size(); }

  /// Adds an element of any dimension. Points are numbered from 0 here and need not be known yet.
  ///
  /// @param number   of the element in its file, for errors.
  void add(int dimension, CellKind kind, std::span<const std::int64_t> corners, std::int64_t label,
           std::size_t number) {
    std::array<index_t, 8> row{no_index, no_index, no_index, no_index, no_index, no_index, no_index, no_index};
    for (std::size_t i = 0; i < corners.size(); ++i) {
      if (corners[i] < 0 || corners[i] >= std::int64_t{no_index})
        throw_missing_vertex(name_, number, corners[i], mesh_.points.size());
      row[i] = static_cast<index_t>(corners[i]);
    }
    if (dimension == 1) mesh_.edges.push_back({{row[0], row[1]}, 0});
    if (dimension == 2) mesh_.faces.push_back({{row[0], row[1], row[2], row[3]}, 0});
    if (dimension == 3) {
      mesh_.add(kind, std::span(row).first(corners.size()));
    }
    labels_[static_cast<std::size_t>(dimension)].push_back(label);
    for (const std::int64_t corner : corners)
      if (corner > greatest_) greatest_ = corner, greatest_user_ = number;
  }

  /// Gives the elements of a label a name; a label may have several, and a name several labels.
  void add_name(int dimension, std::int64_t label, std::int64_t group, const std::string& name) {
    names_.push_back({dimension, group, label, name});
  }

  /// See `add_vtk_cell`.
  void add_vtk(std::int64_t type, std::span<const std::int64_t> corners, std::int64_t label, std::size_t number) {
    add_vtk_cell(*this, name_, type, corners, label, number);
  }

  /// @throws invalid_connectivity, invalid_coordinate, io_error when there is no volume cell though one is required.
  MixedMesh finish(Volume volume) {
    if (greatest_ >= static_cast<std::int64_t>(mesh_.points.size()))
      throw_missing_vertex(name_, greatest_user_, greatest_, mesh_.points.size());
    for (std::size_t v = 0; v < mesh_.points.size(); ++v)
      if (!mesh_.points[v].allFinite()) throw_not_finite(name_, v);
    if (mesh_.n_cells() == 0 && volume == Volume::required)
      throw io_error(name_ + ": holds no tetrahedron, pyramid, prism or hexahedron");
    turn_prisms();
    set_labels();
    return std::move(mesh_);
  }

  /// As they stand in the file; before and after `finish`.
  RawLabels raw_labels() const { return {labels_[3], names_}; }

private:
  /// VTK's manual and the programs that write its files disagree about prisms: if all of them together are inside out,
  /// the file follows the other convention.
  void turn_prisms() {
    double volume = 0;
    for (std::size_t c = 0; c < mesh_.n_cells(); ++c)
      if (mesh_.kinds[c] == CellKind::prism) {
        std::array<Vector3, 6> p;
        for (std::size_t i = 0; i < 6; ++i) p[i] = mesh_.points[mesh_.cells[c][i]];
        volume += cell_volume(CellKind::prism, p);
      }
    if (!(volume < 0)) return;
    for (std::size_t c = 0; c < mesh_.n_cells(); ++c)
      if (mesh_.kinds[c] == CellKind::prism) {
        const auto row = mesh_.cells[c];
        std::swap(row[1], row[2]);
        std::swap(row[4], row[5]);
      }
  }

  void set_labels() {
    std::array<LabelNumbers, 4> number{LabelNumbers{{}, first_label_}, LabelNumbers{labels_[1], first_label_},
                                       LabelNumbers{labels_[2], first_label_}, LabelNumbers{labels_[3], first_label_}};
    for (std::size_t i = 0; i < mesh_.edges.size(); ++i) mesh_.edges[i].label = number[1](labels_[1][i]);
    for (std::size_t i = 0; i < mesh_.faces.size(); ++i) mesh_.faces[i].label = number[2](labels_[2][i]);
    for (const std::int64_t label : labels_[3]) mesh_.regions.push_back(number[3](label));
    // A single region without a number of its own is none.
    if (std::all_of(mesh_.regions.begin(), mesh_.regions.end(), [](index_t r) { return r == 0; }))
      mesh_.regions.clear();
    mesh_.groups = groups_of(names_, number, first_label_);
  }

  std::string name_;
  std::int64_t first_label_;
  MixedMesh mesh_;
  std::array<std::vector<std::int64_t>, 4> labels_;  // by dimension
  std::vector<LabelName> names_;
  std::int64_t greatest_ = -1;
  std::size_t greatest_user_ = 0;
};

}  // namespace detail

/// The tetrahedra of a mesh that has no other cells.
///
/// @return the tetrahedra; their `regions` stay with the caller (`mesh.regions`, same numbers).
/// @throws invalid_connectivity  with the first cell of another kind.
inline IndexedTetMesh tetrahedra_of(const MixedMesh& mesh) {
  IndexedTetMesh tets{mesh.points, {}};
  tets.tets.reserve(mesh.n_cells());
  for (std::size_t c = 0; c < mesh.n_cells(); ++c) {
    if (mesh.kinds[c] != CellKind::tetrahedron)
      throw invalid_connectivity("cell " + std::to_string(c) + " is not a tetrahedron", Entity::cell, {c});
    const auto row = mesh.cells[c];
    tets.tets.push_back({row[0], row[1], row[2], row[3]});
  }
  return tets;
}

}  // namespace framehex
