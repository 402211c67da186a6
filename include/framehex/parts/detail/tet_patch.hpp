// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/mesh/indexed_mesh.hpp"
#include "framehex/parts/detail/held_tets.hpp"

namespace framehex::detail {

/// The order of a tetrahedron's corners that depends on neither its first order nor anything but its orientation: the
/// smallest first, then the smallest of the others.
inline std::array<index_t, 4> canonical_tet(std::array<index_t, 4> t) {
  const auto least = std::min_element(t.begin(), t.end()) - t.begin();
  if (least != 0) {
    std::swap(t[0], t[static_cast<std::size_t>(least)]);
    const std::size_t a = least == 1 ? 2 : 1, b = least == 3 ? 2 : 3;
    std::swap(t[a], t[b]);
  }
  std::rotate(t.begin() + 1, std::min_element(t.begin() + 1, t.end()), t.end());
  return t;
}

/// Tetrahedra in numbers that depend on places alone: vertices by rising coordinates, tetrahedra by rising vertices.
/// Whatever is done with them is the same on every rank that has them, and however the host counts.
struct TetPatch {
  IndexedTetMesh mesh;
  std::vector<global_t> vertex_number, tet_number;
  std::vector<index_t> regions;      ///< by tetrahedron; empty for one region
  std::vector<index_t> leaf_of_tet;  ///< where its centre lies
  TetAdjacency adjacency;
  std::vector<index_t> leaf_of_vertex;  ///< the first of its tetrahedra's

  /// The vertex with a number of the host, or `no_index`.
  index_t vertex(global_t number) const { return find(by_number_, vertex_number, number); }
  index_t tet(global_t number) const { return find(tets_by_number_, tet_number, number); }

  /// @param held  is let go.
  TetPatch(HeldTets held, const Partition& partition, bool has_regions) {
    number_vertices(held);
    add_tets(held, has_regions);
    held = {};
    adjacency = make_adjacency(mesh);
    for (const auto& t : mesh.tets)
      leaf_of_tet.push_back(
          partition.leaf_at(centre_of_tet(mesh.points[t[0]], mesh.points[t[1]], mesh.points[t[2]], mesh.points[t[3]])));
    leaf_of_vertex.assign(mesh.points.size(), no_index);
    for (std::size_t v = 0; v < mesh.points.size(); ++v)
      for (const index_t tet : adjacency.tets_of_vertex[v])
        leaf_of_vertex[v] = std::min(leaf_of_vertex[v], leaf_of_tet[tet]);
    by_number_ = sorted_by(vertex_number);
    tets_by_number_ = sorted_by(tet_number);
  }

private:
  static std::vector<index_t> sorted_by(const std::vector<global_t>& numbers) {
    std::vector<index_t> order(numbers.size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = static_cast<index_t>(i);
    std::sort(order.begin(), order.end(), [&](index_t a, index_t b) { return numbers[a] < numbers[b]; });
    return order;
  }

  static index_t find(const std::vector<index_t>& order, const std::vector<global_t>& numbers, global_t number) {
    const auto at =
        std::lower_bound(order.begin(), order.end(), number, [&](index_t i, global_t n) { return numbers[i] < n; });
    return at != order.end() && numbers[*at] == number ? *at : no_index;
  }

  void number_vertices(const HeldTets& held) {
    std::vector<VertexRecord> vertices = held.vertices;
    std::sort(vertices.begin(), vertices.end(),
              [](const VertexRecord& a, const VertexRecord& b) { return lies_before(a, b); });
    check_count(vertices.size(), no_index, "vertices on one rank");
    for (const VertexRecord& v : vertices) {
      mesh.points.push_back(point_at(v.place));
      vertex_number.push_back(v.number);
    }
    place_.resize(vertices.size());
    for (std::size_t i = 0; i < vertices.size(); ++i) place_[held.find(vertices[i].number)] = static_cast<index_t>(i);
  }

  void add_tets(const HeldTets& held, bool has_regions) {
    struct Tet {
      std::array<index_t, 4> corners;
      index_t record;
    };
    std::vector<Tet> tets(held.tets.size());
    check_count(tets.size(), no_index, "tetrahedra on one rank");
    for (std::size_t i = 0; i < tets.size(); ++i) {
      for (std::size_t k = 0; k < 4; ++k) tets[i].corners[k] = place_[held.find(held.tets[i].vertices[k])];
      tets[i] = {canonical_tet(tets[i].corners), static_cast<index_t>(i)};
    }
    std::vector<index_t>().swap(place_);
    std::sort(tets.begin(), tets.end(), [](const Tet& a, const Tet& b) { return a.corners < b.corners; });
    for (const Tet& tet : tets) {
      mesh.tets.push_back(tet.corners);
      tet_number.push_back(held.tets[tet.record].number);
      if (has_regions) regions.push_back(held.tets[tet.record].region);
    }
  }

  std::vector<index_t> place_;
  std::vector<index_t> by_number_, tets_by_number_;  ///< in ascending order of their numbers
};

}  // namespace framehex::detail
