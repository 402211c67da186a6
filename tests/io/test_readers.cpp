// SPDX-License-Identifier: BSL-1.0
#include "framehex/adapters/mesh_reader.hpp"
#include "framehex/adapters/zlib_compression.hpp"
#include "framehex/mesh/validation.hpp"
#include "support/four_cells.hpp"
#include "support/kuhn_lattice.hpp"
#include "support/temporary_folder.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <bit>
#include <cstring>
#include <fstream>
#include <random>

using namespace framehex;
using Catch::Matchers::Contains;

namespace {

/// Same points, and the same cells with the same labels in any order of cells.
void check_same(MixedMesh found, MixedMesh expected, bool with_labels) {
  REQUIRE(found.points.size() == expected.points.size());
  REQUIRE(found.n_cells() == expected.n_cells());
  REQUIRE(found.faces.size() == expected.faces.size());
  REQUIRE(found.edges.size() == expected.edges.size());
  // Files may number the points anew: compare by coordinates.
  const auto describe = [&](const MixedMesh& mesh) {
    const auto corner = [&](index_t v) {
      const Vector3& p = mesh.points[v];
      return std::to_string(p.x()) + "," + std::to_string(p.y()) + "," + std::to_string(p.z()) + " ";
    };
    std::vector<std::string> all;
    const auto add = [&](std::string text, std::span<const index_t> corners, index_t label) {
      for (const index_t v : corners) text += corner(v);
      if (with_labels) text += std::to_string(label);
      all.push_back(text);
    };
    for (std::size_t c = 0; c < mesh.n_cells(); ++c)
      add("cell ", mesh.cells[c], mesh.regions.empty() ? 0 : mesh.regions[c]);
    for (const auto& face : mesh.faces) add("face ", std::span(face.vertices).first(face.size()), face.label);
    for (const auto& edge : mesh.edges) add("edge ", edge.vertices, edge.label);
    std::sort(all.begin(), all.end());
    return all;
  };
  CHECK(describe(found) == describe(expected));
}

std::string tets_vtk(const std::string& points, const std::string& cells) {
  return "# vtk DataFile Version 3.0\nt\nASCII\nDATASET UNSTRUCTURED_GRID\n" + points + cells;
}

}  // namespace

TEST_CASE("what an independent program wrote is read: every format, encoding and version") {
  const test::TemporaryFolder folder;
  const std::string command = PYTHON " " IO_SCRIPTS "/write_samples.py " + folder.path().string() + " >/dev/null 2>&1";
  REQUIRE(std::system(command.c_str()) == 0);
  for (const char* name :
       {"ascii.vtu", "raw.vtu", "zlib.vtu", "wide.vtu", "lzma.vtu", "ascii42.vtk", "binary42.vtk", "ascii51.vtk",
        "binary51.vtk", "text.mesh", "binary.meshb", "ascii22.msh", "binary22.msh", "ascii41.msh", "binary41.msh"}) {
    INFO(name);
    check_same(read_mesh(folder / name), test::four_cells(), true);
  }
}

TEST_CASE("what we wrote is read back") {
  const test::TemporaryFolder folder;
  for (const char* name : {"cells.vtu", "cells.msh", "cells.mesh"}) {
    INFO(name);
    write_mesh(folder / name, test::four_cells());
    check_same(read_mesh(folder / name), test::four_cells(), true);
  }
  write_mesh(folder / "old.msh", test::four_cells(), {}, {.msh = MshVersion::v2_2});
  check_same(read_mesh(folder / "old.msh"), test::four_cells(), true);
  write_mesh(folder / "packed.vtu", test::four_cells(), {}, {.compression = zlib_compression()});
  check_same(read_mesh(folder / "packed.vtu"), test::four_cells(), true);
}

