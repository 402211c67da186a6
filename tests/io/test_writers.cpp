// SPDX-License-Identifier: BSL-1.0
#include "framehex/adapters/mesh_reader.hpp"
#include "framehex/adapters/zlib_compression.hpp"
#include "framehex/geometry/quality.hpp"
#include "framehex/io/input_file.hpp"
#include "framehex/io/mesh_writer.hpp"
#include "support/four_cells.hpp"
#include "support/temporary_folder.hpp"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <csignal>
#include <map>
#include <numeric>
#include <pugixml.hpp>
#include <random>
#include <set>
#include <sstream>

using namespace framehex;
using Catch::Matchers::Contains;

namespace {

MeshData sample_data() {
  std::vector<double> smoothness;
  std::vector<Quaternion> frames;
  for (int v = 0; v < 12; ++v) {
    smoothness.push_back(v / 16.0);
    frames.emplace_back(1.0, v, 0, 0);
  }
  return {.cells = {{"scaled_jacobian", std::vector<double>{1, 0.75, 0.5, 0.25}}},
          .points = {frame_array(frames), {"smoothness", smoothness}}};
}

}  // namespace

TEST_CASE("an independent reader finds every cell right side out, with labels and arrays") {
  const test::TemporaryFolder folder;
  std::string command = PYTHON " " IO_SCRIPTS "/judge.py";
  for (const char* name : {"cells.vtu", "cells.msh", "cells.mesh"}) {
    write_mesh(folder / name, test::four_cells(), sample_data());
    command += " " + (folder / name).string();
  }
  write_mesh(folder / "old.msh", test::four_cells(), {}, {.msh = MshVersion::v2_2});
  command += " " + (folder / "old.msh").string();
  write_mesh(folder / "packed.vtu", test::four_cells(), sample_data(), {.compression = zlib_compression()});
  command += " " + (folder / "packed.vtu").string();
  CHECK(std::system(command.c_str()) == 0);
  CHECK(folder.n_entries() == 5);
}

TEST_CASE("arrays of any lengths reach a reader that renumbers their offsets", "[regression]") {
  const test::TemporaryFolder folder;
  std::mt19937_64 random(3);
  std::string command = PYTHON " " IO_SCRIPTS "/judge.py --arrays";
  for (int file = 0; file < 200; ++file) {
    MixedMesh mesh = test::four_cells();
    mesh.points.resize(12 + random() % 40, Vector3::Zero());
    MeshData data;
    for (std::size_t k = random() % 7; k > 0; --k) {
      const std::size_t n = 1 + random() % 3;
      const auto first = static_cast<index_t>(random() % 1000);
      std::vector<index_t> values(n * mesh.points.size());
      std::iota(values.begin(), values.end(), first);
      const std::string name = std::to_string(first);
      if (random() % 2 == 0)
        data.points.push_back({name, std::vector<double>(values.begin(), values.end()), n});
      else
        data.points.push_back({name, std::move(values), n});
    }
    const auto path = folder / ("a" + std::to_string(file) + ".vtu");
    if (file % 4 == 3)
      write_vtu(path, mesh, data, zlib_compression());
    else
      write_vtu(path, mesh, data);
    command += " " + path.string();
  }
  CHECK(std::system(command.c_str()) == 0);
}

