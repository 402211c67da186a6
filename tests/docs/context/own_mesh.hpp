// SPDX-License-Identifier: BSL-1.0
// Of the pages that adapt a mesh, which share one namespace.
#pragma once

struct OwnMesh {
  int n_vertices, n_tets;
  float* xyz;
  int (*tets)[4];
};
extern const OwnMesh mesh;
