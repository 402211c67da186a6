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
    locate_opposites(a);
    face_at_.assign(faces_.links().neighbours(a).size(), nullptr);
    combine(a, emit);
  }

private:
  using Face = CornerFaces::Face;

  /// Each three neighbours of a that have quadrilaterals two by two.
  template <class Emit>
  void combine(index_t a, Emit& emit) {
    for (index_t i = 0; i < face_at_.size(); ++i) {
      for (const Face& ij : faces_.faces(i)) face_at_[ij.other] = &ij;
      for (const Face& ij : faces_.faces(i))
        for (const Face& jk : faces_.faces(ij.other))
          if (const Face* const ik = face_at_[jk.other]; ik != nullptr) orient(a, i, ij, *ik, jk, emit);
      for (const Face& ij : faces_.faces(i)) face_at_[ij.other] = nullptr;
    }
  }

  /// Where the vertices opposite a are among the neighbours of its two neighbours beside them, once for all cells.
  void locate_opposites(index_t a) {
    const auto& links = faces_.links();
    const auto ring = links.neighbours(a);
    for (index_t i = 0; i < ring.size(); ++i)
      for (const Face& face : faces_.faces(i)) {
        const auto opposites = faces_.opposites(face);
        if (places_.size() < face.end) places_.resize(face.end);
        for (std::size_t n = 0; n < opposites.size(); ++n)
          places_[face.begin + n] = {links.position(ring[i], opposites[n]),
                                     links.position(ring[face.other], opposites[n])};
      }
  }

  /// Names the neighbours at i < j < k b, d, e, the last two in the order of a positive corner.
  template <class Emit>
  void orient(index_t a, index_t i, const Face& ij, const Face& ik, const Face& jk, Emit& emit) {
    const auto ring = faces_.links().neighbours(a);
    const index_t b = ring[i], x = ring[ij.other], y = ring[jk.other];
    if (faces_.is_corner(a, b, x, y))
      complete({a, b, x, y}, ij, ik, jk, 0, emit);
    else if (faces_.is_corner(a, b, y, x))
      complete({a, b, y, x}, ik, ij, jk, 1, emit);
  }

  /// @param side_of_d  0 when d is the first of the two neighbours of `de`, 1 when it is the second.
  template <class Emit>
  void complete(const std::array<index_t, 4>& corner, const Face& bd, const Face& be, const Face& de,
                std::size_t side_of_d, Emit& emit) {
    const auto& links = faces_.links();
    const auto [a, b, d, e] = corner;
    const auto C = faces_.opposites(bd), F = faces_.opposites(be), H = faces_.opposites(de);
    const Places *const c_at = &places_[bd.begin], *const f_at = &places_[be.begin], *const h_at = &places_[de.begin];
    at_d_.assign(C.size() * H.size(), Known::not_yet);
    at_e_.assign(F.size() * H.size(), Known::not_yet);
    for (std::size_t i = 0; i < C.size(); ++i) {
      const index_t c = C[i];
      if (c == e) continue;
      for (std::size_t j = 0; j < F.size(); ++j) {
        const index_t f = F[j];
        if (f == c || f == d || !faces_.is_corner(b, c, a, f)) continue;
        usable_.clear();
        for (std::size_t k = 0; k < H.size(); ++k) {
          const index_t h = H[k];
          if (h != b && h != c && h != f && is_known(at_d_[i * H.size() + k], d, a, c, h) &&
              is_known(at_e_[j * H.size() + k], e, h, f, a))
            usable_.push_back(k);
        }
        if (usable_.empty()) continue;
        links.for_each_opposite(b, c_at[i][0], f_at[j][0], [&](index_t g) {
          if (g <= a || g == d || g == e || !faces_.is_corner(c, d, b, g) || !faces_.is_corner(f, e, g, b)) return;
          for (const std::size_t k : usable_)
            if (const index_t h = H[k]; h != g && links.is_opposite(d, c_at[i][1], h_at[k][side_of_d], g) &&
                                        links.is_opposite(e, f_at[j][1], h_at[k][1 - side_of_d], g) &&
                                        faces_.is_corner(g, f, h, c) && faces_.is_corner(h, g, e, d))
              emit(Vertices{a, b, c, d, e, f, g, h});
        });
      }
    }
  }

  /// Corners at d and e are shared by several hexahedra and are looked at once.
  enum class Known : std::uint8_t { not_yet, yes, no };

  bool is_known(Known& known, index_t o, index_t x, index_t y, index_t z) const {
    if (known == Known::not_yet) known = faces_.is_corner(o, x, y, z) ? Known::yes : Known::no;
    return known == Known::yes;
  }

  /// Positions of a vertex opposite a among the neighbours of the face's two neighbours of a.
  using Places = std::array<index_t, 2>;

  CornerFaces faces_;
  std::vector<const Face*> face_at_;  ///< by position among the neighbours of a
  std::vector<Places> places_;        ///< by the range of a face
  std::vector<Known> at_d_, at_e_;    ///< [c][h] and [f][h]
  std::vector<std::size_t> usable_;   ///< places of the h that fit c and f
};

}  // namespace framehex::detail
