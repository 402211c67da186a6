// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/assembly/detail/originals.hpp"
#include "framehex/mesh/indexed_mesh.hpp"
#include "framehex/parts/detail/part_state.hpp"
#include "framehex/recombination/candidates.hpp"

namespace framehex::detail {

/// The cells of one part as a complex that can be worked on, in numbers that depend on places alone. What it shares with
/// other parts is frozen: faces stay, vertices neither move nor go.
class PartComplex {
public:
  /// A face that one cell of the part has.
  struct Once {
    FaceKey key;
    index_t cell;
    std::uint8_t face;
    bool facing = false;  ///< a triangle of an open quadrilateral
  };

  /// @param cells         positions of the part's cells in `state`.
  /// @param first_source  by cell of the state: the first of what it was made of.
  PartComplex(const PartState& state, std::span<const index_t> cells, const std::vector<std::size_t>& first_source)
      : state_(state), first_source_(first_source) {
    number_vertices(cells);
    add_cells(cells);
    list_originals();
    look_at_border();
  }

  CellComplex complex;
  std::vector<std::uint8_t> frozen;     ///< by vertex, those of the start
  std::vector<global_t> vertex_number;  ///< by vertex, those of the start
  std::vector<StateVertex> vertices;    ///< by vertex, those of the start
  std::vector<index_t> record_of;       ///< by cell, those of the start: position in the state
  TetAdjacency originals_adjacency;
  PotentialHexahedra hexahedra;  ///< of what hexahedra of the part were made; the row is the cell's source
  PotentialPrisms prisms;
  bool usable = true;  ///< false: faces do not fit, and nothing is to be done

  Originals originals() const { return {originals_adjacency, hexahedra, prisms}; }

  /// Marks of all faces of all living cells as they are now; none when the border is not what it was at the start or
  /// cells do not meet face to face.
  /// @param number_of  callable: vertex -> its number.
  template <class NumberOf>
  bool find_marks(std::vector<std::array<std::uint8_t, 6>>& marks, NumberOf&& number_of) const;

  /// Lists the faces of living cells that one of them has, ascending; calls `shared(face, cell, cell)` for the others.
  /// @return false when a face has more than two cells, or two on one side.
  template <class Shared>
  bool list_once(std::vector<Once>& once, Shared&& shared) const;

  /// Whether another part lies beyond a face.
  bool is_frozen(const std::array<index_t, 4>& face) const { return frozen_mark(face_key(face)) != nullptr; }

private:
  const std::uint8_t* frozen_mark(const FaceKey& key) const {
    const auto at = std::lower_bound(frozen_faces_.begin(), frozen_faces_.end(), std::pair(key, std::uint8_t{0}));
    return at != frozen_faces_.end() && at->first == key ? &at->second : nullptr;
  }
  const CellRecord& record(index_t cell) const { return state_.cells[record_of[cell]]; }
  index_t local(global_t number) const {
    const auto at = std::lower_bound(by_number_.begin(), by_number_.end(), number,
                                     [this](index_t v, global_t n) { return vertex_number[v] < n; });
    return *at;
  }

  void number_vertices(std::span<const index_t> cells) {
    std::vector<global_t> numbers;
    for (const index_t i : cells) {
      const CellRecord& cell = state_.cells[i];
      numbers.insert(numbers.end(), cell.corners.begin(),
                     cell.corners.begin() + static_cast<std::ptrdiff_t>(cell.size()));
      for (std::size_t k = 0; k < cell.n_sources; ++k) {
        const auto& v = state_.sources[first_source_[i] + k].vertices;
        numbers.insert(numbers.end(), v.begin(), v.end());
      }
    }
    std::sort(numbers.begin(), numbers.end());
    numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
    for (const global_t n : numbers) vertices.push_back(state_.vertices[state_.find(n)]);
    std::sort(vertices.begin(), vertices.end(), [](const StateVertex& a, const StateVertex& b) {
      return a.place != b.place ? a.place < b.place : a.number < b.number;
    });
    for (const StateVertex& v : vertices) {
      vertex_number.push_back(v.number);
      complex.add_vertex(point_at(v.place), false);
      complex.settled.push_back(v.settled);
    }
    by_number_.resize(vertices.size());
    for (std::size_t i = 0; i < by_number_.size(); ++i) by_number_[i] = static_cast<index_t>(i);
    std::sort(by_number_.begin(), by_number_.end(),
              [this](index_t a, index_t b) { return vertex_number[a] < vertex_number[b]; });
    frozen.assign(vertices.size(), 0);
  }

  void add_cells(std::span<const index_t> cells) {
    struct Entry {
      CellKind kind;
      std::array<index_t, 8> corners;
      index_t record;
    };
    std::vector<Entry> entries;
    for (const index_t i : cells) {
      const CellRecord& cell = state_.cells[i];
      Entry& entry = entries.emplace_back(Entry{cell.kind, {}, i});
      entry.corners.fill(no_index);
      for (std::size_t k = 0; k < cell.size(); ++k) entry.corners[k] = local(cell.corners[k]);
    }
    std::sort(entries.begin(), entries.end(), [](const Entry& a, const Entry& b) {
      return a.kind != b.kind ? a.kind > b.kind : a.corners < b.corners;
    });
    for (const Entry& entry : entries) {
      const CellRecord& cell = state_.cells[entry.record];
      record_of.push_back(entry.record);
      complex.add(entry.kind, {entry.corners.data(), cell.size()}, cell.region, no_index);
    }
  }

