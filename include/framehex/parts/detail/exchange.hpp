// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/errors.hpp"
#include "framehex/parts/transport.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <string>
#include <type_traits>

namespace framehex {

/// Number of a vertex or a cell of a mesh that is held in parts.
using global_t = std::int64_t;

namespace detail {

/// Items that came from a rank, in the order in which it put them.
template <class T>
struct Received {
  int rank;
  std::vector<T> items;
};

/// Items for each rank.
template <class T>
using Rows = std::vector<std::vector<T>>;

/// Sends row r to rank r. Collective. What a rank sends to itself is moved, not copied.
/// @return by rising rank of the senders; ranks that sent nothing are left out.
template <class T, Transport Tr>
std::vector<Received<T>> send_typed(const Tr& transport, Rows<T> rows) {
  static_assert(std::is_trivially_copyable_v<T>);
  const int self = transport.rank();
  std::vector<Parcel> parcels;
  for (int rank = 0; rank < static_cast<int>(rows.size()); ++rank) {
    auto& row = rows[static_cast<std::size_t>(rank)];
    if (row.empty() || rank == self) continue;
    Parcel& parcel = parcels.emplace_back(Parcel{rank, std::vector<std::byte>(row.size() * sizeof(T))});
    std::memcpy(parcel.bytes.data(), row.data(), parcel.bytes.size());
    std::vector<T>().swap(row);
  }
  std::vector<Received<T>> received;
  const auto add_own = [&] {
    auto& own = rows[static_cast<std::size_t>(self)];
    if (!own.empty()) received.push_back({self, std::move(own)});
  };
  bool own_added = false;
  for (const Parcel& parcel : transport.exchange(std::move(parcels))) {
    if (!own_added && parcel.rank > self) {
      add_own();
      own_added = true;
    }
    auto& items =
        received.emplace_back(Received<T>{parcel.rank, std::vector<T>(parcel.bytes.size() / sizeof(T))}).items;
    if (!items.empty()) std::memcpy(static_cast<void*>(items.data()), parcel.bytes.data(), parcel.bytes.size());
  }
  if (!own_added) add_own();
  return received;
}

/// The same where it does not matter who sent what.
template <class T, Transport Tr>
std::vector<T> send_joined(const Tr& transport, Rows<T> rows) {
  std::vector<T> all;
  for (Received<T>& received : send_typed(transport, std::move(rows))) {
    if (all.empty())
      all = std::move(received.items);
    else
      all.insert(all.end(), received.items.begin(), received.items.end());
  }
  return all;
}

template <class T, Transport Tr>
Rows<T> make_rows(const Tr& transport) {
  return Rows<T>(static_cast<std::size_t>(transport.n_ranks()));
}

template <Transport Tr>
std::int64_t sum_of(const Tr& transport, std::int64_t value) {
  transport.sum(std::span<std::int64_t>(&value, 1));
  return value;
}

/// The greatest number of any rank, exactly; -1 when there is none.
template <Transport Tr>
global_t greatest_number(const Tr& transport, std::span<const global_t> numbers) {
  const global_t mine = numbers.empty() ? -1 : *std::max_element(numbers.begin(), numbers.end());
  // In halves: a double does not hold all of it.
  std::array<double, 1> high{-static_cast<double>(mine >> 32)};
  transport.least(std::span<double>(high));
  const auto first = static_cast<global_t>(-high[0]);
  std::array<double, 1> low{mine >> 32 == first ? -static_cast<double>(mine - (first << 32)) : 0};
  transport.least(std::span<double>(low));
  return (first << 32) + static_cast<global_t>(-low[0]);
}

/// Global numbers are smaller: those from here on are new vertices' while the mesh is made.
inline constexpr global_t number_limit = global_t{1} << 62;

/// @throws invalid_connectivity  for the first that is no number of a vertex or a cell in the whole mesh.
inline void check_numbers(std::span<const global_t> numbers, Entity entity) {
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    if (numbers[i] >= 0 && numbers[i] < number_limit) continue;
    throw invalid_connectivity((entity == Entity::vertex ? "vertex " : "cell ") + std::to_string(i) +
                                   " has the global number " + std::to_string(numbers[i]) +
                                   "; they are from 0 to 2^62 - 1",
                               entity, {i});
  }
}

/// Whether any rank says so.
template <Transport Tr>
bool any_rank(const Tr& transport, bool value) {
  return sum_of(transport, value ? 1 : 0) > 0;
}

}  // namespace detail

}  // namespace framehex
