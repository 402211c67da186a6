# SPDX-License-Identifier: BSL-1.0
# Adapters over the real libraries, those that are light to install; tests/heavy_hosts has the others.
target_sources(test_hosts PRIVATE ${CMAKE_CURRENT_LIST_DIR}/reference.cpp)
foreach(adapter IN ITEMS tetgen openmesh tbb)
  framehex_find_adapter(${adapter})
  target_link_libraries(test_hosts PRIVATE framehex::${adapter})
endforeach()
target_include_directories(test_hosts SYSTEM PRIVATE ${CMAKE_CURRENT_LIST_DIR}/fakes)
# Much is instantiated for little that is run.
target_compile_options(test_hosts PRIVATE -O0)
set_target_properties(test_hosts PROPERTIES DISABLE_PRECOMPILE_HEADERS ON) # theirs are made at -O2

# The examples of the hosts that no Debian package has, by the same stand-ins.
get_target_property(eigen_directories Eigen3::Eigen INTERFACE_INCLUDE_DIRECTORIES)
list(TRANSFORM eigen_directories PREPEND "-isystem;")
foreach(host IN ITEMS geogram openvolumemesh)
  add_test(NAME "hosts: the example of ${host} compiles"
           COMMAND ${CMAKE_CXX_COMPILER} -std=c++20 -fsyntax-only -I${PROJECT_SOURCE_DIR}/include ${eigen_directories} -isystem
                   ${CMAKE_CURRENT_LIST_DIR}/fakes ${PROJECT_SOURCE_DIR}/examples/hosts/${host}.cpp)
endforeach()
