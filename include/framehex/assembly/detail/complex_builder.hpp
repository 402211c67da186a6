// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/assembly/detail/originals.hpp"
#include "framehex/assembly/options.hpp"
#include "framehex/errors.hpp"

#include <string>

namespace framehex::detail {

/// Puts chosen cells one by one in the place of their tetrahedra, and refuses what does not fit.
class ComplexBuilder {
public:
  ComplexBuilder(const std::vector<Vector3>& points, const TetAdjacency& adjacency, const AssemblyOptions& options)
      : adjacency_(adjacency),
        options_(options),
        owner_(adjacency.tets.size(), no_index),
        sliver_of_(adjacency.tets.size(), no_index) {
    for (const Vector3& p : points) complex.add_vertex(p, false);
    if (options.improvement == ImprovementMode::none) complex.is_protected.assign(points.size(), 1);
    for (index_t tet = 0; tet < adjacency.tets.size(); ++tet)
      for (int f = 0; f < 4; ++f) {
        const index_t other = adjacency.neighbours[tet][static_cast<std::size_t>(f)];
        if (other != no_index && region(other) == region(tet)) continue;
        for (const index_t v : facet(adjacency.tets[tet], f)) {
          complex.is_protected[v] = 1;
          if (other == no_index) complex.on_boundary[v] = 1;
        }
      }
    protect_labels();
  }

  CellComplex complex;

  /// Why a cell does not fit.
  struct Refusal {
    const char* reason = nullptr;  ///< nullptr: it fits
    index_t other = no_index;      ///< the cell of the complex that it does not fit to, if there is one
  };

  /// Adds a hexahedron or prism made of some tetrahedra, unless it does not fit.
  Refusal add(CellKind kind, std::span<const index_t> corners, std::span<const index_t> tets, index_t source) {
    if (const Refusal refusal = check(kind, corners, tets); refusal.reason) return refusal;
    const index_t id = complex.add(kind, corners, region(tets[0]), source);
    for (const index_t tet : tets) owner_[tet] = id;
    for (const index_t sliver : slivers_)
      if (sliver_of_[sliver] == no_index) sliver_of_[sliver] = id;
    other_cuts.insert(other_cuts.end(), cuts_.begin(), cuts_.end());
    complex.protected_faces.insert(labelled_inside_.begin(), labelled_inside_.end());
    sides_of_.insert(sides_of_.end(), sides_.begin(), sides_.end());
    for (const auto& [pair, other] : pairs_) pair_use_.try_emplace(pair, PairUse{other, id});
    return {};
  }

  /// Adds the tetrahedra that are in no chosen cell, and opens the quadrilaterals that face two of them.
  void finish() {
    const auto n_chosen = static_cast<index_t>(complex.cells.size());
    for (std::size_t tet = 0; tet < adjacency_.tets.size(); ++tet)
      if (is_free(static_cast<index_t>(tet)))
        complex.add(CellKind::tetrahedron, adjacency_.tets[tet], region(static_cast<index_t>(tet)), no_index);
    for (const Side& side : sides_of_) {
      const int n_rest = (state(side.outer[0]) == State::rest) + (state(side.outer[1]) == State::rest);
      const index_t cell = owner_[side.tet];
      if (n_rest == 0 || cell >= n_chosen) continue;
      complex.add_open_quad({side.quad, cell, side.outer_diagonal, n_rest == 1, true});
    }
    sides_of_.clear();
  }

  /// Labels for the triangles of the other diagonal of labelled quadrilaterals, which may come back cut that way.
  std::vector<OtherCut> other_cuts;

  bool is_free(index_t tet) const { return owner_[tet] == no_index && sliver_of_[tet] == no_index; }

  index_t region(index_t tet) const { return options_.regions.empty() ? 0 : options_.regions[tet]; }

  /// How well the quadrilaterals of the cell that was checked last meet what is there.
  struct Fit {
    int n_matched = 0;  ///< face a quadrilateral or the boundary
    int n_opened = 0;   ///< face two tetrahedra
  };
  Fit last_fit() const { return fit_; }
  Refusal check(CellKind kind, std::span<const index_t> corners, std::span<const index_t> tets);

private:
  enum class State { boundary, rest, chosen };
  State state(index_t tet) const {
    if (tet == no_index) return State::boundary;
    return owner_[tet] == no_index ? State::rest : State::chosen;
  }