TEST_CASE("labels are found under their usual names, or under the one asked for") {
  const test::TemporaryFolder folder;
  const std::string grid = tets_vtk("POINTS 5 float\n0 0 0 1 0 0 0 1 0 0 0 1 0 0 -1\n",
                                    "CELLS 2 10\n4 0 1 2 3\n4 0 2 1 4\nCELL_TYPES 2\n10\n10\n");
  const auto regions = [&](const std::string& data, const std::string& wanted, MeshReadNotes& notes) {
    return read_mesh(folder.write("a.vtk", grid + data), {.regions = wanted}, &notes).regions;
  };
  using Labels = std::vector<index_t>;
  for (const std::string name :
       {"material", "MaterialIDs", "gmsh:physical", "CellEntityIds", "medit:ref", "Region", "attribute"})
    for (const std::string& text :
         {"SCALARS " + name + " int 1\nLOOKUP_TABLE default\n3\n5\n", "SCALARS " + name + " long\n3 5\n",
          "FIELD FieldData 1\n" + name + " 1 2 unsigned_char\n3 5\n"}) {
      MeshReadNotes notes;
      CHECK(regions("CELL_DATA 2\n" + text, "", notes) == Labels{3, 5});
      CHECK(notes.label_array == name);
      CHECK(notes.unused_arrays.empty());
    }
  // Everything else that such a file may hold is passed over, and what might have been meant is named.
  const std::string rest =
      "METADATA\nINFORMATION 1\nNAME L2 LOCATION vtk\nDATA 2 0 1\n\nPOINT_DATA 5\nVECTORS u float\n0 0 0 0 0 0 0 0 0 0 "
      "0 0 0 0 0\n"
      "SCALARS material int\nLOOKUP_TABLE t\n9 9 9 9 9\nLOOKUP_TABLE t 2\n0 0 0 1 1 1 1 1\nCELL_DATA 2\n"
      "COLOR_SCALARS c 3\n0 0 0 1 1 1\nNORMALS n double\n0 0 1 0 0 1\nFIELD f 4\nflag 1 2 int\n7 "
      "8\nMETADATA\nCOMPONENT_NAMES\n\n"
      "my%20part 1 2 double\n4 6\nwords 1 2 string\none\ntwo%20words\nweight 1 2 float\n0.5 1\nTENSORS s float\n"
      "1 0 0 0 1 0 0 0 1\n1 0 0 0 1 0 0 0 1\n";
  MeshReadNotes notes;
  CHECK(regions(rest, "", notes).empty());
  CHECK(notes.unused_arrays == std::vector<std::string>{"flag"});
  CHECK(regions(rest, "flag", notes) == Labels{7, 8});
  CHECK(regions(rest, "my part", notes) == Labels{4, 6});
  CHECK(notes.label_array == "my part");
  CHECK_THROWS_WITH(regions(rest, "weight", notes), Contains("\"weight\" is no label: it is 0.5"));
  CHECK_THROWS_WITH(regions(rest, "u", notes), Contains("no array by cell \"u\" (it has flag, my part, weight)"));
  CHECK_THROWS_WITH(regions("CELL_DATA 3\nSCALARS a int\nLOOKUP_TABLE default\n1 2 3\n", "", notes),
                    Contains("3 cells of 2"));
  CHECK_THROWS_WITH(regions("CELL_DATA 2\nSCALARS material int\nLOOKUP_TABLE default\n1\n", "", notes),
                    Contains("the file ends"));
  write_mesh(folder / "a.mesh", test::four_cells());
  CHECK_THROWS_WITH(read_mesh(folder / "a.mesh", {.regions = "x"}), Contains("a.mesh: has no arrays by cell"));
}

TEST_CASE("arrays by cell of a .vtu file are labels in any type, piece by piece") {
  const test::TemporaryFolder folder;
  const auto piece = [](const std::string& data) {
    return "<Piece NumberOfPoints=\"4\" NumberOfCells=\"1\"><CellData>" + data +
           "</CellData><Points><DataArray type=\"Float32\" NumberOfComponents=\"3\" format=\"ascii\">0 0 0 1 0 0 0 1 0 "
           "0 0 1</DataArray>"
           "</Points><Cells><DataArray type=\"Int32\" Name=\"connectivity\">0 1 2 3</DataArray><DataArray "
           "type=\"Int32\" "
           "Name=\"offsets\">4</DataArray><DataArray type=\"UInt8\" Name=\"types\">10</DataArray></Cells></Piece>";
  };
  const auto array = [](const std::string& name, const std::string& type, const std::string& value) {
    return "<DataArray type=\"" + type + "\" Name=\"" + name + "\" format=\"ascii\">" + value + "</DataArray>";
  };
  const auto file = folder.write("a.vtu", "<VTKFile type=\"UnstructuredGrid\"><UnstructuredGrid>" +
                                              piece(array("part_a", "Int8", "1") + array("material", "UInt16", "300") +
                                                    array("zone", "Float64", "2")) +
                                              piece(array("zone", "Float64", "4") + array("material", "UInt16", "2")) +
                                              piece("") + "</UnstructuredGrid></VTKFile>");
  MeshReadNotes notes;
  CHECK(read_mesh(file, {}, &notes).regions == std::vector<index_t>{300, 2, 0});
  CHECK(notes.unused_arrays == std::vector<std::string>{"part_a"});
  CHECK(read_mesh(file, {.regions = "zone"}).regions == std::vector<index_t>{2, 4, 0});
}

