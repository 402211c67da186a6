// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/distributed/detail/ghost_layer.hpp"
#include "framehex/distributed/run_collectively.hpp"
#include "framehex/io/input_file.hpp"
#include "framehex/io/vtu_writer.hpp"

#include <charconv>
#include <optional>

namespace framehex::distributed {

namespace detail {

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
      detail::HaloedPart piece(transport, part, data);
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
