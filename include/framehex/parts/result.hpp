// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/assembly/options.hpp"
#include "framehex/mesh/mixed_mesh.hpp"
#include "framehex/option_ranges.hpp"
#include "framehex/parts/partition.hpp"
#include "framehex/recombination/finder_options.hpp"
#include "framehex/selection/select.hpp"

namespace framehex {

/// Options of `recombine_in_parts`. Labels of `finder` and `assembly` are not used: those of regions come with the input.
struct PartsOptions {
  HexFinderOptions finder = {};
  /// Whether contenders are exchanged after greedy (`method` is not `greedy`), and the seed; all of it for a mesh of one
  /// part.
  SelectOptions selection = {.gap = 1, .exact_below = 2000};
  /// Interfaces are closed (`conforming`) or left open; `boundary_projection` must be empty.
  AssemblyOptions assembly = {};
  /// Tetrahedra of a part, at most; 1 or more. A part takes some 1,500 bytes a tetrahedron while it is worked on.
  std::size_t part_size = 250000;
  Observer observer = {};

  template <class Options, class Visit>
  static void each_number(Options& o, Visit&& visit) {
    FinderOptions::each_number(o.finder, visit);
    SelectOptions::each_number(o.selection, visit);
    AssemblyOptions::each_number(o.assembly, visit);
    visit("PartsOptions::part_size", o.part_size, 1, unbounded);
  }
};

/// What one rank holds of a mesh recombined in parts.
struct PartRecombination {
  /// A vertex that another rank has, too.
  struct SharedVertex {
    index_t vertex;
    int rank;
  };

  MixedMesh mesh;                        ///< cells of this rank, by no one else held, and their vertices
  std::vector<global_t> vertex_numbers;  ///< in the whole: those of the host, and new ones from the next number on
  std::vector<global_t> cell_numbers;    ///< from 0 on, by parts
  std::vector<int> owners;               ///< of each vertex: the first rank that has it
  std::vector<SharedVertex> shared;      ///< with every other rank, by vertex, then rank
  std::vector<index_t> moved;            ///< vertices of the host that improvement moved, ascending
  Csr<global_t> cell_of;                 ///< cell -> the host's cells that fill it; none if it is made anew
  std::vector<index_t> chosen;           ///< candidates that this rank found and that were selected, ascending
  std::vector<index_t> candidate_of;     ///< cell -> candidate of the rank that found it, `no_index` for other kinds

  // Of all ranks together.
  std::int64_t n_parts = 0, n_candidates = 0, n_chosen = 0;
  double weight = 0;  ///< of the selection, to 2^-30 of the heaviest candidate
  double bound = 0;   ///< no selection weighs more; parts that compete at their borders are counted as if they did not
  std::size_t n_rounds = 0, n_turns = 0;
  std::int64_t n_kept = 0;      ///< turns of parts that were taken back because their cells did not pass the check
  std::int64_t n_given_up = 0;  ///< chosen hexahedra left out because they could not be closed
  AssemblyStatistics assembly;  ///< of several parts: what was done at open quadrilaterals, and new vertices
  // Of this rank, wall time.
  double search_seconds = 0, selection_seconds = 0, assembly_seconds = 0;
  Status status = Status::complete;
};

}  // namespace framehex
