# SPDX-License-Identifier: BSL-1.0
# `framehex::compiled`: what does not depend on the host's types, and what users of the library's own meshes call most
# (adapters/compiled.hpp), compiled once. Whoever links it has FRAMEHEX_COMPILED defined (config.hpp). Built when something
# links it, or by name.
add_library(framehex_compiled STATIC EXCLUDE_FROM_ALL src/compiled.cpp src/field.cpp src/geometry.cpp
                                                      src/lattice.cpp src/mesh_quads.cpp src/mesh_surface.cpp src/parts.cpp
                                                      src/recombination.cpp src/surface.cpp)
add_library(framehex::compiled ALIAS framehex_compiled)
target_link_libraries(framehex_compiled PUBLIC framehex::framehex)
target_compile_definitions(framehex_compiled PUBLIC FRAMEHEX_COMPILED)
# As in the program and the tests: the same results from every compiler and processor.
target_compile_options(framehex_compiled PRIVATE -ffp-contract=off)
