// SPDX-License-Identifier: BSL-1.0
#include "framehex/adapters/compiled.hpp"
#include "framehex/io/mesh_builder.hpp"
#include "framehex/mesh/listed_labels.hpp"

#include "commands.hpp"
#include "library_options.hpp"
#include "report.hpp"

namespace program {

namespace {

/// Labels that are to count for nothing, or do because the file lists everything, go.
void drop_labels(framehex::MixedMesh& mesh, const framehex::IndexedTetMesh& tets, const Options& options) {
  if (options.ignore_edges) mesh.edges.clear();
  if (mesh.faces.empty() && mesh.edges.empty()) return;
  const framehex::TetAdjacency adjacency = framehex::validated_adjacency(tets);
  const framehex::ListedLabels listed = framehex::drop_listed_labels(mesh, adjacency);
  if (listed.all_faces)
    remark(options, "lists every face: the " + std::to_string(listed.n_faces) + " within regions bound nothing");
  if (listed.all_edges)
    remark(options, "lists every edge: " + std::to_string(listed.n_edges) + " that lie on no curve bound nothing");
  if (options.ignore_faces) framehex::drop_inner_faces(mesh, adjacency);
}

}  // namespace

bool recombine(const Options& options, const framehex::Observer& observer) {
  framehex::MixedMesh input = read_input_mesh(options);
  const framehex::IndexedTetMesh tets = framehex::tetrahedra_of(input);
  drop_labels(input, tets, options);
  framehex::RecombineOptions recombine_options = program::recombine_options(options, observer);
  recombine_options.regions = input.regions;
  recombine_options.faces = input.faces;
  recombine_options.edges = input.edges;
  framehex::Recombination result =
      framehex::recombine(tets, recombine_options, framehex::ThreadExecutor(options.threads));
  if (result.status == framehex::Status::cancelled) return false;

  result.mesh.groups = input.groups;
  const Measures measures = measure(result.mesh);
  nlohmann::ordered_json json;
  add_to(json, measures);
  add_groups(json, result.mesh);
  add_to(json, result, options);
  finish(json, options);
  write_results(options, result.mesh, {.cells = cell_arrays(measures), .points = {}}, json);
  end_progress();
  if (!options.quiet) {
    print_row(std::filesystem::path(options.input).stem().string(), measures, result.seconds);
    print_faults(measures);
  }
  return true;
}

}  // namespace program