  /// What hexahedra and prisms were made of, and what lay in their faces, as a mesh of its own.
  void list_originals() {
    struct Tet {
      std::array<index_t, 4> corners;
      global_t number;
    };
    std::vector<Tet> tets;
    const auto each_source = [this](index_t cell, auto&& visit) {
      const index_t i = record_of[cell];
      for (std::size_t k = 0; k < state_.cells[i].n_sources; ++k) visit(state_.sources[first_source_[i] + k]);
    };
    for (index_t cell = 0; cell < record_of.size(); ++cell)
      each_source(cell, [&](const SourceTet& source) {
        Tet tet{{}, source.number};
        for (std::size_t k = 0; k < 4; ++k) tet.corners[k] = local(source.vertices[k]);
        tets.push_back(tet);
      });
    std::sort(tets.begin(), tets.end(), [](const Tet& a, const Tet& b) { return a.number < b.number; });
    tets.erase(std::unique(tets.begin(), tets.end(), [](const Tet& a, const Tet& b) { return a.number == b.number; }),
               tets.end());
    std::sort(tets.begin(), tets.end(), [](const Tet& a, const Tet& b) { return a.corners < b.corners; });
    IndexedTetMesh mesh;
    mesh.points = complex.points;
    std::vector<std::pair<global_t, index_t>> place;
    for (const Tet& tet : tets) {
      place.emplace_back(tet.number, static_cast<index_t>(mesh.tets.size()));
      mesh.tets.push_back(tet.corners);
    }
    std::sort(place.begin(), place.end());
    originals_adjacency = make_adjacency(mesh);
    for (index_t cell = 0; cell < record_of.size(); ++cell) {
      if (record(cell).n_sources == 0) continue;
      const auto add_row = [&](Csr<index_t>& rows) {
        each_source(cell, [&](const SourceTet& source) {
          if (source.is_sliver == 0)
            rows.values.push_back(
                std::lower_bound(place.begin(), place.end(), std::pair(source.number, index_t{0}))->second);
        });
        std::sort(rows.values.begin() + static_cast<std::ptrdiff_t>(rows.offsets.back()), rows.values.end());
        rows.end_row();
        complex.cells[cell].source = static_cast<index_t>(rows.size() - 1);
      };
      complex.cells[cell].kind == CellKind::hexahedron ? add_row(hexahedra.tets) : add_row(prisms.tets);
    }
  }

  /// The diagonal of an open quadrilateral that a mark tells.
  int diagonal(const std::array<index_t, 4>& quad, std::uint8_t mark) const {
    int low = 0;
    for (int i = 1; i < 4; ++i)
      if (vertex_number[quad[static_cast<std::size_t>(i)]] < vertex_number[quad[static_cast<std::size_t>(low)]])
        low = i;
    return (low + (mark & FaceMark::low_diagonal ? 0 : 1)) % 2;
  }

  static std::array<FaceKey, 4> triangles_of(const FaceKey& quad_cycle) {
    std::array<FaceKey, 4> keys;
    for (std::size_t i = 0; i < 4; ++i)
      keys[i] = face_key({quad_cycle[i], quad_cycle[(i + 1) % 4], quad_cycle[(i + 2) % 4], no_index});
    return keys;
  }

  /// Opens the quadrilaterals whose two sides are at hand, and freezes what other parts share.
  void look_at_border() {
    std::vector<Once> once;
    usable = list_once(once, [this](const FaceKey& face, index_t a, index_t b) {
      if (complex.cells[a].region != complex.cells[b].region)
        for (std::size_t i = 0; i < 4 && face[i] != no_index; ++i) complex.is_protected[face[i]] = 1;
    });
    const auto find = [&](const FaceKey& key) {
      const auto at =
          std::lower_bound(once.begin(), once.end(), key, [](const Once& o, const FaceKey& k) { return o.key < k; });
      return at != once.end() && at->key == key ? &*at : nullptr;
    };
    const auto mark_of = [&](const Once& o) { return record(o.cell).marks[o.face]; };
    for (Once& o : once) {
      const std::uint8_t mark = mark_of(o);
      if (o.key[3] == no_index || (mark & FaceMark::boundary) || !(mark & FaceMark::cut)) continue;
      const auto face = complex.face(o.cell, o.face);
      const bool half = (mark & FaceMark::half) != 0;
      const OpenQuad quad{face, o.cell, diagonal(face, mark), half, true};
      const std::array<Once*, 2> sides{find(face_key(quad.triangle(0))), find(face_key(quad.triangle(1)))};
      const auto here = [&](const Once* side) { return side != nullptr && !(mark_of(*side) & FaceMark::boundary); };
      if ((here(sides[0]) ? 1 : 0) + (here(sides[1]) ? 1 : 0) != (half ? 1 : 2)) continue;
      for (std::size_t i = 0; i < 2; ++i) {
        if (here(sides[i]))
          sides[i]->facing = true;
        else
          border_triangles_.push_back(face_key(quad.triangle(static_cast<int>(i))));
      }
      o.facing = true;
      complex.add_open_quad(quad);
    }
    for (const Once& o : once) {
      if (o.facing) continue;
      const auto face = complex.face(o.cell, o.face);
      const std::size_t n = face[3] == no_index ? 3 : 4;
      const bool outside = (mark_of(o) & FaceMark::boundary) != 0;
      for (std::size_t i = 0; i < n; ++i) {
        complex.on_boundary[face[i]] = complex.is_protected[face[i]] = 1;
        if (!outside) frozen[face[i]] = 1;
      }
      if (!outside) {
        frozen_faces_.emplace_back(o.key, mark_of(o));
        // Taken apart, it would come out as triangles.
        if (n == 4) complex.cells[o.cell].source = no_index;
      } else if (n == 3) {
        border_triangles_.push_back(o.key);
      } else {
        const auto keys = triangles_of(face);
        border_triangles_.insert(border_triangles_.end(), keys.begin(), keys.end());
      }
    }
    std::sort(border_triangles_.begin(), border_triangles_.end());
  }

