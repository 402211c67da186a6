// SPDX-License-Identifier: BSL-1.0
#include "framehex/io/surface_reader.hpp"
#include "framehex/mesh/validation.hpp"
#include "support/surfaces.hpp"
#include "support/temporary_folder.hpp"

#include <bit>
#include <catch2/catch.hpp>
#include <random>

using namespace framehex;
using Catch::Matchers::Contains;

namespace {

using Triangles = std::vector<std::array<index_t, 3>>;

std::string number(double x) {
  if (std::isnan(x)) return "nan";
  if (std::isinf(x)) return "inf";
  char digits[32];
  std::snprintf(digits, sizeof digits, "%.17g", x);
  return digits;
}

std::string row(const Vector3& p) {
  return number(p.x()) + " " + number(p.y()) + " " + number(p.z()) + "\n";
}

std::string upper_case(std::string text) {
  for (char& c : text) c = static_cast<char>(std::toupper(c));
  return text;
}

std::string ascii_stl(const IndexedTriangleMesh& mesh) {
  std::string text = "solid test\n";
  for (const auto& t : mesh.triangles) {
    text += "facet normal 0 0 0\nouter loop\n";
    for (const index_t v : t) text += "vertex " + row(mesh.points[v]);
    text += "endloop\nendfacet\n";
  }
  return text + "endsolid test\n";
}

std::string binary_stl(const IndexedTriangleMesh& mesh) {
  std::string bytes(80, ' ');
  const auto put = [&](auto value) { bytes.append(reinterpret_cast<const char*>(&value), sizeof value); };
  put(static_cast<std::uint32_t>(mesh.triangles.size()));
  for (const auto& t : mesh.triangles) {
    for (int i = 0; i < 3; ++i) put(0.0F);
    for (const index_t v : t)
      for (int i = 0; i < 3; ++i) put(static_cast<float>(mesh.points[v][i]));
    put(std::uint16_t{0});
  }
  return bytes;
}

std::string obj(const IndexedTriangleMesh& mesh) {
  std::string text = "# test\n";
  for (const Vector3& p : mesh.points) text += "v " + row(p);
  for (const auto& t : mesh.triangles) {
    text += "f";
    for (const index_t v : t) text += " " + std::to_string(v + 1);
    text += "\n";
  }
  return text;
}

std::string off_rows(const IndexedTriangleMesh& mesh) {
  std::string text;
  for (const Vector3& p : mesh.points) text += row(p);
  for (const auto& t : mesh.triangles) {
    text += "3";
    for (const index_t v : t) text += " " + std::to_string(v);
    text += "\n";
  }
  return text;
}

std::string off(const IndexedTriangleMesh& mesh) {
  return "OFF\n" + std::to_string(mesh.points.size()) + " " + std::to_string(mesh.triangles.size()) + " 0\n" +
         off_rows(mesh);
}

std::string ply(const IndexedTriangleMesh& mesh) {
  return "ply\nformat ascii 1.0\nelement vertex " + std::to_string(mesh.points.size()) +
         "\nproperty float x\nproperty float y\nproperty float z\nelement face " +
         std::to_string(mesh.triangles.size()) + "\nproperty list uchar int vertex_indices\nend_header\n" +
         off_rows(mesh);
}

/// PLY in binary, with properties and elements that a surface has no use for.
template <class Real>
std::string binary_ply(const IndexedTriangleMesh& mesh, std::endian order) {
  const std::string real = sizeof(Real) == 8 ? "double" : "float32";
  std::string bytes = "ply\r\nformat binary_" + std::string(order == std::endian::big ? "big" : "little") +
                      "_endian 1.0\r\ncomment none\r\nelement camera 1\r\nproperty list uint8 int16 view\r\n"
                      "element vertex " +
                      std::to_string(mesh.points.size()) + "\r\nproperty uchar red\r\nproperty " + real +
                      " z\r\nproperty " + real + " x\r\nproperty " + real + " y\r\nelement face " +
                      std::to_string(mesh.triangles.size()) +
                      "\r\nproperty float quality\r\nproperty list uint8 uint vertex_index\r\nproperty short label\r\n"
                      "end_header\r\n";
  const auto put = [&](auto value) {
    std::string raw(reinterpret_cast<const char*>(&value), sizeof value);
    if (order != std::endian::native) std::reverse(raw.begin(), raw.end());
    bytes += raw;
  };
  put(std::uint8_t{2}), put(std::int16_t{3}), put(std::int16_t{4});
  for (const Vector3& p : mesh.points) {
    put(std::uint8_t{200});
    for (const int axis : {2, 0, 1}) put(static_cast<Real>(p[axis]));
  }
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    put(0.5F), put(std::uint8_t{3});
    for (const index_t v : mesh.triangles[t]) put(std::uint32_t{v});
    put(static_cast<std::int16_t>(t < 2 ? -7 : 9));
  }
  return bytes;
}

