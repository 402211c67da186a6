// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/distributed/detail/packing.hpp"
#include "framehex/distributed/mixed_part.hpp"
#include "framehex/io/data_array.hpp"

#include <unordered_map>

namespace framehex::distributed::detail {

/// Packs rows of each array.
inline void pack_rows(std::vector<std::byte>& bytes, const std::vector<DataArray>& arrays,
                      const std::vector<index_t>& rows) {
  for (const DataArray& array : arrays)
    std::visit(
        [&](const auto& values) {
          std::decay_t<decltype(values)> taken;
          for (const index_t row : rows) {
            const auto begin = values.begin() + static_cast<std::ptrdiff_t>(row * array.n_components);
            taken.insert(taken.end(), begin, begin + static_cast<std::ptrdiff_t>(array.n_components));
          }
          pack(bytes, taken);
        },
        array.values);
}

/// Takes them back, and appends some to the arrays.
inline void append_rows(Unpacker& in, std::vector<DataArray>& arrays, const std::vector<std::size_t>& rows) {
  for (DataArray& array : arrays)
    std::visit(
        [&](auto& values) {
          const auto arrived = in.take<typename std::decay_t<decltype(values)>::value_type>();
          for (const std::size_t row : rows) {
            const auto begin = arrived.begin() + static_cast<std::ptrdiff_t>(row * array.n_components);
            values.insert(values.end(), begin, begin + static_cast<std::ptrdiff_t>(array.n_components));
          }
        },
        array.values);
}

/// @throws invalid_option  when another rank has other arrays. Collective.
inline void check_same_arrays(const MpiTransport& transport, const MeshData& data) {
  std::string mine;
  for (const auto* const arrays : {&data.cells, &data.points})
    for (const DataArray& a : *arrays)
      mine += a.name + ' ' + std::to_string(a.n_components) + ' ' + std::to_string(a.values.index()) + ';';
  for (const std::string& other : gathered_texts(transport, {mine}))
    if (other != mine) throw invalid_option("the arrays of one rank are not those of another");
}

/// A part and, behind its own cells, those of other ranks that touch it.
class HaloedPart {
public:
  MixedMesh mesh;
  std::vector<std::int64_t> vertex_ids, cell_ids;
  std::vector<std::uint8_t> vertex_ghosts, cell_ghosts;  ///< VTK's marks: 1 where another rank has it
  MeshData data;

  /// Fetches the cells of other ranks that have a vertex of this one's. Collective; between ranks that share vertices.
  ///
  /// @param own  by cell and point of the part; the rows of ghosts are fetched, too.
  HaloedPart(const MpiTransport& transport, const MixedPart& part, const MeshData& own)
      : mesh(part.mesh),
        vertex_ids(part.vertex_ids.begin(), part.vertex_ids.end()),
        cell_ids(part.cell_ids.begin(), part.cell_ids.end()),
        cell_ghosts(part.mesh.n_cells(), 0),
        data(own) {
    check_same_arrays(transport, own);
    for (const int owner : part.owners) vertex_ghosts.push_back(owner != transport.rank());
    for (index_t v = 0; v < vertex_ids.size(); ++v) vertex_of_.emplace(vertex_ids[v], v);
    const auto touching = touching_cells(part, transport.n_ranks());
    std::vector<Parcel> parcels;
    for (std::size_t rank = 0; rank < touching.size(); ++rank)
      if (!touching[rank].empty()) parcels.push_back({static_cast<int>(rank), packed(part, own, touching[rank])});
    for (const Parcel& p : transport.exchange(std::move(parcels))) add_ghosts(Unpacker(p.bytes));
  }

private:
  /// This rank's cells that have a vertex of another's, per rank.
  static std::vector<std::vector<index_t>> touching_cells(const MixedPart& part, int n_ranks) {
    std::vector<std::vector<index_t>> touching(static_cast<std::size_t>(n_ranks));
    const Csr<int> ranks_of = make_csr<int>(part.mesh.points.size(), [&](auto&& put) {
      for (const SharedWith& s : part.shared) put(s.vertex, s.rank);
    });
    for (index_t c = 0; c < part.mesh.n_cells(); ++c)
      for (const index_t v : part.mesh.cells[c])
        for (const int rank : ranks_of[v]) {
          auto& cells = touching[static_cast<std::size_t>(rank)];
          if (cells.empty() || cells.back() != c) cells.push_back(c);
        }
    return touching;
  }

  static std::vector<std::byte> packed(const MixedPart& part, const MeshData& own, const std::vector<index_t>& cells) {
    const MixedMesh& from = part.mesh;
    std::vector<std::int64_t> ids, corner_ids;
    std::vector<std::uint8_t> kinds;
    std::vector<index_t> regions, corners;
    std::vector<Vector3> points;
    for (const index_t c : cells) {
      ids.push_back(part.cell_ids[c]);
      kinds.push_back(static_cast<std::uint8_t>(from.kinds[c]));
      regions.push_back(from.regions.empty() ? 0 : from.regions[c]);
      for (const index_t v : from.cells[c]) {
        corners.push_back(v);
        corner_ids.push_back(part.vertex_ids[v]);
        points.push_back(from.points[v]);
      }
    }
    std::vector<std::byte> bytes;
    pack(bytes, ids);
    pack(bytes, kinds);
    pack(bytes, regions);
    pack(bytes, corner_ids);
    pack(bytes, points);
    pack_rows(bytes, own.cells, cells);
    pack_rows(bytes, own.points, corners);
    return bytes;
  }

  void add_ghosts(Unpacker in) {
    const auto ids = in.take<std::int64_t>();
    const auto kinds = in.take<std::uint8_t>();
    const auto regions = in.take<index_t>();
    const auto corner_ids = in.take<std::int64_t>();
    const auto points = in.take<Vector3>();
    std::vector<std::size_t> cell_rows, new_rows;
    std::size_t at = 0;
    for (std::size_t c = 0; c < ids.size(); ++c) {
      const auto kind = static_cast<CellKind>(kinds[c]);
      std::array<index_t, 8> corners{};
      const auto n = static_cast<std::size_t>(n_corners(kind));
      for (std::size_t i = 0; i < n; ++i, ++at) {
        const auto [found, is_new] = vertex_of_.emplace(corner_ids[at], static_cast<index_t>(mesh.points.size()));
        if (is_new) {
          mesh.points.push_back(points[at]);
          vertex_ids.push_back(corner_ids[at]);
          vertex_ghosts.push_back(1);
          new_rows.push_back(at);
        }
        corners[i] = found->second;
      }
      mesh.add(kind, std::span(corners).first(n));
      cell_ids.push_back(ids[c]);
      cell_ghosts.push_back(1);
      cell_rows.push_back(c);
      if (!mesh.regions.empty()) mesh.regions.push_back(regions[c]);
    }
    append_rows(in, data.cells, cell_rows);
    append_rows(in, data.points, new_rows);
  }

  std::unordered_map<std::int64_t, index_t> vertex_of_;  // by number
};

}  // namespace framehex::distributed::detail