  const PartState& state_;
  const std::vector<std::size_t>& first_source_;
  std::vector<index_t> by_number_;
  std::vector<std::pair<FaceKey, std::uint8_t>> frozen_faces_;  ///< and their marks; ascending
  std::vector<FaceKey> border_triangles_;  ///< of the outside, both cuts of quadrilaterals; ascending
};

template <class Shared>
bool PartComplex::list_once(std::vector<Once>& once, Shared&& shared) const {
  struct Use {
    FaceKey key;
    index_t cell;
    std::uint8_t face;
  };
  std::vector<Use> uses;
  for (index_t cell = 0; cell < complex.cells.size(); ++cell)
    if (complex.cells[cell].alive)
      for (std::size_t f = 0; f < complex.n_faces(cell); ++f)
        uses.push_back({face_key(complex.face(cell, f)), cell, static_cast<std::uint8_t>(f)});
  std::sort(uses.begin(), uses.end(),
            [](const Use& a, const Use& b) { return a.key != b.key ? a.key < b.key : a.cell < b.cell; });
  bool fits = true;
  for (std::size_t i = 0, end = 0; i < uses.size(); i = end) {
    while (end < uses.size() && uses[end].key == uses[i].key) ++end;
    if (end - i == 1) {
      once.push_back({uses[i].key, uses[i].cell, uses[i].face});
      continue;
    }
    auto other = rotated(complex.face(uses[i + 1].cell, uses[i + 1].face));
    std::swap(other[1], other[other[3] == no_index ? 2 : 3]);
    fits = fits && end - i == 2 && rotated(complex.face(uses[i].cell, uses[i].face)) == other;
    shared(uses[i].key, uses[i].cell, uses[i + 1].cell);
  }
  return fits;
}

template <class NumberOf>
bool PartComplex::find_marks(std::vector<std::array<std::uint8_t, 6>>& marks, NumberOf&& number_of) const {
  std::vector<Once> once;
  if (!list_once(once, [](const FaceKey&, index_t, index_t) {})) return false;
  marks.assign(complex.cells.size(), {});
  for (index_t cell = 0; cell < record_of.size(); ++cell) marks[cell] = record(cell).marks;
  std::size_t n_frozen = 0;
  const auto is_border = [this](const FaceKey& key) {
    return std::binary_search(border_triangles_.begin(), border_triangles_.end(), key);
  };
  for (const Once& o : once) {
    std::uint8_t& mark = marks[o.cell][o.face];
    if (const std::uint8_t* const frozen_face = frozen_mark(o.key)) {
      ++n_frozen;
      mark = *frozen_face;
      continue;
    }
    const index_t open = complex.open_quad_at(o.key);
    if (open != no_index) {
      if (o.key[3] == no_index) continue;
      const OpenQuad& quad = complex.open_quads[open];
      std::size_t low = 0;
      for (std::size_t i = 1; i < 4; ++i)
        if (number_of(quad.vertices[i]) < number_of(quad.vertices[low])) low = i;
      const bool low_diagonal = static_cast<int>(low % 2) == quad.diagonal % 2;
      mark = static_cast<std::uint8_t>(FaceMark::cut | (low_diagonal ? FaceMark::low_diagonal : 0) |
                                       (quad.half_boundary ? FaceMark::half : 0));
      continue;
    }
    if (o.key[3] == no_index) {
      if (!is_border(o.key)) return false;
    } else {
      const auto keys = triangles_of(complex.face(o.cell, o.face));
      if (!(is_border(keys[0]) && is_border(keys[2])) && !(is_border(keys[1]) && is_border(keys[3]))) return false;
    }
    mark = FaceMark::boundary;
  }
  return n_frozen == frozen_faces_.size();
}

}  // namespace framehex::detail