TEST_CASE("a solver's input: elements, sets and surfaces by the numbers of Abaqus' manual") {
  const test::TemporaryFolder folder;
  MixedMesh mesh = test::four_cells();
  mesh.groups = {
      {3, 0, "steel part", {0, 1}}, {3, 1, "2nd/alloy", {2}}, {2, 0, "inlet", {0, 3}}, {2, 4, "inl\"et", {3}}};
  // Nodes of each face, from the manual, by number of nodes of the element.
  using Faces = std::vector<std::set<int>>;
  const std::map<std::string, Faces> faces{
      {"C3D4", {{1, 2, 3}, {1, 4, 2}, {2, 4, 3}, {3, 4, 1}}},
      {"C3D5", {{1, 2, 3, 4}, {1, 5, 2}, {2, 5, 3}, {3, 5, 4}, {4, 5, 1}}},
      {"C3D6", {{1, 2, 3}, {4, 6, 5}, {1, 4, 5, 2}, {2, 5, 6, 3}, {3, 6, 4, 1}}},
      {"C3D8", {{1, 2, 3, 4}, {5, 8, 7, 6}, {1, 5, 6, 2}, {2, 6, 7, 3}, {3, 7, 8, 4}, {4, 8, 5, 1}}}};
  // A label for every face on the boundary, by its turn.
  mesh.faces.clear();
  for (const CellFace& face : faces_used_once(mesh))
    mesh.faces.push_back({face.vertices, static_cast<index_t>(mesh.faces.size() % 4)});
  for (const InpPyramids pyramids : {InpPyramids::own_type, InpPyramids::degenerate_bricks}) {
    write_mesh(folder / "a.inp", mesh, {}, {.pyramids = pyramids});
    std::istringstream file(read_file(folder / "a.inp"));
    std::map<int, std::pair<std::string, std::vector<int>>> elements;
    std::map<std::string, std::set<int>> element_sets, node_sets;
    std::map<std::string, std::multiset<std::set<int>>> surfaces;
    std::string line, keyword, type, name;
    while (std::getline(file, line)) {
      const auto value = [&](const std::string& key) {
        const std::size_t at = line.find(key + "=");
        return at == line.npos ? "" : line.substr(at + key.size() + 1, line.find(',', at) - at - key.size() - 1);
      };
      if (line[0] == '*') {
        keyword = line.substr(1, line.find(',') - 1);
        type = value("TYPE");
        name = keyword == "ELSET" ? value(" ELSET") : keyword == "NSET" ? value(" NSET") : value("NAME");
        continue;
      }
      std::replace(line.begin(), line.end(), ',', ' ');
      std::istringstream numbers(line);
      int number = 0;
      std::vector<int> rest;
      if (keyword == "SURFACE") {
        char s = 0;
        int side = 0;
        numbers >> number >> s >> side;
        const auto& [element_type, nodes] = elements.at(number);
        std::set<int> corners;
        for (const int local : faces.at(element_type).at(static_cast<std::size_t>(side) - 1))
          corners.insert(nodes.at(static_cast<std::size_t>(local) - 1));
        surfaces[name].insert(corners);
      } else if (keyword == "ELEMENT") {
        numbers >> number;
        for (int v = 0; numbers >> v;) rest.push_back(v);
        elements[number] = {type, rest};
      } else {
        while (numbers >> number) (keyword == "ELSET" ? element_sets : node_sets)[name].insert(number);
      }
    }
    REQUIRE(elements.size() == 4);
    for (int c = 0; c < 4; ++c) {
      std::vector<int> expected;
      for (const index_t v : mesh.cells[static_cast<std::size_t>(c)]) expected.push_back(static_cast<int>(v) + 1);
      if (expected.size() == 5 && pyramids == InpPyramids::degenerate_bricks) expected.resize(8, expected[4]);
      CHECK(elements.at(c + 1).second == expected);
    }
    // Regions of the four cells: 0, 0, 2, 1.
    CHECK(element_sets == std::map<std::string, std::set<int>>{{"E_steel_part", {1, 2, 4}}, {"E_n2nd_alloy", {3}}});
    std::map<std::string, std::multiset<std::set<int>>> expected;
    for (const LabelledFace& face : mesh.faces) {
      std::set<int> corners;
      for (std::size_t i = 0; i < face.size(); ++i) corners.insert(static_cast<int>(face.vertices[i]) + 1);
      if (face.label == 0 || face.label == 3) expected["S_inlet"].insert(corners);
      if (face.label == 3) expected["S_inl_et"].insert(corners);
      if (face.label == 1 || face.label == 2) expected["S_patch_" + std::to_string(face.label)].insert(corners);
    }
    CHECK(surfaces == expected);
    for (const auto& [surface, sides] : expected) {
      std::set<int> nodes;
      for (const auto& side : sides) nodes.insert(side.begin(), side.end());
      CHECK(node_sets["N_" + surface.substr(2)] == nodes);
    }
  }
}

