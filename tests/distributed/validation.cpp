// SPDX-License-Identifier: BSL-1.0
#include "framehex/distributed/frame_field.hpp"

#include "distributed/parts.hpp"
#include "support/mapped_lattices.hpp"

#include <catch2/catch.hpp>
#include <cmath>

using namespace framehex;
using namespace framehex::distributed;

namespace {

/// What a damage on one rank is called on all of them.
struct Expected {
  int rank;
  Entity entity;
  std::string words;
};

void check_refused(const MpiTransport& transport, const IndexedPart& part, const Expected& expected) {
  INFO(expected.words);
  for (const bool field : {false, true}) try {
      if (field)
        distributed::compute_frame_field(part, transport);
      else
        distributed::validate(part, transport);
      FAIL("not refused");
    } catch (const remote_error& e) {
      INFO(e.what());
      CHECK(e.rank() == expected.rank);
      CHECK((e.entity() == expected.entity));
      CHECK(std::string(e.what()).find(expected.words) != std::string::npos);
      CHECK(std::string(e.what()).find("rank " + std::to_string(expected.rank) + ":") == 0);
    }
}

}  // namespace

TEST_CASE("what one rank has wrong, or two have otherwise, is one error with rank and entity on all") {
  const MpiTransport transport(MPI_COMM_WORLD);
  const int n = transport.n_ranks(), rank = transport.rank(), last = n - 1;
  const IndexedTetMesh mesh = test::kuhn_lattice(5);
  const auto ranks = test::dealings()[0].ranks(mesh, n);
  const IndexedPart sound = test::part_of(mesh, ranks, rank);
  distributed::validate(sound, transport);
  const bool is_last = rank == last;

  IndexedPart part = sound;
  if (is_last) part.mesh.points[3].y() = std::nan("");
  check_refused(transport, part, {last, Entity::vertex, "vertex 3 has a coordinate that is not finite"});

  part = sound;
  if (is_last) std::swap(part.mesh.tets[4][0], part.mesh.tets[4][1]);
  check_refused(transport, part, {last, Entity::cell, "cell 4 is inverted"});

  part = sound;
  if (is_last) part.vertex_ids[2] = -5;
  check_refused(transport, part, {last, Entity::vertex, "vertex 2 has the global number -5"});

  part = sound;
  if (is_last) part.owners[2] = n;
  check_refused(transport, part, {last, Entity::vertex, "has the owner " + std::to_string(n) + " of"});

  part = sound;
  if (is_last) part.vertex_ids[2] = part.vertex_ids[9];
  check_refused(transport, part, {last, Entity::vertex, "has the number of another vertex"});

  part = sound;
  if (is_last) part.cell_ids[2] = part.cell_ids[9];
  check_refused(transport, part, {last, Entity::cell, "cell 9 has the global number"});

  if (n == 1) return;
  // A vertex of the last rank that another owns.
  const auto shared = static_cast<std::size_t>(
      std::find_if(sound.owners.begin(), sound.owners.end(), [&](int o) { return o != last; }) - sound.owners.begin());
  part = sound;
  if (is_last) part.mesh.points[shared].x() += 1e-9;
  check_refused(transport, part, {last, Entity::vertex, "has other coordinates than on rank"});

  part = sound;
  if (is_last) part.owners[shared] = last;
  check_refused(transport, part, {last, Entity::vertex, "has the owner " + std::to_string(last) + ", but another"});

  // All agree on an owner that has no such vertex: the last rank has none of vertex 0.
  part = sound;
  for (std::size_t v = 0; v < part.vertex_ids.size(); ++v)
    if (part.vertex_ids[v] == 0) part.owners[v] = last;
  check_refused(transport, part, {0, Entity::vertex, "which does not have it"});

  part = sound;
  if (is_last) part.cell_ids[1] = 0;
  check_refused(transport, part, {last, Entity::cell, "as has a cell of rank 0"});
}

TEST_CASE("cells of two ranks on the same place are refused") {
  const MpiTransport transport(MPI_COMM_WORLD);
  if (transport.n_ranks() == 1) return;
  // Each rank has the whole mesh, under numbers of cells of its own.
  const IndexedTetMesh mesh = test::kuhn_lattice(2);
  IndexedPart part{mesh, {}, {}, {}};
  for (std::size_t v = 0; v < mesh.points.size(); ++v) part.vertex_ids.push_back(static_cast<std::int64_t>(v));
  part.owners.assign(mesh.points.size(), 0);
  for (std::size_t c = 0; c < mesh.tets.size(); ++c)
    part.cell_ids.push_back(static_cast<std::int64_t>(c) + 1000 * transport.rank());
  CHECK_THROWS_WITH(distributed::compute_frame_field(part, transport),
                    Catch::Contains("cells of several ranks overlap"));
}

TEST_CASE("a field that an observer ends on one rank ends on all, and one that throws is heard on all") {
  const MpiTransport transport(MPI_COMM_WORLD);
  const IndexedTetMesh mesh = test::ball_mesh(8);
  const IndexedPart part = test::part_of(mesh, test::dealings()[0].ranks(mesh, transport.n_ranks()), transport.rank());
  for (const int heard : {0, transport.n_ranks() - 1})
    for (const FieldMethod method : {FieldMethod::smoothed, FieldMethod::best}) {
      MeshFieldOptions options{.field = {.method = method}};
      int left = method == FieldMethod::best ? 4 : 1;
      if (transport.rank() == heard) options.field.observer = [&](const Progress&) { return --left > 0; };
      const DistributedField field = distributed::compute_frame_field(part, transport, options);
      CHECK((field.report.status == Status::cancelled));
      CHECK(field.frames.size() == part.vertex_ids.size());
      for (const Quaternion& q : field.frames) REQUIRE(std::abs(q.norm() - 1) < 1e-9);
      if (transport.rank() == heard)
        options.field.observer = [&](const Progress&) -> bool { throw std::runtime_error("the host has had enough"); };
      CHECK_THROWS_WITH(distributed::compute_frame_field(part, transport, options),
                        "rank " + std::to_string(heard) + ": the host has had enough");
    }
}
