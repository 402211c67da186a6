// SPDX-License-Identifier: BSL-1.0
#include "own_mesh.hpp"

struct Vertex;
struct Tet;
struct MyMesh;
struct MyVertex;
struct MyMixedMesh {
  MyVertex* new_vertex(double, double, double);
  void new_cell(int, std::span<MyVertex* const>);
};
extern MyMixedMesh mixed;