/// Volume by the divergence theorem, from a point of the surface.
double enclosed_volume(const IndexedTriangleMesh& mesh) {
  double sum = 0;
  const auto at = [&](index_t v) { return Vector3(mesh.points[v] - mesh.points[0]); };
  for (const auto& t : mesh.triangles) sum += at(t[0]).dot(at(t[1]).cross(at(t[2])));
  return sum / 6;
}

void turn(IndexedTriangleMesh& mesh, std::size_t triangle) {
  std::swap(mesh.triangles[triangle][0], mesh.triangles[triangle][1]);
}

IndexedTriangleMesh nested_boxes(double inner) {
  IndexedTriangleMesh mesh = test::box_surface({1, 1, 1});
  const IndexedTriangleMesh small = test::box_surface({inner, inner, inner});
  const auto first = static_cast<index_t>(mesh.points.size());
  for (const Vector3& p : small.points) mesh.points.push_back(p + Vector3::Constant((1 - inner) / 2));
  for (const auto& t : small.triangles) mesh.triangles.push_back({first + t[0], first + t[1], first + t[2]});
  return mesh;
}

}  // namespace

TEST_CASE("every format of surface is read, welded, and closed") {
  const test::TemporaryFolder folder;
  const IndexedTriangleMesh box = test::box_surface({1, 2, 3}, 2, 2, 2);
  folder.write("ascii.stl", ascii_stl(box));
  folder.write("binary.stl", binary_stl(box));
  folder.write("box.obj", obj(box));
  folder.write("box.OFF", off(box));
  folder.write("box.ply", ply(box));
  for (const char* name : {"ascii.stl", "binary.stl", "box.obj", "box.OFF", "box.ply"}) {
    INFO(name);
    const SoupSurface read = read_surface(folder / name);
    CHECK(read.surface.points.size() == 26);
    CHECK(read.surface.triangles.size() == 48);
    CHECK(read.n_turned_triangles == 0);
    CHECK(read.n_dropped_triangles == 0);
    CHECK(!read.welded_by_tolerance);
    CHECK_NOTHROW(validate_closed(read.surface));
    CHECK(enclosed_volume(read.surface) == Approx(6));
  }
}

TEST_CASE("the bunny is read") {
  const SoupSurface bunny = read_surface(EXAMPLE_DATA "/bunny.stl");
  CHECK(bunny.surface.triangles.size() == 3674);
  CHECK_NOTHROW(validate_closed(bunny.surface));
  CHECK(enclosed_volume(bunny.surface) == Approx(194.29).epsilon(1e-4));
}

TEST_CASE("every digit of a coordinate is kept") {
  const test::TemporaryFolder folder;
  IndexedTriangleMesh box = test::box_surface({0.7, 0.7, 0.7}, 2, 2, 2);
  for (Vector3& p : box.points) p += Vector3(500000.3, 4649776.3, 100);  // as surveyors have them
  folder.write("text.stl", ascii_stl(box));
  folder.write("box.obj", obj(box));
  folder.write("box.off", off(box));
  folder.write("box.ply", ply(box));
  folder.write("little.ply", binary_ply<double>(box, std::endian::little));
  folder.write("big.ply", binary_ply<double>(box, std::endian::big));
  for (const char* name : {"text.stl", "box.obj", "box.off", "box.ply", "little.ply", "big.ply"}) {
    INFO(name);
    const SoupSurface read = read_surface(folder / name);
    CHECK_NOTHROW(validate_closed(read.surface));
    CHECK(read.rounding == 0);
    CHECK(enclosed_volume(read.surface) == Approx(0.343).epsilon(1e-7));
    if (std::string_view(name) != "text.stl") CHECK(read.surface.points == box.points);
  }
  // What single precision lost is told: half a unit in the last place of 4649777.
  folder.write("binary.stl", binary_stl(box));
  folder.write("single.ply", binary_ply<float>(box, std::endian::big));
  for (const char* name : {"binary.stl", "single.ply"})
    CHECK(read_surface(folder / name).rounding == Approx(0.277).epsilon(0.01));
}

