// SPDX-License-Identifier: BSL-1.0
// error: .vertices. is not a member of|no member named .vertices.|mesh_traits<M>::vertices.mesh
#include "framehex/mesh/validation.hpp"

struct Host {};

template <>
struct framehex::mesh_traits<Host> {
  using vertex_type = int;
  using cell_type = int;
  using scalar_type = double;
  static std::array<int, 1> cells(const Host&) { return {0}; }
  static std::size_t index(const Host&, int vertex) { return static_cast<std::size_t>(vertex); }
  static std::array<double, 3> point(const Host&, int) { return {}; }
  static std::array<int, 4> cell_vertices(const Host&, int) { return {0, 1, 2, 3}; }
};

void use() { framehex::validate(Host{}); }
