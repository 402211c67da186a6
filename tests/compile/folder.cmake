# SPDX-License-Identifier: BSL-1.0
# What must compile, and what must not.

# Every header compiles alone, with our warnings (scripts/check.sh builds it): the library's, and the adapters' with the
# library each needs. Those of heavy libraries are compiled by tests/heavy_hosts, those over MPI by tests/distributed, those
# of libraries that no Debian package has by tests/hosts.
add_library(framehex_headers_alone INTERFACE)
set(headers_alone ${framehex_headers})
list(FILTER headers_alone EXCLUDE REGEX
     "(adapters/(cgal|cgal_delaunay|gmsh|netgen|vtk|openvolumemesh|geogram|ptscotch)\\.hpp|distributed/.*)$")
target_sources(framehex_headers_alone INTERFACE FILE_SET HEADERS BASE_DIRS ${PROJECT_SOURCE_DIR}/include
                                                                  FILES ${headers_alone})
target_compile_options(framehex_headers_alone INTERFACE -O0) # nothing of them is run
target_link_libraries(framehex_headers_alone INTERFACE framehex_development)
foreach(adapter IN ITEMS mesh_reader tetgen openmesh tbb)
  framehex_find_adapter(${adapter})
  target_link_libraries(framehex_headers_alone INTERFACE framehex::${adapter})
endforeach()
set_target_properties(framehex_headers_alone PROPERTIES VERIFY_INTERFACE_HEADER_SETS ON)

# What the headers' text must keep to: layers, names of foreign libraries, length, licence line, umbrella.
add_test(NAME "compile: headers keep the rules" COMMAND Python3::Interpreter ${CMAKE_CURRENT_LIST_DIR}/check_headers.py
                                                        ${PROJECT_SOURCE_DIR})

# Each file of fail/ lacks one requirement of a concept, or asks for flags that are not allowed; the compiler must
# refuse it and name what is wrong.
set(include_flags -I${PROJECT_SOURCE_DIR}/include)
foreach(dependency IN ITEMS Eigen3::Eigen Boost::headers)
  get_target_property(directories ${dependency} INTERFACE_INCLUDE_DIRECTORIES)
  foreach(directory IN LISTS directories)
    if(NOT directory IN_LIST CMAKE_CXX_IMPLICIT_INCLUDE_DIRECTORIES)
      list(APPEND include_flags -isystem ${directory})
    endif()
  endforeach()
endforeach()
file(GLOB fail_sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_LIST_DIR}/fail/*.cpp)
foreach(source IN LISTS fail_sources)
  cmake_path(GET source STEM name)
  file(STRINGS ${source} expected REGEX "^// error: ")
  string(REPLACE "// error: " "" expected "${expected}")
  file(STRINGS ${source} flags REGEX "^// flags: ")
  string(REPLACE "// flags: " "" flags "${flags}")
  add_test(NAME "compile: refused ${name}" COMMAND ${CMAKE_CXX_COMPILER} -std=c++20 -fsyntax-only ${flags}
                                                   ${include_flags} ${source})
  set_tests_properties("compile: refused ${name}" PROPERTIES ENVIRONMENT LC_ALL=C PASS_REGULAR_EXPRESSION
                                                                                                "${expected}")
endforeach()
