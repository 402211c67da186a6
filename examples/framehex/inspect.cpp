// SPDX-License-Identifier: BSL-1.0
#include "framehex/adapters/mesh_reader.hpp"

#include "commands.hpp"
#include "report.hpp"

namespace program {

bool inspect(const Options& options) {
  const framehex::MixedMesh mesh = framehex::read_mesh(options.input);
  const Measures measures = measure(mesh);
  nlohmann::ordered_json json;
  add_to(json, measures);
  finish(json, options);
  write_report(options, json);
  if (!options.quiet) {
    print_row(std::filesystem::path(options.input).filename().string(), measures, {});
    print_faults(measures);
  }
  return true;
}

}  // namespace program
