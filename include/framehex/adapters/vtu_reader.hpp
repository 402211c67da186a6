// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/io/input_file.hpp"
#include "framehex/io/label_arrays.hpp"
#include "framehex/io/mesh_builder.hpp"

#include <lzma.h>
#include <zlib.h>
#include <pugixml.hpp>

#include <set>

namespace framehex {

/// What the piece of a parallel file says beyond its mesh, by point and by cell of the volume; empty: nothing.
struct VtuPieceArrays {
  std::vector<std::int64_t> point_numbers;  ///< the array GlobalPointIds
  std::vector<std::int64_t> cell_numbers;   ///< the array GlobalCellIds
  std::vector<std::int64_t> ghosts;         ///< the array vtkGhostType: not 0 where another piece has the cell
};

namespace detail {

/// Decodes base64 up to the first character that is none; padding may stand inside, where two encoded runs meet.
inline std::string decode_base64(std::string_view text, std::size_t n_wanted) {
  const auto value = [](char c) {
    if (c >= 'A' && c <= 'Z') return c - 'A';
    if (c >= 'a' && c <= 'z') return c - 'a' + 26;
    if (c >= '0' && c <= '9') return c - '0' + 52;
    return c == '+' ? 62 : c == '/' ? 63 : -1;
  };
  std::string bytes;
  unsigned bits = 0;
  int n_bits = 0;
  for (const char c : text) {
    if (bytes.size() >= n_wanted) break;
    const int v = value(c);
    if (v < 0) {
      if (c != '=') break;
      n_bits = 0;  // the run ends here
      continue;
    }
    bits = (bits << 6 | static_cast<unsigned>(v)) & 0xffffu;
    if ((n_bits += 6) >= 8) {
      n_bits -= 8;
      bytes += static_cast<char>(bits >> n_bits & 0xffu);
    }
  }
  return bytes;
}

/// Unpacks a block of deflated bytes. @return whether it is whole and has the size of `block`.
inline bool unpack_zlib(std::string_view packed, std::string& block) {
  uLongf length = static_cast<uLongf>(block.size());
  return uncompress(reinterpret_cast<Bytef*>(block.data()), &length, reinterpret_cast<const Bytef*>(packed.data()),
                    static_cast<uLong>(packed.size())) == Z_OK &&
         length == block.size();
}

/// The same for xz.
inline bool unpack_lzma(std::string_view packed, std::string& block) {
  std::uint64_t memory = std::uint64_t{1} << 30;
  std::size_t in = 0, out = 0;
  const auto* const from = reinterpret_cast<const std::uint8_t*>(packed.data());
  auto* const to = reinterpret_cast<std::uint8_t*>(block.data());
  return lzma_stream_buffer_decode(&memory, 0, nullptr, from, &in, packed.size(), to, &out, block.size()) == LZMA_OK &&
         out == block.size();
}

class VtuReader {
public:
  VtuReader(std::string name, std::string bytes)
      : name_(std::move(name)), bytes_(std::move(bytes)), builder_(name_, 0) {}

  /// @param lengths  receives values by point when not null. @param arrays  receives what it has when not null.
  MixedMesh read(const MeshReadOptions& options, MeshReadNotes& notes, PointLengths* lengths = nullptr,
                 VtuPieceArrays* arrays = nullptr) {
    parse();
    const pugi::xml_node root = document_.child("VTKFile");
    if (!root) fail("not a VTK XML file");
    if (std::string_view(root.attribute("type").value()) != "UnstructuredGrid") fail("not an unstructured grid");
    order_ =
        std::string_view(root.attribute("byte_order").value()) == "BigEndian" ? std::endian::big : std::endian::little;
    header_bytes_ = std::string_view(root.attribute("header_type").value()) == "UInt64" ? 8 : 4;
    const std::string_view compressor = root.attribute("compressor").value();
    compressed_ = !compressor.empty();
    is_lzma_ = compressor == "vtkLZMADataCompressor";
    if (compressed_ && !is_lzma_ && compressor != "vtkZLibDataCompressor")
      fail("compressed by " + Cursor::printable(compressor) +
           ", which is not read (vtkZLibDataCompressor and vtkLZMADataCompressor are)");
    const pugi::xml_node grid = root.child("UnstructuredGrid");
    if (!grid.child("Piece")) fail("holds no Piece");
    choose_labels(grid.child("Piece"), options, notes);
    read_names(grid.child("FieldData"));
    lengths_ = lengths;
    arrays_ = arrays;
    data_ = options.arrays == FileArrays::read ? &notes.data : nullptr;
    if (lengths_)
      lengths_->array =
          choose_length_array(name_, array_names(grid.child("Piece").child("PointData")), lengths_->wanted);
    for (const pugi::xml_node piece : grid.children("Piece")) read_piece(piece);
    return builder_.finish(options.volume);
  }

private:
  [[noreturn]] void fail(const std::string& what) const { throw io_error(name_ + ": " + what); }

