// SPDX-License-Identifier: BSL-1.0
// Hosts that throw, or answer otherwise than before, at any call: what they throw arrives, what they say is checked, and what
// is made of it is a sound mesh or nothing.
#include "framehex/mesh/validation.hpp"
#include "framehex/pipeline/recombine.hpp"
#include "framehex/verify/conformity.hpp"
#include "support/kuhn_lattice.hpp"

#include <catch2/catch.hpp>

using namespace framehex;

namespace {

enum class Fault {
  throws,
  not_finite,    ///< a point has no place
  moves,         ///< every point is elsewhere at each call
  other_number,  ///< a vertex has the number of another
  too_large,     ///< a vertex has a number that there is not
  other_corner,  ///< a cell has the corners of the one before
  one_corner,    ///< all corners of a cell are one
  one_less       ///< the last vertex and the last cell have gone
};
constexpr Fault all_faults[] = {Fault::throws,    Fault::not_finite, Fault::moves,        Fault::other_number,
                                Fault::too_large, Fault::one_corner, Fault::other_corner, Fault::one_less};

struct HostFailure {};

/// Answers as its mesh does until so many questions have been asked.
struct UnreliableMesh {
  IndexedTetMesh mesh = test::kuhn_lattice(2, 2, 1);
  Fault fault = Fault::throws;
  std::size_t n_honest = std::numeric_limits<std::size_t>::max();
  mutable std::size_t n_asked = 0;

  bool lies(Fault f) const { return fault == f && n_asked > n_honest; }
  void ask() const {
    ++n_asked;
    if (lies(Fault::throws)) throw HostFailure{};
  }
  std::size_t left(std::size_t n) const { return lies(Fault::one_less) ? n - 1 : n; }
};

/// What was made of it, checked; false where an error was reported.
template <class Work>
bool survives(const Work& work) {
  try {
    work();
    return true;
  } catch (const HostFailure&) {
  } catch (const error&) {
  }
  return false;
}

}  // namespace

template <>
struct framehex::mesh_traits<UnreliableMesh> {
  using M = UnreliableMesh;
  using vertex_type = index_t;
  using cell_type = index_t;
  using scalar_type = double;
  static auto vertices(const M& m) {
    m.ask();
    return std::views::iota(index_t{0}, static_cast<index_t>(m.left(m.mesh.points.size())));
  }
  static auto cells(const M& m) {
    m.ask();
    return std::views::iota(index_t{0}, static_cast<index_t>(m.left(m.mesh.tets.size())));
  }
  static std::size_t index(const M& m, index_t v) {
    m.ask();
    return m.lies(Fault::other_number) ? (v + 1) % m.mesh.points.size() : m.lies(Fault::too_large) ? 1'000'000 : v;
  }
  static std::array<double, 3> point(const M& m, index_t v) {
    m.ask();
    const Vector3& p = m.mesh.points[v];
    const double away = m.lies(Fault::moves) ? 0.01 * static_cast<double>(m.n_asked) : 0;
    return {m.lies(Fault::not_finite) ? std::nan("") : p.x() + away, p.y() * (1 + away), p.z()};
  }
  static std::array<index_t, 4> cell_vertices(const M& m, index_t c) {
    m.ask();
    const auto& t = m.mesh.tets[m.lies(Fault::other_corner) && c > 0 ? c - 1 : c];
    return m.lies(Fault::one_corner) ? std::array{t[0], t[0], t[0], t[0]} : t;
  }
};

TEST_CASE("a host that throws or changes its answers at any call does no harm", "[regression]") {
  const auto recombined = [](const UnreliableMesh& host) {
    const Recombination result = recombine(host);
    CHECK(verify::is_conforming(result.mesh));
    CHECK(result.vertex_of.size() == result.mesh.points.size());
  };
  const auto found = [](const UnreliableMesh& host) {
    const PotentialHexahedra candidates = find_potential_hexahedra(host);
    CHECK(candidates.status == Status::complete);
  };
  const auto validated = [](const UnreliableMesh& host) { validate(host); };
  const auto try_all = [](const auto& work) {
    UnreliableMesh honest;
    REQUIRE(survives([&] { work(honest); }));
    REQUIRE(honest.n_asked > honest.mesh.tets.size());
    for (const Fault fault : all_faults) {
      for (std::size_t n = 0; n <= honest.n_asked; ++n) {
        INFO("fault " << static_cast<int>(fault) << " after " << n << " calls of " << honest.n_asked);
        UnreliableMesh host;
        host.fault = fault;
        host.n_honest = n;
        const bool survived = survives([&] { work(host); });
        if (fault == Fault::throws) CHECK(survived == (n == honest.n_asked));
        if (n == 0 && fault != Fault::moves && fault != Fault::one_less) CHECK_FALSE(survived);
      }
    }
  };
  SECTION("checks") {
    try_all(validated);
  }
  SECTION("finder") {
    try_all(found);
  }
  SECTION("recombination") {
    try_all(recombined);
  }
}

TEST_CASE("what an observer throws arrives") {
  for (int n = 1; n < 4; ++n) {
    int n_heard = 0;
    const auto observer = [&](const Progress&) {
      if (++n_heard == n) throw HostFailure{};
      return true;
    };
    CHECK_THROWS_AS(recombine(test::kuhn_lattice(3), {.observer = observer}), HostFailure);
  }
}
