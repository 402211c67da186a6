# SPDX-License-Identifier: BSL-1.0
# g++ and clang make the same meshes, bit by bit: `ctest -C compilers`, after the target compilers_mesh is built, which scripts/check.sh
# does. Skipped where only one of them is installed.
if(NOT TARGET framehex_compiled)
  return()
endif()
add_executable(compilers_mesh EXCLUDE_FROM_ALL ${CMAKE_CURRENT_LIST_DIR}/mesh.cpp)
target_include_directories(compilers_mesh PRIVATE ${CMAKE_CURRENT_SOURCE_DIR})
target_link_libraries(compilers_mesh PRIVATE framehex_development framehex::compiled)
# What `framehex::compiled` has is not compiled again.
target_compile_options(compilers_mesh PRIVATE -include framehex/adapters/compiled.hpp)

if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  find_program(FRAMEHEX_OTHER_COMPILER NAMES clang++-16)
else()
  find_program(FRAMEHEX_OTHER_COMPILER NAMES g++)
endif()
set(models ${PROJECT_SOURCE_DIR}/tests/data)
add_test(NAME "compilers: the same meshes from g++ and clang" CONFIGURATIONS compilers
         COMMAND ${CMAKE_CURRENT_LIST_DIR}/compare.sh "${FRAMEHEX_OTHER_COMPILER}" $<TARGET_FILE:compilers_mesh>
                 ${CMAKE_CURRENT_BINARY_DIR}/compilers "${models}/bunny.stl 0.6 ${models}/dome.ply 0.5 ${models}/naca.ply 0.1"
                 -std=c++20 -O2 -DNDEBUG -ffp-contract=off -I${CMAKE_CURRENT_SOURCE_DIR} ${include_flags}
                 ${CMAKE_CURRENT_LIST_DIR}/mesh.cpp)
set_tests_properties("compilers: the same meshes from g++ and clang" PROPERTIES TIMEOUT 900 SKIP_RETURN_CODE 77)
