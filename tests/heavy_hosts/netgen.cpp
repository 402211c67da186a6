// SPDX-License-Identifier: BSL-1.0
#include "framehex/adapters/netgen.hpp"
#include "support/host_reference.hpp"
#include "support/temporary_folder.hpp"

#include <fstream>

using namespace framehex;
using namespace nglib;

namespace {

/// nglib's types are opaque pointers; it must be told to begin and to end.
struct Netgen {
  Netgen() { Ng_Init(); }
  ~Netgen() {
    Ng_DeleteMesh(mesh);
    Ng_Exit();
  }
  Ng_Mesh* mesh = Ng_NewMesh();

  void add(const Vector3& p) {
    std::array<double, 3> x{p.x(), p.y(), p.z()};
    Ng_AddPoint(mesh, x.data());
  }
};

}  // namespace

TEST_CASE("Netgen's volume elements are a tetrahedral mesh") {
  Netgen host;
  for (const Vector3& p : test::host_reference().mesh.points) host.add(p);
  for (const auto& t : test::host_reference().mesh.tets) {
    std::array<int, 4> v{};  // Netgen's order is the mirror image
    for (std::size_t i = 0; i < 4; ++i) v[i] = static_cast<int>(t[i == 0 ? 1 : i == 1 ? 0 : i]) + 1;
    Ng_AddVolumeElement(host.mesh, NG_TET, v.data());
  }
  test::check_host(NetgenTets(*host.mesh));
}

TEST_CASE("elements of Netgen that are no tetrahedra are refused with their number") {
  const test::TemporaryFolder folder;
  const std::string file = (folder.path() / "pyramid.vol").string();
  std::ofstream(file) << "mesh3d\ndimension\n3\ngeomtype\n0\nsurfaceelements\n0\nvolumeelements\n2\n"
                         "1 4 2 1 3 5\n1 5 1 2 3 4 5\nedgesegmentsgi2\n0\npoints\n5\n"
                         "0 0 0\n1 0 0\n1 1 0\n0 1 0\n0 0 1\nendmesh\n";
  Netgen host;
  Ng_Mesh* const mesh = Ng_LoadMesh(file.c_str());
  REQUIRE(mesh);
  REQUIRE(Ng_GetNE(mesh) == 2);
  try {
    NetgenTets view(*mesh);
    FAIL();
  } catch (const invalid_connectivity& e) {
    CHECK(e.indices() == std::vector<std::size_t>{1});
  }
  Ng_DeleteMesh(mesh);
}

TEST_CASE("what Netgen itself makes of a cube is recombined") {
  Netgen host;
  for (int i = 0; i < 8; ++i) host.add({i & 1 ? 1. : 0., i & 2 ? 1. : 0., i & 4 ? 1. : 0.});
  constexpr int sides[6][4] = {{1, 3, 4, 2}, {5, 6, 8, 7}, {1, 2, 6, 5}, {3, 7, 8, 4}, {1, 5, 7, 3}, {2, 4, 8, 6}};
  for (const auto& s : sides)
    for (int half = 0; half < 2; ++half) {
      std::array<int, 3> v{s[0], s[1 + half], s[2 + half]};
      Ng_AddSurfaceElement(host.mesh, NG_TRIG, v.data());
    }
  Ng_Meshing_Parameters parameters;
  parameters.maxh = 0.3;
  REQUIRE(Ng_GenerateVolumeMesh(host.mesh, &parameters) == NG_OK);
  const NetgenTets view(*host.mesh);
  REQUIRE(view.n_cells() > 5);
  CHECK_NOTHROW(validate(view));
  const Recombination result = recombine(view);
  CHECK(verify::is_conforming(result.mesh));
  CHECK(verify::volume(result.mesh).cells == Approx(1));
}
