// SPDX-License-Identifier: BSL-1.0
extern const framehex::IndexedTriangleMesh mesh;
extern const std::vector<std::array<framehex::index_t, 2>> edges;
extern const std::vector<framehex::SurfaceSample> samples;