TEST_CASE("voxels and pixels are hexahedra and quadrilaterals in another order", "[regression]") {
  const test::TemporaryFolder folder;
  const std::string points = "POINTS 8 float\n0 0 0 1 0 0 0 1 0 1 1 0 0 0 1 1 0 1 0 1 1 1 1 1\n";
  const MixedMesh mesh = read_mesh(
      folder.write("a.vtk", tets_vtk(points, "CELLS 2 14\n8 0 1 2 3 4 5 6 7\n4 0 1 2 3\nCELL_TYPES 2\n11\n8\n")));
  std::array<Vector3, 8> corners;
  for (std::size_t i = 0; i < 8; ++i) corners[i] = mesh.points[mesh.cells[0][i]];
  CHECK(scaled_jacobian(CellKind::hexahedron, corners) == Approx(1));
  CHECK(mesh.faces.at(0).vertices == std::array<index_t, 4>{0, 1, 3, 2});
}

TEST_CASE("names of physical groups: with blanks, several on one entity, of every dimension", "[regression]") {
  const test::TemporaryFolder folder;
  const std::string head =
      "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$PhysicalNames\n5\n3 30 \"steel part\"\n3 77 \"copper\"\n"
      "3 99 \"every \"thing\"\"\n2 3 \"inlet\"\n1 2 \"rim\"\n$EndPhysicalNames\n";
  const std::string tail =
      "$Nodes\n1 5 1 5\n3 1 1 5\n1\n2\n3\n4\n5\n0 0 0 .1 .1 .1\n1 0 0 0 0 0\n0 1 0 0 0 0\n0 0 1 0 0 0\n0 0 -1 0 0 "
      "0\n$EndNodes\n$Elements\n4 4 1 4\n3 1 4 1\n1 1 2 3 4\n"
      "3 2 4 1\n2 1 3 2 5\n2 8 2 1\n3 1 2 3\n1 6 1 1\n4 1 2\n$EndElements\n";
  const auto read = [&](const std::string& first, const std::string& second) {
    return read_mesh(
        folder.write("a.msh", head + "$Entities\n0 1 1 2\n6 0 0 0 1 1 1 1 2 0\n8 0 0 0 1 1 1 1 -3 0\n1 0 0 0 1 1 1 " +
                                  first + " 0\n2 0 0 0 1 1 1 " + second + " 0\n$EndEntities\n" + tail));
  };
  using Labels = std::vector<index_t>;
  const auto groups = [](const MixedMesh& mesh) {
    std::vector<std::tuple<int, std::string, Labels>> all;
    for (const LabelGroup& g : mesh.groups) all.emplace_back(g.dimension, g.name, g.labels);
    return all;
  };
  using Groups = std::vector<std::tuple<int, std::string, Labels>>;
  const Groups others{{1, "rim", {1}}, {2, "inlet", {2}}};
  const auto with_others = [&](Groups more) {
    more.insert(more.begin(), others.begin(), others.end());
    return more;
  };
  const MixedMesh plain = read("1 30", "1 77");
  CHECK(plain.regions == Labels{29, 76});
  CHECK(groups(plain) == with_others({{3, "steel part", {29}}, {3, "copper", {76}}}));
  CHECK(plain.faces.at(0).label == 2);
  const MixedMesh shared = read("2 99 30", "1 99");
  CHECK(shared.regions == Labels{99, 98});
  CHECK(groups(shared) == with_others({{3, "steel part", {99}}, {3, "every \"thing\"", {98, 99}}}));
  const MixedMesh both = read("2 30 99", "2 77 99");
  CHECK(both.regions == Labels{29, 76});
  CHECK(groups(both) == with_others({{3, "steel part", {29}}, {3, "copper", {76}}, {3, "every \"thing\"", {29, 76}}}));
  CHECK(groups(read("1 30", "1 30")) == with_others({{3, "steel part", {29}}}));
  // Ours keep all of it, and the reader of Gmsh's format is not the only one that does.
  for (const char* name : {"b.msh", "b.vtu"}) {
    INFO(name);
    write_mesh(folder / name, both);
    const MixedMesh back = read_mesh(folder / name);
    MixedMesh expected = both;
    if (std::string_view(name) == "b.msh") expected.groups.back().name = "every 'thing'";  // a quote ends a name
    CHECK(groups(back) == groups(expected));
    CHECK(back.regions == both.regions);
  }
}

TEST_CASE("nodes with parameters are read in both versions of MSH", "[regression]") {
  const test::TemporaryFolder folder;
  const std::string v2 =
      "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$ParametricNodes\n4\n1 0 0 0 0 7\n2 1 0 0 1 7 0.5\n3 0 1 0 2 7 0.5 0.25\n"
      "4 0 0 1 3 7\n$EndParametricNodes\n$Elements\n1\n1 4 2 1 1 1 2 3 4\n$EndElements\n";
  const std::string v4 =
      "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Nodes\n4 4 1 4\n0 1 1 1\n1\n0 0 0\n1 1 1 1\n2\n1 0 0 .5\n2 1 1 1\n3\n0 1 "
      "0 .5 .25\n"
      "3 1 0 1\n4\n0 0 1\n$EndNodes\n$Elements\n1 1 1 1\n3 1 4 1\n1 1 2 3 4\n$EndElements\n";
  for (const std::string& text : {v2, v4}) {
    const MixedMesh mesh = read_mesh(folder.write("a.msh", text));
    CHECK(mesh.points == std::vector<Vector3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}});
    CHECK(mesh.n_cells() == 1);
  }
}