TEST_CASE("OpenFOAM's folder: faces in upper triangular order, out of their owners, by patches") {
  const test::TemporaryFolder folder;
  MixedMesh mesh = test::four_cells();
  mesh.groups = {{3, 2, "up", {2}}, {2, 0, "the wall", {0, 3}}, {2, 1, "all", {3}}};
  mesh.faces = {{{0, 3, 2, 1}, 0}, {{1, 2, 8, no_index}, 3}, {{5, 9, 6, no_index}, 7}, {{1, 2, 6, 5}, 5}};
  const auto polymesh = folder / "case/constant/polyMesh";
  write_mesh(polymesh, mesh);
  // The numbers within the outermost parentheses of a file, line by line.
  const auto rows = [&](const char* name) {
    std::istringstream file(read_file(polymesh / name));
    std::vector<std::vector<double>> found;
    std::string line;
    while (std::getline(file, line) && line != "(") {
    }
    while (std::getline(file, line) && line != ")") {
      std::replace_if(
          line.begin(), line.end(), [](char c) { return c == '(' || c == ')'; }, ' ');
      std::istringstream numbers(line);
      found.emplace_back();
      for (double x = 0; numbers >> x;) found.back().push_back(x);
    }
    return found;
  };
  const auto points = rows("points"), faces = rows("faces"), owner = rows("owner"), neighbour = rows("neighbour");
  REQUIRE(points.size() == mesh.points.size());
  for (std::size_t v = 0; v < points.size(); ++v)
    CHECK(Vector3(points[v][0], points[v][1], points[v][2]) == mesh.points[v]);
  REQUIRE(neighbour.size() == 3);
  REQUIRE(faces.size() == 3 + faces_used_once(mesh).size());
  REQUIRE(owner.size() == faces.size());
  // Each cell's faces, turned out of it, enclose its volume.
  std::vector<double> volume(4, 0);
  for (std::size_t f = 0; f < faces.size(); ++f) {
    REQUIRE(static_cast<double>(faces[f].size()) == faces[f][0] + 1);
    const auto p = [&](std::size_t i) -> const Vector3& { return mesh.points[static_cast<std::size_t>(faces[f][i])]; };
    double part = 0;
    for (std::size_t i = 2; i + 1 < faces[f].size(); ++i) part += p(1).dot(p(i).cross(p(i + 1))) / 6;
    volume[static_cast<std::size_t>(owner[f][0])] += part;
    if (f >= neighbour.size()) continue;
    volume[static_cast<std::size_t>(neighbour[f][0])] -= part;
    CHECK(owner[f][0] < neighbour[f][0]);
    if (f > 0) CHECK(std::pair(owner[f - 1][0], neighbour[f - 1][0]) < std::pair(owner[f][0], neighbour[f][0]));
  }
  for (std::size_t c = 0; c < 4; ++c) {
    std::vector<Vector3> corners;
    for (const index_t v : mesh.cells[c]) corners.push_back(mesh.points[v]);
    CHECK(volume[c] == Approx(cell_volume(mesh.kinds[c], corners)));
  }
  const std::string boundary = read_file(polymesh / "boundary"), cell_zones = read_file(polymesh / "cellZones");
  CHECK_THAT(
      boundary,
      Contains(
          "the_wall\n    {\n        type patch;\n        inGroups (all);\n        nFaces 2;\n        startFace 3;"));
  CHECK_THAT(boundary, Contains("patch_7\n    {\n        type patch;\n        nFaces 1;\n        startFace 5;"));
  CHECK_THAT(boundary, Contains("defaultFaces") && !Contains("patch_5"));
  CHECK_THAT(read_file(polymesh / "faceZones"), Contains("patch_5") && Contains("List<bool> 1{0}"));
  CHECK_THAT(cell_zones, Contains("up\n") && Contains("region_0") && Contains("region_1"));
  CHECK(std::distance(std::filesystem::directory_iterator(polymesh), {}) == 7);  // and no partial ones
  folder.write("file", "");
  CHECK_THROWS_WITH(write_mesh(folder / "file/polyMesh", mesh), Contains("file/polyMesh: cannot be made"));
  mesh.add(CellKind::tetrahedron, std::array<index_t, 4>{1, 8, 2, 10});
  mesh.add(CellKind::tetrahedron, std::array<index_t, 4>{1, 8, 2, 11});
  mesh.regions.resize(6);
  CHECK_THROWS_AS(write_mesh(folder / "polyMesh", mesh), nonmanifold);
  CHECK(!std::filesystem::exists(folder / "polyMesh"));
}

