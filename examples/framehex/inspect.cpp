// SPDX-License-Identifier: BSL-1.0
#include "commands.hpp"
#include "report.hpp"

#include <algorithm>
#include <filesystem>

namespace program {

namespace {

/// What the cells of a view can be coloured by: arrays of ours, and those of the file under other names. Our own files
/// have the kind as an array, which every page shows.
framehex::MeshData view_data(const Measures& measures, framehex::MeshReadNotes notes) {
  framehex::MeshData data{.cells = cell_arrays(measures), .points = std::move(notes.data.points)};
  for (framehex::DataArray& array : notes.data.cells) {
    const auto has_its_name = [&](const framehex::DataArray& other) { return other.name == array.name; };
    const bool is_ours = array.name == "kind" && notes.label_array == "label";
    if (!is_ours && std::none_of(data.cells.begin(), data.cells.end(), has_its_name))
      data.cells.push_back(std::move(array));
  }
  return data;
}

}  // namespace

bool inspect(const Options& options) {
  framehex::MeshReadNotes notes;
  const framehex::MixedMesh mesh = read_input_mesh(options, notes);
  if (mesh.n_cells() == 0) return inspect_faces(options, mesh);
  const Measures measures = measure(mesh);
  nlohmann::ordered_json json;
  add_to(json, measures);
  add_groups(json, mesh);
  finish(json, options);
  if (options.command == Command::view)
    write_results(options, mesh, view_data(measures, std::move(notes)), json);
  else
    write_report(options, json);
  if (!options.quiet) {
    print_row(std::filesystem::path(options.input).filename().string(), measures, {});
    print_faults(measures);
  }
  return true;
}

}  // namespace program
