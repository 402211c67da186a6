// SPDX-License-Identifier: BSL-1.0
#include "framehex/adapters/mesh_reader.hpp"
#include "framehex/adapters/zlib_compression.hpp"
#include "framehex/io/input_file.hpp"
#include "framehex/io/mesh_writer.hpp"
#include "support/four_cells.hpp"
#include "support/temporary_folder.hpp"

#include <sys/resource.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <csignal>
#include <numeric>
#include <pugixml.hpp>
#include <random>

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
  write_mesh(folder / "packed.vtu", test::four_cells(), sample_data(), zlib_compression());
  command += " " + (folder / "packed.vtu").string();
  CHECK(std::system(command.c_str()) == 0);
  CHECK(folder.n_entries() == 4);
}

TEST_CASE("arrays of any lengths reach a reader that renumbers their offsets") {
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

TEST_CASE("the same mesh gives the same bytes") {
  const test::TemporaryFolder folder;
  for (const char* extension : {".vtu", ".msh", ".mesh"}) {
    const auto a = folder / (std::string("a") + extension), b = folder / (std::string("b") + extension);
    write_mesh(a, test::four_cells(), sample_data());
    write_mesh(b, test::four_cells(), sample_data());
    CHECK(read_file(a) == read_file(b));
  }
}

TEST_CASE("arrays keep their names, whatever is in them") {
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

TEST_CASE("labels that a format cannot hold are refused before a byte is written") {
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
