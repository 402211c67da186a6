// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/adapters/mesh_reader.hpp"
#include "framehex/distributed/detail/part_labels.hpp"
#include "framehex/distributed/detail/part_numbering.hpp"

#include <map>

namespace framehex::distributed::detail {

/// The smallest usual label of a mesh's file: VTK's are counted from 0, others from 1.
inline std::int64_t first_label(const std::filesystem::path& path) {
  const std::string extension = framehex::detail::lower_text(path.extension().string());
  return extension == ".vtu" || extension == ".pvtu" || extension == ".vtk" ? 0 : 1;
}

/// The pieces that a .pvtu names.
inline std::vector<std::filesystem::path> named_pieces(const std::filesystem::path& path) {
  pugi::xml_document document;
  const std::string bytes = read_file(path);
  if (!document.load_buffer(bytes.data(), bytes.size())) throw io_error(path.string() + ": not an XML file");
  const pugi::xml_node grid = document.child("VTKFile").child("PUnstructuredGrid");
  if (!grid) throw io_error(path.string() + ": holds no PUnstructuredGrid");
  std::vector<std::filesystem::path> files;
  for (const pugi::xml_node piece : grid.children("Piece"))
    files.push_back(path.parent_path() / piece.attribute("Source").value());
  if (files.empty()) throw io_error(path.string() + ": names no piece");
  return files;
}

/// NAME_1.msh, NAME_2.msh... beside NAME.msh, up to the greatest number there is.
/// @throws io_error  for one that is missing among them.
inline std::vector<std::filesystem::path> numbered_files(const std::filesystem::path& path) {
  const std::filesystem::path folder = path.has_parent_path() ? path.parent_path() : ".";
  const std::string stem = path.stem().string() + "_", extension = path.extension().string();
  std::map<std::size_t, std::filesystem::path> found;
  std::error_code ignored;
  for (std::filesystem::directory_iterator at(folder, ignored), end; at != end; at.increment(ignored)) {
    const std::string name = at->path().filename().string();
    if (!name.starts_with(stem) || !name.ends_with(extension)) continue;
    std::size_t number = 0;
    std::from_chars(name.data() + stem.size(), name.data() + name.size(), number);
    if (number > 0 && name == stem + std::to_string(number) + extension)
      found.emplace(number, path.parent_path() / name);
  }
  std::vector<std::filesystem::path> files;
  for (const auto& [number, file] : found) {
    if (number != files.size() + 1)
      throw io_error((path.parent_path() / (stem + std::to_string(files.size() + 1) + extension)).string() +
                     ": is missing: there is " + file.filename().string());
    files.push_back(file);
  }
  return files;
}

/// The files that a mesh lies in: those that a .pvtu names, or Gmsh's partitions where there is no NAME.msh.
/// @return empty: the file itself.
inline std::vector<std::filesystem::path> piece_files(const std::filesystem::path& path) {
  const std::string extension = framehex::detail::lower_text(path.extension().string());
  if (extension == ".pvtu") return named_pieces(path);
  if (extension == ".msh" && !std::filesystem::exists(path)) return numbered_files(path);
  return {};
}

/// A cell of another piece that this one has, too.
struct GhostCell {
  std::array<index_t, 4> corners;
  std::size_t file, cell;
};

/// A piece, its ghosts apart.
struct Piece {
  IndexedTetMesh mesh;
  std::vector<std::int64_t> point_numbers, cell_numbers;  ///< empty where the file tells none
  RawLabels labels;
  std::string label_array;
  std::vector<GhostCell> ghosts;

