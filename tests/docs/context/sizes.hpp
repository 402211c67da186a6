// SPDX-License-Identifier: BSL-1.0
extern const framehex::IndexedTriangleMesh mesh;
