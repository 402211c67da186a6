// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/geometry/quality.hpp"
#include "framehex/pipeline/meshing_result.hpp"

#include <algorithm>

namespace framehex::detail {

/// The cells of a mesh below a scaled Jacobian.
///
/// @param no_room  callable: point -> whether the input leaves no room there for better cells.
template <class NoRoom>
std::vector<PoorCell> find_poor_cells(const MixedMesh& mesh, double least_quality, NoRoom&& no_room) {
  std::vector<PoorCell> poor;
  std::array<Vector3, 8> corners;
  for (index_t cell = 0; cell < mesh.n_cells(); ++cell) {
    const auto row = mesh.cells[cell];
    Vector3 centre = Vector3::Zero();
    for (std::size_t i = 0; i < row.size(); ++i) {
      corners[i] = mesh.points[row[i]];
      centre += corners[i] / static_cast<double>(row.size());
    }
    const std::span<const Vector3> p(corners.data(), row.size());
    const double quality = scaled_jacobian(mesh.kinds[cell], p);
    if (quality < least_quality) poor.push_back({cell, quality, centre, std::ranges::any_of(p, no_room)});
  }
  return poor;
}

/// How far the poor cells that the input's angles do not explain are from what is wanted, taken together.
inline double poverty(const std::vector<PoorCell>& cells, double least_quality) {
  double sum = 0;
  for (const PoorCell& poor : cells)
    if (!poor.input_angle) sum += 1 - poor.quality / least_quality;
  return sum;
}

/// Sizes for the corners of the poor cells that the input's angles do not explain. Cells between two walls are as poor as
/// they are wide for their height, so the poorest ask for a quarter of the size, others for half.
template <SizeField Size>
std::vector<SizeLimit> limits_at_poor_cells(const std::vector<PoorCell>& cells, const MixedMesh& mesh,
                                            double least_quality, const Size& size) {
  std::vector<SizeLimit> limits;
  index_t hint = no_index;
  for (const PoorCell& poor : cells) {
    if (poor.input_angle) continue;
    const double factor = std::clamp(poor.quality / (2 * least_quality), 0.25, 0.5);
    for (const index_t v : mesh.cells[poor.cell])
      limits.push_back({mesh.points[v], factor * checked_size(size, mesh.points[v], hint)});
  }
  return limits;
}

}  // namespace framehex::detail
