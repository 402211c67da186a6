// SPDX-License-Identifier: BSL-1.0
#include "report.hpp"

#include "framehex/adapters/mesh_reader.hpp"
#include "framehex/adapters/zlib_compression.hpp"
#include "framehex/version.hpp"

#include <sys/resource.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>

namespace program {

using framehex::OutputFile;

namespace {

std::size_t peak_bytes(int who) {
  rusage usage{};
  getrusage(who, &usage);
  return static_cast<std::size_t>(usage.ru_maxrss) * 1024;
}

bool same_file(const std::string& a, const std::string& b) {
  std::error_code ignored;
  const auto whole = [&](const std::string& name) {
    return std::filesystem::weakly_canonical(std::filesystem::absolute(name, ignored), ignored);
  };
  return whole(a) == whole(b);
}

const char* to_string(framehex::SelectionStatus status) {
  switch (status) {
    case framehex::SelectionStatus::optimal: return "optimal";
    case framehex::SelectionStatus::gap_reached: return "gap_reached";
    case framehex::SelectionStatus::budget_exhausted: return "budget_exhausted";
    default: return "cancelled";
  }
}

}  // namespace

void add_to(nlohmann::ordered_json& json, const framehex::StageSeconds& s) {
  json["seconds"] = {{"background", s.background}, {"field", s.field},
                     {"insertion", s.insertion},   {"tetrahedralization", s.tetrahedralization},
                     {"search", s.search},         {"selection", s.selection},
                     {"assembly", s.assembly},     {"recombination", s.recombination()},
                     {"total", s.total()}};
}

void add_to(nlohmann::ordered_json& json, const framehex::AssemblyStatistics& a, std::size_t n_given_up) {
  json["assembly"] = {{"open_before", a.n_open_quadrilaterals},
                      {"merged", a.n_merged},
                      {"raised", a.n_raised},
                      {"split", a.n_split},
                      {"dissolved", a.n_dissolved},
                      {"refitted", a.n_refitted},
                      {"unfit", a.n_unfit},
                      {"given_up", n_given_up},
                      {"new_vertices", a.n_new_vertices},
                      {"removed_vertices", a.n_removed_vertices}};
}

void add_to(nlohmann::ordered_json& json, const framehex::Recombination& recombination, const Options& options) {
  json["hex_ratio"]["floor"] = options.floor;
  add_to(json, recombination.seconds);
  json["candidates"] = recombination.n_candidates;
  const framehex::Selection& selection = recombination.selection;
  json["selection"] = {{"value", selection.weight},
                       {"bound", selection.bound},
                       {"gap_percent", 100 * selection.gap()},
                       {"status", to_string(selection.status)},
                       {"iterations", selection.iterations}};
  add_to(json, recombination.assembly, recombination.n_given_up);
}

void add_groups(nlohmann::ordered_json& json, const framehex::MixedMesh& mesh) {
  constexpr const char* kinds[] = {"", "curves", "patches", "regions"};
  for (const framehex::LabelGroup& group : mesh.groups) {
    const auto holds = [&](framehex::index_t label) {
      return std::binary_search(group.labels.begin(), group.labels.end(), label);
    };
    std::size_t n = 0;
    if (group.dimension == 1)
      for (const auto& edge : mesh.edges) n += holds(edge.label);
    if (group.dimension == 2)
      for (const auto& face : mesh.faces) n += holds(face.label);
    if (group.dimension == 3)
      for (std::size_t c = 0; c < mesh.n_cells(); ++c) n += holds(mesh.regions.empty() ? 0 : mesh.regions[c]);
    json["groups"].push_back(
        {{"name", group.name}, {"of", kinds[group.dimension]}, {"labels", group.labels}, {"elements", n}});
  }
}

void remark(const Options& options, const std::string& text) {
  if (!options.quiet) std::fprintf(stderr, "framehex: %s: %s\n", options.input.c_str(), text.c_str());
}

void remark_arrays(const Options& options, const framehex::MeshReadNotes& notes, const std::string& labels) {
  std::string unused;
  for (const std::string& name : notes.unused_arrays) unused += (unused.empty() ? "\"" : "\", \"") + name;
  if (!unused.empty())
    remark(options, (notes.label_array.empty() ? "no array was taken for " + labels
                                               : labels + " are those of \"" + notes.label_array + "\"") +
                        "; arrays of integers by cell not used: " + unused + "\"");
}

framehex::MixedMesh read_input_mesh(const Options& options, framehex::MeshReadNotes& notes) {
  const bool is_view = options.command == Command::view;
  const bool optional = is_view || options.command == Command::inspect;
  const auto volume = optional ? framehex::Volume::optional : framehex::Volume::required;
  const auto arrays = is_view ? framehex::FileArrays::read : framehex::FileArrays::skip;
  framehex::MixedMesh mesh =
      framehex::read_mesh(options.input, {.volume = volume, .regions = options.regions, .arrays = arrays}, &notes);
  if (is_view && mesh.n_cells() == 0)
    throw framehex::io_error(
        options.input + ": holds no tetrahedron, pyramid, prism or hexahedron; a view shows meshes of a volume alone");
  if (!is_view) remark_arrays(options, notes, "regions");  // a view shows them all
  return mesh;
}

framehex::MixedMesh read_input_mesh(const Options& options) {
  framehex::MeshReadNotes notes;
  return read_input_mesh(options, notes);
}

void finish(nlohmann::ordered_json& json, const Options& options) {
  json["peak_memory_bytes"] = peak_bytes(RUSAGE_SELF);
  if (options.command == Command::mesh) json["peak_memory_tetrahedralizer_bytes"] = peak_bytes(RUSAGE_CHILDREN);
  json["options"] = to_json(options);
  json["version"] = FRAMEHEX_VERSION;
}

std::vector<framehex::DataArray> cell_arrays(const Measures& measures) {
  std::vector<framehex::DataArray> arrays{{"scaled_jacobian", measures.scaled_jacobian}};
  if (!measures.open_cells.empty()) {
    std::vector<std::uint8_t> n_open(measures.n_cells, 0);
    for (const framehex::index_t cell : measures.open_cells) ++n_open[cell];
    arrays.push_back({"open_quads", std::move(n_open)});
  }
  return arrays;
}

void write_results(const Options& options, const framehex::MixedMesh& mesh, const framehex::MeshData& data,
                   const nlohmann::ordered_json& json, const framehex::MidsideNodes* midside) {
  framehex::MeshWriteOptions write;
  write.midside = midside;
  if (options.compress) write.compression = framehex::zlib_compression();
  if (options.msh == "2.2") write.msh = framehex::MshVersion::v2_2;
  if (options.pyramids == "bricks") write.pyramids = framehex::InpPyramids::degenerate_bricks;
  if (options.report.empty()) return framehex::write_mesh(options.output, mesh, data, write);
  OutputFile report(options.report);
  report.write(json.dump(2) + "\n");
  report.finish();
  framehex::write_mesh(options.output, mesh, data, write);
  report.commit();
}

void write_report(const Options& options, const nlohmann::ordered_json& json) {
  if (options.report.empty()) return;
  OutputFile report(options.report);
  report.write(json.dump(2) + "\n");
  report.commit();
}

namespace {

/// Files that are written are different ones, and none but the mesh may replace the input.
void check_different(const Options& options) {
  const auto clash = [](const std::string& a, const std::string& b) {
    return !a.empty() && !b.empty() && same_file(a, b);
  };
  if (clash(options.output, options.report))
    throw framehex::invalid_option("the mesh and the report cannot both be " + options.output);
  if (clash(options.output, options.crosses))
    throw framehex::invalid_option("the mesh and the crosses (--crosses) cannot both be " + options.output);
  if (clash(options.crosses, options.report))
    throw framehex::invalid_option("the crosses (--crosses) and the report cannot both be " + options.report);
  if (clash(options.input, options.report))
    throw framehex::invalid_option("the report would replace the input, " + options.input);
  if (clash(options.input, options.crosses))
    throw framehex::invalid_option("the crosses (--crosses) would replace the input, " + options.input);
}

/// The format of the output, refused when the command does not write it.
framehex::MeshFormat output_format(const Options& options) {
  using framehex::MeshFormat;
  std::vector<MeshFormat> written;
  std::string what;
  switch (options.command) {
    case Command::field:
      written = {MeshFormat::vtu, MeshFormat::html};
      what = "a field is written as .vtu or .html";
      break;
    case Command::view:
      written = {MeshFormat::html};
      what = "a view is a page, .html";
      break;
    case Command::plane:
    case Command::shell:
      written = {MeshFormat::vtu, MeshFormat::msh, MeshFormat::medit, MeshFormat::inp};
      what = "quadrilaterals are written as .vtu, .msh, .mesh or .inp";
      break;
    default: return framehex::written_mesh_format(options.output);
  }
  std::string why;
  try {
    const MeshFormat format = framehex::mesh_format(options.output);
    if (std::find(written.begin(), written.end(), format) != written.end()) return format;
    if (format == MeshFormat::html || format == MeshFormat::polymesh) why = "is for meshes of a volume; ";
  } catch (const framehex::io_error&) {
    why = "unknown extension; ";
  }
  throw framehex::io_error(options.output + ": " + why + what);
}

}  // namespace

void check_report(const Options& options) {
  check_different(options);
  if (!options.report.empty()) const OutputFile attempt(options.report);
}

void check_outputs(const Options& options) {
  check_report(options);
  if (!options.output.empty()) {
    const framehex::MeshFormat format = output_format(options);
    if (options.quadratic && !framehex::holds_quadratic(format))
      throw framehex::io_error(options.output + ": quadratic elements are written to .vtu, .msh and .inp");
    if (format != framehex::MeshFormat::polymesh) const OutputFile attempt(options.output);
  }
  if (options.crosses.empty()) return;
  if (framehex::detail::lower_text(std::filesystem::path(options.crosses).extension().string()) != ".vtu")
    throw framehex::io_error(options.crosses + ": crosses are written as .vtu");
  const OutputFile attempt(options.crosses);
}

void print_row(const std::string& name, const Measures& m, const framehex::StageSeconds& s) {
  std::printf("%-26s %8s %7s %7s %7s %8s  %8s %8s %8s %8s %8s  %6s %6s  %6s %6s  %6s\n", "", "cells", "tet", "prism",
              "pyramid", "hex", "field s", "insert s", "tets s", "recomb s", "total s", "hex nb", "hex vol", "SJ min",
              "mean", "MB");
  const auto n = [&](framehex::CellKind kind) { return m.kinds[static_cast<std::size_t>(kind)].n; };
  std::printf("%-26s %8zu %7zu %7zu %7zu %8zu  %8.2f %8.2f %8.2f %8.2f %8.2f  %5.1f%% %6.1f%%  %6.3f %6.3f  %6zu\n",
              name.c_str(), m.n_cells, n(framehex::CellKind::tetrahedron), n(framehex::CellKind::prism),
              n(framehex::CellKind::pyramid), n(framehex::CellKind::hexahedron), s.background + s.field, s.insertion,
              s.tetrahedralization, s.recombination(), s.total(), 100 * m.hex_ratio_by_number(),
              100 * m.hex_ratio_by_volume(), m.least, m.mean, peak_bytes(RUSAGE_SELF) / 1'000'000);
}

void print_faults(const Measures& m) {
  const auto list = [](const char* what, const std::vector<framehex::index_t>& cells) {
    if (cells.empty()) return;
    std::printf("%s: %zu (", what, cells.size());
    for (std::size_t i = 0; i < cells.size() && i < 8; ++i) std::printf("%s%u", i == 0 ? "cells " : " ", cells[i]);
    std::printf("%s)\n", cells.size() > 8 ? " ..." : "");
  };
  list("invalid cells", m.invalid_cells);
  list("inverted cells", m.inverted_cells);
  list("quadrilaterals that face two triangles", m.open_cells);
  if (m.n_bad_faces > 0) std::printf("faces that do not match otherwise: %zu\n", m.n_bad_faces);
  if (m.n_open_edges > 0) std::printf("edges at which the boundary is open: %zu\n", m.n_open_edges);
}

}  // namespace program
