// SPDX-License-Identifier: BSL-1.0
#include "framehex/distributed/run_collectively.hpp"

#include <catch2/catch.hpp>
#include <random>

using namespace framehex;
using namespace framehex::distributed;

namespace {

std::vector<std::byte> bytes_for(int from, int to, std::size_t n) {
  std::vector<std::byte> bytes(n);
  for (std::size_t i = 0; i < n; ++i)
    bytes[i] = static_cast<std::byte>(7 * static_cast<std::size_t>(from) + 3 * static_cast<std::size_t>(to) + i);
  return bytes;
}

}  // namespace

TEST_CASE("parcels arrive whole, by rank, also when cut, empty or to oneself") {
  const MpiTransport transport(MPI_COMM_WORLD, 1000);
  const int rank = transport.rank(), n = transport.n_ranks();
  for (int round = 0; round < 30; ++round) {
    // Who sends what to whom is known to all: the same engine everywhere.
    std::mt19937 engine(static_cast<unsigned>(round));
    std::vector<Parcel> mine, expected;
    for (int from = 0; from < n; ++from)
      for (int to = 0; to < n; ++to) {
        const bool sends = engine() % 3 != 0;
        const std::size_t size = engine() % 5 == 0 ? 0 : engine() % 4 == 0 ? 1000 * (engine() % 4) : engine() % 5000;
        if (sends && from == rank) mine.push_back({to, bytes_for(from, to, size)});
        if (sends && to == rank) expected.push_back({from, bytes_for(from, to, size)});
      }
    const std::vector<Parcel> arrived = transport.exchange(mine);
    REQUIRE(arrived.size() == expected.size());
    for (std::size_t i = 0; i < arrived.size(); ++i) {
      CHECK(arrived[i].rank == expected[i].rank);
      CHECK((arrived[i].bytes == expected[i].bytes));
    }
  }
  if (n > 1) CHECK(transport.traffic().messages > 0);
}

TEST_CASE("sums, least values and gathered bytes are those of all ranks") {
  const MpiTransport transport(MPI_COMM_WORLD, 64);
  const int rank = transport.rank(), n = transport.n_ranks();
  std::vector<std::int64_t> counts{rank, std::int64_t{1} << 40};
  transport.sum(counts);
  CHECK(counts[0] == n * (n - 1) / 2);
  CHECK(counts[1] == n * (std::int64_t{1} << 40));
  std::vector<double> numbers{1.0 + rank, -1.0 * rank};
  transport.least(numbers);
  CHECK(numbers[0] == 1);
  CHECK(numbers[1] == 1 - n);
  const auto all = transport.gather(bytes_for(rank, 0, 100 * static_cast<std::size_t>(rank)));
  REQUIRE(all.size() == static_cast<std::size_t>(n));
  for (int r = 0; r < n; ++r)
    CHECK((all[static_cast<std::size_t>(r)] == bytes_for(r, 0, 100 * static_cast<std::size_t>(r))));
}

TEST_CASE("an exception on one rank is the same on all, wherever the others are") {
  const MpiTransport transport(MPI_COMM_WORLD);
  const int rank = transport.rank(), n = transport.n_ranks();
  for (int bad = 0; bad < n; ++bad)
    for (int when = 0; when < 4; ++when) {
      INFO(bad << " " << when);
      try {
        run_collectively(transport, [&] {
          std::vector<std::int64_t> one{1};
          for (int step = 0; step < 3; ++step) {
            if (rank == bad && step == when) throw inverted_cell("cell 17 is inverted", Entity::cell, {17});
            if (step == 0) transport.sum(one);
            if (step == 1) transport.exchange({{(rank + 1) % n, bytes_for(0, 0, 9)}});
            if (step == 2) transport.gather(bytes_for(0, 0, 9));
          }
          if (rank == bad && when == 3) throw std::bad_alloc();
        });
        FAIL("nobody threw");
      } catch (const remote_error& e) {
        CHECK(e.rank() == bad);
        const std::string expected = when == 3 ? "out of memory" : "cell 17 is inverted";
        CHECK(e.what() == "rank " + std::to_string(bad) + ": " + expected);
        CHECK((e.entity() == (when == 3 ? Entity::none : Entity::cell)));
        CHECK(e.indices().size() == (when == 3 ? 0u : 1u));
      }
    }
  // The ranks are in step still.
  std::vector<std::int64_t> one{1};
  transport.sum(one);
  CHECK(one[0] == n);
}

TEST_CASE("when all fail at once the least rank is named, and inner guards pass on what outer ones know") {
  const MpiTransport transport(MPI_COMM_WORLD);
  try {
    run_collectively(transport, [&] {
      run_collectively(transport, [&] { throw error("here " + std::to_string(transport.rank())); });
    });
    FAIL("nobody threw");
  } catch (const remote_error& e) {
    CHECK(e.what() == std::string("rank 0: here 0"));
  }
}

TEST_CASE("an observer that stops or throws on one rank stops all, and none costs nothing") {
  const MpiTransport transport(MPI_COMM_WORLD);
  const int last = transport.n_ranks() - 1;
  const bool is_last = transport.rank() == last;
  int asked = 0;
  const Observer stops = [&](const Progress& p) { return ++asked, p.fraction < 0.5; };
  const Observer shared = shared_observer(transport, is_last ? stops : Observer{});
  CHECK(shared({"", 0.2}));
  CHECK(!shared({"", 0.7}));
  CHECK(asked == (is_last ? 2 : 0));
  CHECK(!shared_observer(transport, {}));
  const Observer throws = [](const Progress&) -> bool { throw std::runtime_error("no more"); };
  CHECK_THROWS_AS(run_collectively(transport,
                                   [&] {
                                     const Observer all = shared_observer(transport, is_last ? throws : Observer{});
                                     while (all({"", 0})) {
                                     }
                                   }),
                  remote_error);
}
