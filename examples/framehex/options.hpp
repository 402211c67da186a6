// SPDX-License-Identifier: BSL-1.0
// What the command line asks for.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace program {

enum class Command { mesh, recombine, field, inspect, view, plane, shell };

struct Options {
  Command command = Command::mesh;
  std::string input, output, report;   // names of files; empty: none
  std::string regions;                 // array by cell that holds the labels; empty: one of the usual names
  std::optional<double> size;          // wished edge length
  std::optional<std::size_t> cells;    // or about so many cells
  std::string size_field, size_array;  // file with lengths at points; the array by point that holds them
  std::vector<std::string> size_on;    // PATCH=H
  std::optional<double> segments;      // of a circle
  std::optional<double> cells_across;  // thin walls
  std::optional<double> least, most;   // sizes
  double growth = 0.3;                 // of sizes, by distance
  std::optional<double> memory;        // bytes
  std::string field = "best", order = "lattice", front_order = "smoothness", select = "best", interfaces = "conforming";
  std::string match = "exact", crosses;  // of plane and shell: how triangles are joined; file for the cross field
  double feature_degrees = 40;
  double floor = 0.2;
  std::optional<double> gap_percent;  ///< 0.5 unless asked for
  std::optional<double> budget_seconds;
  std::size_t threads = 0;  // 0: as many as the machine has
  std::uint64_t seed = 1;
  bool finite_volume = false;  // cells that suit finite volumes
  bool improve = true;         // move and reconnect what is not a hexahedron
  bool quiet = false;
  std::optional<double> repair;                     // largest tolerance by the box's diagonal; empty: none
  std::optional<double> least_feature;              // what is narrower is merged; empty: a thousandth of the size
  bool compress = false;                            // arrays of .vtu
  std::string msh = "4.1", pyramids = "own";        // how .msh and .inp are written
  std::string bodies = "void";                      // what parts of the surface within others are
  bool quadratic = false;                           // a node on each edge
  std::size_t part_size = 250000;                   // tetrahedra of a part, over MPI
  bool with_field = false;                          // frames at the vertices, over MPI
  bool ignore_faces = false, ignore_edges = false;  // labels of the input
};

/// Reads the command line. On --help and --version, and on a command line that makes no sense, it prints and returns
/// nothing, with the exit status in `exit_status`.
std::optional<Options> parse(int argc, char** argv, int& exit_status);

/// Whether the mesh is to be written in parts, each by a rank: as .pvtu.
bool is_distributed(const Options& options);

/// Those that bear on the command, for the report.
nlohmann::ordered_json to_json(const Options& options);

}  // namespace program