TEST_CASE("MEDIT in lower case and in every version of binary", "[regression]") {
  const test::TemporaryFolder folder;
  write_mesh(folder / "a.mesh", test::four_cells());
  std::string text = read_file(folder / "a.mesh");
  for (char& c : text) c = static_cast<char>(std::tolower(c));
  check_same(read_mesh(folder.write("lower.mesh", text)), test::four_cells(), true);

  for (const std::endian order : {std::endian::little, std::endian::big})
    for (int version = 1; version <= 4; ++version) {
      INFO(version);
      std::string bytes;
      const auto put = [&](auto value) {
        std::string raw(reinterpret_cast<const char*>(&value), sizeof value);
        if (order != std::endian::native) std::reverse(raw.begin(), raw.end());
        bytes += raw;
      };
      const auto put_int = [&](std::int64_t value) {
        version == 4 ? put(value) : put(static_cast<std::int32_t>(value));
      };
      const auto put_position = [&](std::size_t value) {
        version >= 3 ? put(static_cast<std::int64_t>(value)) : put(static_cast<std::int32_t>(value));
      };
      const auto put_real = [&](double value) { version == 1 ? put(static_cast<float>(value)) : put(value); };
      const std::size_t position = version >= 3 ? 8 : 4, integer = version == 4 ? 8 : 4, real = version == 1 ? 4 : 8;
      put(std::int32_t{1}), put(std::int32_t{version});
      put(std::int32_t{3}), put_position(bytes.size() + position + 4), put(std::int32_t{3});
      put(std::int32_t{99}), put_position(bytes.size() + position + 5), bytes += "other";  // a section nobody knows
      put(std::int32_t{4}), put_position(bytes.size() + position + integer + 4 * (3 * real + integer)), put_int(4);
      for (int v = 0; v < 4; ++v) {
        for (int i = 1; i < 4; ++i) put_real(v == i ? 1 : 0);
        put_int(0);
      }
      put(std::int32_t{8}), put_position(bytes.size() + position + 6 * integer), put_int(1);
      for (const int v : {1, 2, 3, 4, 6}) put_int(v);
      put(std::int32_t{54}), put_position(0);
      const MixedMesh mesh = read_mesh(folder.write("a.meshb", bytes));
      CHECK(mesh.points == std::vector<Vector3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}});
      CHECK(mesh.n_cells() == 1);
      CHECK(mesh.regions == std::vector<index_t>{5});
      for (std::size_t n = 0; n < bytes.size() - 4 - position; ++n)  // up to the last section, "end"

        CHECK_THROWS_AS(read_mesh(folder.write("a.meshb", bytes.substr(0, n))), io_error);
    }
}

TEST_CASE("coordinates survive to the last bit") {
  const test::TemporaryFolder folder;
  std::mt19937_64 random(1);
  MixedMesh mesh = test::four_cells();
  for (Vector3& p : mesh.points)
    for (int i = 0; i < 3; ++i)
      p[i] += std::ldexp(static_cast<double>(random() >> 11), -60 - static_cast<int>(random() % 300));
  for (const char* name : {"cells.vtu", "cells.msh", "cells.mesh"}) {
    write_mesh(folder / name, mesh);
    CHECK(read_mesh(folder / name).points == mesh.points);
  }
}

TEST_CASE("prisms that do not follow VTK's manual are turned, all together") {
  const test::TemporaryFolder folder;
  const std::string points = "POINTS 6 float\n0 0 0 1 0 0 0 1 0 0 0 1 1 0 1 0 1 1\n", types = "CELL_TYPES 1\n13\n";
  for (const char* order : {"0 2 1 3 5 4", "0 1 2 3 4 5"}) {
    const auto file = folder.write("prism.vtk", tets_vtk(points, std::string("CELLS 1 7\n6 ") + order + "\n" + types));
    const MixedMesh mesh = read_mesh(file);
    const auto row = mesh.cells[0];
    CHECK(std::vector<index_t>(row.begin(), row.end()) == std::vector<index_t>{0, 1, 2, 3, 4, 5});
  }
}

TEST_CASE("tetrahedra are taken out of a mesh of tetrahedra only") {
  const IndexedTetMesh lattice = test::kuhn_lattice(2);
  MixedMesh mesh{.points = lattice.points, .kinds = {}, .cells = {}, .regions = {}, .faces = {}, .edges = {}};
  for (const auto& tet : lattice.tets) mesh.add(CellKind::tetrahedron, tet);
  CHECK(tetrahedra_of(mesh).tets == lattice.tets);
  CHECK_THROWS_WITH(tetrahedra_of(test::four_cells()), Contains("cell 0 is not a tetrahedron"));
}

