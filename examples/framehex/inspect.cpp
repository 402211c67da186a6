// SPDX-License-Identifier: BSL-1.0
#include "commands.hpp"
#include "report.hpp"

#include <filesystem>

namespace program {

bool inspect(const Options& options) {
  const framehex::MixedMesh mesh = read_input_mesh(options);
  if (mesh.n_cells() == 0) return inspect_faces(options, mesh);
  const Measures measures = measure(mesh);
  nlohmann::ordered_json json;
  add_to(json, measures);
  add_groups(json, mesh);
  finish(json, options);
  if (options.command == Command::view)
    write_results(options, mesh, {.cells = cell_arrays(measures), .points = {}}, json);
  else
    write_report(options, json);
  if (!options.quiet) {
    print_row(std::filesystem::path(options.input).filename().string(), measures, {});
    print_faults(measures);
  }
  return true;
}

}  // namespace program
