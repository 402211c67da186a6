// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/assembly/detail/prism_chooser.hpp"
#include "framehex/parts/detail/calling_thread.hpp"
#include "framehex/parts/detail/candidate_states.hpp"
#include "framehex/parts/detail/part_state.hpp"

namespace framehex::detail {

/// Cells that take the place of tetrahedra of a patch, in its numbers.
struct ChosenCells {
  std::vector<std::array<index_t, 8>> vertices;  ///< of a prism the last two are `no_index`
  Csr<index_t> tets, slivers;                    ///< ascending
  std::vector<std::uint8_t> is_own;              ///< this rank makes the cell of it
  std::vector<index_t> candidate;                ///< of this rank, `no_index` for others

  std::size_t size() const { return vertices.size(); }
};

/// Makes the chosen hexahedra known to all ranks with tetrahedra at their vertices. Collective.
template <Transport Tr>
ChosenCells share_chosen(const Tr& transport, const Partition& partition, const TetPatch& patch,
                         const CandidatePool& pool, const CandidateStates<Tr>& states) {
  struct Header {
    std::array<global_t, 8> vertices;
    std::uint32_t n_tets, n_slivers;
  };
  struct Entry {
    std::array<index_t, 8> vertices;
    std::vector<index_t> tets, slivers;
    std::uint8_t is_own;
    index_t candidate;
  };
  std::vector<Entry> entries;
  auto headers = make_rows<Header>(transport);
  auto numbers = make_rows<global_t>(transport);
  for (index_t i = 0; i < pool.n_own; ++i) {
    if (states[i] != CandidateStates<Tr>::taken) continue;
    const auto tets = pool.candidates.tets[i], slivers = pool.candidates.face_slivers[i];
    const auto& vertices = pool.candidates.vertices[i];
    entries.push_back({vertices, {tets.begin(), tets.end()}, {slivers.begin(), slivers.end()}, 1, i});
    if (transport.n_ranks() == 1) continue;
    std::vector<int> ranks;
    for (const index_t v : vertices)
      for (const index_t tet : patch.adjacency.tets_of_vertex[v])
        ranks.push_back(partition.rank(patch.leaf_of_tet[tet]));
    std::sort(ranks.begin(), ranks.end());
    ranks.erase(std::unique(ranks.begin(), ranks.end()), ranks.end());
    for (const int rank : ranks) {
      if (rank == transport.rank()) continue;
      const auto to = static_cast<std::size_t>(rank);
      Header& header = headers[to].emplace_back();
      for (std::size_t k = 0; k < 8; ++k) header.vertices[k] = patch.vertex_number[vertices[k]];
      header.n_tets = static_cast<std::uint32_t>(tets.size());
      header.n_slivers = static_cast<std::uint32_t>(slivers.size());
      for (const index_t tet : tets) numbers[to].push_back(patch.tet_number[tet]);
      for (const index_t tet : slivers) numbers[to].push_back(patch.tet_number[tet]);
    }
  }
  const auto arrived = send_joined(transport, std::move(headers));
  const auto arrived_numbers = send_joined(transport, std::move(numbers));
  auto next = arrived_numbers.begin();
  const auto take = [&](std::vector<index_t>& to, std::uint32_t n) {
    for (; n > 0; --n) to.push_back(patch.tet(*next++));
    std::sort(to.begin(), to.end());
  };
  for (const Header& header : arrived) {
    Entry& entry = entries.emplace_back();
    for (std::size_t k = 0; k < 8; ++k) entry.vertices[k] = patch.vertex(header.vertices[k]);
    take(entry.tets, header.n_tets);
    take(entry.slivers, header.n_slivers);
    entry.is_own = 0;
    entry.candidate = no_index;
  }
  std::sort(entries.begin(), entries.end(), [](const Entry& a, const Entry& b) { return a.vertices < b.vertices; });
  ChosenCells chosen;
  for (const Entry& entry : entries) {
    chosen.vertices.push_back(entry.vertices);
    chosen.is_own.push_back(entry.is_own);
    chosen.candidate.push_back(entry.candidate);
    chosen.tets.values.insert(chosen.tets.values.end(), entry.tets.begin(), entry.tets.end());
    chosen.tets.end_row();
    chosen.slivers.values.insert(chosen.slivers.values.end(), entry.slivers.begin(), entry.slivers.end());
    chosen.slivers.end_row();
  }
  return chosen;
}

/// Chooses prisms among the tetrahedra of one leaf that are in no hexahedron. All their vertices are inside the leaf, so
/// that those of two leaves do not meet.
class LeafPrisms {
public:
  LeafPrisms(const TetPatch& patch, const ChosenCells& hexahedra, const Csr<index_t>& hexahedra_of_vertex,
             const AssemblyOptions& options)
      : patch_(patch), hexahedra_(hexahedra), hexahedra_of_vertex_(hexahedra_of_vertex), options_(options) {}

