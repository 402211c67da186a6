// SPDX-License-Identifier: BSL-1.0
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace framehex {

/// Bytes for a rank, or from one.
struct Parcel {
  int rank = 0;
  std::vector<std::byte> bytes;
};

/// How the holders of a mesh's parts ("ranks") reach one another. All calls are collective: every rank makes the same ones
/// in the same order.
///
/// - `exchange(parcels)` delivers each parcel to its rank, at most one to each, and gives those that arrived, by rising
///   rank of their senders. A rank may send to itself. Nobody says beforehand who receives.
/// - `sum(values)` and `least(values)` replace each entry by the sum, and by the least, over all ranks.
template <class T>
concept Transport = requires(const T& t, std::vector<Parcel> parcels, std::span<std::int64_t> counts,
                             std::span<double> numbers) {
  { t.rank() } -> std::convertible_to<int>;
  { t.n_ranks() } -> std::convertible_to<int>;
  { t.exchange(std::move(parcels)) } -> std::same_as<std::vector<Parcel>>;
  t.sum(counts);
  t.least(numbers);
};

/// All parts in one process: what is sent arrives at once.
struct SerialTransport {
  int rank() const { return 0; }
  int n_ranks() const { return 1; }
  std::vector<Parcel> exchange(std::vector<Parcel> parcels) const { return parcels; }
  void sum(std::span<std::int64_t>) const {}
  void least(std::span<double>) const {}
};

static_assert(Transport<SerialTransport>);

}  // namespace framehex
