// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/config.hpp"
#include "framehex/geometry/cell_kinds.hpp"
#include "framehex/mesh/csr.hpp"

#include <array>
#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace framehex {

/// A face of the boundary or between regions, with the label of the surface patch it lies on.
struct LabelledFace {
  std::array<index_t, 4> vertices;  ///< a triangle's fourth is `no_index`
  index_t label;
  std::size_t size() const { return vertices[3] == no_index ? 3 : 4; }
};

/// An edge of a feature curve, with the label of the curve.
struct LabelledEdge {
  std::array<index_t, 2> vertices;
  index_t label;
};

/// A name that a user gave to regions, patches or curves. A label may be in several groups.
struct LabelGroup {
  int dimension;                ///< 3: regions, 2: patches, 1: curves
  index_t number;               ///< from 0, once in each dimension; files count it from 1
  std::string name;             ///< not empty
  std::vector<index_t> labels;  ///< ascending
};

/// The result: tetrahedra, pyramids, prisms and hexahedra over one set of points.
struct MixedMesh {
  std::vector<Vector3> points;
  std::vector<CellKind> kinds;          ///< n_cells
  Csr<index_t> cells;                   ///< n_cells rows, corners in the order of geometry/cell_kinds.hpp
  std::vector<index_t> regions;         ///< n_cells labels, or empty
  std::vector<LabelledFace> faces;      ///< boundary faces, anticlockwise seen from outside; may be empty
  std::vector<LabelledEdge> edges;      ///< feature edges; may be empty
  std::vector<LabelGroup> groups = {};  ///< names of labels, for files and reports; may be empty

  std::size_t n_cells() const { return kinds.size(); }
  void add(CellKind kind, std::span<const index_t> corners) {
    kinds.push_back(kind);
    cells.values.insert(cells.values.end(), corners.begin(), corners.end());
    cells.end_row();
  }
};

}  // namespace framehex
