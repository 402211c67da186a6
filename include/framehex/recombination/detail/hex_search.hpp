// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/recombination/detail/corner_faces.hpp"

namespace framehex::detail {

/// Enumerates eight vertices with the connectivity of a hexahedron. Scratch memory for one thread.
///
/// Names: a is the smallest vertex; b, d, e are its neighbours, c, f, h lie opposite it in its three quadrilaterals, g
/// opposite it in the cell:
///
///        h--------g
///       /|       /|
///      e--------f |
///      | |      | |
///      | d------|-c
///      |/       |/
///      a--------b
class HexSearch {
public:
  using Vertices = std::array<index_t, 8>;

  explicit HexSearch(const FinderInput& input) : faces_(input) {}

  /// Calls emit(vertices) for each hexahedron with smallest vertex `a`, once. Corners below the quality floor by more
  /// than rounding are pruned; the rest is for the caller to check.
  template <class Emit>
  void search(index_t a, Emit&& emit) {
    faces_.collect(a);
    const auto ring = faces_.links().neighbours(a);
    face_at_.assign(ring.size(), nullptr);
    for (index_t i = 0; i < ring.size(); ++i) {
      for (const Face& ij : faces_.faces(i)) face_at_[ij.other] = &ij;
      for (const Face& ij : faces_.faces(i))
        for (const Face& jk : faces_.faces(ij.other)) {
          const Face* const ik = face_at_[jk.other];
          if (ik == nullptr) continue;
          const index_t b = ring[i], x = ring[ij.other], y = ring[jk.other];
          if (faces_.is_corner(a, b, x, y))
            complete({a, b, no_index, x, y}, ij, *ik, jk, emit);
          else if (faces_.is_corner(a, b, y, x))
            complete({a, b, no_index, y, x}, *ik, ij, jk, emit);
        }
      for (const Face& ij : faces_.faces(i)) face_at_[ij.other] = nullptr;
    }
  }

private:
  using Face = CornerFaces::Face;

  template <class Emit>
  void complete(const Vertices& corner, const Face& bd, const Face& be, const Face& de, Emit& emit) const {
    const auto& links = faces_.links();
    const index_t a = corner[0], b = corner[1], d = corner[3], e = corner[4];
    for (const index_t c : faces_.opposites(bd)) {
      if (c == e) continue;
      for (const index_t f : faces_.opposites(be)) {
        if (f == c || f == d || !faces_.is_corner(b, c, a, f)) continue;
        links.for_each_opposite(b, links.position(b, c), links.position(b, f), [&](index_t g) {
          if (g <= a || g == d || g == e || !faces_.is_corner(c, d, b, g) || !faces_.is_corner(f, e, g, b)) return;
          for (const index_t h : faces_.opposites(de)) {
            if (h == b || h == c || h == f || h == g) continue;
            if (!faces_.is_quadrilateral(d, c, g, h) || !faces_.is_quadrilateral(e, f, g, h)) continue;
            if (faces_.is_corner(d, a, c, h) && faces_.is_corner(e, h, f, a) && faces_.is_corner(g, f, h, c) &&
                faces_.is_corner(h, g, e, d))
              emit(Vertices{a, b, c, d, e, f, g, h});
          }
        });
      }
    }
  }

  CornerFaces faces_;
  std::vector<const Face*> face_at_;  ///< by position among the neighbours of a
};

}  // namespace framehex::detail
