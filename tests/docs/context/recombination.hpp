// SPDX-License-Identifier: BSL-1.0
extern const framehex::IndexedTetMesh mesh;
void use(const auto&...) {}