TEST_CASE("STL as other programs write it", "[regression]") {
  const test::TemporaryFolder folder;
  const IndexedTriangleMesh box = test::box_surface({1, 2, 3});
  const std::string text = ascii_stl(box), binary = binary_stl(box);
  folder.write("upper.stl", upper_case(text));
  folder.write("long.stl", "solid " + std::string(3000, 'x') + "\n" + text.substr(text.find('\n') + 1));
  folder.write("nameless.stl", "solid\n" + text.substr(text.find('\n') + 1, text.rfind("endsolid") - 11) + "endsolid");
  std::string normals = text;
  for (std::size_t at = 0; (at = normals.find("normal 0 0 0", at)) != normals.npos;)
    normals.replace(at, 12, "normal nan -nan 1e999");
  folder.write("normals.stl", normals);
  folder.write("trailing.stl", binary + std::string(33, '\1'));
  folder.write("header.stl", "solid of nothing" + binary.substr(16));
  folder.write("both.stl", "solid of nothing" + binary.substr(16) + "made by someone");
  for (const char* name :
       {"upper.stl", "long.stl", "nameless.stl", "normals.stl", "trailing.stl", "header.stl", "both.stl"}) {
    INFO(name);
    const SoupSurface read = read_surface(folder / name);
    CHECK(read.surface.triangles.size() == 12);
    CHECK(read.patches.empty());
    CHECK(enclosed_volume(read.surface) == Approx(6));
  }
  folder.write("short.stl", binary.substr(0, binary.size() - 1));
  CHECK_THROWS_WITH(read_surface(folder / "short.stl"), Contains("tells 12 triangles, it has room for 11"));
  folder.write("vertex.stl",
               "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nendloop\nendfacet\nendsolid a\n");
  CHECK_THROWS_WITH(read_surface(folder / "vertex.stl"), Contains("line 6: a facet has 2 vertices"));
}

TEST_CASE("solids, groups, materials and labels are patches with names") {
  const test::TemporaryFolder folder;
  const IndexedTriangleMesh box = test::box_surface({1, 1, 1});
  const auto part = [&](std::size_t first, std::size_t last) {
    IndexedTriangleMesh mesh = box;
    mesh.triangles.assign(box.triangles.begin() + static_cast<std::ptrdiff_t>(first),
                          box.triangles.begin() + static_cast<std::ptrdiff_t>(last));
    return mesh;
  };
  const auto solid = [&](const std::string& name, std::size_t first, std::size_t last) {
    const std::string text = ascii_stl(part(first, last));
    return "solid " + name + text.substr(text.find('\n'));
  };
  const std::string points = obj({box.points, {}});
  const auto faces = [&](std::size_t first, std::size_t last) {
    return obj({{}, part(first, last).triangles}).substr(7);
  };
  folder.write("solids.stl", solid("hot inlet", 0, 2) + solid("wall", 2, 6) + solid("", 6, 7) + solid("wall", 7, 12));
  folder.write("groups.obj", points + "g hot inlet\n" + faces(0, 2) + "g wall\n" + faces(2, 12));
  folder.write("materials.obj", points + "usemtl a\n" + faces(0, 2) + "o thing\nusemtl b\n" + faces(2, 12));
  folder.write("labels.ply", binary_ply<double>(box, std::endian::little));
  const auto check = [&](const char* name, std::vector<std::string> names, std::vector<index_t> patches) {
    INFO(name);
    const SoupSurface read = read_surface(folder / name);
    CHECK(read.patch_names == names);
    CHECK(read.patches == patches);
  };
  check("solids.stl", {"hot inlet", "wall", "solid_2"}, {0, 0, 1, 1, 1, 1, 2, 1, 1, 1, 1, 1});
  check("groups.obj", {"hot inlet", "wall"}, {0, 0, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1});
  check("materials.obj", {"a", "thing:b"}, {0, 0, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1});
  check("labels.ply", {"label_-7", "label_9"}, {0, 0, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1});
}

TEST_CASE("triangles know the polygons of the file that they are of") {
  const test::TemporaryFolder folder;
  // Quadrilaterals, a triangle that loses a corner by welding, negative numbers, a line that goes on, textures.
  const SoupSurface cube = read_surface(
      folder.write("cube.obj",
                   "v 0 0 0\nv 1 0 0\nv 1 1 0 1.0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\nv 0 0 0\nvn 0 0 1\n"
                   "f 1 4 3 2\nf 1 9 2\nf 5//1 6//1 7//1 8//1\nf 1/1 2/2 6/3 \\\n5/4\nf 2/1/1 3/1/1 7/1/1 6/1/1\n"
                   "f -7 -6 -2 -3\nf 4 1 5 8\n"));
  CHECK(cube.polygons == std::vector<index_t>{0, 0, 2, 2, 3, 3, 4, 4, 5, 5, 6, 6});
  CHECK(cube.n_dropped_triangles == 1);
  CHECK(enclosed_volume(cube.surface) == Approx(1));
}

