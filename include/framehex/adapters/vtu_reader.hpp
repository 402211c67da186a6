// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/adapters/detail/vtu_arrays.hpp"
#include "framehex/io/input_file.hpp"
#include "framehex/io/label_arrays.hpp"
#include "framehex/io/mesh_builder.hpp"

#include <pugixml.hpp>

#include <set>

namespace framehex {

/// What the piece of a parallel file says beyond its mesh, by point and by cell of the volume; empty: nothing.
struct VtuPieceArrays {
  std::vector<std::int64_t> point_numbers;  ///< the array that the attribute GlobalIds names, or GlobalPointIds
  std::vector<std::int64_t> cell_numbers;   ///< the same, or GlobalCellIds
  std::vector<std::int64_t> ghosts;         ///< the array vtkGhostType: not 0 where another piece has the cell
  RawLabels labels;
  std::string label_array;  ///< that they come from; empty: none
};

namespace detail {

/// @tparam Builder  takes what is found, as MeshBuilder does.
template <class Builder = MeshBuilder>
class VtuReader {
public:
  /// @param bytes    of the file; must outlive this, as must the builder.
  /// @param release  gives back memory of what was looked at of them; may be empty.
  VtuReader(std::string name, std::string_view bytes, Builder& builder, std::function<void()> release = {})
      : name_(std::move(name)), bytes_(bytes), builder_(builder), release_(std::move(release)) {}

  /// @param lengths  receives values by point when not null. @param arrays  receives what it has when not null.
  auto read(const MeshReadOptions& options, MeshReadNotes& notes, PointLengths* lengths = nullptr,
            VtuPieceArrays* arrays = nullptr) {
    parse();
    const pugi::xml_node root = document_.child("VTKFile");
    if (!root) fail("not a VTK XML file");
    if (std::string_view(root.attribute("type").value()) != "UnstructuredGrid") fail("not an unstructured grid");
    read_encoding(root);
    const pugi::xml_node grid = root.child("UnstructuredGrid");
    if (!grid.child("Piece")) fail("holds no Piece");
    const auto pieces = grid.children("Piece");
    const bool has_cells = std::any_of(pieces.begin(), pieces.end(), [](pugi::xml_node piece) {
      return piece.attribute("NumberOfCells").as_ullong() > 0;
    });
    if (has_cells || options.volume == Volume::required) choose_labels(grid.child("Piece"), options, notes);
    read_names(grid.child("FieldData"));
    lengths_ = lengths;
    arrays_ = arrays;
    data_ = options.arrays == FileArrays::read ? &notes.data : nullptr;
    if (lengths_)
      lengths_->array =
          choose_length_array(name_, array_names(grid.child("Piece").child("PointData")), lengths_->wanted);
    for (const pugi::xml_node piece : pieces) read_piece(piece);
    return builder_.finish(options.volume);
  }

private:
  [[noreturn]] void fail(const std::string& what) const { throw io_error(name_ + ": " + what); }

  /// Raw appended data are no XML: the document is cut there.
  void parse() {
    std::string_view xml = bytes_;
    std::size_t n_lines = 0;
    const std::size_t tag = find_far(xml, "<AppendedData", 0, release_, n_lines);
    if (tag != xml.npos) {
      const std::size_t begin = xml.find('_', xml.find('>', tag));
      if (begin == xml.npos) fail("the appended data do not begin");
      appended_is_base64_ = xml.substr(tag, begin - tag).find("base64") != xml.npos;
      appended_ = xml.substr(begin + 1);
      xml = xml.substr(0, tag);
    }
    VtuSkeleton skeleton(xml, release_);
    if (tag != std::string::npos) skeleton.xml += "</VTKFile>";
    const pugi::xml_parse_result result = document_.load_buffer(skeleton.xml.data(), skeleton.xml.size());
    if (!result) {
      const std::size_t line = skeleton.line(static_cast<std::size_t>(std::max<std::ptrdiff_t>(result.offset, 0)));
      throw io_error(name_ + ": line " + std::to_string(line) + ": " + result.description(), Entity::line, {line});
    }
    texts_ = std::move(skeleton.texts);
  }

  void read_encoding(pugi::xml_node root) {
    using Compression = VtuEncoding::Compression;
    const bool is_big = std::string_view(root.attribute("byte_order").value()) == "BigEndian";
    encoding_.order = is_big ? std::endian::big : std::endian::little;
    encoding_.header_bytes = std::string_view(root.attribute("header_type").value()) == "UInt64" ? 8 : 4;
    const std::string_view compressor = root.attribute("compressor").value();
    if (compressor.empty()) return;
    encoding_.compression = compressor == "vtkLZMADataCompressor" ? Compression::lzma : Compression::zlib;
    if (encoding_.compression == Compression::zlib && compressor != "vtkZLibDataCompressor")
      fail("compressed by " + Cursor::printable(compressor) +
           ", which is not read (vtkZLibDataCompressor and vtkLZMADataCompressor are)");
  }

