// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/io/data_array.hpp"
#include "framehex/io/output_file.hpp"
#include "framehex/io/quadratic_elements.hpp"
#include "framehex/io/vtk_cells.hpp"
#include "framehex/mesh/mixed_mesh.hpp"

#include <bit>
#include <functional>
#include <limits>
#include <memory>

namespace framehex {

/// How arrays of a file are compressed; nothing by default. `zlib_compression` of the adapters makes one.
struct VtuCompression {
  std::string name = {};                                   ///< VTK's name of the compressor
  std::function<std::string(std::string_view)> pack = {};  ///< bytes -> compressed bytes
};

namespace detail {

/// Cells of all dimensions in the order of the file: the volume's, then faces, then edges.
struct VtuCells {
  std::vector<std::int64_t> connectivity, offsets;
  std::vector<std::uint8_t> types, kinds;
  std::vector<index_t> labels;

  VtuCells(const MixedMesh& mesh, const MidsideNodes* midside) : mesh_(mesh), midside_(midside) {
    for (std::size_t c = 0; c < mesh.n_cells(); ++c) {
      const CellKind kind = mesh.kinds[c];
      std::array<index_t, 8> corners{};
      const std::size_t n = mesh.cells[c].size();
      for (std::size_t i = 0; i < n; ++i) corners[i] = mesh.cells[c][vtk::corner(kind, i)];
      add(std::span(corners).first(n), vtk_edge_order(kind),
          midside ? vtk::quadratic_cell_type(kind) : vtk::cell_type(kind), static_cast<std::uint8_t>(kind),
          mesh.regions.empty() ? 0 : mesh.regions[c]);
    }
    for (const LabelledFace& face : mesh.faces) {
      const bool is_triangle = face.size() == 3;
      const vtk::CellType plain = is_triangle ? vtk::triangle : vtk::quad;
      const vtk::CellType quadratic = is_triangle ? vtk::quadratic_triangle : vtk::quadratic_quad;
      add(std::span(face.vertices).first(face.size()), face_edge_order(face.size()), midside ? quadratic : plain,
          is_triangle ? 4 : 5, face.label);
    }
    for (const LabelledEdge& edge : mesh.edges)
      add(edge.vertices, face_edge_order(2), midside ? vtk::quadratic_line : vtk::line, 6, edge.label);
  }

  std::size_t size() const { return types.size(); }

private:
  void add(std::span<const index_t> corners, EdgeOrder order, vtk::CellType type, std::uint8_t kind, index_t label) {
    connectivity.insert(connectivity.end(), corners.begin(), corners.end());
    if (midside_) append_midside(connectivity, *midside_, mesh_.points.size(), corners, order);
    offsets.push_back(static_cast<std::int64_t>(connectivity.size()));
    types.push_back(type);
    kinds.push_back(kind);
    labels.push_back(label);
  }

  const MixedMesh& mesh_;
  const MidsideNodes* midside_;
};

/// Rows by point, with those of the nodes on edges: each has that of its edge's first end.
inline DataArray with_midside_rows(DataArray array, const MidsideNodes& midside) {
  std::visit(
      [&](auto& values) {
        for (const auto& edge : midside.edges)
          for (std::size_t i = 0; i < array.n_components; ++i)
            values.push_back(values[edge[0] * array.n_components + i]);
      },
      array.values);
  return array;
}

/// Text as the value of an XML attribute.
inline std::string xml_escaped(std::string_view text) {
  std::string out;
  for (const char c : text) switch (c) {
      case '&': out += "&amp;"; break;
      case '<': out += "&lt;"; break;
      case '>': out += "&gt;"; break;
      case '"': out += "&quot;"; break;
      case '\t':
      case '\n':
      case '\r': out += "&#" + std::to_string(static_cast<int>(c)) + ";"; break;
      default: out += c;
    }
  return out;
}

/// Opens an element of arrays. VTK has an attribute that tells which of them holds numbers in a mesh of many pieces.
inline std::string data_element(const char* element, const std::vector<DataArray>& arrays, const char* numbers) {
  const bool has_numbers =
      std::any_of(arrays.begin(), arrays.end(), [&](const DataArray& a) { return a.name == numbers; });
  return std::string("<") + element + (has_numbers ? " GlobalIds=\"" + std::string(numbers) + "\"" : "") + ">\n";
}

/// The XML part of a file, and the arrays appended to it.
///
/// Their bytes stand in the opposite order of their elements. Readers that renumber offsets while they go through the
/// bytes, and look for elements from the top (meshio 5.3 does), else take an element already renumbered for a later one.
class VtuDocument {
public:
  explicit VtuDocument(const VtuCompression& compression) : compression_(compression) {}

