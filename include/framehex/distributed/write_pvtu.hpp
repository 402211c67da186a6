// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/distributed/detail/packing.hpp"
#include "framehex/distributed/run_collectively.hpp"
#include "framehex/io/vtu_writer.hpp"

#include <optional>
#include <unordered_map>

namespace framehex::distributed {

/// A vertex that another rank has, too.
struct SharedWith {
  index_t vertex;
  int rank;
};

/// A rank's cells of a distributed mesh of any cells, as they are to be written. Spans must outlive the call only.
struct MixedPart {
  const MixedMesh& mesh;
  std::span<const std::int64_t> vertex_ids;  ///< global numbers
  std::span<const std::int64_t> cell_ids;
  std::span<const int> owners;         ///< of the vertices
  std::span<const SharedWith> shared;  ///< with every other rank that has the vertex
};

namespace detail {

/// A part and, behind its own cells, those of other ranks that touch it.
struct HaloedPart {
  MixedMesh mesh;
  std::vector<std::int64_t> vertex_ids, cell_ids;
  std::vector<std::uint8_t> vertex_ghosts, cell_ghosts;  ///< VTK's marks: 1 where another rank has it
};

/// Fetches the cells of other ranks that have a vertex of this one's. Collective; between ranks that share vertices.
inline HaloedPart with_halo(const MpiTransport& transport, const MixedPart& part) {
  const auto n_ranks = static_cast<std::size_t>(transport.n_ranks());
  HaloedPart out{part.mesh,
                 {part.vertex_ids.begin(), part.vertex_ids.end()},
                 {part.cell_ids.begin(), part.cell_ids.end()},
                 {},
                 {}};
  for (const int owner : part.owners) out.vertex_ghosts.push_back(owner != transport.rank());
  out.cell_ghosts.assign(part.mesh.n_cells(), 0);

  const MixedMesh& mesh = part.mesh;
  std::vector<std::vector<index_t>> touching(n_ranks);  // cells that touch a rank
  const Csr<int> ranks_of = make_csr<int>(mesh.points.size(), [&](auto&& put) {
    for (const SharedWith& s : part.shared) put(s.vertex, s.rank);
  });
  for (index_t c = 0; c < mesh.n_cells(); ++c)
    for (const index_t v : mesh.cells[c])
      for (const int rank : ranks_of[v]) {
        auto& cells = touching[static_cast<std::size_t>(rank)];
        if (cells.empty() || cells.back() != c) cells.push_back(c);
      }
  std::vector<Parcel> parcels;
  for (std::size_t rank = 0; rank < n_ranks; ++rank) {
    if (touching[rank].empty()) continue;
    std::vector<std::int64_t> ids, corner_ids;
    std::vector<std::uint8_t> kinds;
    std::vector<index_t> regions;
    std::vector<Vector3> points;
    for (const index_t c : touching[rank]) {
      ids.push_back(part.cell_ids[c]);
      kinds.push_back(static_cast<std::uint8_t>(mesh.kinds[c]));
      regions.push_back(mesh.regions.empty() ? 0 : mesh.regions[c]);
      for (const index_t v : mesh.cells[c]) {
        corner_ids.push_back(part.vertex_ids[v]);
        points.push_back(mesh.points[v]);
      }
    }
    Parcel& parcel = parcels.emplace_back(Parcel{static_cast<int>(rank), {}});
    pack(parcel.bytes, ids);
    pack(parcel.bytes, kinds);
    pack(parcel.bytes, regions);
    pack(parcel.bytes, corner_ids);
    pack(parcel.bytes, points);
  }
  std::unordered_map<std::int64_t, index_t> vertex_of;
  for (index_t v = 0; v < out.vertex_ids.size(); ++v) vertex_of.emplace(out.vertex_ids[v], v);
  for (const Parcel& p : transport.exchange(std::move(parcels))) {
    Unpacker in(p.bytes);
    const auto ids = in.take<std::int64_t>();
    const auto kinds = in.take<std::uint8_t>();
    const auto regions = in.take<index_t>();
    const auto corner_ids = in.take<std::int64_t>();
    const auto points = in.take<Vector3>();
    std::size_t at = 0;
    for (std::size_t c = 0; c < ids.size(); ++c) {
      const auto kind = static_cast<CellKind>(kinds[c]);
      std::array<index_t, 8> corners{};
      const auto n = static_cast<std::size_t>(n_corners(kind));
      for (std::size_t i = 0; i < n; ++i, ++at) {
        const auto [found, is_new] = vertex_of.emplace(corner_ids[at], static_cast<index_t>(out.mesh.points.size()));
        if (is_new) {
          out.mesh.points.push_back(points[at]);
          out.vertex_ids.push_back(corner_ids[at]);
          out.vertex_ghosts.push_back(1);
        }
        corners[i] = found->second;
      }
      out.mesh.add(kind, std::span(corners).first(n));
      out.cell_ids.push_back(ids[c]);
      out.cell_ghosts.push_back(1);
      if (!out.mesh.regions.empty()) out.mesh.regions.push_back(regions[c]);
    }
  }
  return out;
}

inline const char* vtk_type(const DataArray& array) {
  constexpr std::array<const char*, 4> names{"Float64", "UInt32", "UInt8", "Int64"};
  return names[array.values.index()];
}

/// The file that names the pieces.
/// @param ranks  that have one.
inline std::string pvtu_text(const std::string& stem, std::span<const int> ranks, const MeshData& data) {
  const auto array = [](const char* type, const std::string& name, std::size_t n_components) {
    return "      <PDataArray type=\"" + std::string(type) + "\" Name=\"" + framehex::detail::xml_escaped(name) +
           "\" NumberOfComponents=\"" + std::to_string(n_components) + "\"/>\n";
  };
  std::string text = "<?xml version=\"1.0\"?>\n<VTKFile type=\"PUnstructuredGrid\" version=\"1.0\" byte_order=\"";
  text += std::endian::native == std::endian::little ? "LittleEndian" : "BigEndian";
  text += "\" header_type=\"UInt64\">\n  <PUnstructuredGrid GhostLevel=\"1\">\n    <PPoints>\n";
  text += array("Float64", "Points", 3) + "    </PPoints>\n    <PCellData>\n";
  text += array("UInt8", "kind", 1) + array("UInt32", "label", 1);
  for (const DataArray& a : data.cells) text += array(vtk_type(a), a.name, a.n_components);
  text += "    </PCellData>\n    <PPointData>\n";
  for (const DataArray& a : data.points) text += array(vtk_type(a), a.name, a.n_components);
  text += "    </PPointData>\n";
  for (const int rank : ranks)
    text += "    <Piece Source=\"" + framehex::detail::xml_escaped(stem) + "_" + std::to_string(rank) + ".vtu\"/>\n";
  return text + "  </PUnstructuredGrid>\n</VTKFile>\n";
}

/// The pieces' names: NAME_0.vtu, NAME_1.vtu... beside NAME.pvtu.
inline std::filesystem::path piece_path(const std::filesystem::path& path, int rank) {
  return path.parent_path() / (path.stem().string() + "_" + std::to_string(rank) + ".vtu");
}

/// The ranks that have a piece: readers such as meshio take none without cells. Of nothing there is one. Collective.
inline std::vector<int> ranks_with_pieces(const MpiTransport& transport, const MixedMesh& mesh) {
  const std::uint8_t is_empty = mesh.n_cells() == 0 && mesh.points.empty() ? 1 : 0;
  std::vector<int> ranks;
  for (const std::uint8_t empty : gathered(transport, std::vector{is_empty}))
    ranks.push_back(empty ? -1 : int(ranks.size()));
  std::erase(ranks, -1);
  if (ranks.empty()) ranks.push_back(0);
  return ranks;
}

/// Rows for the ghosts behind those of one's own: NaN, or 0.
inline DataArray padded(DataArray array, std::size_t n_rows) {
  std::visit(
      [&](auto& values) {
        using Value = typename std::decay_t<decltype(values)>::value_type;
        constexpr Value none = std::is_floating_point_v<Value> ? std::numeric_limits<Value>::quiet_NaN() : Value{};
        values.resize(n_rows * array.n_components, none);
      },
      array.values);
  return array;
}

}  // namespace detail

/// Writes a distributed mesh as NAME.pvtu and a piece NAME_0.vtu, NAME_1.vtu... for each rank that has cells, for
/// ParaView and whoever builds on VTK. Collective.
///
/// Pieces have a layer of ghost cells, marked in `vtkGhostType` (cells and points), and the arrays GlobalPointIds and
/// GlobalCellIds. All files appear or none: each is written without a name to the last byte, and takes its own when all
/// ranks have come so far (`OutputFile`); NAME.pvtu, without which the pieces are none, comes last, and an older one goes
/// before the first piece takes its name.
///
/// @param data  arrays by cell and point of this rank's part; ghosts have NaN (integers: 0) in them.
/// @throws remote_error  naming file and rank when one of them cannot be written; no file of the new mesh is left then.
inline void write_pvtu(const std::filesystem::path& path, const MpiTransport& transport, const MixedPart& part,
                       const MeshData& data = {}) {
  const std::filesystem::path piece_path = detail::piece_path(path, transport.rank());
  bool is_committed = false;
  try {
    run_collectively(transport, [&] {
      framehex::detail::check_rows(path.string(), part.mesh.n_cells(), part.mesh.points.size(), data);
      detail::HaloedPart piece = detail::with_halo(transport, part);
      MeshData all;
      for (const DataArray& a : data.cells) all.cells.push_back(detail::padded(a, piece.mesh.n_cells()));
      for (const DataArray& a : data.points) all.points.push_back(detail::padded(a, piece.mesh.points.size()));
      all.cells.push_back({"GlobalCellIds", std::move(piece.cell_ids)});
      all.cells.push_back({"vtkGhostType", std::move(piece.cell_ghosts)});
      all.points.push_back({"GlobalPointIds", std::move(piece.vertex_ids)});
      all.points.push_back({"vtkGhostType", std::move(piece.vertex_ghosts)});
      const std::vector<int> ranks = detail::ranks_with_pieces(transport, piece.mesh);
      std::optional<OutputFile> file, index;
      if (std::ranges::binary_search(ranks, transport.rank())) {
        file.emplace(piece_path);
        framehex::detail::put_vtu(*file, piece_path.string(), piece.mesh, all, {}, nullptr);
        file->finish();
      }
      if (transport.rank() == 0) {
        index.emplace(path);
        index->write(detail::pvtu_text(path.stem().string(), ranks, all));
        index->finish();
      }
      transport.agree();
      // An older mesh's index must not name a mixture of old pieces and new ones, whatever happens from here on.
      if (index) std::filesystem::remove(path);
      transport.agree();
      if (file) {
        file->commit();
        is_committed = true;
      } else {
        std::filesystem::remove(piece_path);  // of an older mesh
      }
      transport.agree();
      if (index) index->commit();
    });
  } catch (...) {
    std::error_code ignored;
    if (is_committed) std::filesystem::remove(piece_path, ignored);
    throw;
  }
}

}  // namespace framehex::distributed