  VtuValues open(pugi::xml_node array) const {
    const std::string_view format = array.attribute("format").value(), type = array.attribute("type").value();
    // There is no number in an array without text, or in none.
    const std::string_view number = array.text().get();
    std::size_t place = texts_.size();
    std::from_chars(number.data(), number.data() + number.size(), place);
    const std::string_view text = place < texts_.size() ? texts_[place] : std::string_view();
    if (format == "ascii" || format.empty()) return {name_, text};
    if (format == "binary") return {name_, VtuBytes(name_, text, true, encoding_), type, encoding_.order};
    if (format != "appended") fail("a DataArray of format \"" + Cursor::printable(format) + "\"");
    const std::size_t offset = array.attribute("offset").as_ullong();
    if (offset >= appended_.size()) fail("an array begins after the end of the file");
    return {name_, VtuBytes(name_, appended_.substr(offset), appended_is_base64_, encoding_), type, encoding_.order};
  }

  template <class Value>
  std::vector<Value> values(pugi::xml_node array) const {
    return open(array).template all<Value>();
  }

  static bool is_integer_array(pugi::xml_node array) {
    return !std::string_view(array.attribute("type").value()).starts_with("Float");
  }

  static std::vector<CellArrayName> array_names(pugi::xml_node data) {
    std::vector<CellArrayName> names;
    for (const pugi::xml_node array : data.children("DataArray"))
      names.push_back({array.attribute("Name").value(), is_integer_array(array),
                       std::max<std::size_t>(array.attribute("NumberOfComponents").as_ullong(1), 1)});
    return names;
  }

  void choose_labels(pugi::xml_node piece, const MeshReadOptions& options, MeshReadNotes& notes) {
    const std::vector<CellArrayName> names = array_names(piece.child("CellData"));
    const std::size_t chosen = choose_label_array(name_, names, options, notes);
    if (chosen < names.size()) label_array_ = names[chosen].name;
  }

  /// Names of labels as our own writer leaves them: arrays of labels called "regions:NAME", "patches:..", "curves:..".
  void read_names(pugi::xml_node field_data) {
    std::int64_t group = 0;
    for (const pugi::xml_node array : field_data.children("DataArray"))
      for (int dimension = 1; dimension < 4; ++dimension) {
        const std::string_view name = array.attribute("Name").value();
        const std::string_view prefix = vtk::group_prefixes[static_cast<std::size_t>(dimension)];
        if (!name.starts_with(prefix)) continue;
        for (const std::int64_t label : values<std::int64_t>(array))
          builder_.add_name(dimension, label, group, std::string(name.substr(prefix.size())));
        ++group;
      }
  }

  /// Labels of the next cells.
  class Labels {
  public:
    Labels(const VtuReader& reader, pugi::xml_node piece) : reader_(reader) {
      const auto array =
          piece.child("CellData").find_child_by_attribute("DataArray", "Name", reader.label_array_.c_str());
      if (reader.label_array_.empty() || !array) return;
      is_integer_ = is_integer_array(array);
      values_.emplace(reader.open(array));
    }

    std::vector<std::int64_t> next(std::size_t n) {
      if (!values_) return std::vector<std::int64_t>(n, 0);
      return is_integer_ ? values_->template next<std::int64_t>(n)
                         : labels_of(reader_.name_, reader_.label_array_, values_->template next<double>(n));
    }
    /// How many there are beyond what was read.
    bool ends() { return !values_ || values_->template next<double>(1).empty(); }

  private:
    const VtuReader& reader_;
    std::optional<VtuValues> values_;
    bool is_integer_ = true;
  };

  /// The array of a name, where there is one of as many rows.
  void read_numbers(pugi::xml_node data, const char* wanted, std::size_t n, std::vector<std::int64_t>& numbers) const {
    const pugi::xml_node array = data.find_child_by_attribute("DataArray", "Name", wanted);
    if (!array) return;
    const auto read = values<std::int64_t>(array);
    if (read.size() != n) fail(std::string("array \"") + wanted + "\" holds another number of rows than told");
    numbers.insert(numbers.end(), read.begin(), read.end());
  }

  /// The array of the global numbers: VTK has an attribute that tells its name.
  static const char* numbers_name(pugi::xml_node data, const char* usual) {
    return data.attribute("GlobalIds").as_string(usual);
  }

