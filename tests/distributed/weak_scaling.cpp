// SPDX-License-Identifier: BSL-1.0
// What a rank spends when each brings as many tetrahedra: mpirun -n N weak_scaling LAYERS [field|recombine] [PART_SIZE]
// A box of cubes, LAYERS^3 of them a rank, their inner vertices moved; for fields bent to a cylinder, which has singular
// lines. Rank 0 prints a line.
#include "framehex/distributed/frame_field.hpp"
#include "framehex/distributed/recombine.hpp"

#include "support/kuhn_lattice.hpp"

#include <sys/resource.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>

using namespace framehex;
using namespace framehex::distributed;

namespace {

/// A slab of n x n x n cubes of a box of n x n x (n * n_ranks).
IndexedPart slab(index_t n, int rank, int n_ranks) {
  IndexedPart part{test::kuhn_lattice(n), {}, {}, {}};
  const std::int64_t layer = (std::int64_t{n} + 1) * (n + 1), n_layers = std::int64_t{n} * n_ranks;
  for (Vector3& p : part.mesh.points) {
    const std::int64_t k = static_cast<std::int64_t>(p.z()) + std::int64_t{n} * rank;
    const auto in_layer = static_cast<std::int64_t>(p.x()) + static_cast<std::int64_t>(p.y()) * (n + 1);
    const std::int64_t id = in_layer + k * layer;
    part.vertex_ids.push_back(id);
    part.owners.push_back(p.z() == 0 && rank > 0 ? rank - 1 : rank);
    const bool is_inner = p.x() > 0 && p.y() > 0 && p.x() < n && p.y() < n && k > 0 && k < n_layers;
    p.z() = static_cast<double>(k);
    if (!is_inner) continue;
    auto random = static_cast<std::uint64_t>(id) * 0x9e3779b97f4a7c15u;
    for (int i = 0; i < 3; ++i) {
      random = (random ^ (random >> 29)) * 0xbf58476d1ce4e5b9u;
      p[i] += 0.1 * (static_cast<double>(random >> 11) * 0x1p-52 - 1);
    }
  }
  for (std::size_t c = 0; c < part.mesh.tets.size(); ++c)
    part.cell_ids.push_back(static_cast<std::int64_t>(c + part.mesh.tets.size() * static_cast<std::size_t>(rank)));
  return part;
}

void bend(IndexedPart& part, index_t n) {
  for (Vector3& p : part.mesh.points) {
    const double x = 2 * p.x() / n - 1, y = 2 * p.y() / n - 1;
    p.x() = 0.5 * n * x * std::sqrt(1 - y * y / 2);
    p.y() = 0.5 * n * y * std::sqrt(1 - x * x / 2);
  }
}

void run(const MpiTransport& transport, index_t n, bool is_field, std::size_t part_size) {
  IndexedPart part = slab(n, transport.rank(), transport.n_ranks());
  if (is_field) {
    bend(part, n);
    distributed::compute_frame_field(part, transport);
  } else {
    distributed::RecombineOptions options;
    options.parts.part_size = part_size;
    distributed::recombine(part, transport, options);
  }
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  const Traffic& traffic = transport.traffic();
  const std::vector<double> mine{seconds(usage.ru_utime) + seconds(usage.ru_stime) - traffic.seconds,
                                 traffic.seconds,
                                 1e-3 * double(usage.ru_maxrss),
                                 double(traffic.messages),
                                 1e-6 * double(traffic.bytes),
                                 double(traffic.collectives)};
  const std::vector<double> all = distributed::detail::gathered(transport, mine);
  if (transport.rank() != 0) return;
  std::printf("%2d ranks of %zu tetrahedra, mean and largest of a rank:", transport.n_ranks(), part.mesh.tets.size());
  constexpr std::array<const char*, 6> names{"s", "in MPI s", "MB", "messages", "MB sent", "collectives"};
  for (std::size_t i = 0; i < mine.size(); ++i) {
    double sum = 0, largest = 0;
    for (std::size_t r = i; r < all.size(); r += mine.size()) {
      sum += all[r];
      largest = std::max(largest, all[r]);
    }
    std::printf("  %s %.1f %.1f", names[i], sum / transport.n_ranks(), largest);
  }
  std::printf("\n");
}

}  // namespace

int main(int argc, char** argv) {
  MPI_Init(&argc, &argv);
  if (argc < 3) return std::fprintf(stderr, "weak_scaling LAYERS field|recombine [PART_SIZE]\n"), 2;
  {
    const MpiTransport transport(MPI_COMM_WORLD);
    run(transport, static_cast<index_t>(std::atoi(argv[1])), std::strcmp(argv[2], "field") == 0,
        argc > 3 ? static_cast<std::size_t>(std::atoll(argv[3])) : 250000);
  }
  MPI_Finalize();
}