TEST_CASE("a count that the file cannot hold is refused before anything is allocated", "[regression]") {
  const test::TemporaryFolder folder;
  const IndexedTriangleMesh box = test::box_surface({1, 1, 1});
  const std::string good_off = off(box), good_ply = ply(box);
  const auto with = [](std::string text, const std::string& from, const std::string& to) {
    return text.replace(text.find(from), from.size(), to);
  };
  for (const std::string huge :
       {"353535235358", "9223372036854775807", "18446744073709551615", "4294967295", "99999999999999999999"}) {
    INFO(huge);
    folder.write("a.off", with(good_off, "8 12 0", huge + " 12 0"));
    folder.write("b.off", with(good_off, "8 12 0", "8 " + huge + " 0"));
    folder.write("c.off", with(good_off, "\n3 ", "\n" + huge + " "));
    folder.write("a.ply", with(good_ply, "vertex 8", "vertex " + huge));
    folder.write("b.ply", with(good_ply, "face 12", "face " + huge));
    folder.write("c.ply", with(good_ply, "\n3 ", "\n" + huge + " "));
    folder.write("d.ply", with(good_ply, "element face", "element nothing " + huge + "\nelement face"));
    for (const char* name : {"a.off", "b.off", "c.off", "a.ply", "b.ply", "c.ply", "d.ply"}) {
      INFO(name);
      CHECK_THROWS_AS(read_surface(folder / name), io_error);
    }
  }
  CHECK_THROWS_WITH(read_surface(folder.write("a.off", with(good_off, "8 12 0", "353535235358 12 0"))),
                    Contains("line 2: the number of vertices is 353535235358, more than the file can hold"));
  std::string many = binary_ply<double>(box, std::endian::big);
  many[many.find("end_header") + 12] = '\xff';  // a list of 255 where 4 bytes are left of its values
  CHECK_THROWS_AS(read_surface(folder.write("list.ply", many)), io_error);
}

TEST_CASE("polygons are cut into triangles") {
  const test::TemporaryFolder folder;
  const SoupSurface cube =
      read_surface(folder.write("cube.obj",
                                "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n"
                                "f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n"));
  CHECK(cube.surface.triangles.size() == 12);
  CHECK_NOTHROW(validate_closed(cube.surface));
  CHECK(enclosed_volume(cube.surface) == Approx(1));
}

TEST_CASE("polygons that are not convex are cut inside") {
  // A comb of teeth, its corners in a plane askew, starting at each of them.
  std::vector<Eigen::Vector2d> comb{{0, 0}, {5, 0}, {5, 3}, {4, 1}, {3, 3}, {2, 1}, {1, 3}};
  double area = 0;
  for (std::size_t i = 0; i < comb.size(); ++i) {
    const auto &a = comb[i], &b = comb[(i + 1) % comb.size()];
    area += (a.x() * b.y() - a.y() * b.x()) / 2;
  }
  for (std::size_t start = 0; start < comb.size(); ++start) {
    IndexedTriangleMesh soup;
    std::vector<index_t> polygon;
    for (std::size_t i = 0; i < comb.size(); ++i) {
      const auto& p = comb[(start + i) % comb.size()];
      soup.points.emplace_back(p.x(), p.y(), p.x() - p.y());
      polygon.push_back(static_cast<index_t>(i));
    }
    append_polygon(soup, polygon);
    REQUIRE(soup.triangles.size() == 5);
    double sum = 0;
    for (const auto& t : soup.triangles) {
      const Vector3 u = soup.points[t[1]] - soup.points[t[0]], v = soup.points[t[2]] - soup.points[t[0]];
      CHECK(u.cross(v).z() > 0);
      sum += u.cross(v).z() / 2;
    }
    CHECK(sum == Approx(area));
  }
}

