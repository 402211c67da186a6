// SPDX-License-Identifier: BSL-1.0
#include "framehex/adapters/mesh_reader.hpp"

#include "commands.hpp"
#include "library_options.hpp"
#include "report.hpp"

namespace program {

bool recombine(const Options& options, const framehex::Observer& observer) {
  const framehex::MixedMesh input = framehex::read_mesh(options.input);
  const framehex::IndexedTetMesh tets = framehex::tetrahedra_of(input);
  framehex::RecombineOptions recombine_options = program::recombine_options(options, observer);
  recombine_options.regions = input.regions;
  recombine_options.faces = input.faces;
  recombine_options.edges = input.edges;
  const framehex::Recombination result =
      framehex::recombine(tets, recombine_options, framehex::ThreadExecutor(options.threads));
  if (result.status == framehex::Status::cancelled) return false;

  const Measures measures = measure(result.mesh);
  nlohmann::ordered_json json;
  add_to(json, measures);
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
