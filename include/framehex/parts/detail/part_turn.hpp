// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/assembly/detail/improver.hpp"
#include "framehex/assembly/detail/interface_closer.hpp"
#include "framehex/parts/detail/part_complex.hpp"

namespace framehex::detail {

/// How a part is worked on in its turn.
struct TurnSettings {
  const AssemblyOptions& options;
  int turn = 0;
  bool defers = true;  ///< leaves open quadrilaterals at what is frozen to a later turn
};

/// Closes and improves the cells of one part. What comes out is checked, and the part stays as it was when it does not
/// pass: cells valid, faces matched, the border as before.
class PartTurn {
public:
  /// A face beyond which another part lies, or nothing that fits: what must find its other side there.
  struct OpenFace {
    std::array<global_t, 4> vertices;  ///< ascending; a triangle's last is -1
    Place centre;
    std::uint32_t side;  ///< differs for the two sides
  };

  PartTurn(const PartState& state, std::span<const index_t> cells, const std::vector<std::size_t>& first_source,
           const TurnSettings& settings, index_t leaf)
      : state_(state), cells_(cells), first_source_(first_source), settings_(settings), leaf_(leaf) {}

  AssemblyStatistics statistics;
  std::vector<OpenFace> open_faces;  ///< of the result
  bool kept = false;                 ///< the part stays as it was

  PartState run(const Observer& observer) {
    PartComplex part(state_, cells_, first_source_);
    if (part.usable) work(part, observer);
    std::vector<std::array<std::uint8_t, 6>> marks;
    const auto number_of = [&](index_t v) { return number(part, v); };
    if (part.usable && changed_cells_are_valid(part) && part.find_marks(marks, number_of)) return result(part, marks);
    kept = true;
    statistics = {};
    PartComplex unchanged(state_, cells_, first_source_);
    for (const index_t id : unchanged.record_of) marks.push_back(state_.cells[id].marks);
    unchanged.complex.settled.clear();
    return result(unchanged, marks);
  }

private:
  void work(PartComplex& part, const Observer& observer) {
    CellComplex& complex = part.complex;
    const AssemblyOptions& options = settings_.options;
    if (settings_.defers) complex.deferred = part.frozen;
    hold_unclosed(part);
    Pulse pulse(observer, "assembly");
    const Originals originals = part.originals();
    const bool improves = options.improvement == ImprovementMode::improve;
    if (!improves) complex.is_protected.assign(complex.n_vertices(), 1);
    Improver improver(complex, QualityEnergy::reaching(options.hexahedron_target, options.quality_target), {},
                      statistics, pulse);
    InterfaceCloser closer(complex, originals, options.quality_floor, statistics, pulse);
    closer.merge_pairs(options.quality_floor);
    if (options.interfaces == InterfaceMode::conforming) {
      if (improves) improver.reconnect();
      closer.close_all();
    }
    if (improves) improver.run(8, options.interfaces == InterfaceMode::conforming);
  }

  /// Keeps the corners of cells where they are that may yet have to be taken back into their tetrahedra: those with a
  /// quadrilateral that is left to a later turn.
  void hold_unclosed(PartComplex& part) {
    CellComplex& complex = part.complex;
    held_ = part.frozen;
    const auto hold = [&](index_t cell) {
      for (const index_t v : complex.corners(cell)) held_[v] = complex.on_boundary[v] = complex.is_protected[v] = 1;
    };
    for (index_t cell = 0; cell < part.record_of.size(); ++cell) {
      const CellRecord& record = state_.cells[part.record_of[cell]];
      for (std::size_t f = 0; record.n_sources > 0 && f < complex.n_faces(cell); ++f)
        if ((record.marks[f] & FaceMark::cut) && part.is_frozen(complex.face(cell, f))) hold(cell);
    }
    for (const OpenQuad& quad : complex.open_quads)
      if (complex.is_deferred(quad)) hold(quad.cell);
    if (settings_.defers) complex.spared = held_;
  }

  global_t number(const PartComplex& part, index_t v) const {
    const std::size_t n = part.vertex_number.size();
    return v < n ? part.vertex_number[v] : new_vertex_number(settings_.turn, leaf_, v - n);
  }

  bool is_unchanged(const PartComplex& part, index_t cell) const {
    if (cell >= part.record_of.size()) return false;
    return std::ranges::none_of(part.complex.corners(cell), [&](index_t v) { return has_moved(part, v); });
  }
  static bool has_moved(const PartComplex& part, index_t v) {
    return v < part.vertices.size() && place_of(part.complex.points[v]) != part.vertices[v].place;
  }

