// SPDX-License-Identifier: BSL-1.0
// A box that Gmsh meshes, recombined; the result as another model of Gmsh, with the physical groups of the first.
#include <framehex/adapters/gmsh.hpp>
#include <framehex/pipeline/recombine.hpp>

#include <cstdio>

int main() {
  gmsh::initialize();
  gmsh::option::setNumber("General.Terminal", 0);
  gmsh::model::add("box");
  gmsh::model::occ::addBox(0, 0, 0, 1, 1, 1);
  gmsh::model::occ::synchronize();
  gmsh::model::addPhysicalGroup(3, {1}, 1);
  gmsh::model::setPhysicalName(3, 1, "steel");
  gmsh::option::setNumber("Mesh.MeshSizeMax", 0.2);
  gmsh::model::mesh::generate(3);

  const framehex::GmshTets tets = framehex::read_gmsh_model();
  auto result = framehex::recombine(tets.mesh, {.regions = tets.regions, .faces = tets.faces, .edges = tets.edges});
  result.mesh.groups = tets.groups;
  framehex::GmshOutput output("recombined");
  framehex::export_mesh(result.mesh, output);
  output.finish();
  std::printf("%zu tetrahedra became %zu cells\n", tets.mesh.tets.size(), result.mesh.n_cells());
  gmsh::write("gmsh.msh");
  gmsh::finalize();
}
