// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/distributed/validation.hpp"
#include "framehex/distributed/write_pvtu.hpp"
#include "framehex/parts/detail/recombine_in_parts_impl.hpp"

namespace framehex::distributed {

/// Spans must outlive the call only.
struct RecombineOptions {
  /// The same on all ranks but for the observer, of which every rank may have one: each is asked, and one stops all.
  PartsOptions parts = {};
  std::span<const index_t> regions = {};  ///< label of each cell of this rank, or empty on all ranks: one region

  template <class Options, class Visit>
  static void each_number(Options& o, Visit&& visit) {
    PartsOptions::each_number(o.parts, visit);
  }
};

/// Turns a distributed tetrahedral mesh into a distributed hex-dominant one. Collective.
///
/// Cells are dealt out anew for this, by the leaves of an octree, whatever the host's parts are; see `recombine_in_parts`.
///
/// @return this rank's cells: with global numbers of cells and vertices, the first rank that has it as the owner of each
///         vertex, and who shares which, as codes for finite elements want them. All ranks' cells together conform, are
///         valid, and fill the volume.
/// @throws remote_error  on all ranks: what `validate` and `recombine_in_parts` throw on one.
/// @par Complexity   O(n) on each rank; messages between ranks whose parts touch.
/// @par Determinism  The same cells, by the places of their corners, for any number of ranks and threads.
template <DistributedTetMesh M, Executor E = SerialExecutor>
PartRecombination recombine(const M& mesh, const MpiTransport& transport, const RecombineOptions& options = {},
                            const E& executor = {}) {
  return run_collectively(transport, [&] {
    check_options(options);
    const IndexedPart part = detail::validated_part(mesh, transport);
    if (detail::any_rank(transport, !options.regions.empty()) && options.regions.size() != part.mesh.tets.size())
      throw invalid_option("there are " + std::to_string(options.regions.size()) + " region labels for " +
                           std::to_string(part.mesh.tets.size()) + " tetrahedra");
    const PartInput input{part.mesh.points, part.mesh.tets, part.vertex_ids, part.cell_ids, options.regions};
    return recombine_in_parts(input, transport, options.parts, executor);
  });
}

/// What `write_pvtu` is to write of a result, which must outlive it.
inline std::vector<SharedWith> shared_with(const PartRecombination& result) {
  std::vector<SharedWith> shared;
  for (const auto& s : result.shared) shared.push_back({s.vertex, s.rank});
  return shared;
}

/// Values of vertices, brought to ranks that know them by global numbers only. Collective.
///
/// @param known   numbers, ascending or not, and a value for each; a number known to several has one value.
/// @param wanted  numbers. @param none  for those that nobody knows.
/// @return a value for each wanted number.
template <class Value>
std::vector<Value> values_by_number(const MpiTransport& transport, std::span<const std::int64_t> known,
                                    std::span<const Value> values, std::span<const std::int64_t> wanted,
                                    const Value& none) {
  struct Entry {
    std::int64_t id;
    Value value;
  };
  const auto n_ranks = static_cast<std::size_t>(transport.n_ranks());
  const auto clerk = [&](std::int64_t id) { return static_cast<std::size_t>(id) / 1024 % n_ranks; };
  std::vector<std::vector<Entry>> told(n_ranks);
  for (std::size_t i = 0; i < known.size(); ++i) told[clerk(known[i])].push_back({known[i], values[i]});
  std::vector<Entry> entries = detail::send_joined(transport, std::move(told));
  std::ranges::stable_sort(entries, {}, &Entry::id);
  std::vector<std::vector<std::int64_t>> questions(n_ranks);
  for (const std::int64_t id : wanted) questions[clerk(id)].push_back(id);
  const auto answers = detail::ask<Value>(transport, questions, [&](std::int64_t id, int) {
    const auto at = std::ranges::lower_bound(entries, id, {}, &Entry::id);
    return at == entries.end() || at->id != id ? none : at->value;
  });
  std::vector<std::size_t> next(n_ranks, 0);
  std::vector<Value> result;
  for (const std::int64_t id : wanted) result.push_back(answers[clerk(id)][next[clerk(id)]++]);
  return result;
}

}  // namespace framehex::distributed
