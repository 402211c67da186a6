// SPDX-License-Identifier: BSL-1.0
#include "options.hpp"

#include "framehex/version.hpp"

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <cmath>
#include <filesystem>
#include <iostream>
#include <limits>

namespace program {

namespace {

/// Numbers that `min` and `max` bound; NaN is in no range.
CLI::Validator in_range(double min, double max, const std::string& text) {
  return CLI::Validator(
      [=](const std::string& word) -> std::string {
        try {
          const double value = std::stod(word);
          if (value >= min && value <= max) return {};
        } catch (const std::exception&) {
        }
        return (word.find_first_not_of(" \t") == word.npos ? "nothing" : word) + " is not " + text;
      },
      text);
}

CLI::Validator positive() {
  return in_range(std::numeric_limits<double>::min(), std::numeric_limits<double>::max(), "a positive number");
}

void add_input(CLI::App& command, Options& options, const char* what) {
  command.add_option("input", options.input, what)->required();
  command.add_option("--report", options.report, "Write the report to this file as well")->type_name("FILE.json");
}

void add_output(CLI::App& command, Options& options, const char* what) {
  command.add_option("-o,--output", options.output, what)->required()->type_name("FILE");
  command.add_flag("--compress", options.compress, "Compress the arrays of a .vtu file");
  command.add_option("--msh", options.msh, "Version of a .msh file")
      ->check(CLI::IsMember({"4.1", "2.2"}))
      ->capture_default_str();
  command
      .add_option("--pyramids", options.pyramids,
                  "What pyramids are in an .inp file: C3D5, or bricks with a repeated node, for CalculiX")
      ->check(CLI::IsMember({"own", "bricks"}))
      ->capture_default_str();
}

void add_regions(CLI::App& command, Options& options) {
  command
      .add_option(
          "--regions", options.regions,
          "Array by cell of a .vtu, .pvtu or .vtk file that tells the regions; without it, one of the usual names")
      ->type_name("ARRAY");
}

void add_run(CLI::App& command, Options& options) {
  command
      .add_option("--threads", options.threads, "Threads; 0: as many as the machine has. Results do not depend on it")
      ->check(in_range(0, 1024, "a number of threads from 0 to 1024"))
      ->type_name("N");
  command.add_flag("--quiet", options.quiet, "Print nothing but errors");
}

/// @param size, cells  the options that say how large cells are by one number.
void add_sizes(CLI::App& command, Options& options, CLI::Option* size, CLI::Option* cells) {
  const auto patch_size = CLI::Validator(
      [](const std::string& word) -> std::string {
        const std::size_t sign = word.rfind('=');
        try {
          if (sign != word.npos && sign > 0 && std::stod(word.substr(sign + 1)) > 0) return {};
        } catch (const std::exception&) {
        }
        return word + " is not PATCH=H with a positive length";
      },
      "");
  command
      .add_option("--size-field", options.size_field,
                  "Wished edge lengths at the points of a mesh of tetrahedra or of a surface")
      ->type_name("FILE.vtu")
      ->excludes(size)
      ->excludes(cells);
  command.add_option("--size-array", options.size_array, "Which array by point of that file holds the lengths")
      ->type_name("ARRAY");
  command.add_option("--curvature", options.segments, "So many edges go round a circle as curved as the surface")
      ->check(in_range(3, 1e4, "a number from 3 to 10000"))
      ->type_name("N");
  command.add_option("--cells-across", options.cells_across, "So many cells go across walls that are thin")
      ->check(in_range(1, 1000, "a number from 1 to 1000"))
      ->type_name("N");
  command
      .add_option("--size-on", options.size_on,
                  "Edge length on a patch, by its name or the number it has in the output; can be repeated")
      ->check(patch_size)
      ->type_name("PATCH=H")
      ->allow_extra_args(false);
  command.add_option("--least", options.least, "No size is smaller; a tenth of the wished size without it")
      ->check(positive())
      ->type_name("H");
  command.add_option("--most", options.most, "No size is larger")->check(positive())->type_name("H");
  command.add_option("--gradation", options.growth, "How fast sizes grow: by so much of the distance")
      ->check(in_range(0.01, 10, "a number from 0.01 to 10"))
      ->type_name("G")
      ->capture_default_str();
}

void add_features(CLI::App& command, Options& options, const std::string& more = "") {
  command
      .add_option("--features", options.feature_degrees,
                  "An edge bent by more than so many degrees is a feature" + more)
      ->check(in_range(0.1, 179.9, "an angle from 0.1 to 179.9"))
      ->type_name("DEGREES")
      ->capture_default_str();
}

void add_field(CLI::App& command, Options& options) {
  command
      .add_option("--field", options.field, "Frame field: of the nearest boundary point, that smoothed, or the best")
      ->check(CLI::IsMember({"nearest", "smoothed", "best"}))
      ->capture_default_str();
  add_features(command, options);
}

void add_recombination(CLI::App& command, Options& options) {
  command.add_option("--floor", options.floor, "Least scaled Jacobian of a hexahedron")
      ->check(in_range(0, 0.99, "a quality from 0 to 0.99"))
      ->type_name("Q")
      ->capture_default_str();
  command.add_option("--select", options.select, "How hexahedra are selected")
      ->check(CLI::IsMember({"greedy", "best", "exact"}))
      ->capture_default_str();
  command
      .add_option("--gap", options.gap_percent,
                  "Prove how little can be missing, and end when it is this; without it no proof is attempted")
      ->check(in_range(0, 100, "a percentage"))
      ->type_name("PERCENT");
  command
      .add_option("--budget", options.budget_seconds,
                  "Time for the selection; without it the result does not depend on the machine's speed")
      ->check(in_range(0, HUGE_VAL, "a time of 0 or more seconds"))
      ->type_name("SECONDS");
  command.add_option("--interfaces", options.interfaces, "What becomes of quadrilaterals that face two triangles")
      ->check(CLI::IsMember({"conforming", "no-pyramids", "open"}))
      ->capture_default_str();
  command.add_flag("!--no-improvement", options.improve,
                   "Leave the vertices in their places: nothing is moved, reconnected or removed to make cells better, "
                   "and no size shrinks for it");
  command.add_flag("--finite-volume", options.finite_volume,
                   "Cells that finite volume solvers take: inner faces look into all directions, faces can be cut into "
                   "tetrahedra with the centres of their cells");
  command.add_option("--seed", options.seed, "Of all random choices")
      ->check(in_range(0, 1e15, "a number from 0 to 1e15"))
      ->type_name("N")
      ->capture_default_str();
}

/// What is wrong with the arguments; where it is the subcommand, the names that there are.
std::string message_of(const CLI::ParseError& e, const CLI::App& app, int argc, char** argv) {
  if (!app.get_subcommands().empty()) return e.what();
  std::string names;
  for (const CLI::App* const command : app.get_subcommands([](const CLI::App*) { return true; }))
    names += (names.empty() ? "" : ", ") + command->get_name();
  const std::string first = argc > 1 ? argv[1] : "";
  if (first.empty()) return "a subcommand is required: " + names;
  return first.starts_with("-") ? std::string(e.what()) : first + " is no subcommand; there are " + names;
}

}  // namespace

std::optional<Options> parse(int argc, char** argv, int& exit_status) {
  Options options;
  CLI::App app(
      "Hex-dominant meshes, from closed surfaces and from tetrahedral meshes; quadrilaterals, from outlines and "
      "surfaces.",
      "framehex");
  app.set_version_flag("--version", FRAMEHEX_VERSION);
  app.require_subcommand(1);

  CLI::App& mesh = *app.add_subcommand(
      "mesh", "Mesh the inside of a closed surface (.stl .obj .off .ply .vtu .vtk .msh .mesh .meshb)");
  mesh.add_option("--patches", options.regions, "Array by cell of a .vtu or .vtk surface that tells the patches")
      ->type_name("ARRAY");
  add_input(mesh, options, "The surface");
  add_output(
      mesh, options,
      "The mesh: .vtu, .msh (Gmsh), .mesh (MEDIT), .inp (Abaqus, CalculiX), a folder polyMesh (OpenFOAM), or .html, a "
      "page that shows it");
  auto* const size = mesh.add_option("--size", options.size, "Wished edge length, in the surface's unit")
                         ->check(positive())
                         ->type_name("H");
  auto* const cells = mesh.add_option("--cells", options.cells,
                                      "Size of which so many cubes have the volume of the body; without either, 10000")
                          ->check(CLI::Range(std::size_t{1}, std::size_t{1'000'000'000}))
                          ->type_name("N")
                          ->excludes(size);
  add_sizes(mesh, options, size, cells);
  mesh.add_option("--bodies", options.bodies,
                  "What closed parts of the surface within others bound: voids, or regions; with regions, faces in "
                  "which bodies touch become one, between them")
      ->check(CLI::IsMember({"void", "regions"}))
      ->capture_default_str();
  mesh.add_option(
          "--repair", options.repair,
          "Mend the surface: weld vertices nearer than T of its box's diagonal (1e-4 without T) where that closes "
          "it, drop repeated triangles, split edges at vertices in their middle; bodies that touch are regions")
      ->check(in_range(0, 0.01, "a tolerance from 0 to 0.01"))
      ->type_name("[T]")
      ->expected(0, 1)
      ->default_str("1e-4");
  mesh.add_option("--least-feature", options.least_feature,
                  "Merge ledges, steps and grooves narrower than L, in the surface's unit; a thousandth of the size "
                  "unless given, 0 for none")
      ->check(CLI::NonNegativeNumber)
      ->type_name("L");
  add_field(mesh, options);
  mesh.add_option(
          "--order", options.order,
          "Placement of points: as one lattice, or by fronts, smoothest field first (the default with --curvature "
          "and --cells-across) or first in first out")
      ->check(CLI::IsMember({"lattice", "smoothness", "fifo"}))
      ->capture_default_str();
  mesh.add_flag("--quadratic", options.quadratic,
                "Quadratic elements, their nodes on the surface where cells stay valid: .vtu, .msh and .inp");
  add_recombination(mesh, options);
  mesh.add_option("--memory", options.memory, "Refuse before any work what is estimated to take more: 500MB, 8GB")
      ->transform(CLI::AsSizeValue(true))
      ->type_name("BYTES");
  add_run(mesh, options);

  CLI::App& recombine =
      *app.add_subcommand("recombine", "Recombine the tetrahedra of a mesh (.vtu .vtk .msh .mesh .meshb)");
  add_input(recombine, options, "The tetrahedral mesh");
  add_output(
      recombine, options,
      "The mesh: .vtu, .msh (Gmsh), .mesh (MEDIT), .inp (Abaqus, CalculiX), a folder polyMesh (OpenFOAM), or .html, a "
      "page that shows it; over MPI .pvtu, a piece for each rank");
  add_regions(recombine, options);
  recombine.add_flag("--ignore-faces", options.ignore_faces,
                     "Labelled faces within a region are none: cells may swallow them");
  recombine.add_flag("--ignore-edges", options.ignore_edges, "Labelled edges are none: cells may swallow them");
  add_recombination(recombine, options);
  recombine.add_flag("--field", options.with_field, "Write the frame field at the vertices as well, to a .pvtu file");
  recombine.add_option("--part-size", options.part_size, "Tetrahedra of a part, at most, for a .pvtu file")
      ->check(in_range(1, 4e9, "a number of tetrahedra"))
      ->capture_default_str();
  add_run(recombine, options);

  CLI::App& plane = *app.add_subcommand("plane", "Mesh a planar domain with quadrilaterals");
  add_input(plane, options, "Its outline: loops as text (a point \"x y\" a line), or lines of an .obj file or a mesh");
  CLI::App& shell = *app.add_subcommand("shell", "Mesh a surface, open or closed, with quadrilaterals");
  add_input(shell, options, "The surface (.stl .obj .off .ply .vtu .vtk .msh .mesh .meshb)");
  for (CLI::App* const command : {&plane, &shell}) {
    add_output(*command, options, "The mesh: .vtu, .msh (Gmsh), .mesh (MEDIT) or .inp (Abaqus, CalculiX)");
    command->add_option("--size", options.size, "Wished edge length")->check(positive())->type_name("H")->required();
    add_features(*command, options,
                 ", and a bend of a curve a corner, a bend between long straight parts from a quarter of that on");
    command->add_option("--order", options.front_order, "Which point proposes its neighbours next")
        ->check(CLI::IsMember({"fifo", "smoothness"}))
        ->capture_default_str();
    command
        ->add_option("--match", options.match,
                     "exact: quadrilaterals alone, at the least cost; greedy: some triangles stay")
        ->check(CLI::IsMember({"exact", "greedy"}))
        ->capture_default_str();
    command->add_flag("!--no-improvement", options.improve, "Change no more than it takes to unfold cells");
    command->add_option("--crosses", options.crosses, "Write the cross field to this file as well")
        ->type_name("FILE.vtu");
    command->add_flag("--quiet", options.quiet, "Print nothing but errors");
  }

  CLI::App& field = *app.add_subcommand("field", "Frame field of a tetrahedral mesh (.vtu .vtk .msh .mesh .meshb)");
  add_input(field, options, "The tetrahedral mesh");
  add_output(field, options, "Frames, smoothness and singular lines: .vtu, or .html, a page that shows them");
  add_field(field, options);
  add_run(field, options);

  CLI::App& inspect =
      *app.add_subcommand("inspect", "Count and judge the cells of any mesh (.vtu .vtk .msh .mesh .meshb)");
  add_input(inspect, options, "The mesh");
  add_regions(inspect, options);
  inspect.add_flag("--quiet", options.quiet, "Print nothing but errors");

  CLI::App& view = *app.add_subcommand("view", "A page that shows any mesh (.vtu .vtk .msh .mesh .meshb) in a browser");
  add_input(view, options, "The mesh");
  view.add_option("-o,--output", options.output, "The page: .html")->required()->type_name("FILE");
  add_regions(view, options);
  view.add_flag("--quiet", options.quiet, "Print nothing but errors");

  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& e) {  // --help, --version
    exit_status = app.exit(e);
    return std::nullopt;
  } catch (const CLI::ParseError& e) {
    std::cerr << "framehex: " << message_of(e, app, argc, argv) << " (see framehex --help)\n";
    exit_status = 2;
    return std::nullopt;
  }
  options.command = mesh.parsed()        ? Command::mesh
                    : recombine.parsed() ? Command::recombine
                    : field.parsed()     ? Command::field
                    : view.parsed()      ? Command::view
                    : plane.parsed()     ? Command::plane
                    : shell.parsed()     ? Command::shell
                                         : Command::inspect;
  // A lattice has four, eight, twelve... steps round a circle, whatever is asked for.
  const bool counts = options.segments || options.cells_across;
  if (counts && mesh["--order"]->empty()) options.order = "smoothness";
  return options;
}

bool is_distributed(const Options& options) {
  return std::filesystem::path(options.output).extension() == ".pvtu";
}

nlohmann::ordered_json to_json(const Options& options) {
  nlohmann::ordered_json json;
  const bool is_mesh = options.command == Command::mesh, is_field = options.command == Command::field;
  const bool is_quads = options.command == Command::plane || options.command == Command::shell;
  constexpr const char* names[] = {"mesh", "recombine", "field", "inspect", "view", "plane", "shell"};
  json["command"] = names[static_cast<int>(options.command)];
  json["input"] = options.input;
  if (!options.output.empty()) json["output"] = options.output;
  if (!options.regions.empty()) json[is_mesh ? "patches" : "regions"] = options.regions;
  if (options.size) json["size"] = *options.size;
  if (options.cells) json["cells"] = *options.cells;
  if (!options.size_field.empty()) json["size_field"] = options.size_field;
  if (!options.size_array.empty()) json["size_array"] = options.size_array;
  if (!options.size_on.empty()) json["size_on"] = options.size_on;
  if (options.segments) json["curvature"] = *options.segments;
  if (options.cells_across) json["cells_across"] = *options.cells_across;
  if (options.least) json["least"] = *options.least;
  if (options.most) json["most"] = *options.most;
  if (options.memory) json["memory"] = *options.memory;
  if (is_mesh) json["gradation"] = options.growth;
  if (is_mesh || is_field) {
    json["field"] = options.field;
    json["features"] = options.feature_degrees;
  }
  if (is_quads) json["features"] = options.feature_degrees;
  if (is_quads) json["match"] = options.match;
  if (is_quads) json["improvement"] = options.improve;
  if (is_mesh) json["order"] = options.order;
  if (is_quads) json["order"] = options.front_order;
  if (is_mesh) json["bodies"] = options.bodies;
  if (options.repair) json["repair"] = *options.repair;
  if (options.least_feature) json["least_feature"] = *options.least_feature;
  if (is_mesh || options.command == Command::recombine) {
    json["floor"] = options.floor;
    json["select"] = options.select;
    if (options.gap_percent) json["gap"] = *options.gap_percent;
    if (options.budget_seconds) json["budget"] = *options.budget_seconds;
    json["interfaces"] = options.interfaces;
    json["improvement"] = options.improve;
    json["finite_volume"] = options.finite_volume;
    json["seed"] = options.seed;
    if (options.quadratic) json["quadratic"] = true;
  }
  if (options.command == Command::recombine) {
    json["ignore_faces"] = options.ignore_faces;
    json["ignore_edges"] = options.ignore_edges;
    if (is_distributed(options)) json["part_size"] = options.part_size;
    if (is_distributed(options)) json["field"] = options.with_field;
  }
  if (options.command != Command::inspect && options.command != Command::view && !is_quads)
    json["threads"] = options.threads;
  return json;
}

}  // namespace program
