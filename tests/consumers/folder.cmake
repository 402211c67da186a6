# SPDX-License-Identifier: BSL-1.0
# Projects that use framehex as users do, each configured, built and run from nothing.
set(prefix ${CMAKE_CURRENT_BINARY_DIR}/consumers/prefix)

add_test(NAME "consumers: install" COMMAND ${CMAKE_COMMAND} --install ${PROJECT_BINARY_DIR} --prefix ${prefix})
set_tests_properties("consumers: install" PROPERTIES FIXTURES_SETUP installed)

function(add_consumer name source)
  add_test(NAME "consumers: ${name}"
           COMMAND ${CMAKE_CTEST_COMMAND} --build-and-test ${source} ${CMAKE_CURRENT_BINARY_DIR}/consumers/${name}
                   --build-generator ${CMAKE_GENERATOR} --build-options ${ARGN} -DCMAKE_BUILD_TYPE=Debug
                   -DCMAKE_CXX_COMPILER=${CMAKE_CXX_COMPILER} --test-command ${CMAKE_CTEST_COMMAND}
                   --output-on-failure)
  set_tests_properties("consumers: ${name}" PROPERTIES FIXTURES_REQUIRED installed TIMEOUT 900)
endfunction()
add_consumer(find_package ${CMAKE_CURRENT_LIST_DIR}/find_package -Dframehex_ROOT=${prefix})
add_consumer(add_subdirectory ${CMAKE_CURRENT_LIST_DIR}/add_subdirectory -DFRAMEHEX_SOURCE=${PROJECT_SOURCE_DIR})

# The library as one header compiles, and so do the recipes of package managers, as far as that can be seen without them.
set(single ${CMAKE_CURRENT_BINARY_DIR}/consumers/single/framehex)
file(MAKE_DIRECTORY ${single})
get_target_property(eigen_directories Eigen3::Eigen INTERFACE_INCLUDE_DIRECTORIES)
list(TRANSFORM eigen_directories PREPEND "-isystem;")
add_test(NAME "consumers: write single header"
         COMMAND Python3::Interpreter ${PROJECT_SOURCE_DIR}/scripts/amalgamate.py ${single}/framehex.hpp)
set_tests_properties("consumers: write single header" PROPERTIES FIXTURES_SETUP single_header)
add_test(NAME "consumers: single header" COMMAND ${CMAKE_CXX_COMPILER} -std=c++20 -fsyntax-only -I${single}/..
                                                 ${eigen_directories} ${CMAKE_CURRENT_LIST_DIR}/consumer.cpp)
set_tests_properties("consumers: single header" PROPERTIES FIXTURES_REQUIRED single_header TIMEOUT 900)
add_test(NAME "consumers: recipes" COMMAND Python3::Interpreter ${CMAKE_CURRENT_LIST_DIR}/check_recipes.py
                                           ${PROJECT_SOURCE_DIR})
add_test(NAME "consumers: Debian packages"
         COMMAND Python3::Interpreter ${CMAKE_CURRENT_LIST_DIR}/check_deb.py ${CMAKE_CPACK_COMMAND} ${PROJECT_BINARY_DIR}
                 ${prefix} ${CMAKE_CXX_COMPILER})
set_tests_properties("consumers: Debian packages" PROPERTIES FIXTURES_REQUIRED installed)
add_test(NAME "consumers: FetchContent"
         COMMAND ${CMAKE_COMMAND} -S ${CMAKE_CURRENT_LIST_DIR}/fetch_content -B ${CMAKE_CURRENT_BINARY_DIR}/consumers/fetch_content
                 -DFRAMEHEX_SOURCE=${PROJECT_SOURCE_DIR} -DCMAKE_CXX_COMPILER=${CMAKE_CXX_COMPILER})
add_test(NAME "consumers: results of the microbenchmark are compared"
         COMMAND Python3::Interpreter ${CMAKE_CURRENT_LIST_DIR}/check_compare.py
                 ${PROJECT_SOURCE_DIR}/examples/microbenchmark/compare.py)
