// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/field/tet_locator.hpp"
#include "framehex/insertion/surface_inserter.hpp"
#include "framehex/insertion/volume_inserter.hpp"
#include "framehex/lattice/lattice_points.hpp"

namespace framehex {

/// Covers a surface with the samples of a lattice, and with those of a front where the lattice has none: near singular
/// lines, dislocations, and where the map is too far from the sizes.
///
/// @param curves   of `insert_curve_points` with the same lattice.
/// @param options  `complete` and `rounds` are the lattice's: its samples are not moved.
/// @throws as `SurfaceInserter`.
template <InsertionOrder Order = SmoothnessOrder, SizeField Size>
SurfaceInsertion fill_lattice_surface(const Surface& surface, std::span<const Quaternion> frames,
                                      std::span<const double> smoothness, const CurveInsertion& curves,
                                      const Size& size, const LatticePoints& lattice, SurfaceOptions options = {},
                                      Order order = Order{}) {
  options.complete = lattice.complete_triangles;
  options.rounds = 0;
  SurfaceInserter<Order, Size> inserter(surface, frames, smoothness, curves, size, options, std::move(order));
  for (const SurfaceSample& sample : lattice.surface) inserter.add_sample(sample.entity, sample.point);
  return std::move(inserter).finish();
}

/// Fills a domain with the points of a lattice, and with those of a front where the lattice has none.
///
/// @param locator  of the mesh whose tetrahedra `lattice` speaks of.
/// @param options  `wanted` is the lattice's.
/// @throws as `VolumeInserter`.
template <InsertionOrder Order = SmoothnessOrder, FrameSource Frames, SizeField Size, Domain D>
VolumeInsertion fill_lattice_volume(std::span<const BoundarySeed> seeds, const Frames& frames, const Size& size,
                                    const D& domain, const LatticePoints& lattice, const TetLocator& locator,
                                    VolumeOptions options = {}, Order order = Order{}) {
  index_t hint = no_index;
  options.wanted = [&, hint](const Vector3& p) mutable {
    const TetLocation at = locator.locate(p, hint);
    hint = at.tet;
    return at.tet == no_index || lattice.complete_tets[at.tet] == 0;
  };
  VolumeInserter<Order, Frames, Size, D> inserter(frames, size, domain, seeds, options, std::move(order));
  for (const Vector3& p : lattice.interior) inserter.add_point(p);
  return std::move(inserter).finish();
}

}  // namespace framehex