  void read_arrays(pugi::xml_node piece, std::size_t n_points, const std::vector<std::int64_t>& types) {
    const pugi::xml_node points = piece.child("PointData"), cells = piece.child("CellData");
    read_numbers(points, numbers_name(points, "GlobalPointIds"), n_points, arrays_->point_numbers);
    for (const auto& [name, numbers] : {std::pair(numbers_name(cells, "GlobalCellIds"), &arrays_->cell_numbers),
                                        std::pair("vtkGhostType", &arrays_->ghosts)}) {
      std::vector<std::int64_t> all;
      read_numbers(cells, name, types.size(), all);
      for (std::size_t c = 0; c < all.size(); ++c)
        if (types[c] >= vtk::tetrahedron && types[c] <= vtk::pyramid) numbers->push_back(all[c]);
    }
  }

  /// Arrays of one number a row, of a type that is a number; a name that stands twice counts once.
  template <class Add>
  void read_data(pugi::xml_node data, std::size_t n_rows, Add&& add) const {
    std::set<std::string> seen;
    for (const pugi::xml_node array : data.children("DataArray")) {
      const std::string_view type = array.attribute("type").value();
      const std::string name = array.attribute("Name").value();
      const bool is_number = type.starts_with("Float") || type.starts_with("Int") || type.starts_with("UInt");
      if (!is_number || array.attribute("NumberOfComponents").as_ullong(1) > 1 || !seen.insert(name).second) continue;
      std::vector<double> rows = values<double>(array);
      if (rows.size() != n_rows)
        fail("array \"" + Cursor::printable(name) + "\" holds another number of rows than told");
      add(name, std::move(rows));
    }
  }

  void read_data(pugi::xml_node piece, std::size_t n_points, const std::vector<std::int64_t>& types) const {
    read_data(piece.child("PointData"), n_points, [&](const std::string& name, std::vector<double> rows) {
      append_rows(data_->points, name, std::move(rows));
    });
    read_data(piece.child("CellData"), types.size(), [&](const std::string& name, const std::vector<double>& rows) {
      if (name != label_array_) append_rows(data_->cells, name, of_volume(rows, types));
    });
  }

  void read_lengths(pugi::xml_node piece, std::size_t n_points) {
    const pugi::xml_node array =
        piece.child("PointData").find_child_by_attribute("DataArray", "Name", lengths_->array.c_str());
    const std::vector<double> read = array ? values<double>(array) : std::vector<double>{};
    if (read.size() != n_points) fail("array \"" + lengths_->array + "\" holds not one number for each point");
    lengths_->values.insert(lengths_->values.end(), read.begin(), read.end());
  }

  void read_piece(pugi::xml_node piece) {
    const std::size_t n_points = piece.attribute("NumberOfPoints").as_ullong();
    const auto first = static_cast<std::int64_t>(builder_.n_points());
    read_points(piece, n_points);
    if (lengths_) read_lengths(piece, n_points);
    if (arrays_ || data_) {
      const auto types = values<std::int64_t>(cell_array(piece, "types"));
      if (arrays_) read_arrays(piece, n_points, types);
      if (data_) read_data(piece, n_points, types);
    }
    read_cells(piece, static_cast<std::int64_t>(n_points), first);
  }

  /// Some at a time, so that the file need not be in memory.
  static constexpr std::size_t n_at_once = std::size_t{1} << 14;

  void read_points(pugi::xml_node piece, std::size_t n_points) {
    VtuValues values = open(piece.child("Points").child("DataArray"));
    std::size_t n_read = 0;
    for (;;) {
      const std::vector<double> x = values.next<double>(3 * n_at_once);
      if (x.empty()) break;
      n_read += x.size();
      if (x.size() % 3 != 0 || n_read / 3 > n_points) break;
      for (std::size_t i = 0; i < x.size(); i += 3) builder_.add_point(x[i], x[i + 1], x[i + 2]);
    }
    if (n_read != 3 * n_points) fail("Points holds not three numbers for each point");
  }

  pugi::xml_node cell_array(pugi::xml_node piece, const char* wanted) const {
    const pugi::xml_node found = piece.child("Cells").find_child_by_attribute("DataArray", "Name", wanted);
    if (!found) fail(std::string("Cells lacks ") + wanted);
    return found;
  }

