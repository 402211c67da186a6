# SPDX-License-Identifier: BSL-1.0
# The program, run as users run it. Each class of the scripts is a test.
if(NOT TARGET framehex_program)
  return()
endif()
set(program_environment FRAMEHEX=$<TARGET_FILE:framehex_program> PYTHONDONTWRITEBYTECODE=1)
file(STRINGS ${CMAKE_CURRENT_LIST_DIR}/test_program.py classes REGEX "^class Test")
foreach(line IN LISTS classes)
  string(REGEX REPLACE "^class (Test[A-Za-z]+).*" "\\1" class "${line}")
  add_test(NAME "program: ${class}" COMMAND Python3::Interpreter ${CMAKE_CURRENT_LIST_DIR}/test_program.py ${class})
  set_tests_properties("program: ${class}" PROPERTIES ENVIRONMENT "${program_environment}" TIMEOUT 900)
endforeach()
add_test(NAME "program: files_campaign" COMMAND Python3::Interpreter ${CMAKE_CURRENT_LIST_DIR}/test_files_campaign.py)
set_tests_properties("program: files_campaign" PROPERTIES ENVIRONMENT "${program_environment}" TIMEOUT 900)
# It times the program, so nothing else may run.
set_tests_properties("program: TestInterruption" PROPERTIES RUN_SERIAL ON)
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${CMAKE_CURRENT_LIST_DIR}/test_program.py)
add_test(NAME "program: checkMesh takes what is made for finite volumes"
         COMMAND Python3::Interpreter ${PROJECT_SOURCE_DIR}/benchmarks/solvers/check_mesh.py $<TARGET_FILE:framehex_program>
                 ${PROJECT_SOURCE_DIR}/tests/data/dome.ply:0.3 ${PROJECT_SOURCE_DIR}/tests/data/naca.ply:0.06)
# A small part of the campaign (docs/robustness.md).
add_test(NAME "program: surfaces turned at random are meshed, without a fault and without a poor cell"
         COMMAND Python3::Interpreter ${PROJECT_SOURCE_DIR}/benchmarks/campaign.py --program $<TARGET_FILE:framehex_program>
                 --cells 300 --limit 120 ${PROJECT_SOURCE_DIR}/tests/data)
if(TARGET own_mesh)
  add_test(NAME "program: own_mesh" COMMAND own_mesh)
  set_tests_properties("program: own_mesh" PROPERTIES PASS_REGULAR_EXPRESSION
                                                      "384 tetrahedra became 64 cells, 64 of them hexahedra")
  # A host's own mesh over the compiled library: the same file, byte for byte.
  add_executable(own_mesh_compiled ${PROJECT_SOURCE_DIR}/examples/own_mesh/own_mesh.cpp)
  target_link_libraries(own_mesh_compiled PRIVATE framehex::compiled)
  add_test(NAME "program: own_mesh is the same over the compiled library"
           COMMAND sh -c "\"$1\" headers.vtu && \"$2\" compiled.vtu && cmp headers.vtu compiled.vtu" --
                   $<TARGET_FILE:own_mesh> $<TARGET_FILE:own_mesh_compiled>)
endif()