  /// A quadrilateral of a chosen cell and what lies outside.
  struct Side {
    std::array<index_t, 4> quad;
    std::array<index_t, 2> outer;  ///< tetrahedra behind triangle 0 and 1 of the outer diagonal
    int outer_diagonal;
    index_t tet;  ///< one inside
  };
  struct PairUse {
    std::uint64_t other;  ///< of a diagonal: the other diagonal of its quadrilateral; 0 for an edge
    index_t cell;
  };

  void protect_labels() {
    for (const LabelledFace& face : options_.faces) {
      const FaceKey key = face_key(face.vertices);
      label_at_.emplace(key, &face);
      for (std::size_t i = 0; i < face.size(); ++i) complex.is_protected[face.vertices[i]] = 1;
      if (!is_boundary_facet(key)) complex.protected_faces.insert(key);
    }
    for (const LabelledEdge& edge : options_.edges) {
      complex.protected_edges.insert(face_key({edge.vertices[0], edge.vertices[1], no_index, no_index}));
      pair_use_.try_emplace(edge_key(edge.vertices[0], edge.vertices[1]), PairUse{0, no_index});
      for (const index_t v : edge.vertices) complex.is_protected[v] = 1;
    }
  }

  bool is_boundary_facet(const FaceKey& key) const {
    for (const index_t tet : adjacency_.tets_of_vertex[key[0]])
      for (int f = 0; f < 4; ++f)
        if (adjacency_.neighbours[tet][static_cast<std::size_t>(f)] == no_index) {
          const auto t = facet(adjacency_.tets[tet], f);
          if (face_key({t[0], t[1], t[2], no_index}) == key) return true;
        }
    return false;
  }

  Refusal check_pairs(CellKind kind, std::span<const index_t> corners);
  Refusal check_sides(CellKind kind, std::span<const index_t> corners, std::span<const index_t> tets);
  Refusal add_side(const std::array<index_t, 4>& quad, const std::array<index_t, 2>& inner_tets, int inner_diagonal);

  const TetAdjacency& adjacency_;
  const AssemblyOptions& options_;
  std::vector<index_t> owner_;      ///< by tetrahedron: the chosen cell that it is part of
  std::vector<index_t> sliver_of_;  ///< by tetrahedron: the first chosen cell in whose face it lies
  std::unordered_map<std::uint64_t, PairUse> pair_use_;
  std::unordered_map<FaceKey, const LabelledFace*, FaceKeyHash> label_at_;
  std::vector<Side> sides_of_;

