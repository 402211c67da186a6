// SPDX-License-Identifier: BSL-1.0
extern const framehex::Surface surface;
extern const framehex::SurfaceCrossField cross;
extern const framehex::FrameField<framehex::IndexedTetMesh> field;