  /// @param tets     of the leaf.
  /// @param allowed  callable: number of a vertex -> whether prisms may have it.
  /// @return prisms in the numbers of the patch.
  template <class Allowed>
  ChosenCells choose(index_t leaf, std::span<const index_t> tets, Allowed&& allowed, const Observer& observer) {
    gather(tets);
    ChosenCells chosen;
    if (n_free_ == 0) return chosen;
    AssemblyOptions options = options_;
    options.regions = regions_;
    options.faces = {};
    options.edges = {};
    const TetAdjacency adjacency = make_adjacency(mesh_);
    ComplexBuilder builder(mesh_.points, adjacency, options);
    for (const index_t hex : near_) {
      std::array<index_t, 8> corners{};
      for (std::size_t k = 0; k < 8; ++k) corners[k] = local(vertex_of_, hexahedra_.vertices[hex][k]);
      std::vector<index_t> inside;
      for (const index_t tet : hexahedra_.tets[hex]) inside.push_back(local(tet_of_, tet));
      builder.add(CellKind::hexahedron, corners, inside, hex);
    }
    PotentialPrisms prisms = find_free_prisms(builder, adjacency, options,
                                              {.quality_floor = options_.prism_quality_floor, .observer = observer});
    if (prisms.status == Status::cancelled) return chosen;
    keep_inside(prisms, leaf, allowed);
    const auto n_before = builder.complex.cells.size();
    choose_prisms(builder, prisms, options_.interfaces == InterfaceMode::open ? 3 : 1);
    for (std::size_t cell = n_before; cell < builder.complex.cells.size(); ++cell) {
      const index_t prism = builder.complex.cells[cell].source;
      auto& vertices = chosen.vertices.emplace_back();
      vertices.fill(no_index);
      for (std::size_t k = 0; k < 6; ++k) vertices[k] = vertex_of_[prisms.vertices[prism][k]];
      for (const index_t tet : prisms.tets[prism]) chosen.tets.values.push_back(tet_of_[tet]);
      for (const index_t tet : prisms.face_slivers[prism]) chosen.slivers.values.push_back(tet_of_[tet]);
      chosen.tets.end_row();
      chosen.slivers.end_row();
      chosen.is_own.push_back(1);
      chosen.candidate.push_back(no_index);
    }
    return chosen;
  }

private:
  static index_t local(const std::vector<index_t>& list, index_t i) {
    return static_cast<index_t>(std::lower_bound(list.begin(), list.end(), i) - list.begin());
  }
  static void tidy(std::vector<index_t>& list) {
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
  }

  /// The leaf's tetrahedra with those of all hexahedra that touch them.
  void gather(std::span<const index_t> tets) {
    tet_of_.assign(tets.begin(), tets.end());
    for (const index_t tet : tets)
      for (const index_t v : patch_.mesh.tets[tet])
        near_.insert(near_.end(), hexahedra_of_vertex_[v].begin(), hexahedra_of_vertex_[v].end());
    tidy(near_);
    std::vector<index_t> used;
    for (const index_t hex : near_)
      for (const auto row : {hexahedra_.tets[hex], hexahedra_.slivers[hex]})
        used.insert(used.end(), row.begin(), row.end());
    tidy(used);
    tet_of_.insert(tet_of_.end(), used.begin(), used.end());
    tidy(tet_of_);
    n_free_ = tet_of_.size() - used.size();
    for (const index_t tet : tet_of_) {
      vertex_of_.insert(vertex_of_.end(), patch_.mesh.tets[tet].begin(), patch_.mesh.tets[tet].end());
      if (!patch_.regions.empty()) regions_.push_back(patch_.regions[tet]);
    }
    tidy(vertex_of_);
    for (const index_t v : vertex_of_) mesh_.points.push_back(patch_.mesh.points[v]);
    for (const index_t tet : tet_of_) {
      auto& corners = mesh_.tets.emplace_back(patch_.mesh.tets[tet]);
      for (index_t& v : corners) v = local(vertex_of_, v);
    }
  }

