# SPDX-License-Identifier: BSL-1.0
# Other people's solvers on meshes of the program: each script knows the answer.
if(NOT TARGET framehex_program)
  return()
endif()
foreach(solve IN ITEMS openfoam_laplace getfem_elasticity calculix_bracket)
  add_test(NAME "solvers: ${solve}"
           COMMAND Python3::Interpreter ${PROJECT_SOURCE_DIR}/examples/solvers/${solve}.py
                   $<TARGET_FILE:framehex_program> --picture ${CMAKE_CURRENT_BINARY_DIR}/${solve}.png)
  set_tests_properties("solvers: ${solve}" PROPERTIES ENVIRONMENT PYTHONDONTWRITEBYTECODE=1 TIMEOUT 900)
endforeach()