TEST_CASE("what VTK adds to a legacy file is passed over: metadata of arrays and fields of data", "[regression]") {
  const test::TemporaryFolder folder;
  const std::string head = "# vtk DataFile Version 5.1\nvtk output\n", grid = "DATASET UNSTRUCTURED_GRID\n";
  const std::string metadata =
      "METADATA\nINFORMATION 2\nNAME L2_NORM_RANGE LOCATION vtkDataArray\nDATA 2 0 1\n"
      "NAME L2_NORM_FINITE_RANGE LOCATION vtkDataArray\nDATA 2 0 1\n\n";
  const auto check = [&](const std::string& text) {
    INFO(text);
    const MixedMesh mesh = read_mesh(folder.write("a.vtk", text));
    REQUIRE(mesh.n_cells() == 1);
    CHECK(mesh.cells[0][3] == 3);
    CHECK(mesh.points[3] == Vector3(0, 0, 1));
  };
  SECTION("text") {
    const std::string points = "POINTS 4 double\n0 0 0 1 0 0 0 1 0\n0 0 1\n",
                      offsets = "CELLS 2 4\nOFFSETS vtktypeint64\n0 4\n", rest = "CONNECTIVITY vtktypeint64\n0 1 2 3\n",
                      types = "CELL_TYPES 1\n10\n";
    const std::string field = "FIELD FieldData 3\nTimeValue 1 1 double\n0.5\n" + metadata +
                              "Names 1 2 string\nPOINTS 4 double\nCELLS\nPairs 2 3 int\n1 2 3 4 5 6\n";
    check(head + "ASCII\n" + grid + points + metadata + offsets + metadata + rest + metadata + types);
    check(head + "ASCII\n" + grid + field + points + metadata + offsets + rest + types);
    check(head + "ASCII\r\n" + grid + points + "METADATA\r\nINFORMATION 0\r\n\r\n" + offsets + rest + types);
    CHECK_THROWS_AS(check(head + "ASCII\n" + grid + "FIELD F 1\na 1000000 1000000000000000 int\n"), io_error);
    CHECK_THROWS_AS(check(head + "ASCII\n" + grid + "FIELD F 1\na 1 1 complex\n1\n" + metadata), io_error);
  }
  SECTION("binary") {
    std::string bytes;
    const auto put = [&bytes](auto value) {
      std::string one(sizeof value, '\0');
      std::memcpy(one.data(), &value, sizeof value);
      if (std::endian::native == std::endian::little) std::reverse(one.begin(), one.end());
      bytes += one;
    };
    bytes = head + "BINARY\n" + grid + "FIELD FieldData 3\nTimeValue 1 1 double\n";
    put(0.5);
    // A string of 5 bytes: its length in the last six bits of one byte, the first two of which are set.
    bytes +=
        "\nNames 1 1 string\n\xc5"
        "CELLS\nbits 1 9 bit\nab\nPOINTS 4 float\n";
    for (const float x : {0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f}) put(x);
    bytes += "\n" + metadata + "CELLS 2 4\nOFFSETS vtktypeint64\n";
    for (const std::int64_t offset : {0, 4}) put(offset);
    bytes += "\n" + metadata + "CONNECTIVITY vtktypeint64\n";
    for (const std::int64_t v : {0, 1, 2, 3}) put(v);
    bytes += "\nCELL_TYPES 1\n";
    put(std::int32_t{10});
    check(bytes);
  }
}

TEST_CASE("numbers at the ends of their ranges are read as what is nearest, or refused", "[regression]") {
  const test::TemporaryFolder folder;
  const auto x_of = [&](const std::string& number) {
    const std::string points = "POINTS 4 double\n0 0 0 1 0 0 0 1 0 " + number + " 0 1\n";
    return read_mesh(folder.write("a.vtk", tets_vtk(points, "CELLS 1 5\n4 0 1 2 3\nCELL_TYPES 1\n10\n"))).points[3].x();
  };
  const std::string zeros(400, '0');
  for (const std::string& tiny :
       {std::string("1e-400"), std::string("1E-400"), std::string("-12.5E-999999999999999999999"), "0." + zeros + "1",
        "." + zeros + "1e10", "1" + zeros + "e-900"})
    CHECK(x_of(tiny) == 0);
  for (const std::string& huge : {std::string("1e400"), std::string("1E400"), std::string("1e999999999999999999999"),
                                  "1" + zeros, "1" + zeros + "e-10", std::string("1e-400x"), std::string("1e-")})
    CHECK_THROWS_AS(x_of(huge), io_error);
  // The least integer, from which one cannot be taken.
  CHECK_THROWS_AS(read_mesh(folder.write("a.mesh",
                                         "MeshVersionFormatted 2\nDimension 3\nVertices\n1\n0 0 0 0\n"
                                         "Tetrahedra\n1\n-9223372036854775808 1 1 1 0\nEnd\n")),
                  invalid_connectivity);
}

