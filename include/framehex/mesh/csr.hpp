// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/config.hpp"

#include <cstddef>
#include <span>
#include <vector>

namespace framehex {

/// Rows of varying length in two flat arrays (compressed rows).
template <class Value = index_t>
struct Csr {
  std::vector<offset_t> offsets{0};  ///< n_rows + 1 entries, the first 0
  std::vector<Value> values;

  std::size_t size() const { return offsets.size() - 1; }
  bool empty() const { return size() == 0; }

  std::span<const Value> operator[](std::size_t row) const {
    return {values.data() + offsets[row], static_cast<std::size_t>(offsets[row + 1] - offsets[row])};
  }
  std::span<Value> operator[](std::size_t row) {
    return {values.data() + offsets[row], static_cast<std::size_t>(offsets[row + 1] - offsets[row])};
  }

  /// Ends the row to which values were appended since the last call.
  void end_row() { offsets.push_back(values.size()); }
};

/// Sorts (row, value) pairs into rows by counting; within a row the pairs keep the order in which they are emitted.
///
/// @param n_rows  number of rows.
/// @param emit    called twice with a callable `put(row, value)`; must emit the same pairs both times.
/// @par Complexity   O(n_rows + pairs); no memory but the result and n_rows counters.
template <class Value = index_t, class Emit>
Csr<Value> make_csr(std::size_t n_rows, Emit&& emit) {
  Csr<Value> csr;
  csr.offsets.assign(n_rows + 1, 0);
  emit([&](std::size_t row, const Value&) { ++csr.offsets[row + 1]; });
  for (std::size_t row = 0; row < n_rows; ++row) csr.offsets[row + 1] += csr.offsets[row];
  csr.values.resize(csr.offsets.back());
  std::vector<offset_t> next(csr.offsets.begin(), csr.offsets.end() - 1);
  emit([&](std::size_t row, const Value& value) { csr.values[next[row]++] = value; });
  return csr;
}

}  // namespace framehex