TEST_CASE("triangles of mixed orientation are turned outward and counted") {
  std::mt19937_64 random(3);
  for (int round = 0; round < 20; ++round) {
    IndexedTriangleMesh sphere = test::sphere_surface(1, 1);
    std::size_t n_turned = 0;
    for (std::size_t t = 0; t < sphere.triangles.size(); ++t)
      if (round == 0 || random() % 3 == 0) {
        turn(sphere, t);
        ++n_turned;
      }
    const SoupSurface result = surface_of_soup(sphere);
    CHECK(result.n_turned_triangles == n_turned);
    CHECK_NOTHROW(validate_closed(result.surface));
    CHECK(enclosed_volume(result.surface) > 0);
  }
}

TEST_CASE("cavities look inward") {
  const double expected = 1 - 0.125;
  IndexedTriangleMesh boxes = nested_boxes(0.5);  // the inner one turned like the outer one
  const SoupSurface result = surface_of_soup(boxes);
  CHECK(result.n_turned_triangles == 12);
  CHECK(enclosed_volume(result.surface) == Approx(expected));
  CHECK(surface_of_soup(result.surface).n_turned_triangles == 0);
  turn(boxes, 3);
  turn(boxes, 20);
  CHECK(enclosed_volume(surface_of_soup(boxes).surface) == Approx(expected));
}

TEST_CASE("vertices that differ by rounding are welded where that closes the surface, and only there") {
  std::mt19937_64 random(5);
  const IndexedTriangleMesh box = test::box_surface({1, 1, 1}, 3, 3, 3);
  IndexedTriangleMesh soup;
  for (const auto& t : box.triangles) {
    const auto first = static_cast<index_t>(soup.points.size());
    for (const index_t v : t) {
      const double noise = 1e-8 * static_cast<double>(random() % 10);
      soup.points.push_back(box.points[v] + Vector3::Constant(noise));
    }
    soup.triangles.push_back({first, first + 1, first + 2});
  }
  const SoupSurface result = surface_of_soup(soup);
  CHECK(result.welded_by_tolerance);
  CHECK(result.surface.points.size() == box.points.size());
  CHECK_NOTHROW(validate_closed(result.surface));

  // A needle thinner than the tolerance survives when the surface is closed as it is.
  IndexedTriangleMesh needle = test::box_surface({1, 1, 1e-9});
  CHECK(surface_of_soup(needle).surface.points.size() == 8);
}

TEST_CASE("triangles that lose a corner by welding are dropped and counted") {
  IndexedTriangleMesh box = test::box_surface({1, 1, 1});
  box.points.push_back(box.points[2]);
  box.triangles.push_back({2, static_cast<index_t>(box.points.size() - 1), 3});
  const SoupSurface result = surface_of_soup(box);
  CHECK(result.n_dropped_triangles == 1);
  CHECK_NOTHROW(validate_closed(result.surface));
}

TEST_CASE("vertices that no triangle uses are left out") {
  const test::TemporaryFolder folder;
  IndexedTriangleMesh box = test::box_surface({1, 1, 1});
  const std::size_t n = box.points.size();
  box.points.insert(box.points.begin() + 3, Vector3(2, 2, 2));
  box.points.emplace_back(0.5, 0.5, 1);
  for (auto& t : box.triangles)
    for (index_t& v : t) v += v >= 3 ? 1 : 0;
  folder.write("box.off", off(box));
  folder.write("box.ply", ply(box));
  for (const char* name : {"box.off", "box.ply"}) {
    const IndexedTriangleMesh read = read_surface(folder / name).surface;
    CHECK(read.points.size() == n);
    CHECK(enclosed_volume(read) == Approx(1));
    CHECK_NOTHROW(validate_closed(read));
  }
}

TEST_CASE("vertices that no triangle uses take no place of those that some do, not even NaN", "[regression]") {
  const IndexedTriangleMesh box = test::box_surface({1, 1, 1}, 2, 2, 2);
  for (std::size_t k = 0; k < box.points.size(); ++k)
    for (int axis = 0; axis < 3; ++axis) {
      IndexedTriangleMesh soup = box;
      soup.points.insert(soup.points.begin(), box.points[k]);
      soup.points[0][axis] = std::nan("");
      for (auto& t : soup.triangles)
        for (index_t& v : t) ++v;
      CHECK(surface_of_soup(soup).surface.points == box.points);
    }
}