TEST_CASE("files that are not what they should be are refused by name and place") {
  const test::TemporaryFolder folder;
  const auto message = [&](const char* name, const std::string& bytes) -> std::string {
    try {
      read_mesh(folder.write(name, bytes));
    } catch (const error& e) {
      std::string text = e.what();
      CHECK(text.starts_with((folder / name).string() + ": "));
      CHECK(text.find('\n') == text.npos);
      return text.substr((folder / name).string().size() + 2);
    }
    return "no error";
  };
  const std::string points = "POINTS 4 float\n0 0 0 1 0 0 0 1 0 0 0 1\n", types = "CELL_TYPES 1\n10\n";

  CHECK_THROWS_WITH(read_mesh(folder / "none.vtu"), Contains("none.vtu: cannot be read (No such file or directory)"));
  CHECK_THROWS_WITH(read_mesh(folder / "mesh.xyz"), Contains("mesh.xyz: unknown extension"));
  std::filesystem::create_directory(folder / "folder.vtu");
  CHECK_THROWS_WITH(read_mesh(folder / "folder.vtu"), Contains("cannot be read (Is a directory)"));

  for (const char* name : {"a.vtu", "a.vtk", "a.msh", "a.mesh"}) {
    CHECK(message(name, "") != "no error");
    CHECK(message(name, "hello\n") != "no error");
    CHECK(message(name, std::string(1000, '\0')) != "no error");
  }
  CHECK(message("a.vtk", "hello\n") == "line 2: not a VTK file");
  CHECK(message("a.vtk", tets_vtk(points, "CELLS 1 5\n4 0 1 2 4\n" + types)) == "cell 0 refers to vertex 4 of 4");
  CHECK(message("a.vtk", tets_vtk(points, "CELLS 1 5\n4 0 1 2 -1\n" + types)) == "cell 0 refers to vertex -1 of 4");
  CHECK(message("a.vtk", tets_vtk(points, "CELLS 1 5\n5 0 1 2 3\n" + types)) == "line 8: CELLS ends within cell 0");
  CHECK(message("a.vtk", tets_vtk(points, "CELLS 1 4\n3 0 1 2\n" + types)) == "cell 0 of VTK type 10 has 3 corners");
  CHECK(message("a.vtk", tets_vtk(points, "CELLS 1 5\n4 0 1 2 3\nCELL_TYPES 1\n42\n"))
            .starts_with("cell 0 is of VTK type 42"));
  CHECK(message("a.vtk", tets_vtk("POINTS 4 float\n0 0 0 1 0 0 0 nan 0 0 0 1\n", "CELLS 1 5\n4 0 1 2 3\n" + types)) ==
        "vertex 2 has a coordinate that is not finite");
  CHECK(message("a.vtk", tets_vtk("POINTS 4 float\n0 0 0 1 0 0 0 inf 0 0 0 1\n", "CELLS 1 5\n4 0 1 2 3\n" + types)) ==
        "vertex 2 has a coordinate that is not finite");
  CHECK(message("a.vtk", tets_vtk("POINTS 4 float\n0 0 0 1 0 0\n0 abc 0 0 0 1\n", "")) ==
        "line 7: a coordinate should stand where \"abc\" does");
  CHECK(message("a.vtk", tets_vtk("POINTS 4000000000000 float\n0 0 0\n", "")) ==
        "line 5: the number of points is 4000000000000, more than the file can hold");
  CHECK(message("a.vtk", tets_vtk("POINTS 4 float\n0 0 0 1 0 0\n0", "")) ==
        "line 7: the file ends where a coordinate should stand");
  CHECK(message("a.vtk", tets_vtk(points, "CELLS 1 2\n1 0\nCELL_TYPES 1\n1\n")) ==
        "holds no tetrahedron, pyramid, prism or hexahedron");

  CHECK(message("a.mesh", "MeshVersionFormatted 2\nDimension 2\n") == "line 2: not a mesh in space");
  CHECK(message("a.mesh", "MeshVersionFormatted 2\nDimension 3\nVertices\n1\n0 0 0\nTetrahedra\n") ==
        "line 6: a reference should stand where \"Tetrahedra\" does");
  CHECK(
      message("a.mesh", "MeshVersionFormatted 2\nDimension 3\nVertices\n1\n0 0 0 0\nTetrahedra\n1\n1 1 1 2 0\nEnd\n") ==
      "cell 0 refers to vertex 1 of 1");

  CHECK(message("a.msh", "$MeshFormat\n1.0 0 8\n$EndMeshFormat\n") ==
        "line 2: version of the format is neither 2 nor 4.1");
  const std::string head = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n1\n7 0 0 0\n$EndNodes\n";
  CHECK(message("a.msh", head + "$Elements\n1\n3 4 2 1 1 7 7 7 8\n$EndElements\n") ==
        "element 3 refers to node 8, which does not exist");
  CHECK(message("a.msh", head + "$Elements\n1\n3 11 2 1 1 7 7 7 8\n$EndElements\n")
            .starts_with("line 10: element type 11 is not read"));
  CHECK(message("a.msh", head + "$Comments\nunfinished").starts_with("line 9: the file ends within $Comments"));

  CHECK(message("a.vtu", "<VTKFile type=\"PolyData\"/>") == "not an unstructured grid");
  CHECK(message("a.vtu", "<VTKFile type=\"UnstructuredGrid\">\n<a>\n</b></VTKFile>").starts_with("line 3: "));
  CHECK(message("a.vtu", "<VTKFile type=\"UnstructuredGrid\" compressor=\"vtkLZ4DataCompressor\"></VTKFile>")
            .starts_with("compressed by vtkLZ4DataCompressor"));
}