  // of the cell under check
  std::vector<index_t> slivers_;
  std::vector<std::pair<std::uint64_t, std::uint64_t>> pairs_;
  std::vector<Side> sides_;
  std::vector<OtherCut> cuts_;
  std::vector<FaceKey> labelled_inside_;
  Fit fit_;
};

inline ComplexBuilder::Refusal ComplexBuilder::check(CellKind kind, std::span<const index_t> corners,
                                                     std::span<const index_t> tets) {
  slivers_.clear();
  sides_.clear();
  cuts_.clear();
  labelled_inside_.clear();
  fit_ = {};
  if (tets.empty()) return {"it has no tetrahedra"};
  for (std::size_t i = 0; i < corners.size(); ++i) {
    if (corners[i] >= complex.n_vertices()) return {"it refers to a vertex that does not exist"};
    if (std::find(corners.begin(), corners.begin() + static_cast<std::ptrdiff_t>(i), corners[i]) !=
        corners.begin() + static_cast<std::ptrdiff_t>(i))
      return {"it has a vertex twice"};
  }
  for (std::size_t i = 0; i < tets.size(); ++i) {
    if (tets[i] >= adjacency_.tets.size()) return {"it refers to a tetrahedron that does not exist"};
    if (i > 0 && tets[i - 1] >= tets[i]) return {"its tetrahedra are not in ascending order"};
    if (owner_[tets[i]] != no_index) return {"they share a tetrahedron", owner_[tets[i]]};
    if (sliver_of_[tets[i]] != no_index) return {"a tetrahedron lies in a face of the other", sliver_of_[tets[i]]};
    if (region(tets[i]) != region(tets[0])) return {"it lies in two regions"};
  }
  if (const Refusal refusal = check_pairs(kind, corners); refusal.reason) return refusal;
  return check_sides(kind, corners, tets);
}

/// An edge of one cell may not be a diagonal of another's quadrilateral, nor two quadrilaterals share a diagonal.
inline ComplexBuilder::Refusal ComplexBuilder::check_pairs(CellKind kind, std::span<const index_t> corners) {
  pairs_.clear();
  const auto at = [&](std::int8_t i) { return corners[static_cast<std::size_t>(i)]; };
  for (const auto& edge : edges_of(kind)) pairs_.emplace_back(edge_key(at(edge[0]), at(edge[1])), 0);
  for (const LocalFace& face : faces_of(kind)) {
    if (face.size() == 3) continue;
    const std::uint64_t first = edge_key(at(face.corners[0]), at(face.corners[2]));
    const std::uint64_t second = edge_key(at(face.corners[1]), at(face.corners[3]));
    pairs_.emplace_back(first, second);
    pairs_.emplace_back(second, first);
  }
  for (const auto& [pair, other] : pairs_) {
    const auto found = pair_use_.find(pair);
    if (found == pair_use_.end() || found->second.other == other) continue;
    if (found->second.cell == no_index) return {"a labelled edge is a diagonal of one of its faces"};
    return {"a diagonal of a face of one is an edge or another diagonal of the other", found->second.cell};
  }
  return {};
}

inline ComplexBuilder::Refusal ComplexBuilder::check_sides(CellKind kind, std::span<const index_t> corners,
                                                           std::span<const index_t> tets) {
  constexpr const char* not_filled = "its tetrahedra do not fill it";
  const auto faces = faces_of(kind);
  std::array<std::array<index_t, 4>, 6> inner{};  // by face and missing corner: the tetrahedron behind the triangle
  for (auto& face : inner) face.fill(no_index);
  std::array<int, 6> n_triangles{};
  for (const index_t tet : tets)
    for (int i = 0; i < 4; ++i) {
      const auto triangle = facet(adjacency_.tets[tet], i);
      const index_t beyond = adjacency_.neighbours[tet][static_cast<std::size_t>(i)];
      if (beyond != no_index && std::binary_search(tets.begin(), tets.end(), beyond)) {
        if (!complex.protected_faces.empty() &&
            complex.protected_faces.contains(face_key({triangle[0], triangle[1], triangle[2], no_index})))
          return {"a labelled face lies inside"};
        continue;
      }
      bool found = false;
      for (std::size_t f = 0; f < faces.size() && !found; ++f) {
        int n_shared = 0;
        std::size_t missing = 0;
        for (std::size_t k = 0; k < static_cast<std::size_t>(faces[f].size()); ++k) {
          const index_t v = corners[static_cast<std::size_t>(faces[f].corners[k])];
          if (std::find(triangle.begin(), triangle.end(), v) != triangle.end())
            ++n_shared;
          else
            missing = k;
        }
        if (n_shared < 3) continue;
        found = true;
        if (inner[f][missing] != no_index) return {not_filled};
        inner[f][missing] = tet;
        ++n_triangles[f];
      }
      if (!found) return {not_filled};
    }
  for (std::size_t f = 0; f < faces.size(); ++f) {
    if (n_triangles[f] != faces[f].size() - 2) return {not_filled};
    if (faces[f].size() == 3) continue;
    const int diagonal = inner[f][3] != no_index ? 0 : 1;
    std::array<index_t, 4> quad{};
    for (std::size_t k = 0; k < 4; ++k) quad[k] = corners[static_cast<std::size_t>(faces[f].corners[k])];
    const std::array<index_t, 2> inner_tets{inner[f][diagonal == 0 ? 3 : 0], inner[f][diagonal == 0 ? 1 : 2]};
    if (inner_tets[0] == no_index || inner_tets[1] == no_index) return {not_filled};
    if (const Refusal refusal = add_side(quad, inner_tets, diagonal); refusal.reason) return refusal;
  }
  return {};
}

/// Finds what lies outside a quadrilateral, past a face sliver if there is one.
inline ComplexBuilder::Refusal ComplexBuilder::add_side(const std::array<index_t, 4>& quad,
                                                        const std::array<index_t, 2>& inner_tets, int inner_diagonal) {
  // The corner that triangle i of a diagonal leaves out, as in OpenQuad.
  const auto missing = [&](int diagonal, int i) { return quad[static_cast<std::size_t>((diagonal + 2 * i + 3) % 4)]; };
  const auto beyond = [&](index_t tet, int diagonal, int i) {
    const auto& t = adjacency_.tets[tet];
    for (std::size_t f = 0; f < 4; ++f)
      if (std::find(quad.begin(), quad.end(), t[f]) == quad.end() || t[f] == missing(diagonal, i))
        return adjacency_.neighbours[tet][f];
    return no_index;
  };
  const auto triangle = [&](int diagonal, int i) { return OpenQuad{quad, 0, diagonal, false, false}.triangle(i); };
  const auto labelled = [&](int diagonal, int i) -> const LabelledFace* {
    const auto found = label_at_.find(face_key(triangle(diagonal, i)));
    return found == label_at_.end() ? nullptr : found->second;
  };
  Side side{quad, {}, inner_diagonal, inner_tets[0]};
  for (std::size_t i = 0; i < 2; ++i) side.outer[i] = beyond(inner_tets[i], inner_diagonal, static_cast<int>(i));
  const index_t sliver = side.outer[0];
  const bool has_sliver = sliver != no_index && face_key(adjacency_.tets[sliver]) == face_key(quad);
  if (has_sliver) {
    if (side.outer[1] != sliver) return {"its tetrahedra do not fill it"};
    if (owner_[sliver] != no_index) return {"a tetrahedron of the other lies in one of its faces", owner_[sliver]};
    if (region(sliver) != region(inner_tets[0])) return {"it lies in two regions"};
    if (labelled(inner_diagonal, 0) || labelled(inner_diagonal, 1)) return {"a labelled face lies inside"};
    slivers_.push_back(sliver);
    side.outer_diagonal = 1 - inner_diagonal;
    for (int i = 0; i < 2; ++i) side.outer[static_cast<std::size_t>(i)] = beyond(sliver, side.outer_diagonal, i);
  }
  if (!label_at_.empty()) {
    // Of the cut that the face shows; a labelled triangle of the other cut, if there is one, belongs to another cell.
    const int shown = side.outer_diagonal;
    const LabelledFace *const one = labelled(shown, 0), *const two = labelled(shown, 1);
    if ((one != nullptr) != (two != nullptr) || (one && one->label != two->label))
      return {"one of its faces lies on two labelled patches"};
    if (one) {
      const bool outward = rotated(one->vertices) == rotated(triangle(shown, 0));
      for (int i = 0; i < 2; ++i) {
        auto other = triangle(1 - shown, i);
        if (side.outer[0] != no_index) labelled_inside_.push_back(face_key(other));
        if (!outward) std::swap(other[0], other[2]);
        cuts_.push_back({{other, one->label}, face_key(one->vertices)});
      }
      if (side.outer[0] != no_index) labelled_inside_.push_back(face_key(quad));
    }
  }

  const State first = state(side.outer[0]), second = state(side.outer[1]);
  if (first == State::chosen || second == State::chosen) {
    const index_t other = owner_[side.outer[first == State::chosen ? 0 : 1]];
    bool same = first == second && owner_[side.outer[0]] == owner_[side.outer[1]], shared = false;
    for (std::size_t f = 0; same && f < complex.n_faces(other); ++f)
      shared = shared || face_key(complex.face(other, f)) == face_key(quad);
    if (!shared) return {"they meet in part of a face", other};
  }
  if (first == State::rest || second == State::rest)
    fit_.n_opened += first == second ? 1 : 2;
  else
    ++fit_.n_matched;
  sides_.push_back(side);
  return {};
}

}  // namespace framehex::detail
