// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/assembly/detail/originals.hpp"
#include "framehex/assembly/options.hpp"
#include "framehex/observer.hpp"

namespace framehex::detail {

/// Closes open quadrilaterals without pyramids.
///
/// A quadrilateral can then meet a quadrilateral only, so that a hexahedron in front of tetrahedra must go. One that is
/// open on one side, or on two opposite ones whose diagonals agree, becomes two prisms, and the next hexahedron in the
/// row is open in its turn until the row ends on the boundary; any other goes back to tetrahedra. A hexahedron that cannot,
/// because neighbours are cut along other diagonals, is joined to a new vertex at its centre; where no centre sees all its
/// triangles the quadrilateral stays open.
class PyramidFreeCloser {
public:
  PyramidFreeCloser(CellComplex& complex, const Originals& originals, double quality_floor,
                    AssemblyStatistics& statistics, Pulse& pulse)
      : complex_(complex),
        filler_(complex),
        originals_(originals),
        floor_(quality_floor),
        statistics_(statistics),
        pulse_(pulse) {}

  void close_all() {
    for (index_t quad = 0; quad < complex_.open_quads.size(); ++quad) {
      if (!complex_.open_quads[quad].open) continue;
      if (!pulse_.beat(0.5 * quad / static_cast<double>(complex_.open_quads.size()))) return;
      const index_t cell = complex_.open_quads[quad].cell;
      if (split_in_prisms(cell)) {
        ++statistics_.n_split;
      } else if (dissolve(complex_, filler_, originals_, cell)) {
        ++statistics_.n_dissolved;
      } else if (shatter(cell)) {
        ++statistics_.n_split;
      }
    }
  }

private:
  /// Opens the face of the cell across, if there is one, with a diagonal given by one of its ends.
  void open_across(const std::array<index_t, 4>& face, index_t neighbour, index_t end) {
    if (neighbour == no_index) return;
    const auto quad = complex_.face_like(neighbour, face);
    complex_.add_open_quad({quad, neighbour, quad[0] == end || quad[2] == end ? 0 : 1, false, true});
  }

  bool split_in_prisms(index_t id) {
    const CellComplex::Cell cell = complex_.cells[id];
    if (cell.kind != CellKind::hexahedron) return false;
    // Opposite faces of a hexahedron and, for a diagonal from the first corner of the first, the corners of the others.
    constexpr std::array<std::array<std::size_t, 2>, 3> opposite{{{0, 1}, {2, 4}, {3, 5}}};
    constexpr std::array<std::array<std::size_t, 8>, 3> turned{
        {{0, 1, 2, 3, 4, 5, 6, 7}, {0, 4, 5, 1, 3, 7, 6, 2}, {1, 5, 6, 2, 0, 4, 7, 3}}};
    std::size_t axis = 3;
    for (std::size_t a = 0; a < 3; ++a)
      for (const std::size_t f : opposite[a]) {
        const index_t open = complex_.open_quad_at(complex_.face(id, f));
        if (open == no_index) continue;
        if ((axis != 3 && axis != a) || complex_.open_quads[open].half_boundary) return false;
        axis = a;
      }
    // The hexahedron seen with the open pair as bottom 0 1 2 3 and top 4 5 6 7.
    std::array<index_t, 8> v{};
    for (std::size_t i = 0; i < 8; ++i) v[i] = cell.corners[turned[axis][i]];
    int diagonal = -1;
    for (const std::size_t f : opposite[axis]) {
      const index_t open = complex_.open_quad_at(complex_.face(id, f));
      if (open == no_index) continue;
      const index_t end = complex_.open_quads[open].triangle(0)[0];
      const int d = end == v[0] || end == v[2] || end == v[4] || end == v[6] ? 0 : 1;
      if (diagonal >= 0 && diagonal != d) return false;
      diagonal = d;
    }
    const std::size_t s = diagonal == 0 ? 0 : 1;
    const auto at = [&](std::size_t i) { return v[(i + s) % 4]; };
    const auto top = [&](std::size_t i) { return v[4 + (i + s) % 4]; };
    const std::array<index_t, 6> first{at(0), at(1), at(2), top(0), top(1), top(2)};
    const std::array<index_t, 6> second{at(0), at(2), at(3), top(0), top(2), top(3)};
    for (const auto& prism : {first, second}) {
      std::array<Vector3, 6> p;
      for (std::size_t i = 0; i < 6; ++i) p[i] = complex_.points[prism[i]];
      if (scaled_jacobian(CellKind::prism, p) < floor_ || !is_valid(CellKind::prism, p)) return false;
    }
    struct Other {
      std::array<index_t, 4> face;
      index_t neighbour;
    };
    std::array<Other, 2> others{};
    for (std::size_t i = 0; i < 2; ++i) {
      const auto face = complex_.face(id, opposite[axis][i]);
      others[i] = {face, complex_.across(id, face)};
      if (const index_t open = complex_.open_quad_at(face); open != no_index) complex_.close_quad(open);
    }
    complex_.remove(id);
    for (const auto& prism : {first, second}) complex_.add(CellKind::prism, prism, cell.region, no_index);
    for (const Other& other : others) {
      const bool bottom = std::find(other.face.begin(), other.face.end(), at(0)) != other.face.end();
      open_across(other.face, other.neighbour, bottom ? at(0) : top(0));
    }
    return true;
  }

  /// Cuts all faces in triangles and joins them to a new vertex at the centre.
  /// @return false, with nothing changed, when there is no place for it.
  bool shatter(index_t id) {
    struct Cut {
      std::array<index_t, 4> face;
      index_t neighbour;
    };
    std::vector<Cut> cuts;
    for (std::size_t f = 0; f < complex_.n_faces(id); ++f) {
      const auto face = complex_.face(id, f);
      if (face[3] == no_index || complex_.open_quad_at(face) != no_index) continue;
      cuts.push_back({face, complex_.across(id, face)});
      complex_.add_open_quad({face, id, 0, false, true});
    }
    if (!fill_from_centre(id)) {
      for (const Cut& cut : cuts) complex_.close_quad(complex_.open_quad_at(cut.face));
      return false;
    }
    for (const Cut& cut : cuts) open_across(cut.face, cut.neighbour, cut.face[0]);
    return true;
  }

  bool fill_from_centre(index_t id) {
    Cavity cavity;
    cavity.cells = {id};
    if (!filler_.build(cavity)) return false;
    Vector3 centre = Vector3::Zero();
    const auto corners = complex_.corners(id);
    for (const index_t v : corners) centre += complex_.points[v] / static_cast<double>(corners.size());
    const double size = (complex_.points[corners[0]] - centre).norm();
    filler_.improve_point(cavity, centre, 0.2 * size, filler_.evaluate(cavity, centre, no_index));
    return filler_.fill_from_new_vertex(cavity, centre);
  }

  CellComplex& complex_;
  CavityFiller filler_;
  const Originals& originals_;
  double floor_;
  AssemblyStatistics& statistics_;
  Pulse& pulse_;
};

}  // namespace framehex::detail
