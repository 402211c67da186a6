// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/recombination/detail/corner_faces.hpp"
#include "framehex/recombination/detail/find_cells.hpp"

namespace framehex {

namespace detail {

/// Enumerates six vertices with the connectivity of a prism: triangle a b c under d e f, a the smallest of the six.
class PrismSearch {
public:
  using Vertices = std::array<index_t, 6>;

  explicit PrismSearch(const FinderInput& input) : faces_(input) {}

  /// Calls emit(vertices) for each prism with smallest vertex `a`, once; see HexSearch.
  template <class Emit>
  void search(index_t a, Emit&& emit) {
    faces_.collect(a);
    gather_by_vertical(faces_.links().neighbours(a).size());
    const auto ring = faces_.links().neighbours(a);
    // b and c are two neighbours linked to one another that both have a quadrilateral with d.
    for (index_t d = 0; d < ring.size(); ++d) {
      const auto faces = by_vertical_[d];
      for (const Face& face : faces) face_at_[face.other] = &face;
      for (const Face& bd : faces)
        faces_.links().for_each_link(a, bd.other, [&](index_t c) {
          if (c < bd.other || face_at_[c] == nullptr) return;
          if (faces_.is_corner(a, ring[bd.other], ring[c], ring[d]))
            complete({a, ring[bd.other], ring[c], ring[d]}, bd, *face_at_[c], emit);
          else if (faces_.is_corner(a, ring[c], ring[bd.other], ring[d]))
            complete({a, ring[c], ring[bd.other], ring[d]}, *face_at_[c], bd, emit);
        });
      for (const Face& face : faces) face_at_[face.other] = nullptr;
    }
  }

private:
  using Face = CornerFaces::Face;

  void gather_by_vertical(std::size_t n) {
    face_at_.assign(n, nullptr);
    by_vertical_ = make_csr<Face>(n, [&](auto&& put) {
      for (index_t i = 0; i < n; ++i)
        for (const Face& face : faces_.faces(i)) {
          put(i, face);
          put(face.other, {i, face.begin, face.end});
        }
    });
  }

  template <class Emit>
  void complete(const std::array<index_t, 4>& corner, const Face& bd, const Face& cd, Emit& emit) const {
    const auto [a, b, c, d] = corner;
    const auto& links = faces_.links();
    for (const index_t e : faces_.opposites(bd)) {
      if (e == c || !faces_.is_corner(b, c, a, e)) continue;
      for (const index_t f : faces_.opposites(cd)) {
        if (f == b || f == e || !faces_.is_corner(c, a, b, f)) continue;
        if (links.is_facet(d, e, f) && links.is_opposite(b, links.position(b, c), links.position(b, e), f))
          emit(Vertices{a, b, c, d, e, f});
      }
    }
  }

  CornerFaces faces_;
  Csr<Face> by_vertical_;  ///< the faces of a with its neighbour at a position, whatever the other
  std::vector<const Face*> face_at_;
};

}  // namespace detail

/// Every potential prism of a tetrahedral mesh, for those who want it vertex by vertex; see PotentialHexFinder.
template <TetMesh Mesh>
class PotentialPrismFinder : public detail::PotentialCellFinder<6, detail::PrismSearch> {
public:
  explicit PotentialPrismFinder(const Mesh& mesh, const PrismFinderOptions& options = {})
      : PotentialCellFinder(mesh, options) {}
};

/// Every potential prism of a tetrahedral mesh; `find_potential_hexahedra` says the rest, with triangles that are
/// facets of the mesh for the two ends.
///
/// @return each prism once, ordered by its smallest vertex, which is its corner 0.
template <TetMesh Mesh, Executor E = SerialExecutor>
PotentialPrisms find_potential_prisms(const Mesh& mesh, const PrismFinderOptions& options = {},
                                      const E& executor = {}) {
  return PotentialPrismFinder<Mesh>(mesh, options).find(executor);
}

}  // namespace framehex
