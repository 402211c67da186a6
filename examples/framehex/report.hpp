// SPDX-License-Identifier: BSL-1.0
// The report of a run: a row of the paper's Table 2 on the terminal, and JSON.
#pragma once

#include "framehex/io/data_array.hpp"
#include "framehex/io/label_arrays.hpp"
#include "framehex/mesh/midside_nodes.hpp"
#include "framehex/mesh/mixed_mesh.hpp"
#include "framehex/pipeline/recombine.hpp"

#include "measures.hpp"
#include "options.hpp"

#include <nlohmann/json.hpp>

namespace program {

/// `seconds`, `candidates`, `selection`, `assembly` of a recombination, and `hex_ratio.floor`.
void add_to(nlohmann::ordered_json& json, const framehex::Recombination& recombination, const Options& options);

/// `seconds`, and `assembly`.
void add_to(nlohmann::ordered_json& json, const framehex::StageSeconds& seconds);
void add_to(nlohmann::ordered_json& json, const framehex::AssemblyStatistics& assembly, std::size_t n_given_up);

/// `groups`: names of labels, and how many elements of the mesh each has.
void add_groups(nlohmann::ordered_json& json, const framehex::MixedMesh& mesh);

/// Adds what every report has: `peak_memory_bytes`, `options`, `version`.
void finish(nlohmann::ordered_json& json, const Options& options);

/// Arrays by cell for the file: `scaled_jacobian`, and `open_quads` where there are any.
std::vector<framehex::DataArray> cell_arrays(const Measures& measures);

/// Writes mesh and report; when one of them cannot be written neither appears.
void write_results(const Options& options, const framehex::MixedMesh& mesh, const framehex::MeshData& data,
                   const nlohmann::ordered_json& json, const framehex::MidsideNodes* midside = nullptr);
void write_report(const Options& options, const nlohmann::ordered_json& json);

/// Refuses, before any work, output that could not be written in the end. @throws io_error.
void check_outputs(const Options& options);
void check_report(const Options& options);  // the report alone, and that it takes no other file's place

/// A remark on the input, on standard error, unless nothing but errors is wanted.
void remark(const Options& options, const std::string& text);

/// Says which array of a file was taken for labels, where there are others that were not.
void remark_arrays(const Options& options, const framehex::MeshReadNotes& notes, const std::string& labels);

/// Reads the mesh that the options name, with remarks on its arrays; for a view, the arrays too.
framehex::MixedMesh read_input_mesh(const Options& options);
framehex::MixedMesh read_input_mesh(const Options& options, framehex::MeshReadNotes& notes);

/// Prints header and row. Times are those of `seconds`.
void print_row(const std::string& name, const Measures& measures, const framehex::StageSeconds& seconds);

/// A few lines on faults, if there are any.
void print_faults(const Measures& measures);

}  // namespace program