  void text(std::string xml) { parts_.push_back({std::move(xml), 0, {}}); }

  /// @param n_padding  values to add at the end, for the cells that have none.
  template <class Value>
  void array(const std::string& name, std::size_t n_components, const Value* values, std::size_t n,
             std::size_t n_padding = 0) {
    static_assert(sizeof(Value) <= 8);
    const char* const family = std::is_floating_point_v<Value> ? "Float" : std::is_signed_v<Value> ? "Int" : "UInt";
    std::string element = "        <DataArray type=\"" + std::string(family) + std::to_string(8 * sizeof(Value)) +
                          "\" Name=\"" + xml_escaped(name) + "\"";
    if (n_components != 1) element += " NumberOfComponents=\"" + std::to_string(n_components) + "\"";
    constexpr Value padding = std::is_floating_point_v<Value> ? std::numeric_limits<Value>::quiet_NaN() : Value{};
    if (compression_.pack) {
      std::vector<Value> all(n + n_padding, padding);
      std::copy_n(values, n, all.begin());
      auto bytes = std::make_shared<const std::string>(
          packed({reinterpret_cast<const char*>(all.data()), all.size() * sizeof(Value)}));
      parts_.push_back({element, bytes->size(), [bytes](OutputFile& file) { file.write(*bytes); }});
      return;
    }
    parts_.push_back({element, sizeof(std::uint64_t) + (n + n_padding) * sizeof(Value), [=](OutputFile& file) {
                        file.write_value(static_cast<std::uint64_t>((n + n_padding) * sizeof(Value)));
                        file.write_values(values, n);
                        const std::vector<Value> tail(n_padding, padding);
                        file.write_values(tail.data(), n_padding);
                      }});
  }

  void array(const DataArray& array, std::size_t n_padded_rows) {
    const std::size_t n_padding = (n_padded_rows - array.size()) * array.n_components;
    std::visit(
        [&](const auto& values) {
          this->array(array.name, array.n_components, values.data(), values.size(), n_padding);
        },
        array.values);
  }

  void write(OutputFile& file) const {
    std::vector<std::uint64_t> offsets(parts_.size() + 1, 0);
    for (std::size_t i = parts_.size(); i-- > 0;) offsets[i] = offsets[i + 1] + parts_[i].n_bytes;
    for (std::size_t i = 0; i < parts_.size(); ++i) {
      file.write(parts_[i].xml);
      if (parts_[i].append) file.write(" format=\"appended\" offset=\"" + std::to_string(offsets[i + 1]) + "\"/>\n");
    }
    file.write("  <AppendedData encoding=\"raw\">\n_");
    for (std::size_t i = parts_.size(); i-- > 0;)
      if (parts_[i].append) parts_[i].append(file);
    file.write("\n  </AppendedData>\n");
  }

private:
  struct Part {
    std::string xml;
    std::uint64_t n_bytes;
    std::function<void(OutputFile&)> append;  // empty: nothing but text
  };

  /// Blocks, after their number, their size, that of the last one if it is smaller, and what each is packed to.
  std::string packed(std::string_view bytes) const {
    constexpr std::size_t bytes_a_block = std::size_t{1} << 18;
    const std::size_t n_blocks = (bytes.size() + bytes_a_block - 1) / bytes_a_block;
    std::vector<std::uint64_t> header{n_blocks, bytes_a_block, bytes.size() % bytes_a_block};
    std::string body;
    for (std::size_t b = 0; b < n_blocks; ++b) {
      const std::string block = compression_.pack(bytes.substr(b * bytes_a_block, bytes_a_block));
      header.push_back(block.size());
      body += block;
    }
    return std::string(reinterpret_cast<const char*>(header.data()), header.size() * sizeof(std::uint64_t)) + body;
  }

