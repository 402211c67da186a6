// SPDX-License-Identifier: BSL-1.0
// What a mixed mesh is made of and how good it is.
#pragma once

#include "framehex/verify/solver_quality.hpp"

#include <nlohmann/json_fwd.hpp>

#include <array>
#include <vector>

namespace program {

struct KindMeasures {
  std::size_t n = 0;
  double volume = 0;
  double least = 1, mean = 0;  // scaled Jacobian
};

struct Measures {
  std::size_t n_points = 0, n_cells = 0;
  std::array<KindMeasures, 4> kinds{};  // by CellKind
  double volume = 0, boundary_volume = 0;
  double least = 1, mean = 0;           // scaled Jacobian over all cells
  double fraction_good = 0;             // share of cells with 0.2 or more
  std::vector<double> scaled_jacobian;  // by cell
  std::vector<framehex::index_t> inverted_cells, invalid_cells;
  std::vector<framehex::index_t> open_cells;  // with an open quadrilateral, once for each
  std::size_t n_bad_faces = 0;                // any other fault of conformity
  std::size_t n_open_edges = 0, n_nonmanifold_edges = 0;
  framehex::verify::SolverQuality solver;

  double hex_ratio_by_number() const;
  double hex_ratio_by_volume() const;
};

/// @throws invalid_connectivity  for a cell that names a vertex twice.
Measures measure(const framehex::MixedMesh& mesh);

/// Adds `counts`, `hex_ratio`, `quality`, `solver_quality` and `conformity`.
void add_to(nlohmann::ordered_json& json, const Measures& measures);

}  // namespace program
