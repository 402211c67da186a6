// SPDX-License-Identifier: BSL-1.0
// TetGen fills a cube within the process; its output is recombined where it lies.
#include <framehex/adapters/tetgen.hpp>
#include <framehex/io/vtu_writer.hpp>
#include <framehex/pipeline/recombine.hpp>

#include <cstdio>

int main() {
  tetgenio in, out;
  in.numberofpoints = 8;
  in.pointlist = new double[24]{0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 0, 0, 1, 1, 0, 1, 1, 1, 1, 0, 1, 1};
  const int sides[6][4] = {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}};
  in.numberoffacets = 6;
  in.facetlist = new tetgenio::facet[6];
  in.facetmarkerlist = new int[6]{1, 2, 3, 4, 5, 6};
  for (int f = 0; f < 6; ++f) {
    tetgenio::init(&in.facetlist[f]);
    in.facetlist[f].numberofpolygons = 1;
    in.facetlist[f].polygonlist = new tetgenio::polygon[1];
    in.facetlist[f].polygonlist[0].numberofvertices = 4;
    in.facetlist[f].polygonlist[0].vertexlist = new int[4]{sides[f][0], sides[f][1], sides[f][2], sides[f][3]};
  }
  char switches[] = "pq1.2a0.002Q";
  tetrahedralize(switches, &in, &out);

  const auto faces = framehex::tetgen_faces(out);  // the markers come back on the faces of the result
  const auto result = framehex::recombine(out, {.faces = faces});
  std::printf("%d tetrahedra became %zu cells, with labels of %zu faces\n", out.numberoftetrahedra,
              result.mesh.n_cells(), result.mesh.faces.size());
  framehex::write_vtu("tetgen.vtu", result.mesh);
}
