// SPDX-License-Identifier: BSL-1.0
#include "framehex/pipeline/mesh_surface.hpp"
#include "framehex/adapters/tetgen_process.hpp"
#include "framehex/mesh/boundary.hpp"
#include "framehex/verify/conformity.hpp"
#include "framehex/verify/validity.hpp"
#include "polycube.hpp"
#include "targets.hpp"

namespace framehex::test {

void fuzz_mesh_surface(std::span<const std::uint8_t> input) {
  Bytes bytes(input);
  const IndexedTetMesh body = polycube(bytes);
  const double h = std::array{3.0, 1.0, 0.7, 0.45}[bytes.below(4)];
  MeshingOptions options;
  options.order = static_cast<PointOrder>(bytes.below(3));
  options.field.method = static_cast<FieldMethod>(bytes.below(3));
  options.features.angle = std::array{0.2, 0.7, 2.0}[bytes.below(3)];
  options.recombination.assembly.interfaces = static_cast<InterfaceMode>(bytes.below(2));
  try {
    const TetAdjacency adjacency = validated_adjacency(body);
    const IndexedTriangleMesh surface = extract_boundary(body, adjacency).surface;
    const MeshingResult result = mesh_surface(
        surface, [h](const Vector3&) { return h; }, TetgenProcess{}, options);
    const verify::ConformityReport conformity = verify::is_conforming(result.recombination.mesh);
    promise(conformity.closed() && conformity.conforming(), "the mesh is closed and conforms");
    promise(verify::is_valid(result.recombination.mesh).invalid_cells.empty(), "every cell is valid");
  } catch (const unsound_mesh&) {
    promise(false, "a mesh that is handed out has passed its check");
  } catch (const error&) {
  }
}

}  // namespace framehex::test