TEST_CASE("the same mesh gives the same bytes") {
  const test::TemporaryFolder folder;
  for (const char* extension : {".vtu", ".msh", ".mesh"}) {
    const auto a = folder / (std::string("a") + extension), b = folder / (std::string("b") + extension);
    write_mesh(a, test::four_cells(), sample_data());
    write_mesh(b, test::four_cells(), sample_data());
    CHECK(read_file(a) == read_file(b));
  }
}

TEST_CASE("arrays keep their names, whatever is in them", "[regression]") {
  const test::TemporaryFolder folder;
  const std::string name = "a < b && \"c\" > 'd'\tsigma\n\xcf\x83";
  write_vtu(folder / "a.vtu", test::four_cells(), {.cells = {}, .points = {{name, std::vector<double>(12, 1.0)}}});
  const std::string bytes = read_file(folder / "a.vtu");
  const std::string xml = bytes.substr(0, bytes.find("<AppendedData")) + "</VTKFile>";
  pugi::xml_document document;
  REQUIRE(document.load_string(xml.c_str()));
  const auto array =
      document.child("VTKFile").child("UnstructuredGrid").child("Piece").child("PointData").first_child();
  CHECK(array.attribute("Name").value() == name);
}

TEST_CASE("a mesh without cells, faces or labels can be written") {
  const test::TemporaryFolder folder;
  for (const char* name : {"none.vtu", "none.msh", "none.mesh"}) {
    CHECK_NOTHROW(write_mesh(folder / name, MixedMesh{}));
    CHECK(std::filesystem::exists(folder / name));
  }
}

TEST_CASE("what cannot be written is refused by name, and leaves nothing") {
  const test::TemporaryFolder folder;
  const MixedMesh mesh = test::four_cells();
  CHECK_THROWS_WITH(write_mesh(folder / "mesh.stl", mesh), Contains("mesh.stl: unknown extension"));
  CHECK_THROWS_WITH(write_mesh(folder / "mesh.vtk", mesh), Contains("mesh.vtk") && Contains("not written"));
  CHECK_THROWS_WITH(write_mesh(folder / "none/mesh.vtu", mesh),
                    Contains("none/mesh.vtu: cannot be written (No such file or directory)"));
  CHECK_THROWS_AS(write_mesh(folder / "mesh.vtu", mesh, {.cells = {{"x", std::vector<double>(3)}}, .points = {}}),
                  invalid_option);
  std::filesystem::create_directory(folder / "folder.vtu");
  CHECK_THROWS_WITH(write_mesh(folder / "folder.vtu", mesh), Contains("folder.vtu: is a directory"));
  std::filesystem::remove(folder / "folder.vtu");
  CHECK(folder.n_entries() == 0);
}

TEST_CASE("labels that a format cannot hold are refused before a byte is written", "[regression]") {
  const test::TemporaryFolder folder;
  for (const char* name : {"mesh.msh", "mesh.mesh"}) {
    for (const index_t label : {index_t{2147483647}, no_index}) {
      const std::string text = std::to_string(label);
      MixedMesh mesh = test::four_cells();
      mesh.regions.assign(mesh.n_cells(), label);
      CHECK_THROWS_WITH(write_mesh(folder / name, mesh), Contains(name) && Contains(text));
      mesh = test::four_cells();
      mesh.faces = {{{0, 1, 2, no_index}, label}};
      CHECK_THROWS_WITH(write_mesh(folder / name, mesh), Contains(name) && Contains(text));
      mesh = test::four_cells();
      mesh.edges = {{{0, 1}, label}};
      CHECK_THROWS_WITH(write_mesh(folder / name, mesh), Contains(name) && Contains(text));
    }
    CHECK(folder.n_entries() == 0);
    MixedMesh mesh = test::four_cells();
    mesh.regions.assign(mesh.n_cells(), 2147483646);
    mesh.regions[0] = 0;
    write_mesh(folder / name, mesh);
    auto regions = read_mesh(folder / name).regions;  // cells come by region
    std::sort(regions.begin(), regions.end());
    CHECK(regions == mesh.regions);
    std::filesystem::remove(folder / name);
  }
}

TEST_CASE("a full disk is an error that names the file") {
  CHECK_THROWS_WITH(write_vtu("/dev/full", test::four_cells()),
                    Contains("/dev/full: cannot be written whole (No space left on device)"));
  CHECK(std::filesystem::is_character_file("/dev/full"));
}

