// SPDX-License-Identifier: BSL-1.0
// A host whose mesh is distributed over MPI already, in arrays of its own: its frame field and its recombination, without
// a copy of the whole anywhere. mpirun -n 4 distributed_host
#include "framehex/distributed/frame_field.hpp"
#include "framehex/distributed/recombine.hpp"

#include <cstdio>

namespace solver {

/// Cells of a slab of n layers of cubes a rank, six tetrahedra each, and all their vertices.
struct Part {
  std::vector<double> xyz;
  std::vector<int> corners;          // four a tetrahedron
  std::vector<long> vertex_numbers;  // in the whole mesh
  long first_cell_number;            // cells are numbered on from rank to rank
  std::vector<int> owners;           // rank, of each vertex
};

Part make_part(int n, int rank) {
  Part part;
  const auto vertex = [n](int i, int j, int k) { return i + (n + 1) * (j + (n + 1) * k); };
  for (int k = 0; k <= n; ++k)
    for (int j = 0; j <= n; ++j)
      for (int i = 0; i <= n; ++i) {
        part.xyz.insert(part.xyz.end(), {double(i), double(j), double(k + rank * n)});
        part.vertex_numbers.push_back(vertex(i, j, k) + long(rank) * n * (n + 1) * (n + 1));
        part.owners.push_back(k == 0 && rank > 0 ? rank - 1 : rank);  // the layer between belongs to the rank below
      }
  constexpr int orders[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}};
  for (int cube = 0; cube < n * n * n; ++cube)
    for (int o = 0; o < 6; ++o) {
      int at[3] = {cube % n, cube / n % n, cube / (n * n)}, tet[4] = {vertex(at[0], at[1], at[2])};
      for (int step = 0; step < 3; ++step) {
        ++at[orders[o][step]];
        tet[step + 1] = vertex(at[0], at[1], at[2]);
      }
      if (o >= 3) std::swap(tet[2], tet[3]);
      part.corners.insert(part.corners.end(), tet, tet + 4);
    }
  part.first_cell_number = long(rank) * 6 * n * n * n;
  return part;
}

}  // namespace solver

// What framehex asks of the host: how the part is read, as of any mesh...
template <>
struct framehex::mesh_traits<solver::Part> {
  using vertex_type = int;
  using cell_type = int;
  using scalar_type = double;

  static auto vertices(const solver::Part& p) { return std::views::iota(0, int(p.owners.size())); }
  static auto cells(const solver::Part& p) { return std::views::iota(0, int(p.corners.size()) / 4); }
  static std::size_t index(const solver::Part&, int v) { return std::size_t(v); }
  static std::array<double, 3> point(const solver::Part& p, int v) {
    const double* x = &p.xyz[3 * std::size_t(v)];
    return {x[0], x[1], x[2]};
  }
  static std::array<int, 4> cell_vertices(const solver::Part& p, int c) {
    const int* v = &p.corners[4 * std::size_t(c)];
    return {v[0], v[1], v[2], v[3]};
  }
};

// ... and how it belongs to the whole.
template <>
struct framehex::distributed::distribution_traits<solver::Part> {
  static std::int64_t global_vertex(const solver::Part& p, int v) { return p.vertex_numbers[std::size_t(v)]; }
  static std::int64_t global_cell(const solver::Part& p, int c) { return p.first_cell_number + c; }
  static int owner(const solver::Part& p, int v) { return p.owners[std::size_t(v)]; }
};

int main(int argc, char** argv) {
  MPI_Init(&argc, &argv);
  int status = 0;
  {
    const framehex::distributed::MpiTransport transport(MPI_COMM_WORLD);
    const solver::Part part = solver::make_part(6, transport.rank());
    try {
      const auto field = framehex::distributed::compute_frame_field(part, transport);
      const auto result = framehex::distributed::recombine(part, transport);
      std::printf("rank %d: %zu frames, %zu cells, %zu vertices, %zu of them shared with other ranks\n",
                  transport.rank(), field.frames.size(), result.mesh.n_cells(), result.owners.size(),
                  result.shared.size());
    } catch (const framehex::distributed::remote_error& e) {
      if (transport.rank() == 0) std::fprintf(stderr, "%s\n", e.what());  // the same on all ranks
      status = 1;
    }
  }
  MPI_Finalize();
  return status;
}