TEST_CASE("polygonal lines and polygonal data of VTK are read as the lines and faces they are made of",
          "[regression]") {
  const test::TemporaryFolder folder;
  const std::string points = "POINTS 5 double\n0 0 0 2 0 0 2 1 0 0 1 0 1 .5 0\n";
  const std::string head = "# vtk DataFile Version 5.1\nt\nASCII\nDATASET ";
  const std::string cells = "5 0 1 2 3 0\n2 0 4\n";
  const std::vector<std::array<index_t, 2>> lines{{0, 1}, {1, 2}, {2, 3}, {3, 0}, {0, 4}};
  const auto xml = [](const std::string& of_points, const std::string& corners, const std::string& types,
                      const std::string& offsets) {
    const auto array = [](const char* name, const char* type, const std::string& text, int n) {
      return "<DataArray type=\"" + std::string(type) + "\" Name=\"" + name + "\" NumberOfComponents=\"" +
             std::to_string(n) + "\" format=\"ascii\">" + text + "</DataArray>";
    };
    return "<VTKFile type=\"UnstructuredGrid\" byte_order=\"LittleEndian\"><UnstructuredGrid><Piece "
           "NumberOfPoints=\"5\" NumberOfCells=\"2\"><Points>" +
           array("Points", "Float64", of_points, 3) + "</Points><Cells>" + array("connectivity", "Int64", corners, 1) +
           array("offsets", "Int64", offsets, 1) + array("types", "UInt8", types, 1) +
           "</Cells></Piece></UnstructuredGrid></VTKFile>";
  };
  const std::vector<std::pair<std::string, std::string>> files{
      {"grid.vtk", head + "UNSTRUCTURED_GRID\n" + points + "CELLS 2 9\n" + cells + "CELL_TYPES 2\n4\n4\n"},
      {"poly.vtk", head + "POLYDATA\n" + points + "LINES 2 9\n" + cells},
      {"poly51.vtk", head + "POLYDATA\n" + points +
                         "VERTICES 2 1\nOFFSETS vtktypeint64\n0 1\nCONNECTIVITY vtktypeint64\n4\nLINES 3 7\nOFFSETS "
                         "vtktypeint64\n0 5 7\nCONNECTIVITY vtktypeint64\n0 1 2 3 0 0 4\n"},
      {"grid.vtu", xml("0 0 0 2 0 0 2 1 0 0 1 0 1 .5 0", "0 1 2 3 0 0 4", "4 4", "5 7")}};
  for (const auto& [name, text] : files) {
    INFO(name);
    std::ofstream(folder / name) << text;
    const MixedMesh mesh = read_mesh(folder / name, {.volume = Volume::optional});
    std::vector<std::array<index_t, 2>> found;
    for (const LabelledEdge& edge : mesh.edges) found.push_back(edge.vertices);
    CHECK(found == lines);
    CHECK(mesh.faces.empty());
  }
  std::ofstream(folder / "faces.vtk") << head + "POLYDATA\n" + points +
                                             "LINES 1 3\n2 0 4\nPOLYGONS 2 9\n4 0 1 2 3\n3 0 1 "
                                             "4\nCELL_DATA 3\nSCALARS part int 1\nLOOKUP_TABLE default\n5 6 7\n";
  const MixedMesh faces = read_mesh(folder / "faces.vtk", {.volume = Volume::optional});
  REQUIRE(faces.faces.size() == 2);
  CHECK(faces.faces[0].vertices == std::array<index_t, 4>{0, 1, 2, 3});
  CHECK(faces.faces[1].vertices == std::array<index_t, 4>{0, 1, 4, no_index});
  REQUIRE(faces.edges.size() == 1);
  std::ofstream(folder / "strips.vtk") << head + "POLYDATA\n" + points + "TRIANGLE_STRIPS 1 5\n4 0 1 3 2\n";
  CHECK_THROWS_WITH(read_mesh(folder / "strips.vtk", {.volume = Volume::optional}),
                    Contains("line 7: unexpected \"TRIANGLE_STRIPS\""));
  std::ofstream(folder / "pentagon.vtk") << head + "POLYDATA\n" + points + "POLYGONS 1 6\n5 0 1 2 3 4\n";
  CHECK_THROWS_WITH(read_mesh(folder / "pentagon.vtk", {.volume = Volume::optional}), Contains("is of VTK type 7"));
}

