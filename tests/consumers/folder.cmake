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