TEST_CASE("a polygon of a vertex that the file does not have is refused with file and polygon") {
  const test::TemporaryFolder folder;
  const IndexedTriangleMesh box = test::box_surface({1, 1, 1});
  for (const std::string bad : {"99", "-1"}) {
    folder.write("box.off", "# a comment\n" + off(box) + "# another\n3 0 1 " + bad + "\n");
    CHECK_NOTHROW(read_surface(folder / "box.off"));  // beyond what the header counts
    std::string text = off(box);
    if (bad == "-1") text.replace(3, 1, " ");  // the counts on the first line
    folder.write("box.off", text);
    CHECK(read_surface(folder / "box.off").surface.triangles == box.triangles);
    text.replace(text.rfind("\n3 ") + 1, text.npos, "3 0 1 " + bad + "\n");
    folder.write("box.off", text);
    const std::string polygon = std::to_string(box.triangles.size() - 1);
    CHECK_THROWS_AS(read_surface(folder / "box.off"), invalid_connectivity);
    CHECK_THROWS_WITH(read_surface(folder / "box.off"),
                      Contains("box.off: polygon " + polygon + " refers to vertex " + bad));
  }
}

TEST_CASE("a coordinate that is not finite is refused with file, vertex and triangle") {
  const test::TemporaryFolder folder;
  for (const double bad : {std::nan(""), HUGE_VAL}) {
    IndexedTriangleMesh box = test::box_surface({1, 1, 1});
    box.points[6].y() = bad;
    folder.write("ascii.stl", ascii_stl(box));
    folder.write("binary.stl", binary_stl(box));
    folder.write("box.obj", obj(box));
    folder.write("box.off", off(box));
    folder.write("box.ply", ply(box));
    for (const char* name : {"ascii.stl", "binary.stl", "box.obj", "box.off", "box.ply"}) {
      INFO(name);
      CHECK_THROWS_AS(read_surface(folder / name), invalid_coordinate);
      CHECK_THROWS_WITH(read_surface(folder / name), Contains(std::string(name) + ": vertex") && Contains("triangle"));
    }
  }
}

TEST_CASE("what is no surface is refused by name, in one line") {
  const test::TemporaryFolder folder;
  const auto message = [&](const std::filesystem::path& path) -> std::string {
    try {
      read_surface(path);
    } catch (const error& e) {
      const std::string text = e.what();
      CHECK(text.starts_with(path.string() + ": "));
      CHECK(text.find('\n') == text.npos);
      CHECK(text.find("$$$") == text.npos);
      return text.substr(path.string().size() + 2);
    }
    return "no error";
  };
  CHECK(message(folder / "none.stl") == "cannot be read (No such file or directory)");
  CHECK(message(folder.path()).starts_with("unknown extension"));
  CHECK(message(folder.write("surface.step", "")).starts_with("unknown extension of a surface"));
  for (const char* name : {"a.stl", "a.obj", "a.off", "a.ply"}) {
    INFO(name);
    CHECK(message(folder.write(name, "")) == "is empty");
    CHECK(message(folder.write(name, "hello\n")) != "no error");
    CHECK(message(folder.write(name, std::string(500, '\xff'))) != "no error");
  }
  CHECK(message(folder.write("none.stl", "solid x\nendsolid x\n")) != "no error");
  IndexedTriangleMesh bad = test::box_surface({1, 1, 1});
  bad.triangles.push_back({0, 1, 20});
  CHECK(message(folder.write("range.obj", obj(bad))) != "no error");
  CHECK(message(folder.write("range.ply", ply(bad))) == "polygon 12 refers to vertex 20 of 8");
}

TEST_CASE("damaged surfaces are refused or read, never worse", "[robustness]") {
  const test::TemporaryFolder folder;
  const IndexedTriangleMesh box = test::box_surface({1, 1, 1});
  const std::vector<std::pair<std::string, std::string>> samples{
      {"ascii.stl", ascii_stl(box)}, {"binary.stl", binary_stl(box)},
      {"box.obj", obj(box)},         {"box.off", off(box)},
      {"box.ply", ply(box)},         {"big.ply", binary_ply<double>(box, std::endian::big)}};
  std::mt19937_64 random(11);
  for (const auto& [name, bytes] : samples)
    for (std::size_t i = 0; i < 1000; ++i) {
      std::string damaged = i < 50 ? bytes.substr(0, bytes.size() * i / 50) : bytes;
      if (i >= 50) damaged[random() % damaged.size()] = static_cast<char>(random());
      try {
        const SoupSurface read = read_surface(folder.write(name, damaged));
        for (const auto& t : read.surface.triangles)
          for (const index_t v : t) REQUIRE(v < read.surface.points.size());
      } catch (const error& e) {
        CHECK_THAT(e.what(), Contains(name));
      }
    }
}
