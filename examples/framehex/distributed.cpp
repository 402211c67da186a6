// SPDX-License-Identifier: BSL-1.0
// `mpirun -n N framehex recombine IN -o OUT.pvtu`: the parts of a mesh, each on a rank.
#include "framehex/distributed/frame_field.hpp"
#include "framehex/distributed/read_parts.hpp"
#include "framehex/distributed/recombine.hpp"

#include "framehex/io/mesh_writer.hpp"

#include "commands.hpp"
#include "library_options.hpp"
#include "report.hpp"

#include <sys/resource.h>

#include <chrono>
#include <iostream>

namespace program {

namespace {

namespace fd = framehex::distributed;

/// MPI for as long as it is needed. A rank that leaves by an exception that the others do not know of takes them along.
class Session {
public:
  Session() { MPI_Init(nullptr, nullptr); }
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;
  ~Session() { MPI_Finalize(); }
};

double cpu_seconds() {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

fd::RecombineOptions part_options(const Options& options, const framehex::Observer& observer,
                                  std::span<const framehex::index_t> regions) {
  const framehex::RecombineOptions serial = recombine_options(options, observer);
  fd::RecombineOptions result;
  result.parts.finder = serial.finder;
  result.parts.selection = serial.selection;
  result.parts.assembly = serial.assembly;
  result.parts.part_size = options.part_size;
  result.parts.observer = observer;
  result.regions = regions;
  return result;
}

/// Frames at the vertices of the result; those that are new have none (NaN).
framehex::DataArray frames_of(const fd::MpiTransport& transport, const fd::ReadPart& read, const Options& options,
                              const framehex::Observer& observer, const framehex::PartRecombination& result) {
  using Frame = std::array<double, 4>;
  framehex::MeshFieldOptions field{.field = {.observer = observer}};
  field.regions = read.regions;
  const fd::DistributedField frames =
      fd::compute_frame_field(read.part, transport, field, framehex::ThreadExecutor(options.threads));
  std::vector<Frame> known;
  for (const framehex::Quaternion& q : frames.frames) known.push_back({q.w(), q.x(), q.y(), q.z()});
  Frame none;
  none.fill(std::numeric_limits<double>::quiet_NaN());
  std::vector<double> values;
  for (const Frame& frame :
       fd::values_by_number<Frame>(transport, read.part.vertex_ids, known, result.vertex_numbers, none))
    values.insert(values.end(), frame.begin(), frame.end());
  return {"frame", std::move(values), 4};
}

/// What all ranks' parts have together.
Measures joined(const fd::MpiTransport& transport, const Measures& mine, const framehex::PartRecombination& result) {
  struct Share {
    std::array<double, 4> volume, mean;
    double least;
  };
  Share share{{}, {}, mine.n_cells > 0 ? mine.least : 1};
  Measures all;
  const auto count = [&](std::size_t n) {
    return static_cast<std::size_t>(fd::detail::sum_of(transport, static_cast<std::int64_t>(n)));
  };
  for (std::size_t k = 0; k < 4; ++k) {
    share.volume[k] = mine.kinds[k].volume;
    share.mean[k] = mine.kinds[k].mean * static_cast<double>(mine.kinds[k].n);
    all.kinds[k].n = count(mine.kinds[k].n);
  }
  all.n_cells = count(mine.n_cells);
  all.n_points =
      count(static_cast<std::size_t>(std::count(result.owners.begin(), result.owners.end(), transport.rank())));
  for (const Share& s : fd::detail::gathered(transport, std::vector<Share>{share})) {
    all.least = std::min(all.least, s.least);
    for (std::size_t k = 0; k < 4; ++k) {
      all.kinds[k].volume += s.volume[k];
      all.volume += s.volume[k];
      all.mean += all.n_cells > 0 ? s.mean[k] / static_cast<double>(all.n_cells) : 0;
    }
  }
  return all;
}

/// Of each number the greatest of all ranks.
framehex::StageSeconds slowest(const fd::MpiTransport& transport, const framehex::StageSeconds& mine) {
  std::array<double, 4> least{-mine.field, -mine.search, -mine.selection, -mine.assembly};
  transport.least(least);
  framehex::StageSeconds all;
  all.field = -least[0];
  all.search = -least[1];
  all.selection = -least[2];
  all.assembly = -least[3];
  return all;
}

/// `ranks`: what each has spent and has in the end.
void add_ranks(nlohmann::ordered_json& json, const fd::MpiTransport& transport, std::size_t n_cells) {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  const fd::Traffic traffic = transport.traffic();
  const std::vector<double> mine{cpu_seconds(),
                                 1024.0 * static_cast<double>(usage.ru_maxrss),
                                 static_cast<double>(traffic.messages),
                                 static_cast<double>(traffic.bytes),
                                 static_cast<double>(traffic.collectives),
                                 static_cast<double>(n_cells)};
  const std::vector<double> ranks = fd::detail::gathered(transport, mine);
  constexpr std::array<const char*, 6> columns{"cpu_seconds", "peak_memory_bytes", "messages",
                                               "bytes",       "collectives",       "cells"};
  for (std::size_t i = 0; i < ranks.size(); ++i) json["ranks"][columns[i % mine.size()]].push_back(ranks[i]);
}

nlohmann::ordered_json json_of(const fd::MpiTransport& transport, const Measures& all,
                               const framehex::StageSeconds& seconds, const framehex::PartRecombination& result,
                               const Options& options) {
  nlohmann::ordered_json json;
  json["counts"] = {{"vertices", all.n_points}, {"cells", all.n_cells}};
  constexpr std::array<const char*, 4> names{"tetrahedra", "pyramids", "prisms", "hexahedra"};
  for (std::size_t k = 0; k < 4; ++k) json["counts"][names[k]] = all.kinds[k].n;
  json["hex_ratio"] = {
      {"number", all.hex_ratio_by_number()}, {"volume", all.hex_ratio_by_volume()}, {"floor", options.floor}};
  json["quality"] = {{"least", all.least}, {"mean", all.mean}, {"volume", all.volume}};
  add_groups(json, result.mesh);
  for (auto& group : json["groups"])
    group["elements"] = fd::detail::sum_of(transport, group["elements"].get<std::int64_t>());
  if (result.mesh.groups.empty()) json.erase("groups");
  add_to(json, seconds);
  json["parts"] = result.n_parts;
  json["candidates"] = result.n_candidates;
  framehex::Selection selection;
  selection.weight = result.weight;
  selection.bound = result.bound;
  json["selection"] = {{"value", selection.weight},
                       {"bound", selection.bound},
                       {"gap_percent", 100 * selection.gap()},
                       {"chosen", result.n_chosen},
                       {"rounds", result.n_rounds}};
  add_to(json, result.assembly, static_cast<std::size_t>(result.n_given_up));
  if (result.n_parts > 1)  // these are counted of one part alone
    for (const char* const key : {"open_before", "refitted", "unfit", "removed_vertices"}) json["assembly"].erase(key);
  add_ranks(json, transport, result.mesh.n_cells());
  finish(json, options);
  return json;
}

/// Refuses, before any work, files that could not be written in the end. Of a rank its own.
void check_files(const fd::MpiTransport& transport, const Options& options) {
  const framehex::OutputFile piece(fd::detail::piece_path(options.output, transport.rank()));
  if (transport.rank() != 0) return;
  check_report(options);
  const framehex::OutputFile index(options.output);
}

bool run(const fd::MpiTransport& transport, const Options& options, const framehex::Observer& observer) {
  check_files(transport, options);
  const fd::ReadPart read = fd::read_parts(options.input, transport, options.regions);
  framehex::PartRecombination result = fd::recombine(
      read.part, transport, part_options(options, observer, read.regions), framehex::ThreadExecutor(options.threads));
  if (result.status == framehex::Status::cancelled) return false;
  result.mesh.groups = read.groups;
  const Measures measures = measure(result.mesh);
  framehex::MeshData data{.cells = {{"scaled_jacobian", measures.scaled_jacobian}}, .points = {}};
  framehex::StageSeconds seconds;
  seconds.search = result.search_seconds;
  seconds.selection = result.selection_seconds;
  seconds.assembly = result.assembly_seconds;
  if (options.with_field) {
    const auto begin = std::chrono::steady_clock::now();
    data.points.push_back(frames_of(transport, read, options, observer, result));
    seconds.field = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  }
  seconds = slowest(transport, seconds);
  const Measures all = joined(transport, measures, result);
  const nlohmann::ordered_json json = json_of(transport, all, seconds, result, options);
  // The report reaches the disk before the mesh takes its name, and takes its own after it.
  std::optional<framehex::OutputFile> report;
  if (transport.rank() == 0 && !options.report.empty()) {
    report.emplace(options.report);
    report->write(json.dump(2) + "\n");
    report->finish();
  }
  const std::vector<fd::SharedWith> shared = fd::shared_with(result);
  fd::write_pvtu(options.output, transport,
                 {result.mesh, result.vertex_numbers, result.cell_numbers, result.owners, shared}, data);
  if (report) report->commit();
  end_progress();
  if (!options.quiet) print_row(std::filesystem::path(options.input).stem().string(), all, seconds);
  return true;
}

/// One line: the rank, and the input where the message is about it and names no file.
std::string line_of(const fd::remote_error& e, const Options& options) {
  const std::string text = e.what(), rank = "rank " + std::to_string(e.rank()) + ": ";
  const std::string rest = text.substr(rank.size());
  const std::filesystem::path named = rest.substr(0, rest.find(": "));
  const bool names_file = named.extension() == ".pvtu" || framehex::known_mesh_format(named).has_value();
  return e.entity() == framehex::Entity::none || names_file ? text : rank + options.input + ": " + rest;
}

}  // namespace

int run_distributed(Options options) {
  const Session session;
  const fd::MpiTransport transport(MPI_COMM_WORLD);
  const bool speaks = transport.rank() == 0;
  // Each rank is a process of its own; more threads are for those who ask.
  if (options.threads == 0) options.threads = 1;
  options.quiet = options.quiet || !speaks;
  const Interruption interruption({fd::detail::piece_path(options.output, transport.rank()).string(),
                                   speaks ? options.output : std::string{}, speaks ? options.report : std::string{}});
  try {
    const bool complete = fd::run_collectively(
        transport, [&] { return run(transport, options, make_observer(interruption, !options.quiet)); });
    if (speaks) end_progress();
    if (speaks && !complete) std::cerr << "framehex: interrupted\n";
    return complete ? 0 : 130;
  } catch (const fd::remote_error& e) {
    if (speaks) end_progress();
    if (speaks) std::cerr << "framehex: " << line_of(e, options) << "\n";
    return 2;
  }
}

}  // namespace program
