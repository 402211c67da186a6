// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/geometry/bounding_box.hpp"
#include "framehex/insertion/estimate.hpp"
#include "framehex/insertion/volume_inserter.hpp"
#include "framehex/mesh/enclosed_volume.hpp"
#include "framehex/pipeline/meshing_options.hpp"
#include "framehex/surface/regions.hpp"
#include "framehex/surface/surface_locator.hpp"

namespace framehex {

/// What `mesh_surface` is about to take.
struct MemoryEstimate {
  double n_points = 0;  ///< on the surface and inside
  double n_bytes = 0;   ///< most of the time less, the tetrahedraliser's process included
};

/// About how much memory `mesh_surface` takes, before it does anything.
///
/// Points are those that the sizes ask for, or those of the background mesh where they are more; each costs `bytes_a_point`:
/// 13 to 17 kB are measured for six models, other orders of points and proofs (docs/sizes.md).
///
/// @param surface  with its regions. @param background_edge  as in `MeshingOptions`.
/// @throws invalid_field  when a size is not positive and finite.
/// @par Complexity   O(n + 4096 log n) for each region.
template <SizeField Size>
MemoryEstimate estimate_memory(const Surface& surface, const SurfaceRegions& regions, const Size& size,
                               std::optional<double> background_edge = {}) {
  constexpr double bytes_a_point = 17'000, bytes_at_least = 10'000'000;
  MemoryEstimate result;
  double volume = 0;
  for (index_t region = 0; region < regions.n_regions; ++region) {
    const RegionSurface part = region_surface(surface, regions, region);
    const Eigen::AlignedBox3d box = bounding_box(part.surface.points);
    const SurfaceLocator locator(part.surface);
    volume += enclosed_volume(part.surface);
    result.n_points += estimate_volume_points(box.min(), box.max(), SurfaceDomain{locator}, size).n_points;
  }
  result.n_points += estimate_surface_points(surface, size).n_points;
  double mean = 0;
  index_t hint = no_index;
  for (const Vector3& p : surface.points)
    mean += detail::checked_size(size, p, hint) / static_cast<double>(surface.points.size());
  const double edge = background_edge.value_or(mean);
  result.n_bytes = bytes_at_least + bytes_a_point * std::max(result.n_points, volume / (edge * edge * edge));
  return result;
}

}  // namespace framehex