  template <class Allowed>
  void keep_inside(PotentialPrisms& prisms, index_t leaf, Allowed&& allowed) const {
    PotentialPrisms kept;
    for (std::size_t i = 0; i < prisms.size(); ++i) {
      const bool inside = std::ranges::all_of(prisms.vertices[i], [&](index_t v) {
        return allowed(patch_.vertex_number[vertex_of_[v]]) &&
               std::ranges::all_of(patch_.adjacency.tets_of_vertex[vertex_of_[v]],
                                   [&](index_t tet) { return patch_.leaf_of_tet[tet] == leaf; });
      });
      if (!inside) continue;
      kept.vertices.push_back(prisms.vertices[i]);
      kept.quality.push_back(prisms.quality[i]);
      kept.volume.push_back(prisms.volume[i]);
      for (const auto& [from, to] : {std::pair(&prisms.tets, &kept.tets), {&prisms.face_slivers, &kept.face_slivers}}) {
        to->values.insert(to->values.end(), (*from)[i].begin(), (*from)[i].end());
        to->end_row();
      }
    }
    prisms = std::move(kept);
  }

  const TetPatch& patch_;
  const ChosenCells& hexahedra_;
  const Csr<index_t>& hexahedra_of_vertex_;
  const AssemblyOptions& options_;
  std::vector<index_t> near_;                ///< hexahedra that touch the leaf
  std::vector<index_t> tet_of_, vertex_of_;  ///< of the patch, ascending
  std::vector<index_t> regions_;
  IndexedTetMesh mesh_;
  std::size_t n_free_ = 0;
};

/// Makes the state that the turns begin with: chosen cells, and the tetrahedra that are in none.
class StateMaker {
public:
  explicit StateMaker(const TetPatch& patch) : patch_(patch), used_(patch.mesh.tets.size(), 0) {}

  /// Tetrahedra of all chosen cells are used, and this rank makes its own ones.
  void add(CellKind kind, const ChosenCells& chosen) {
    for (std::size_t i = 0; i < chosen.size(); ++i) {
      for (const auto row : {chosen.tets[i], chosen.slivers[i]})
        for (const index_t tet : row)
          if (tet != no_index) used_[tet] = 1;
      if (!chosen.is_own[i]) continue;
      add_cell(kind, chosen.vertices[i], chosen.tets[i], chosen.slivers[i]);
      state_.cells.back().candidate = chosen.candidate[i];
    }
  }

  /// @param leaves  that this rank holds.
  PartState finish(const std::array<index_t, 2>& leaves) {
    for (index_t tet = 0; tet < patch_.mesh.tets.size(); ++tet) {
      if (used_[tet] || patch_.leaf_of_tet[tet] < leaves[0] || patch_.leaf_of_tet[tet] >= leaves[1]) continue;
      CellRecord& cell = begin_cell(CellKind::tetrahedron, patch_.mesh.tets[tet], tet);
      cell.tet = patch_.tet_number[tet];
      for (std::size_t f = 0; f < 4; ++f)
        if (patch_.adjacency.neighbours[tet][f] == no_index) cell.marks[local_face(f)] = FaceMark::boundary;
    }
    for (index_t v = 0; v < has_vertex_.size(); ++v)
      if (has_vertex_[v]) state_.vertices.push_back({patch_.vertex_number[v], place_of(patch_.mesh.points[v]), 0, 0});
    state_.tidy();
    return std::move(state_);
  }

private:
  /// Facet i of a tetrahedron lies opposite corner i; so do the faces of the kind.
  static std::size_t local_face(std::size_t opposite) { return opposite; }