TEST_CASE("damaged files are refused or read, never worse", "[robustness]") {
  const test::TemporaryFolder folder;
  const std::string command = PYTHON " " IO_SCRIPTS "/write_samples.py " + folder.path().string() + " >/dev/null 2>&1";
  REQUIRE(std::system(command.c_str()) == 0);
  write_mesh(folder / "ours.vtu", test::four_cells());
  std::vector<std::filesystem::path> samples;
  for (const auto& entry : std::filesystem::directory_iterator(folder.path())) samples.push_back(entry.path());
  std::sort(samples.begin(), samples.end());
  std::mt19937_64 random(7);
  std::size_t n_refused = 0, n_read = 0;
  const auto attempt = [&](const std::string& name, const std::string& bytes) {
    try {
      const MixedMesh mesh = read_mesh(folder.write(name, bytes));
      for (const index_t v : mesh.cells.values) REQUIRE(v < mesh.points.size());
      ++n_read;
    } catch (const error& e) {
      REQUIRE(std::string_view(e.what()).find(name) != std::string_view::npos);
      ++n_refused;
    }
  };
  for (const auto& sample : samples) {
    INFO(sample);
    const std::string bytes = read_file(sample), name = "damaged" + sample.extension().string();
    for (std::size_t i = 0; i < 60; ++i) attempt(name, bytes.substr(0, bytes.size() * i / 60));
    for (int i = 0; i < 200; ++i) {
      std::string damaged = bytes;
      for (std::size_t n = 1 + random() % 4; n > 0; --n) {
        const std::size_t at = random() % damaged.size();
        switch (random() % 4) {
          case 0: damaged[at] = static_cast<char>(random()); break;
          case 1: damaged.erase(at, random() % 9); break;
          case 2: damaged.insert(at, 1, static_cast<char>('0' + random() % 10)); break;
          default: damaged[at] = static_cast<char>(damaged[at] ^ (1 << random() % 8));
        }
      }
      attempt(name, damaged);
    }
  }
  CHECK(n_refused > samples.size() * 100);
  CHECK(n_read > 0);
}

TEST_CASE("what else stands in a .vtu, in and around its arrays, is passed over, and lines are counted all the same") {
  const test::TemporaryFolder folder;
  const std::string begin =
      "<?xml version='1.0'?>\n<VTKFile type='UnstructuredGrid' version='0.1'>\n"
      "<!-- a <DataArray> that is none -->\n<UnstructuredGrid><Piece NumberOfPoints='4' NumberOfCells='1'>\n"
      "<Points><DataArray type='Float64' Name='a > b' NumberOfComponents=\"3\" format='ascii'>\n"
      "<InformationKey name='L2_NORM_RANGE' length='2'>\n<Value index='0'>7</Value><Value index='1'>8</Value>\n"
      "</InformationKey>\n<!-- 9 -->\n0 0 0 1 0 0\n0 1 0 0 0 1\n</DataArray></Points>\n<Cells>\n"
      "<DataArray type='Int64' Name='connectivity' format='ascii'>0\n1 2 3</DataArray>\n"
      "<DataArray type='Int64' Name='offsets' format='ascii'>4</DataArray>\n"
      "<DataArray type='UInt8' Name='types' format='ascii'>10</DataArray>\n</Cells>\n";
  const MixedMesh mesh = read_mesh(folder.write("good.vtu", begin + "</Piece></UnstructuredGrid>\n</VTKFile>\n"));
  REQUIRE(mesh.points.size() == 4);
  CHECK((mesh.points[1] == Vector3(1, 0, 0)));
  CHECK((mesh.points[3] == Vector3(0, 0, 1)));
  CHECK(mesh.n_cells() == 1);
  const auto n_lines = static_cast<std::size_t>(std::count(begin.begin(), begin.end(), '\n'));
  CHECK_THROWS_WITH(read_mesh(folder.write("bad.vtu", begin + "</Piece>\n</Unstructured>\n")),
                    Contains("line " + std::to_string(n_lines + 2)));
}
