// SPDX-License-Identifier: BSL-1.0
#include "framehex/insertion/insertion_order.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <limits>
#include <random>
#include <tuple>

using namespace framehex;

TEST_CASE("FIFO order gives back what came first") {
  FifoOrder queue;
  for (const index_t i : {5U, 3U, 9U}) queue.push(i, i == 3 ? 1.0 : 0.0, 9 - i);
  for (const index_t i : {5U, 3U, 9U}) CHECK(queue.pop() == i);
  CHECK(queue.empty());
}

TEST_CASE("smoothness order sorts by bin, generation and index") {
  std::mt19937_64 engine(7);
  const int n_bins = 13;
  SmoothnessOrder queue(n_bins);
  std::vector<std::tuple<int, index_t, index_t>> expected;
  for (index_t i = 0; i < 3000; ++i) {
    const double smoothness = static_cast<double>(engine() % 1400) / 1000 - 0.39;
    const auto generation = static_cast<index_t>(engine() % 20);
    int bin = 0;
    while (bin + 1 < n_bins && smoothness >= static_cast<double>(bin + 1) / n_bins) ++bin;
    expected.emplace_back(-bin, generation, i);
    queue.push(i, smoothness, generation);
  }
  std::sort(expected.begin(), expected.end());
  for (const auto& [bin, generation, index] : expected) REQUIRE(queue.pop() == index);
  CHECK(queue.empty());
}

TEST_CASE("smoothness order takes any number for a smoothness, and any generation") {
  SmoothnessOrder queue;
  queue.push(1, std::numeric_limits<double>::quiet_NaN(), 0);
  queue.push(2, std::numeric_limits<double>::infinity(), std::numeric_limits<index_t>::max());
  queue.push(3, -5.0, 1);
  for (const index_t i : {2U, 1U, 3U}) CHECK(queue.pop() == i);
  CHECK_THROWS_AS(SmoothnessOrder(0), invalid_option);
  CHECK_THROWS_AS(SmoothnessOrder(256), invalid_option);
}
