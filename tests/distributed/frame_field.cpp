// SPDX-License-Identifier: BSL-1.0
#include "framehex/distributed/frame_field.hpp"

#include "distributed/parts.hpp"
#include "support/kuhn_lattice.hpp"
#include "support/mapped_lattices.hpp"

#include <catch2/catch.hpp>

using namespace framehex;
using namespace framehex::distributed;

namespace {

struct Named {
  const char* name;
  IndexedTetMesh mesh;
};

IndexedTetMesh perturbed(IndexedTetMesh mesh, double by) {
  std::mt19937_64 engine(3);
  const auto uniform = [&] { return 2 * (static_cast<double>(engine() >> 11) * 0x1p-53) - 1; };
  for (Vector3& p : mesh.points)
    for (int i = 0; i < 3; ++i) p[i] += by * uniform();
  return mesh;
}

/// Numbers without order: chains of neighbours of rising number are short, and cross borders.
IndexedTetMesh renumbered(const IndexedTetMesh& mesh) {
  std::mt19937 engine(11);
  std::vector<index_t> number(mesh.points.size());
  std::iota(number.begin(), number.end(), 0u);
  std::shuffle(number.begin(), number.end(), engine);
  IndexedTetMesh result = mesh;
  for (index_t v = 0; v < number.size(); ++v) result.points[number[v]] = mesh.points[v];
  for (auto& tet : result.tets)
    for (index_t& v : tet) v = number[v];
  std::shuffle(result.tets.begin(), result.tets.end(), engine);
  return result;
}

/// Everybody's frames in the order of the whole mesh; as `compute_frame_field` turns their forms to one another.
std::vector<Quaternion> whole_frames(const MpiTransport& transport, const IndexedTetMesh& mesh, const IndexedPart& part,
                                     const DistributedField& field) {
  struct Entry {
    std::int64_t id;
    std::array<double, 4> frame;
  };
  std::vector<Entry> mine;
  for (std::size_t v = 0; v < part.vertex_ids.size(); ++v) {
    const Quaternion& q = field.frames[v];
    mine.push_back({part.vertex_ids[v], {q.w(), q.x(), q.y(), q.z()}});
  }
  std::vector<Quaternion> frames(mesh.points.size());
  std::vector<char> known(frames.size(), 0);
  for (const Entry& e : distributed::detail::gathered(transport, mine)) {
    const auto v = static_cast<std::size_t>(e.id);
    const Quaternion q(e.frame[0], e.frame[1], e.frame[2], e.frame[3]);
    if (known[v]) REQUIRE((frames[v].coeffs() == q.coeffs()));
    known[v] = 1;
    frames[v] = q;
  }
  REQUIRE(std::count(known.begin(), known.end(), 1) == static_cast<std::ptrdiff_t>(frames.size()));
  align_representatives(make_adjacency(mesh), frames);
  return frames;
}

double largest_difference(const std::vector<Quaternion>& a, const std::vector<Quaternion>& b) {
  double largest = 0;
  for (std::size_t v = 0; v < a.size(); ++v)
    largest = std::max(largest, (a[v].coeffs() - b[v].coeffs()).cwiseAbs().maxCoeff());
  return largest;
}

/// @return how many small loops were removed.
std::size_t check_field(const MpiTransport& transport, const IndexedTetMesh& mesh, const MeshFieldOptions& options) {
  FieldReport report;
  const auto serial = compute_frame_field(mesh, options, SerialExecutor{}, &report);
  for (const test::Dealing& dealing : test::dealings()) {
    INFO(dealing.name);
    const auto ranks = dealing.ranks(mesh, transport.n_ranks());
    const test::IndexedPart part = test::part_of(mesh, ranks, transport.rank());
    const DistributedField field = distributed::compute_frame_field(part, transport, options);
    const auto frames = whole_frames(transport, mesh, part, field);
    CHECK(largest_difference(frames, serial.frames()) == 0);
    for (std::size_t v = 0; v < part.vertex_ids.size(); ++v) {
      const auto id = static_cast<std::size_t>(part.vertex_ids[v]);
      REQUIRE(std::abs(field.smoothness[v] - serial.smoothness()[id]) < 1e-9);
      REQUIRE((field.constraints[v] == serial.constraints()[id]));
    }
    CHECK(field.report.removed_loops == report.removed_loops);
    CHECK(field.report.smoothing.sweeps.size() == report.smoothing.sweeps.size());
    CHECK(field.report.diffusion.steps == report.diffusion.steps);
  }
  return report.removed_loops;
}

}  // namespace

TEST_CASE("fields are those of the whole mesh, for all methods, meshes and ways to deal it out") {
  const MpiTransport transport(MPI_COMM_WORLD);
  const std::vector<Named> meshes{{"perturbed lattice", perturbed(test::kuhn_lattice(14), 0.1)},
                                  {"ball, without order", renumbered(test::ball_mesh(14))},
                                  {"dome", test::dome_mesh(12)}};
  for (const Named& named : meshes)
    for (const FieldMethod method : {FieldMethod::nearest, FieldMethod::smoothed, FieldMethod::best}) {
      INFO(named.name << ", method " << static_cast<int>(method));
      check_field(transport, named.mesh, {.field = {.method = method}});
    }
}

TEST_CASE("small loops that a rough field has are removed as in the whole mesh") {
  const MpiTransport transport(MPI_COMM_WORLD);
  MeshFieldOptions rough;
  rough.field.diffusion = {.max_steps = 0, .tolerance = 0.5};
  rough.field.polish.max_sweeps = rough.field.polish.max_local_iterations = 1;
  CHECK(check_field(transport, test::cylinder_mesh(8, 8, 1, 2), rough) > 0);
  check_field(transport, renumbered(test::cylinder_mesh(12, 12, 1, 2)), rough);
}

TEST_CASE("frames follow facets between regions") {
  const MpiTransport transport(MPI_COMM_WORLD);
  const IndexedTetMesh mesh = test::ball_mesh(8);
  std::vector<index_t> regions;
  for (const auto& tet : mesh.tets) regions.push_back(mesh.points[tet[0]].x() + mesh.points[tet[3]].x() > 0.1 ? 4 : 2);
  MeshFieldOptions options;
  options.regions = regions;
  const auto serial = compute_frame_field(mesh, options);
  const test::IndexedPart part =
      test::part_of(mesh, test::dealings()[1].ranks(mesh, transport.n_ranks()), transport.rank());
  std::vector<index_t> mine;
  for (const std::int64_t c : part.cell_ids) mine.push_back(regions[static_cast<std::size_t>(c)]);
  options.regions = mine;
  const DistributedField field = distributed::compute_frame_field(part, transport, options);
  CHECK(largest_difference(whole_frames(transport, mesh, part, field), serial.frames()) == 0);
}