  const VtuCompression& compression_;
  std::vector<Part> parts_;
};

/// Names of labels as field data: under "regions:steel part" the labels that are called so.
inline void add_groups(VtuDocument& document, const std::vector<LabelGroup>& groups) {
  if (groups.empty()) return;
  document.text("    <FieldData>\n");
  for (const LabelGroup& group : groups) {
    std::string labels;
    for (const index_t label : group.labels) labels += std::to_string(label) + " ";
    document.text(
        "      <DataArray type=\"UInt32\" Name=\"" +
        xml_escaped(std::string(vtk::group_prefixes[static_cast<std::size_t>(group.dimension)]) + group.name) +
        "\" NumberOfTuples=\"" + std::to_string(group.labels.size()) + "\" format=\"ascii\">" + labels +
        "</DataArray>\n");
  }
  document.text("    </FieldData>\n");
}

/// Puts what `write_vtu` writes into a file that is not committed yet.
inline void put_vtu(OutputFile& file, const std::string& name, const MixedMesh& mesh, const MeshData& data,
                    const VtuCompression& compression, const MidsideNodes* midside) {
  static_assert(sizeof(Vector3) == 3 * sizeof(double));
  check_rows(name, mesh.n_cells() > 0 ? mesh.n_cells() : mesh.faces.size(), mesh.points.size(), data);
  const VtuCells cells(mesh, midside);
  const std::vector<Vector3> points = points_with(mesh, midside);
  std::vector<DataArray> by_point = data.points;
  if (midside)
    for (DataArray& array : by_point) array = with_midside_rows(std::move(array), *midside);
  VtuDocument document(compression);

  const double* const coordinates = points.empty() ? nullptr : points.front().data();
  std::string head = "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"";
  head += std::endian::native == std::endian::little ? "LittleEndian" : "BigEndian";
  head += "\" header_type=\"UInt64\"";
  if (compression.pack) head += " compressor=\"" + compression.name + "\"";
  document.text(head + ">\n  <UnstructuredGrid>\n");
  add_groups(document, mesh.groups);
  document.text("    <Piece NumberOfPoints=\"" + std::to_string(points.size()) + "\" NumberOfCells=\"" +
                std::to_string(cells.size()) + "\">\n      <Points>\n");
  document.array("Points", 3, coordinates, 3 * points.size());
  document.text("      </Points>\n      <Cells>\n");
  document.array("connectivity", 1, cells.connectivity.data(), cells.connectivity.size());
  document.array("offsets", 1, cells.offsets.data(), cells.size());
  document.array("types", 1, cells.types.data(), cells.size());
  document.text("      </Cells>\n      " + data_element("CellData", data.cells, "GlobalCellIds"));
  document.array("kind", 1, cells.kinds.data(), cells.size());
  document.array("label", 1, cells.labels.data(), cells.size());
  for (const DataArray& array : data.cells) document.array(array, cells.size());
  document.text("      </CellData>\n      " + data_element("PointData", data.points, "GlobalPointIds"));
  for (const DataArray& array : by_point) document.array(array, points.size());
  document.text("      </PointData>\n    </Piece>\n  </UnstructuredGrid>\n");

  document.write(file);
  file.write("</VTKFile>\n");
}

}  // namespace detail

/// Writes a mesh as a VTK XML unstructured grid, for ParaView and whoever builds on VTK.
///
/// @param path  the file; appears whole or not at all (`OutputFile`).
/// @param mesh  its labelled faces and edges are written as cells too, after the volume's.
/// @param data  arrays of n_cells and n_points rows; those by cell are by face where the mesh has no volume. Faces and edges have NaN (integers: 0) in the arrays by cell. Two
///              arrays are always written: `kind` (0 tetrahedron, 1 pyramid, 2 prism, 3 hexahedron, 4 triangle,
///              5 quadrilateral, 6 edge) and `label` (region, patch or curve). Names of labels are field data.
/// @param midside      nodes on its edges, when not null: cells, faces and edges are quadratic, and rows by point of these
///                     nodes are those of an end of their edge.
/// @param compression  of the arrays; they are held packed in memory then.
/// @throws invalid_option  for an array of another length; io_error naming the file.
/// @par Complexity   O(n); connectivity is held once more in memory.
/// @par Determinism  Same mesh, same bytes (on machines of one byte order, which the file states).
/// @par Source       VTK file formats, XML, version 1.0: appended raw data, 64-bit headers. Prisms in the order of
///                   VTK's manual (vtk_cells.hpp).
inline void write_vtu(const std::filesystem::path& path, const MixedMesh& mesh, const MeshData& data = {},
                      const VtuCompression& compression = {}, const MidsideNodes* midside = nullptr) {
  OutputFile file(path);
  detail::put_vtu(file, path.string(), mesh, data, compression, midside);
  file.commit();
}

}  // namespace framehex
