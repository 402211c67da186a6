// SPDX-License-Identifier: BSL-1.0
#include "framehex/parts/detail/contender_turns.hpp"
#include "framehex/parts/detail/greedy_rounds.hpp"
#include "framehex/parts/detail/halo.hpp"
#include "framehex/parts/detail/part_candidates.hpp"
#include "parts/part_fixtures.hpp"
#include "support/jittered_delaunay.hpp"

#include <catch2/catch.hpp>

#include <mutex>
#include <set>

using namespace framehex;

namespace {

using Coordinates = std::array<double, 24>;

/// A candidate by its corners, whatever their order.
Coordinates key_of(std::array<Vector3, 8> corners) {
  std::sort(corners.begin(), corners.end(),
            [](const Vector3& a, const Vector3& b) { return detail::lies_before(a, b); });
  Coordinates key{};
  for (std::size_t i = 0; i < 8; ++i)
    for (std::size_t k = 0; k < 3; ++k) key[3 * i + k] = corners[i][static_cast<Eigen::Index>(k)];
  return key;
}

std::array<Vector3, 8> corners_of(const std::vector<Vector3>& points, const std::array<index_t, 8>& vertices) {
  std::array<Vector3, 8> corners;
  for (std::size_t i = 0; i < 8; ++i) corners[i] = points[vertices[i]];
  return corners;
}

struct Found {
  std::multiset<Coordinates> candidates, taken, improved;
  double weight = 0, improved_weight = 0;
  std::size_t n_at_border = 0, n_told = 0;
};

Found find_on_ranks(const IndexedTetMesh& mesh, int n_ranks, std::size_t part_size) {
  Found found;
  std::mutex mutex;
  test::run_on_ranks(n_ranks, [&](const test::ThreadTransport& transport) {
    const auto brought = test::part_of(mesh, transport.rank(), [&](std::size_t cell) {
      return static_cast<int>(cell * 7919 / 1000 % static_cast<std::size_t>(n_ranks));
    });
    const PartInput input = brought.input();
    Vector3 low, high;
    if (!detail::find_box(transport, input, low, high)) throw std::runtime_error("no cells");
    const MortonCube cube(low, high, 0);
    std::vector<MortonCube::Code> codes;
    for (std::size_t t = 0; t < input.tets.size(); ++t) codes.push_back(cube.code(detail::centre_of_tet(input, t)));
    const Partition partition(transport, cube, codes, part_size);
    detail::HeldTets held = detail::distribute(transport, partition, input);
    detail::HaloExchange(transport, partition, held).run(detail::n_halo_layers);
    const detail::TetPatch patch(std::move(held), partition, false);
    const auto own = detail::own_vertices(patch, partition.leaves_of(transport.rank()));
    auto candidates = detail::find_candidates_at(patch, own, {}, SerialExecutor{});
    std::vector<double> weights;
    for (index_t i = 0; i < candidates.size(); ++i) weights.push_back(volume_times_quality(candidates)(i));
    detail::CandidatePool pool(patch, std::move(candidates), std::move(weights));
    detail::BorderExchange border(transport, partition, pool);
    detail::CandidateStates states(transport, pool);
    detail::GreedyRounds rounds(transport, pool, border, states);
    if (!rounds.run([] { return false; })) throw std::runtime_error("stopped");
    std::vector<std::uint8_t> greedy;
    for (index_t i = 0; i < pool.n_own; ++i)
      greedy.push_back(states[i] == detail::CandidateStates<test::ThreadTransport>::taken);
    const std::size_t n_told = pool.copies.size();
    const Observer nobody;
    detail::CallingThread thread(nobody);
    const SerialExecutor serial;
    detail::ContenderTurns turns(transport, pool, border, states, serial, thread);
    for (const double shift : {0.0, 0.4, 0.2}) {
      const MortonCube shifted(low, high, shift);
      std::vector<MortonCube::Code> own_codes;
      for (std::size_t t = 0; t < input.tets.size(); ++t)
        own_codes.push_back(shifted.code(detail::centre_of_tet(input, t)));
      turns.run(Partition(transport, shifted, own_codes, part_size), 1);
    }
    states.reopen();
    states.exchange();
    if (!detail::GreedyRounds(transport, pool, border, states).run([] { return false; }))
      throw std::runtime_error("stopped");
    const std::lock_guard lock(mutex);
    found.n_told += n_told;
    for (index_t i = 0; i < pool.n_own; ++i) {
      const Coordinates key = key_of(corners_of(pool.points, pool.candidates.vertices[i]));
      found.candidates.insert(key);
      if (border.is_at_border(i)) ++found.n_at_border;
      if (greedy[i]) {
        found.taken.insert(key);
        found.weight += pool.weights[i];
      }
      if (states[i] == detail::CandidateStates<test::ThreadTransport>::taken) {
        found.improved.insert(key);
        found.improved_weight += pool.weights[i];
      }
    }
  });
  return found;
}

/// All candidates of the whole mesh, and the greedy selection by comparing each with all that are taken.
Found find_at_once(const IndexedTetMesh& given) {
  const IndexedTetMesh mesh = test::in_order(given);
  const PotentialHexahedra candidates = find_potential_hexahedra(mesh);
  const auto weight = volume_times_quality(candidates);
  std::vector<index_t> order(candidates.size());
  for (index_t i = 0; i < order.size(); ++i) order[i] = i;
  std::sort(order.begin(), order.end(), [&](index_t a, index_t b) {
    return weight(a) != weight(b) ? weight(a) > weight(b) : candidates.vertices[a] < candidates.vertices[b];
  });
  Found found;
  std::vector<index_t> taken;
  for (const index_t v : order) {
    const Coordinates key = key_of(corners_of(mesh.points, candidates.vertices[v]));
    found.candidates.insert(key);
    if (std::ranges::any_of(taken, [&](index_t u) { return !compatible(candidates, u, v); })) continue;
    taken.push_back(v);
    found.taken.insert(key);
  }
  return found;
}

}  // namespace

TEST_CASE("candidates and greedy selection of parts are those of the whole mesh") {
  const std::array<IndexedTetMesh, 3> meshes{test::jittered_kuhn(8, 0), test::jittered_kuhn(8, 0.2),
                                             test::jittered_delaunay(7, 4, 0.35)};
  for (const IndexedTetMesh& mesh : meshes) {
    const Found whole = find_at_once(mesh);
    REQUIRE(whole.taken.size() > 100);
    for (const std::size_t part_size : {50u, 400u, 100000u}) {
      std::multiset<Coordinates> improved;
      for (const int n_ranks : {1, 2, 3, 5}) {
        CAPTURE(&mesh - meshes.data(), n_ranks, part_size);
        const Found parts =
            find_on_ranks(test::permuted(mesh, part_size + static_cast<std::size_t>(n_ranks)), n_ranks, part_size);
        CHECK(parts.candidates == whole.candidates);
        CHECK(parts.taken == whole.taken);
        CHECK(parts.improved_weight >= parts.weight);
        if (n_ranks == 1) improved = parts.improved;
        CHECK(parts.improved == improved);
      }
    }
  }
}

TEST_CASE("ranks are told of few of the candidates at their borders") {
  // A candidate that has a corner in common with another rank's would be known to one rank more, at least.
  for (const int n_ranks : {2, 5}) {
    const Found parts = find_on_ranks(test::jittered_kuhn(12, 0.1), n_ranks, 2000);
    CAPTURE(n_ranks, parts.n_at_border, parts.n_told);
    CHECK(parts.n_at_border > 10000);
    CHECK(parts.n_told > 0);
    CHECK(3 * parts.n_told < parts.n_at_border);
  }
}