  /// Raw appended data are no XML: the document is cut there.
  void parse() {
    std::string_view xml = bytes_;
    const std::size_t tag = xml.find("<AppendedData");
    if (tag != xml.npos) {
      const std::size_t begin = xml.find('_', xml.find('>', tag));
      if (begin == xml.npos) fail("the appended data do not begin");
      appended_is_base64_ = xml.substr(tag, begin - tag).find("base64") != xml.npos;
      appended_ = xml.substr(begin + 1);
      xml = xml.substr(0, tag);
    }
    std::string text(xml);
    if (tag != std::string::npos) text += "</VTKFile>";
    const pugi::xml_parse_result result = document_.load_buffer(text.data(), text.size());
    if (!result) {
      const auto end = text.begin() + static_cast<std::ptrdiff_t>(std::clamp<std::ptrdiff_t>(
                                          result.offset, 0, static_cast<std::ptrdiff_t>(text.size())));
      const auto line = static_cast<std::size_t>(1 + std::count(text.begin(), end, '\n'));
      throw io_error(name_ + ": line " + std::to_string(line) + ": " + result.description(), Entity::line, {line});
    }
  }

  std::uint64_t header(std::string_view bytes, std::size_t i) const {
    Cursor in(name_, bytes.substr(i * header_bytes_));
    return header_bytes_ == 8 ? in.raw<std::uint64_t>(order_) : in.raw<std::uint32_t>(order_);
  }

  /// Bytes [from, from + n) of an encoded stream that begins at a run of base64, or raw.
  std::string stream(std::string_view data, bool base64, std::size_t from, std::size_t n) const {
    if (!base64) {
      if (from > data.size() || n > data.size() - from) fail("the file ends within binary data");
      return std::string(data.substr(from, n));
    }
    if (n > data.size() || from > data.size()) fail("the file ends within binary data");
    std::string bytes = decode_base64(data, from + n);
    if (bytes.size() < from + n) fail("the file ends within binary data");
    return bytes.substr(from);
  }

  std::string binary(std::string_view data, bool base64) const {
    if (!compressed_) {
      const std::uint64_t n = header(stream(data, base64, 0, header_bytes_), 0);
      return stream(data, base64, header_bytes_, n);
    }
    const std::string head = stream(data, base64, 0, 3 * header_bytes_);
    const std::uint64_t n_blocks = header(head, 0), unpacked_size = header(head, 1), last_size = header(head, 2);
    if (n_blocks == 0) return {};
    if (n_blocks > data.size()) fail("a count of compressed blocks is more than the file can hold");
    const std::string sizes = stream(data, base64, 3 * header_bytes_, n_blocks * header_bytes_);
    std::string out;
    std::size_t at = (3 + n_blocks) * header_bytes_;
    std::uint64_t n_compressed = 0;
    for (std::size_t b = 0; b < n_blocks; ++b) {
      const std::uint64_t n = header(sizes, b);
      if (n > data.size()) fail("a compressed block is longer than the file");
      n_compressed += n;
    }
    const std::string packed = stream(data, base64, at, n_compressed);
    at = 0;
    for (std::size_t b = 0; b < n_blocks; ++b) {
      const std::uint64_t n = header(sizes, b);
      const std::uint64_t expected = b + 1 == n_blocks && last_size != 0 ? last_size : unpacked_size;
      // No byte can stand for more: deflate's limit is 1032, that of xz below 10000.
      if (expected / (is_lzma_ ? 10000 : 1100) > n) fail("a compressed block unpacks to more than it can");
      std::string block(expected, '\0');
      const std::string_view bytes = std::string_view(packed).substr(at, n);
      if (!(is_lzma_ ? unpack_lzma(bytes, block) : unpack_zlib(bytes, block))) fail("a compressed block is damaged");
      out += block;
      at += n;
    }
    return out;
  }

