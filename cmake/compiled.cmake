# SPDX-License-Identifier: BSL-1.0
# `framehex::compiled`: what users of the library's own meshes call most, compiled once (adapters/compiled.hpp).
# Built when something links it, or by name.
add_library(framehex_compiled STATIC EXCLUDE_FROM_ALL src/compiled.cpp)
add_library(framehex::compiled ALIAS framehex_compiled)
target_link_libraries(framehex_compiled PUBLIC framehex::framehex)
# As in the program and the tests: the same results from every compiler and processor.
target_compile_options(framehex_compiled PRIVATE -ffp-contract=off)
