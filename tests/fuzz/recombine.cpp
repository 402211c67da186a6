// SPDX-License-Identifier: BSL-1.0
#include "framehex/pipeline/recombine.hpp"
#include "framehex/verify/conformity.hpp"
#include "framehex/verify/validity.hpp"
#include "polycube.hpp"
#include "targets.hpp"

namespace framehex::test {

namespace {

double volume_of(const std::vector<Vector3>& p, const std::array<index_t, 4>& t) {
  return (p[t[1]] - p[t[0]]).cross(p[t[2]] - p[t[0]]).dot(p[t[3]] - p[t[0]]) / 6;
}

double volume_of(const IndexedTetMesh& mesh) {
  double sum = 0;
  for (const auto& t : mesh.tets) sum += volume_of(mesh.points, t);
  return sum;
}

/// The most that the volume can differ because two triangles have become a quadrilateral that is not plane, or face one: a
/// bilinear one lies half-way between its two pairs of triangles.
double twist_of(const Recombination& result) {
  const std::vector<Vector3>& points = result.mesh.points;
  double sum = 0;
  for (const LabelledFace& face : result.mesh.faces)
    if (face.size() == 4) sum += std::abs(volume_of(points, face.vertices)) / 2;
  for (const OpenInterface& interface : result.open) sum += std::abs(volume_of(points, interface.quadrilateral)) / 2;
  return sum;
}

/// Labels, some of them on things that are not there.
struct Labels {
  std::vector<index_t> regions;
  std::vector<LabelledFace> faces;
  std::vector<LabelledEdge> edges;

  Labels(Bytes& bytes, const IndexedTetMesh& mesh) {
    if (bytes.below(2) == 1)
      for (std::size_t t = 0; t < mesh.tets.size(); ++t) regions.push_back(bytes.below(3));
    for (unsigned n = bytes.below(4); n > 0; --n) {
      const auto& t = mesh.tets[bytes.byte() % mesh.tets.size()];
      faces.push_back({{t[0], t[1], t[2], no_index}, bytes.below(3)});
      edges.push_back({{t[bytes.below(4)], t[bytes.below(4)]}, bytes.below(3)});
    }
  }
};

}  // namespace

void fuzz_recombine(std::span<const std::uint8_t> input) {
  Bytes bytes(input);
  const IndexedTetMesh mesh = polycube(bytes);
  const Labels labels(bytes, mesh);
  RecombineOptions options;
  options.regions = labels.regions;
  options.faces = labels.faces;
  options.edges = labels.edges;
  options.finder.quality_floor = std::array{1e-4, 0.2, 0.5}[bytes.below(3)];
  options.assembly.interfaces = static_cast<InterfaceMode>(bytes.below(3));
  options.assembly.improvement = static_cast<ImprovementMode>(bytes.below(2));
  options.assembly.prisms = static_cast<PrismMode>(bytes.below(2));
  options.selection.method = static_cast<SelectMethod>(bytes.below(2));
  try {
    const Recombination result = recombine(mesh, options);
    const verify::ConformityReport conformity = verify::is_conforming(result.mesh);
    promise(conformity.closed(), "the boundary is closed");
    if (options.assembly.interfaces != InterfaceMode::open) promise(conformity.conforming(), "the mesh conforms");
    promise(verify::is_valid(result.mesh).invalid_cells.empty(), "every cell is valid");
    const double wanted = volume_of(mesh);
    promise(std::abs(verify::volume(result.mesh).cells - wanted) < 1e-9 * wanted + twist_of(result),
            "the volume is that of the host");
  } catch (const unsound_mesh&) {
    promise(false, "a mesh that is handed out has passed its check");
  } catch (const error&) {
  }
}

}  // namespace framehex::test