  bool knows_points() const { return point_numbers.size() == mesh.points.size(); }
  bool knows_cells() const { return cell_numbers.size() == mesh.tets.size(); }
};

/// @throws io_error  when there are other partitions than files.
inline void check_partitions(const MshPieceArrays& read, const std::vector<std::filesystem::path>& files,
                             std::size_t number) {
  const std::size_t n = read.n_partitions > 0
                            ? read.n_partitions
                            : std::max(files.size(), static_cast<std::size_t>(read.greatest_partition));
  if (n == files.size()) return;
  const std::string text = files[number].string() + ": is one of " + std::to_string(n) + " partitions, but ";
  if (n < files.size()) throw io_error(text + files.back().filename().string() + " is there, too");
  const std::string stem = files[0].stem().string();  // NAME_1
  throw io_error(text + stem.substr(0, stem.size() - 1) + std::to_string(files.size() + 1) +
                 files[0].extension().string() + " is missing");
}

/// The file of a partition of Gmsh's, its ghosts marked as in a .vtu.
inline MixedMesh read_msh_partition(const std::vector<std::filesystem::path>& files, std::size_t number,
                                    VtuPieceArrays& arrays) {
  MshPieceArrays read;
  MixedMesh mesh = read_msh_piece(files[number], read);
  check_partitions(read, files, number);
  std::vector<std::int64_t> ghosts;
  for (const MshPieceArrays::Ghost& ghost : read.ghosts)
    if (ghost.partition != static_cast<std::int64_t>(number) + 1) ghosts.push_back(ghost.element);
  std::sort(ghosts.begin(), ghosts.end());
  for (const std::int64_t cell : read.cell_numbers)
    arrays.ghosts.push_back(std::binary_search(ghosts.begin(), ghosts.end(), cell));
  arrays.point_numbers = std::move(read.point_numbers);
  arrays.labels = std::move(read.labels);
  return mesh;
}

/// @param number  of the file among the pieces, from 0.
inline Piece read_piece(const std::vector<std::filesystem::path>& files, std::size_t number,
                        const std::string& region_array) {
  const std::filesystem::path& path = files[number];
  const std::string extension = framehex::detail::lower_text(path.extension().string());
  if (extension != ".vtu" && extension != ".msh") throw io_error(path.string() + ": pieces are .vtu or .msh");
  framehex::detail::check_has_arrays(path, mesh_format(path), {.regions = region_array});
  VtuPieceArrays arrays;
  const MixedMesh mesh =
      extension == ".vtu" ? read_vtu_piece(path, arrays, region_array) : read_msh_partition(files, number, arrays);
  Piece piece;
  piece.mesh.points = mesh.points;
  piece.point_numbers = std::move(arrays.point_numbers);
  piece.labels.names = std::move(arrays.labels.names);
  piece.label_array = std::move(arrays.label_array);
  for (std::size_t c = 0; c < mesh.n_cells(); ++c) {
    if (mesh.kinds[c] != CellKind::tetrahedron)
      throw invalid_connectivity(path.string() + ": cell " + std::to_string(c) + " is not a tetrahedron", Entity::cell,
                                 {c});
    const auto row = mesh.cells[c];
    const std::array<index_t, 4> corners{row[0], row[1], row[2], row[3]};
    const std::int64_t ghost = arrays.ghosts.empty() ? 0 : arrays.ghosts[c];
    if ((ghost & 1) != 0) piece.ghosts.push_back({corners, number, c});  // a copy; other bits hide a cell
    if (ghost != 0) continue;
    piece.mesh.tets.push_back(corners);
    piece.labels.cells.push_back(arrays.labels.cells[c]);
    if (!arrays.cell_numbers.empty()) piece.cell_numbers.push_back(arrays.cell_numbers[c]);
  }
  return piece;
}

/// Refuses pieces whose labels lie in different arrays: what one means would depend on the piece. Collective.
inline void check_label_arrays(const MpiTransport& transport, const std::vector<std::filesystem::path>& files,
                               std::size_t first, const std::vector<Piece>& pieces) {
  std::vector<std::string> mine;
  for (std::size_t i = 0; i < pieces.size(); ++i)
    if (!pieces[i].mesh.tets.empty()) mine.insert(mine.end(), {files[first + i].string(), pieces[i].label_array});
  const std::vector<std::string> all = gathered_texts(transport, mine);
  const auto holds = [](const std::string& array) {
    return array.empty() ? "has no array of integers for them" : "has them in \"" + array + "\"";
  };
  for (std::size_t i = 2; i < all.size(); i += 2)
    if (all[i + 1] != all[1])
      throw io_error(all[i] + ": labels of regions lie elsewhere than in " + all[0] + ": it " + holds(all[i + 1]) +
                     ", the other " + holds(all[1]));
}

/// Refuses ghosts that no piece has as a cell of its own. Collective.
inline void check_ghosts(const MpiTransport& transport, const std::vector<std::filesystem::path>& files,
                         const IndexedPart& part, const std::vector<GhostCell>& ghosts) {
  if (!any_rank(transport, !ghosts.empty())) return;
  using Corners = std::array<std::int64_t, 4>;
  const auto numbers = [&](const std::array<index_t, 4>& corners) {
    Corners ids{};
    for (std::size_t i = 0; i < 4; ++i) ids[i] = part.vertex_ids[corners[i]];
    std::ranges::sort(ids);
    return ids;
  };
  const auto n_ranks = static_cast<std::size_t>(transport.n_ranks());
  const auto clerk = [&](const Corners& ids) { return static_cast<std::uint64_t>(ids[0]) / 1024 % n_ranks; };
  std::vector<std::vector<Corners>> told(n_ranks), questions(n_ranks);
  for (const auto& tet : part.mesh.tets) told[clerk(numbers(tet))].push_back(numbers(tet));
  std::vector<Corners> known = send_joined(transport, std::move(told));
  std::ranges::sort(known);
  for (const GhostCell& ghost : ghosts) questions[clerk(numbers(ghost.corners))].push_back(numbers(ghost.corners));
  const auto answers = ask<std::uint8_t>(transport, questions, [&](const Corners& ids, int) {
    return static_cast<std::uint8_t>(std::ranges::binary_search(known, ids));
  });
  std::vector<std::size_t> next(n_ranks, 0);
  for (const GhostCell& ghost : ghosts) {
    const std::size_t rank = clerk(numbers(ghost.corners));
    if (answers[rank][next[rank]++] == 0)
      throw invalid_connectivity(files[ghost.file].string() + ": cell " + std::to_string(ghost.cell) +
                                     " is marked as a ghost, but no piece has it as its own",
                                 Entity::cell, {ghost.cell});
  }
}

/// Pieces put into one part, with numbers in the whole.
struct JoinedPieces {
  LabelledPart read;
  std::vector<GhostCell> ghosts;