  template <class Stored, class Value>
  std::vector<Value> convert(const std::string& bytes) const {
    std::vector<Stored> stored(bytes.size() / sizeof(Stored));
    Cursor(name_, bytes).raw(stored.data(), stored.size(), order_);
    std::vector<Value> values;
    values.reserve(stored.size());
    for (const Stored x : stored) values.push_back(static_cast<Value>(x));
    return values;
  }

  template <class Value>
  std::vector<Value> values(pugi::xml_node array) const {
    const std::string_view format = array.attribute("format").value(), type = array.attribute("type").value();
    if (format == "ascii" || format.empty()) {
      std::vector<Value> out;
      Cursor in(name_, array.text().get());
      while (!in.at_end()) out.push_back(in.number<Value>("a number of a DataArray"));
      return out;
    }
    std::string bytes;
    if (format == "appended") {
      const std::size_t offset = array.attribute("offset").as_ullong();
      if (offset >= appended_.size()) fail("an array begins after the end of the file");
      bytes = binary(appended_.substr(offset), appended_is_base64_);
    } else if (format == "binary") {
      std::string_view text = array.text().get();
      text.remove_prefix(std::min(text.find_first_not_of(" \t\r\n"), text.size()));
      bytes = binary(text, true);
    } else {
      fail("a DataArray of format \"" + Cursor::printable(format) + "\"");
    }
    if (type == "Float64") return convert<double, Value>(bytes);
    if (type == "Float32") return convert<float, Value>(bytes);
    if (type == "Int64") return convert<std::int64_t, Value>(bytes);
    if (type == "UInt64") return convert<std::uint64_t, Value>(bytes);
    if (type == "Int32") return convert<std::int32_t, Value>(bytes);
    if (type == "UInt32") return convert<std::uint32_t, Value>(bytes);
    if (type == "Int16") return convert<std::int16_t, Value>(bytes);
    if (type == "UInt16") return convert<std::uint16_t, Value>(bytes);
    if (type == "Int8") return convert<std::int8_t, Value>(bytes);
    if (type == "UInt8") return convert<std::uint8_t, Value>(bytes);
    fail("a DataArray of type \"" + Cursor::printable(type) + "\"");
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

  std::vector<std::int64_t> read_labels(pugi::xml_node piece, std::size_t n_cells) const {
    const pugi::xml_node array =
        piece.child("CellData").find_child_by_attribute("DataArray", "Name", label_array_.c_str());
    if (label_array_.empty() || !array) return std::vector<std::int64_t>(n_cells, 0);
    std::vector<std::int64_t> labels =
        is_integer_array(array) ? values<std::int64_t>(array) : labels_of(name_, label_array_, values<double>(array));
    if (labels.size() != n_cells) fail("array \"" + label_array_ + "\" holds another number of cells than told");
    return labels;
  }

  /// The array of a name, where there is one of as many rows.
  void read_numbers(pugi::xml_node data, const char* wanted, std::size_t n, std::vector<std::int64_t>& numbers) const {
    const pugi::xml_node array = data.find_child_by_attribute("DataArray", "Name", wanted);
    if (!array) return;
    const auto read = values<std::int64_t>(array);
    if (read.size() != n) fail(std::string("array \"") + wanted + "\" holds another number of rows than told");
    numbers.insert(numbers.end(), read.begin(), read.end());
  }

  void read_arrays(pugi::xml_node piece, std::size_t n_points, const std::vector<std::int64_t>& types) {
    read_numbers(piece.child("PointData"), "GlobalPointIds", n_points, arrays_->point_numbers);
    for (const auto& [name, numbers] :
         {std::pair("GlobalCellIds", &arrays_->cell_numbers), std::pair("vtkGhostType", &arrays_->ghosts)}) {
      std::vector<std::int64_t> all;
      read_numbers(piece.child("CellData"), name, types.size(), all);
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
    const std::size_t n_cells = piece.attribute("NumberOfCells").as_ullong();
    const std::vector<double> x = values<double>(piece.child("Points").child("DataArray"));
    if (x.size() % 3 != 0 || x.size() / 3 != n_points) fail("Points holds not three numbers for each point");
    const auto first = static_cast<std::int64_t>(builder_.n_points());
    for (std::size_t i = 0; i < n_points; ++i) builder_.add_point(x[3 * i], x[3 * i + 1], x[3 * i + 2]);
    if (lengths_) read_lengths(piece, n_points);

    const pugi::xml_node cells = piece.child("Cells");
    const auto array = [&](const char* wanted) {
      const pugi::xml_node found = cells.find_child_by_attribute("DataArray", "Name", wanted);
      if (!found) fail(std::string("Cells lacks ") + wanted);
      return values<std::int64_t>(found);
    };
    std::vector<std::int64_t> connectivity = array("connectivity");
    const std::vector<std::int64_t> offsets = array("offsets"), types = array("types");
    if (offsets.size() != n_cells || types.size() != n_cells) fail("Cells holds another number of cells than told");
    for (std::int64_t& v : connectivity) {
      if (v < 0 || v >= static_cast<std::int64_t>(n_points)) v = std::int64_t{no_index};  // reported with its cell
      v += v < std::int64_t{no_index} ? first : 0;
    }
    if (arrays_) read_arrays(piece, n_points, types);
    if (data_) read_data(piece, n_points, types);
    const std::vector<std::int64_t> labels = read_labels(piece, n_cells);
    std::int64_t begin = 0;
    for (std::size_t c = 0; c < n_cells; ++c) {
      if (offsets[c] < begin || offsets[c] > static_cast<std::int64_t>(connectivity.size()))
        throw io_error(name_ + ": the offset of cell " + std::to_string(n_read_ + c) + " is out of range", Entity::cell,
                       {n_read_ + c});
      const auto corners = std::span(connectivity)
                               .subspan(static_cast<std::size_t>(begin), static_cast<std::size_t>(offsets[c] - begin));
      builder_.add_vtk(types[c], corners, labels[c], n_read_ + c);
      begin = offsets[c];
    }
    n_read_ += n_cells;
  }

  std::string name_, bytes_, label_array_;
  pugi::xml_document document_;
  std::string_view appended_;
  bool appended_is_base64_ = false, compressed_ = false, is_lzma_ = false;
  std::endian order_ = std::endian::little;
  std::size_t header_bytes_ = 4, n_read_ = 0;
  MeshBuilder builder_;
  PointLengths* lengths_ = nullptr;
  VtuPieceArrays* arrays_ = nullptr;
  MeshData* data_ = nullptr;
};

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
  return detail::VtuReader(path.string(), read_file(path)).read(options, notes ? *notes : ignored);
}

/// Reads a piece of a parallel file, which may hold no cell.
///
/// @throws as `read_vtu`.
inline MixedMesh read_vtu_piece(const std::filesystem::path& path, VtuPieceArrays& arrays) {
  MeshReadNotes ignored;
  return detail::VtuReader(path.string(), read_file(path))
      .read({.volume = Volume::optional}, ignored, nullptr, &arrays);
}

/// Reads a mesh of any cells, or of faces alone, and the lengths that an array by point of it holds.
///
/// @param lengths  `wanted` chooses the array; the rest is filled in.
/// @throws as `read_vtu`; io_error when no array can be chosen, with the names of those there are.
inline MixedMesh read_vtu_lengths(const std::filesystem::path& path, PointLengths& lengths) {
  MeshReadNotes ignored;
  return detail::VtuReader(path.string(), read_file(path)).read({.volume = Volume::optional}, ignored, &lengths);
}

}  // namespace framehex