TEST_CASE("a disk that fills up midway leaves neither a partial file nor harms the old one") {
  const test::TemporaryFolder folder;
  folder.write("mesh.vtu", "old");
  // The limit on a file's size stands in for the disk's: past it, writing fails just so.
  rlimit old_limit{};
  ::getrlimit(RLIMIT_FSIZE, &old_limit);
  const auto old_handler = std::signal(SIGXFSZ, SIG_IGN);
  rlimit limit = old_limit;
  limit.rlim_cur = 1000;
  ::setrlimit(RLIMIT_FSIZE, &limit);
  std::string message;
  try {
    write_vtu(folder / "mesh.vtu", test::four_cells());
  } catch (const io_error& e) {
    message = e.what();
  }
  ::setrlimit(RLIMIT_FSIZE, &old_limit);
  std::signal(SIGXFSZ, old_handler);
  CHECK_THAT(message, Contains("mesh.vtu: cannot be written whole"));
  CHECK(read_file(folder / "mesh.vtu") == "old");
  CHECK(folder.n_entries() == 1);
}

TEST_CASE("a folder or file without write permission is refused", "[permission]") {
  if (::geteuid() == 0) {
    // Root may write anywhere but in the kernel's own folders.
    CHECK_THROWS_WITH(write_mesh("/proc/mesh.vtu", test::four_cells()), Contains("/proc/mesh.vtu: cannot be written"));
    return;
  }
  const test::TemporaryFolder folder;
  const auto file = folder.write("mesh.vtu", "old");
  std::filesystem::permissions(file, std::filesystem::perms::owner_read);
  CHECK_THROWS_WITH(write_mesh(file, test::four_cells()), Contains("Permission denied"));
  std::filesystem::permissions(folder.path(), std::filesystem::perms::owner_read | std::filesystem::perms::owner_exec);
  CHECK_THROWS_WITH(write_mesh(folder / "new.vtu", test::four_cells()), Contains("Permission denied"));
  std::filesystem::permissions(folder.path(), std::filesystem::perms::owner_all);
  CHECK(read_file(file) == "old");
}

TEST_CASE("of a process that is killed while it writes nothing is left, and the next removes what others left") {
  const test::TemporaryFolder folder;
  const auto old_file = folder.write("old.vtu", "old");
  // What a file system without files without names leaves: of a process that is no more, and of one that is.
  const pid_t killed = ::fork();
  if (killed == 0) {
    OutputFile file(folder / "new.vtu"), other(folder / "old.vtu");
    for (OutputFile* f : {&file, &other}) {
      f->write(std::string(1 << 20, 'x'));
      f->finish();
    }
    ::raise(SIGKILL);
  }
  int status = 0;
  REQUIRE(::waitpid(killed, &status, 0) == killed);
  REQUIRE(WIFSIGNALED(status));
  const int probe = ::open(folder.path().c_str(), O_TMPFILE | O_WRONLY, 0600);
  if (probe >= 0) {
    ::close(probe);
    CHECK(folder.n_entries() == 1);
  }
  CHECK(read_file(old_file) == "old");

  std::string name = OutputFile::temporary_name(old_file);
  const auto of_process = [&](pid_t process) {
    const std::string own = std::to_string(::getpid());
    return std::filesystem::path(
        std::string(name).replace(name.rfind(own + ".partial"), own.size(), std::to_string(process)));
  };
  const auto abandoned = of_process(killed), in_use = of_process(::getppid());
  folder.write(abandoned.filename().string(), "half");
  folder.write(in_use.filename().string(), "half");
  OutputFile file(old_file);
  file.write("new");
  file.commit();
  CHECK(read_file(old_file) == "new");
  CHECK(!std::filesystem::exists(abandoned));
  CHECK(std::filesystem::exists(in_use));
}

TEST_CASE("a file not committed does not appear; a link is followed") {
  const test::TemporaryFolder folder;
  {
    OutputFile file(folder / "new");
    file.write("half");
  }
  CHECK(folder.n_entries() == 0);
  folder.write("real", "old");
  std::filesystem::create_symlink(folder / "real", folder / "link");
  OutputFile file(folder / "link");
  file.write("new");
  file.commit();
  CHECK(read_file(folder / "real") == "new");
  CHECK(std::filesystem::is_symlink(folder / "link"));
}