  bool changed_cells_are_valid(const PartComplex& part) const {
    for (index_t cell = 0; cell < part.complex.cells.size(); ++cell)
      if (part.complex.cells[cell].alive && !is_unchanged(part, cell) && !part.complex.valid(cell)) return false;
    return true;
  }

  PartState result(const PartComplex& part, const std::vector<std::array<std::uint8_t, 6>>& marks) {
    const CellComplex& complex = part.complex;
    PartState state;
    for (index_t id = 0; id < complex.cells.size(); ++id) {
      if (!complex.cells[id].alive) continue;
      CellRecord& cell = state.cells.emplace_back();
      const bool is_new = id >= part.record_of.size();
      if (!is_new) {
        cell = state_.cells[part.record_of[id]];
        const auto first = state_.sources.begin() + static_cast<std::ptrdiff_t>(first_source_[part.record_of[id]]);
        state.sources.insert(state.sources.end(), first, first + cell.n_sources);
      } else {
        cell.kind = complex.cells[id].kind;
        cell.region = complex.cells[id].region;
        cell.corners.fill(-1);
        for (std::size_t k = 0; k < cell.size(); ++k) cell.corners[k] = number(part, complex.cells[id].corners[k]);
      }
      cell.marks = marks[id];
    }
    add_vertices(part, state);
    list_open_faces(part);
    return state;
  }

  /// Vertices that cells or what they were made of have. Settled are those that have no cell with one that was held.
  void add_vertices(const PartComplex& part, PartState& state) const {
    const CellComplex& complex = part.complex;
    std::vector<std::uint8_t> needed(complex.n_vertices(), 0), near_held(complex.n_vertices(), 0);
    for (index_t id = 0; id < complex.cells.size(); ++id) {
      if (!complex.cells[id].alive) continue;
      const auto corners = complex.corners(id);
      const bool touches = std::ranges::any_of(corners, [&](index_t v) { return v < held_.size() && held_[v] != 0; });
      for (const index_t v : corners) {
        needed[v] = 1;
        if (touches) near_held[v] = 1;
      }
    }
    std::vector<global_t> of_sources;
    for (const SourceTet& source : state.sources)
      of_sources.insert(of_sources.end(), source.vertices.begin(), source.vertices.end());
    std::sort(of_sources.begin(), of_sources.end());
    for (index_t v = 0; v < complex.n_vertices(); ++v) {
      const global_t n = number(part, v);
      if (!needed[v] && !std::binary_search(of_sources.begin(), of_sources.end(), n)) continue;
      StateVertex vertex{n, place_of(complex.points[v]), 0, 0};
      if (v < part.vertices.size()) {
        vertex.moved = part.vertices[v].moved != 0 || has_moved(part, v) ? 1 : 0;
        vertex.settled = part.vertices[v].settled;
      }
      if (!kept && !near_held[v]) vertex.settled = 1;
      state.vertices.push_back(vertex);
    }
  }

  void list_open_faces(const PartComplex& part) {
    std::vector<PartComplex::Once> once;
    part.list_once(once, [](const FaceKey&, index_t, index_t) {});
    for (const auto& o : once) {
      const auto face = part.complex.face(o.cell, o.face);
      if (!part.is_frozen(face) && part.complex.open_quad_at(face) == no_index) continue;
      open_faces.push_back(open_face(part, face));
    }
  }

  OpenFace open_face(const PartComplex& part, const std::array<index_t, 4>& face) const {
    const std::size_t n = face[3] == no_index ? 3 : 4;
    OpenFace open{};
    std::array<Vector3, 4> p;
    open.vertices.fill(-1);
    std::size_t low = 0;
    for (std::size_t i = 0; i < n; ++i) {
      open.vertices[i] = number(part, face[i]);
      p[i] = part.complex.points[face[i]];
      if (open.vertices[i] < open.vertices[low]) low = i;
    }
    open.side = open.vertices[(low + 1) % n] < open.vertices[(low + n - 1) % n] ? 1 : 0;
    std::sort(open.vertices.begin(), open.vertices.begin() + static_cast<std::ptrdiff_t>(n));
    open.centre = place_of(centre_of(p, n));
    return open;
  }

  const PartState& state_;
  std::span<const index_t> cells_;
  const std::vector<std::size_t>& first_source_;
  const TurnSettings& settings_;
  index_t leaf_;
  std::vector<std::uint8_t> held_;  ///< vertices that could not move for what lies beyond the border
};

}  // namespace framehex::detail
