// SPDX-License-Identifier: BSL-1.0
#include "framehex/adapters/gmsh.hpp"
#include "framehex/pipeline/recombine_into.hpp"
#include "support/host_reference.hpp"

using namespace framehex;

namespace {

struct Gmsh {
  Gmsh() {
    gmsh::initialize();
    gmsh::option::setNumber("General.Terminal", 0);
  }
  ~Gmsh() { gmsh::finalize(); }
};

/// All solid cells of the current model, in order of their tags.
MixedMesh from_model() {
  MixedMesh mesh;
  std::vector<std::size_t> tags;
  std::vector<double> x, parametric;
  gmsh::model::mesh::getNodes(tags, x, parametric);
  mesh.points.resize(tags.size());
  for (std::size_t i = 0; i < tags.size(); ++i)
    mesh.points[tags[i] - 1] = Vector3(x[3 * i], x[3 * i + 1], x[3 * i + 2]);
  for (const CellKind kind : all_cell_kinds) {
    std::vector<std::size_t> elements, nodes;
    gmsh::model::mesh::getElementsByType(detail::gmsh_type(kind), elements, nodes);
    const auto n = static_cast<std::size_t>(n_corners(kind));
    for (std::size_t c = 0; c < elements.size(); ++c) {
      std::vector<index_t> corners;
      for (std::size_t i = 0; i < n; ++i) corners.push_back(static_cast<index_t>(nodes[n * c + i] - 1));
      mesh.add(kind, corners);
    }
  }
  return mesh;
}

}  // namespace

TEST_CASE("a model of Gmsh takes the result, and its tetrahedra are a mesh") {
  const Gmsh session;
  const auto& reference = test::host_reference();
  MixedMesh tets;  // the reference in Gmsh
  tets.points = reference.mesh.points;
  for (std::size_t c = 0; c < reference.mesh.tets.size(); ++c) tets.add(CellKind::tetrahedron, reference.mesh.tets[c]);
  tets.regions = std::vector<index_t>(reference.mesh.tets.size(), 3);
  tets.faces = reference.faces;
  tets.groups = {{3, 4, "steel", {3}}, {2, 1, "inlet", {7}}};
  GmshOutput input("tets");
  export_mesh(tets, input);
  input.finish();

  const GmshTets read = read_gmsh_model();
  test::check_host(read.mesh);
  CHECK(read.regions == tets.regions);
  REQUIRE(read.faces.size() == reference.faces.size());
  for (const LabelledFace& face : read.faces) CHECK(face.label == 7);
  REQUIRE(read.groups.size() == 2);
  const LabelGroup& inlet = read.groups[read.groups[0].dimension == 2 ? 0 : 1];
  CHECK(inlet.name == "inlet");
  CHECK(inlet.number == 1);
  CHECK(inlet.labels == std::vector<index_t>{7});

  GmshOutput output("mixed");
  export_mesh(reference.result.mesh, output);
  output.finish();
  test::check_same_cells(from_model(), reference.result.mesh);
  gmsh::vectorpair groups;
  gmsh::model::getPhysicalGroups(groups);
  CHECK(groups.size() == 3);
  if (const char* const folder = std::getenv("FRAMEHEX_KEEP_MESHES")) gmsh::write(std::string(folder) + "/gmsh.msh");
}

TEST_CASE("what Gmsh makes of two boxes is recombined, and their physical groups are kept") {
  const Gmsh session;
  gmsh::model::add("boxes");
  gmsh::model::occ::addBox(0, 0, 0, 1, 1, 1);
  gmsh::model::occ::addBox(1, 0, 0, 1, 1, 1);
  gmsh::vectorpair out;
  std::vector<gmsh::vectorpair> map;
  gmsh::model::occ::fragment({{3, 1}}, {{3, 2}}, out, map);
  gmsh::model::occ::synchronize();
  gmsh::model::addPhysicalGroup(3, {1}, 11);
  gmsh::model::setPhysicalName(3, 11, "left");
  gmsh::model::addPhysicalGroup(3, {2}, 12);
  gmsh::model::setPhysicalName(3, 12, "right");
  gmsh::option::setNumber("Mesh.MeshSizeMax", 0.34);
  gmsh::model::mesh::generate(3);

  const GmshTets tets = read_gmsh_model();
  REQUIRE(tets.mesh.tets.size() > 100);
  CHECK_NOTHROW(validate(tets.mesh));
  const RecombineOptions options{.regions = tets.regions, .faces = tets.faces, .edges = tets.edges};
  Recombination result = recombine(tets.mesh, options);
  CHECK(verify::is_conforming(result.mesh));
  result.mesh.groups = tets.groups;
  GmshOutput output("recombined");
  export_mesh(result.mesh, output);
  output.finish();

  for (const auto& [tag, name, entity] : {std::tuple(11, "left", 1), std::tuple(12, "right", 2)}) {
    std::string found;
    gmsh::model::getPhysicalName(3, tag, found);
    CHECK(found == name);
    std::vector<int> entities;
    gmsh::model::getEntitiesForPhysicalGroup(3, tag, entities);
    CHECK(entities == std::vector<int>{entity});
  }
  test::check_same_cells(from_model(), result.mesh);
  for (std::size_t c = 0; c < result.mesh.n_cells(); ++c) {
    double x = 0;
    for (const index_t v : result.mesh.cells[c]) x += result.mesh.points[v].x();
    CHECK((x / n_corners(result.mesh.kinds[c]) < 1) == (result.mesh.regions[c] == 0));
  }
}

TEST_CASE("solid elements that are no tetrahedra are refused with their tag") {
  const Gmsh session;
  GmshOutput output("mixed");
  export_mesh(test::host_reference().result.mesh, output);
  output.finish();
  CHECK_THROWS_AS(read_gmsh_model(), invalid_connectivity);
}

TEST_CASE("labels and groups without a tag in Gmsh are refused") {
  GmshOutput output("labels");
  const std::vector<std::size_t> corners{1, 2, 3, 4};
  CHECK_NOTHROW(output.add_cell(CellKind::tetrahedron, corners, 2147483646u));
  CHECK_THROWS_AS(output.add_cell(CellKind::tetrahedron, corners, 2147483647u), io_error);
  CHECK_THROWS_AS(output.add_face(std::span(corners).first(3), 4000000000u), io_error);
  CHECK_THROWS_AS(output.add_edge(std::span(corners).first<2>(), 2147483647u), io_error);
  CHECK_THROWS_AS(output.add_group({3, 2147483647u, "steel", {}}), io_error);
}