  void read_cells(pugi::xml_node piece, std::int64_t n_points, std::int64_t first) {
    const std::size_t n_cells = piece.attribute("NumberOfCells").as_ullong();
    VtuValues connectivity = open(cell_array(piece, "connectivity")), offsets = open(cell_array(piece, "offsets")),
              types = open(cell_array(piece, "types"));
    Labels labels(*this, piece);
    const char* const other_number = "Cells holds another number of cells than told";
    std::int64_t begin = 0;
    for (std::size_t n = 0; n < n_cells;) {
      const std::size_t n_now = std::min(n_at_once, n_cells - n);
      const auto ends = offsets.next<std::int64_t>(n_now), kinds = types.next<std::int64_t>(n_now),
                 labels_now = labels.next(n_now);
      if (ends.size() != n_now || kinds.size() != n_now) fail(other_number);
      if (labels_now.size() != n_now) fail_label_count();
      const auto in_order = [&](std::size_t c) { return ends[c] >= (c > 0 ? ends[c - 1] : begin); };
      std::size_t n_good = 0;
      while (n_good < n_now && in_order(n_good)) ++n_good;
      std::vector<std::int64_t> corners;
      if (n_good > 0) corners = connectivity.next<std::int64_t>(static_cast<std::size_t>(ends[n_good - 1] - begin));
      for (std::int64_t& v : corners) v = v < 0 || v >= n_points ? std::int64_t{no_index} : v + first;
      const std::span<const std::int64_t> all(corners);
      std::size_t from = 0;
      for (std::size_t c = 0; c < n_good; ++c, ++n_read_) {
        const auto to = static_cast<std::size_t>(ends[c] - begin);
        if (to > corners.size()) fail_offset();
        builder_.add_vtk(kinds[c], all.subspan(from, to - from), labels_now[c], n_read_);
        from = to;
      }
      if (n_good < n_now) fail_offset();
      begin = ends[n_now - 1];
      n += n_now;
    }
    if (!offsets.next<std::int64_t>(1).empty() || !types.next<std::int64_t>(1).empty()) fail(other_number);
    if (!labels.ends()) fail_label_count();
  }

  [[noreturn]] void fail_offset() const {
    throw io_error(name_ + ": the offset of cell " + std::to_string(n_read_) + " is out of range", Entity::cell,
                   {n_read_});
  }
  [[noreturn]] void fail_label_count() const {
    fail("array \"" + label_array_ + "\" holds another number of cells than told");
  }

  std::string name_, label_array_;
  std::string_view bytes_;
  pugi::xml_document document_;
  std::vector<std::string_view> texts_;
  std::string_view appended_;
  bool appended_is_base64_ = false;
  VtuEncoding encoding_;
  std::size_t n_read_ = 0;
  Builder& builder_;
  std::function<void()> release_;
  PointLengths* lengths_ = nullptr;
  VtuPieceArrays* arrays_ = nullptr;
  MeshData* data_ = nullptr;
};

inline MixedMesh read_vtu_with(const std::filesystem::path& path, const MeshReadOptions& options, MeshReadNotes& notes,
                               PointLengths* lengths = nullptr, VtuPieceArrays* arrays = nullptr) {
  const std::string bytes = read_file(path);
  MeshBuilder builder(path.string(), 0);
  MixedMesh mesh = VtuReader(path.string(), bytes, builder).read(options, notes, lengths, arrays);
  if (arrays) {
    arrays->labels = builder.raw_labels();
    arrays->label_array = notes.label_array;
  }
  return mesh;
}

}  // namespace detail

/// Reads a VTK XML unstructured grid: text, base64 or raw, inline or appended, compressed by zlib, xz or not. Needs
/// pugixml, zlib and liblzma.
///
/// @param options  which array by cell holds the labels.
/// @param notes    what else was found, when not null.
/// @return its cells, and its triangles, quadrilaterals and lines as faces and edges; names of labels where our own writer
///         left them. Prisms are turned as a whole where the file does not follow VTK's manual.
/// @throws io_error naming file and line or cell; invalid_connectivity (a vertex out of range) and invalid_coordinate
///         (NaN, infinity), both naming the file as well.
/// @par Complexity   O(n).
inline MixedMesh read_vtu(const std::filesystem::path& path, const MeshReadOptions& options = {},
                          MeshReadNotes* notes = nullptr) {
  MeshReadNotes ignored;
  return detail::read_vtu_with(path, options, notes ? *notes : ignored);
}

/// Reads a piece of a parallel file, which may hold no cell.
///
/// @param regions  array by cell that holds the labels, which a piece without cells need not have; empty: one of the usual
///                 names.
/// @throws as `read_vtu`.
inline MixedMesh read_vtu_piece(const std::filesystem::path& path, VtuPieceArrays& arrays,
                                const std::string& regions = {}) {
  MeshReadNotes ignored;
  return detail::read_vtu_with(path, {.volume = Volume::optional, .regions = regions}, ignored, nullptr, &arrays);
}

/// Reads a mesh of any cells, or of faces alone, and the lengths that an array by point of it holds.
///
/// @param lengths  `wanted` chooses the array; the rest is filled in.
/// @throws as `read_vtu`; io_error when no array can be chosen, with the names of those there are.
inline MixedMesh read_vtu_lengths(const std::filesystem::path& path, PointLengths& lengths) {
  MeshReadNotes ignored;
  return detail::read_vtu_with(path, {.volume = Volume::optional}, ignored, &lengths);
}

}  // namespace framehex