  /// @param first_point, first_cell  number of the piece's first, where its file tells none.
  void add(const Piece& piece, bool knows_points, bool knows_cells, std::int64_t first_point, std::int64_t first_cell) {
    IndexedPart& part = read.part;
    const auto offset = static_cast<index_t>(part.mesh.points.size());
    const auto moved = [&](std::array<index_t, 4> corners) {
      for (index_t& v : corners) v += offset;
      return corners;
    };
    part.mesh.points.insert(part.mesh.points.end(), piece.mesh.points.begin(), piece.mesh.points.end());
    for (std::size_t v = 0; v < piece.mesh.points.size(); ++v)
      part.vertex_ids.push_back(knows_points ? piece.point_numbers[v] : first_point + static_cast<std::int64_t>(v));
    for (std::size_t c = 0; c < piece.mesh.tets.size(); ++c) {
      part.mesh.tets.push_back(moved(piece.mesh.tets[c]));
      part.cell_ids.push_back(knows_cells ? piece.cell_numbers[c] : first_cell + static_cast<std::int64_t>(c));
    }
    for (const GhostCell& ghost : piece.ghosts) ghosts.push_back({moved(ghost.corners), ghost.file, ghost.cell});
    const RawLabels& labels = piece.labels;
    read.labels.cells.insert(read.labels.cells.end(), labels.cells.begin(), labels.cells.end());
    read.labels.names.insert(read.labels.names.end(), labels.names.begin(), labels.names.end());
  }
};

/// This rank's share of the files, in one part; numbers by the order of the files, where these tell none. Collective.
inline LabelledPart read_pieces(const MpiTransport& transport, const std::vector<std::filesystem::path>& files,
                                const std::string& region_array) {
  const auto n = static_cast<std::size_t>(transport.n_ranks()), rank = static_cast<std::size_t>(transport.rank());
  const std::size_t first = rank * files.size() / n, last = (rank + 1) * files.size() / n;
  std::vector<Piece> pieces;
  std::vector<std::int64_t> counts(2 * files.size() + 2, 0);  // points and cells of each, files that tell their numbers
  for (std::size_t i = first; i < last; ++i) {
    const Piece& piece = pieces.emplace_back(read_piece(files, i, region_array));
    counts[2 * i] = static_cast<std::int64_t>(piece.mesh.points.size());
    counts[2 * i + 1] = static_cast<std::int64_t>(piece.mesh.tets.size());
    counts[2 * files.size()] += piece.knows_points();
    counts[2 * files.size() + 1] += piece.knows_cells();
  }
  transport.sum(counts);
  check_label_arrays(transport, files, first, pieces);
  const auto n_files = static_cast<std::int64_t>(files.size());
  const bool knows_points = counts[2 * files.size()] == n_files, knows_cells = counts[2 * files.size() + 1] == n_files;
  std::int64_t first_point = 0, first_cell = 0;
  JoinedPieces joined;
  for (std::size_t i = 0; i < last; ++i) {
    if (i >= first) joined.add(pieces[i - first], knows_points, knows_cells, first_point, first_cell);
    first_point += counts[2 * i];
    first_cell += counts[2 * i + 1];
  }
  IndexedPart& part = joined.read.part;
  agree_on_vertices(transport, part, knows_points);
  check_ghosts(transport, files, part, joined.ghosts);
  join_vertices(part);
  // Owners again: some that had a vertex had it for cells of others only.
  agree_on_vertices(transport, part, true);
  return std::move(joined.read);
}

}  // namespace framehex::distributed::detail