  CellRecord& begin_cell(CellKind kind, std::span<const index_t> corners, index_t tet) {
    CellRecord& cell = state_.cells.emplace_back();
    cell.kind = kind;
    cell.region = patch_.regions.empty() ? 0 : patch_.regions[tet];
    cell.corners.fill(-1);
    for (std::size_t k = 0; k < cell.size(); ++k) cell.corners[k] = number(corners[k]);
    return cell;
  }

  global_t number(index_t v) {
    has_vertex_.resize(patch_.vertex_number.size(), 0);
    has_vertex_[v] = 1;
    return patch_.vertex_number[v];
  }

  void add_cell(CellKind kind, const std::array<index_t, 8>& corners, std::span<const index_t> tets,
                std::span<const index_t> slivers) {
    CellRecord& cell = begin_cell(kind, corners, tets[0]);
    cell.n_sources = static_cast<std::uint32_t>(tets.size() + slivers.size());
    for (const auto& [row, is_sliver] : {std::pair(tets, 0U), std::pair(slivers, 1U)})
      for (const index_t tet : row) {
        SourceTet& source = state_.sources.emplace_back();
        for (std::size_t k = 0; k < 4; ++k) source.vertices[k] = number(patch_.mesh.tets[tet][k]);
        source.number = patch_.tet_number[tet];
        source.is_sliver = is_sliver;
      }
    const auto faces = faces_of(kind);
    for (std::size_t f = 0; f < faces.size(); ++f) {
      std::array<index_t, 4> face{};
      for (std::size_t k = 0; k < 4; ++k)
        face[k] = faces[f].corners[k] < 0 ? no_index : corners[static_cast<std::size_t>(faces[f].corners[k])];
      cell.marks[f] = mark(face, tets);
    }
  }

  /// What lies outside a face, past a sliver in it if there is one.
  std::uint8_t mark(const std::array<index_t, 4>& face, std::span<const index_t> tets) const {
    const auto& neighbours = patch_.adjacency.neighbours;
    const bool is_quad = face[3] != no_index;
    const auto position = [&](index_t v) {
      return static_cast<std::size_t>(std::ranges::find(face, v) - face.begin());
    };
    int n_outside = 0;
    std::size_t diagonal = 0;  // 0 or 1: the corner at which the common edge of the outer triangles begins
    for (const index_t tet : tets)
      for (std::size_t i = 0; i < 4; ++i) {
        index_t beyond = neighbours[tet][i];
        if (beyond != no_index && std::binary_search(tets.begin(), tets.end(), beyond)) continue;
        const auto triangle = facet(patch_.mesh.tets[tet], static_cast<int>(i));
        if (!std::ranges::all_of(triangle, [&](index_t v) { return position(v) < 4; })) continue;
        if (!is_quad) return beyond == no_index ? FaceMark::boundary : 0;
        // The corner that this triangle leaves out is no end of the diagonal.
        std::size_t missing = 0;
        while (std::ranges::find(triangle, face[missing]) != triangle.end()) ++missing;
        diagonal = (missing + 1) % 2;
        if (beyond != no_index &&
            std::ranges::all_of(patch_.mesh.tets[beyond], [&](index_t v) { return position(v) < 4; })) {
          // Of a sliver the facet that is opposite one end of its inner diagonal.
          const auto& corners = patch_.mesh.tets[beyond];
          const index_t end = face[(missing + 1) % 4];
          beyond = neighbours[beyond][static_cast<std::size_t>(std::ranges::find(corners, end) - corners.begin())];
          diagonal = 1 - diagonal;
        }
        n_outside += beyond == no_index ? 1 : 0;
      }
    if (n_outside == 2) return FaceMark::boundary;
    std::size_t low = 0;
    for (std::size_t k = 1; k < 4; ++k)
      if (patch_.vertex_number[face[k]] < patch_.vertex_number[face[low]]) low = k;
    return static_cast<std::uint8_t>(FaceMark::cut | (low % 2 == diagonal ? FaceMark::low_diagonal : 0) |
                                     (n_outside == 1 ? FaceMark::half : 0));
  }

  const TetPatch& patch_;
  std::vector<std::uint8_t> used_;        ///< by tetrahedron
  std::vector<std::uint8_t> has_vertex_;  ///< by vertex
  PartState state_;
};

}  // namespace framehex::detail
