// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/distributed/detail/packing.hpp"
#include "framehex/distributed/run_collectively.hpp"
#include "framehex/io/input_file.hpp"
#include "framehex/io/vtu_writer.hpp"

#include <charconv>
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
  MeshData data;
};

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

/// Fetches the cells of other ranks that have a vertex of this one's. Collective; between ranks that share vertices.
///
/// @param data  by cell and point of the part; the rows of ghosts are fetched, too.
inline HaloedPart with_halo(const MpiTransport& transport, const MixedPart& part, const MeshData& data) {
  check_same_arrays(transport, data);
  const auto n_ranks = static_cast<std::size_t>(transport.n_ranks());
  HaloedPart out{
      part.mesh, {part.vertex_ids.begin(), part.vertex_ids.end()}, {part.cell_ids.begin(), part.cell_ids.end()}, {}, {},
      data};
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
    std::vector<index_t> regions, corners;
    std::vector<Vector3> points;
    for (const index_t c : touching[rank]) {
      ids.push_back(part.cell_ids[c]);
      kinds.push_back(static_cast<std::uint8_t>(mesh.kinds[c]));
      regions.push_back(mesh.regions.empty() ? 0 : mesh.regions[c]);
      for (const index_t v : mesh.cells[c]) {
        corners.push_back(v);
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
    pack_rows(parcel.bytes, data.cells, touching[rank]);
    pack_rows(parcel.bytes, data.points, corners);
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
    std::vector<std::size_t> cell_rows, new_rows;
    for (std::size_t c = 0; c < ids.size(); ++c) {
      cell_rows.push_back(c);
      const auto kind = static_cast<CellKind>(kinds[c]);
      std::array<index_t, 8> corners{};
      const auto n = static_cast<std::size_t>(n_corners(kind));
      for (std::size_t i = 0; i < n; ++i, ++at) {
        const auto [found, is_new] = vertex_of.emplace(corner_ids[at], static_cast<index_t>(out.mesh.points.size()));
        if (is_new) {
          out.mesh.points.push_back(points[at]);
          out.vertex_ids.push_back(corner_ids[at]);
          out.vertex_ghosts.push_back(1);
          new_rows.push_back(at);
        }
        corners[i] = found->second;
      }
      out.mesh.add(kind, std::span(corners).first(n));
      out.cell_ids.push_back(ids[c]);
      out.cell_ghosts.push_back(1);
      if (!out.mesh.regions.empty()) out.mesh.regions.push_back(regions[c]);
    }
    append_rows(in, out.data.cells, cell_rows);
    append_rows(in, out.data.points, new_rows);
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
  text += array("Float64", "Points", 3) + "    </PPoints>\n    ";
  text += framehex::detail::data_element("PCellData", data.cells, "GlobalCellIds");
  text += array("UInt8", "kind", 1) + array("UInt32", "label", 1);
  for (const DataArray& a : data.cells) text += array(vtk_type(a), a.name, a.n_components);
  text += "    </PCellData>\n    " + framehex::detail::data_element("PPointData", data.points, "GlobalPointIds");
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

/// The pieces that an older file of the name names, so far as these are names of ours; none where there is no such file.
inline std::vector<std::filesystem::path> older_pieces(const std::filesystem::path& path) {
  std::vector<std::filesystem::path> pieces;
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored)) return pieces;
  const std::string text = read_file(path),
                    key = "Source=\"" + framehex::detail::xml_escaped(path.stem().string()) + "_";
  for (std::size_t at = text.find(key); at != text.npos; at = text.find(key, at + 1)) {
    const std::string_view rest = std::string_view(text).substr(at + key.size());
    int rank = 0;
    std::from_chars(rest.data(), rest.data() + rest.size(), rank);
    if (rest.starts_with(std::to_string(rank) + ".vtu\"")) pieces.push_back(piece_path(path, rank));
  }
  return pieces;
}

/// Removes those that the new mesh has not taken the place of. The new mesh is whole: whatever stays does no harm.
inline void remove_older(const std::filesystem::path& path, const std::vector<std::filesystem::path>& older,
                         std::span<const int> ranks) {
  std::error_code ignored;
  for (const std::filesystem::path& piece : older)
    if (std::ranges::none_of(ranks, [&](int rank) { return piece_path(path, rank) == piece; }))
      std::filesystem::remove(piece, ignored);
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
/// The pieces of an older mesh of the name are replaced or removed.
///
/// @param data  arrays by cell and point of this rank's part, the same on all ranks but for the rows; those of ghosts are
///              fetched.
/// @throws remote_error  naming file and rank when one of them cannot be written; no file of the new mesh is left then.
inline void write_pvtu(const std::filesystem::path& path, const MpiTransport& transport, const MixedPart& part,
                       const MeshData& data = {}) {
  const std::filesystem::path piece_path = detail::piece_path(path, transport.rank());
  bool is_committed = false;
  try {
    run_collectively(transport, [&] {
      framehex::detail::check_rows(path.string(), part.mesh.n_cells(), part.mesh.points.size(), data);
      detail::HaloedPart piece = detail::with_halo(transport, part, data);
      MeshData& all = piece.data;
      all.cells.push_back({"GlobalCellIds", std::move(piece.cell_ids)});
      all.cells.push_back({"vtkGhostType", std::move(piece.cell_ghosts)});
      all.points.push_back({"GlobalPointIds", std::move(piece.vertex_ids)});
      all.points.push_back({"vtkGhostType", std::move(piece.vertex_ghosts)});
      const std::vector<int> ranks = detail::ranks_with_pieces(transport, piece.mesh);
      std::optional<OutputFile> file, index;
      std::vector<std::filesystem::path> older;
      if (std::ranges::binary_search(ranks, transport.rank())) {
        file.emplace(piece_path);
        framehex::detail::put_vtu(*file, piece_path.string(), piece.mesh, all, {}, nullptr);
        file->finish();
      }
      if (transport.rank() == 0) {
        older = detail::older_pieces(path);
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
      if (!index) return;
      index->commit();
      detail::remove_older(path, older, ranks);
    });
  } catch (...) {
    std::error_code ignored;
    if (is_committed) std::filesystem::remove(piece_path, ignored);
    throw;
  }
}

}  // namespace framehex::distributed
