// SPDX-License-Identifier: BSL-1.0
#include "framehex/adapters/tetgen.hpp"
#include "support/host_reference.hpp"

using namespace framehex;

namespace {

/// A copy of the reference, counted from `first`; `corners` 10: with nodes on the edges, which must not be read.
void fill(tetgenio& io, int first, int corners) {
  const auto& reference = test::host_reference();
  io.firstnumber = first;
  io.numberofcorners = corners;
  io.numberofpoints = static_cast<int>(reference.mesh.points.size());
  io.pointlist = new double[3 * reference.mesh.points.size()];
  for (std::size_t v = 0; v < reference.mesh.points.size(); ++v)
    std::copy_n(reference.mesh.points[v].data(), 3, io.pointlist + 3 * v);
  io.numberoftetrahedra = static_cast<int>(reference.mesh.tets.size());
  io.tetrahedronlist = new int[static_cast<std::size_t>(corners) * reference.mesh.tets.size()];
  for (std::size_t c = 0; c < reference.mesh.tets.size(); ++c)
    for (std::size_t i = 0; i < static_cast<std::size_t>(corners); ++i)
      io.tetrahedronlist[static_cast<std::size_t>(corners) * c + i] =
          i < 4 ? static_cast<int>(reference.mesh.tets[c][i]) + first : -9;
}

const std::vector<Vector3> cube_points{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0},
                                       {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
const std::vector<std::array<index_t, 3>> cube_triangles{{0, 2, 1}, {0, 3, 2}, {4, 5, 6}, {4, 6, 7},
                                                         {0, 1, 5}, {0, 5, 4}, {1, 2, 6}, {1, 6, 5},
                                                         {2, 3, 7}, {2, 7, 6}, {3, 0, 4}, {3, 4, 7}};

}  // namespace

TEST_CASE("tetgenio is a tetrahedral mesh, counted from 0 or 1, with or without nodes on edges") {
  for (const int first : {0, 1})
    for (const int corners : {4, 10}) {
      tetgenio io;
      fill(io, first, corners);
      test::check_host(io);
    }
}

TEST_CASE("TetGen's own output: orientation, regions, faces") {
  tetgenio in, out;
  detail::fill_tetgen_input({cube_points, 8, cube_triangles}, in);
  in.facetmarkerlist = new int[cube_triangles.size()];
  for (std::size_t f = 0; f < cube_triangles.size(); ++f) in.facetmarkerlist[f] = static_cast<int>(f / 2) + 1;
  in.numberofregions = 1;
  in.regionlist = new double[5]{0.4, 0.5, 0.6, 12, 0};
  std::string switches = "pAa0.05fQ";
  ::tetrahedralize(switches.data(), &in, &out);

  REQUIRE(out.numberoftetrahedra > 20);
  CHECK_NOTHROW(validate(out));
  const auto regions = tetgen_regions(out);
  REQUIRE(regions.size() == static_cast<std::size_t>(out.numberoftetrahedra));
  CHECK(std::count(regions.begin(), regions.end(), 12u) == out.numberoftetrahedra);
  const auto faces = tetgen_faces(out);
  const auto boundary = extract_boundary(out, make_adjacency(out));
  CHECK(faces.size() == boundary.surface.triangles.size());  // of all faces (switch f) those inside have no label
  const auto points = positions(out);
  for (const LabelledFace& face : faces) {
    REQUIRE((face.label >= 1 && face.label <= 6));
    const int axis = std::array{2, 2, 1, 0, 1, 0}[face.label - 1];
    for (std::size_t i = 0; i < 3; ++i)
      CHECK(points[face.vertices[i]][axis] == std::array{0., 1., 0., 1., 1., 0.}[face.label - 1]);
  }
  const Recombination result = recombine(out, {.regions = regions, .faces = faces});
  CHECK(verify::is_conforming(result.mesh));
  CHECK(verify::is_valid(result.mesh));
}

TEST_CASE("tetgenio: attributes that are no labels are refused with their tetrahedron") {
  tetgenio io;
  fill(io, 0, 4);
  CHECK(tetgen_regions(io).empty());
  CHECK(tetgen_faces(io).empty());
  CHECK(tetgen_edges(io).empty());
  io.numberoftetrahedronattributes = 2;
  const auto n = static_cast<std::size_t>(io.numberoftetrahedra);
  io.tetrahedronattributelist = new double[2 * n]();
  CHECK(tetgen_regions(io) == std::vector<index_t>(n, 0));
  for (const double wrong : {-1.0, 0.5, 1e10, std::nan("")}) {
    io.tetrahedronattributelist[7] = wrong;
    try {
      tetgen_regions(io);
      FAIL();
    } catch (const invalid_option& e) {
      CHECK(e.indices() == std::vector<std::size_t>{3});
    }
  }
}

TEST_CASE("TetGen within the process fills a surface, and refuses one that crosses itself") {
  const std::vector<Vector3> inside{{0.5, 0.5, 0.5}, {0.3, 0.4, 0.6}};
  const IndexedTriangleMesh cube{cube_points, cube_triangles};
  const auto filled = tetrahedralize(TetgenLibrary{}, cube, inside);
  CHECK(filled.n_extra_points == 0);
  CHECK(enclosed_volume(extract_boundary(filled.mesh, filled.adjacency).surface) == Approx(1));

  IndexedTriangleMesh crossing = cube;  // a second cube that sticks half in the first
  for (const Vector3& p : cube_points) crossing.points.push_back(p + Vector3(0.5, 0.3, 0.2));
  for (const auto& t : cube_triangles) crossing.triangles.push_back({t[0] + 8, t[1] + 8, t[2] + 8});
  try {
    tetrahedralize(TetgenLibrary{}, crossing, std::span<const Vector3>{});
    FAIL();
  } catch (const invalid_surface& e) {
    REQUIRE(e.indices().size() == 2);
    CHECK(e.indices()[0] < 12);
    CHECK(e.indices()[1] >= 12);
  }
}

TEST_CASE("TetGen within the process leaves cavities empty") {
  IndexedTriangleMesh hollow{cube_points, cube_triangles};
  for (const Vector3& corner : {Vector3(0.1, 0.2, 0.3), Vector3(0.6, 0.6, 0.6)}) {
    const auto first = static_cast<index_t>(hollow.points.size());
    for (const Vector3& p : cube_points) hollow.points.push_back(corner + 0.25 * p);
    for (const auto& t : cube_triangles) hollow.triangles.push_back({t[0] + first, t[2] + first, t[1] + first});
  }
  const auto filled = tetrahedralize(TetgenLibrary{}, hollow, std::span<const Vector3>{});
  double volume = 0;
  for (const auto& t : filled.mesh.tets) {
    const auto& p = filled.mesh.points;
    volume += (p[t[1]] - p[t[0]]).cross(p[t[2]] - p[t[0]]).dot(p[t[3]] - p[t[0]]) / 6;
  }
  CHECK(volume == Approx(1 - 2 * 0.25 * 0.25 * 0.25));
}
