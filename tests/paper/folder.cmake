# SPDX-License-Identifier: BSL-1.0
# A few rows of docs/results.md: no share of hexahedra may fall below what is stored there. The scripts that make and keep
# the rows, with a program that makes its reports up; whether the pages are what the rows give.
if(TARGET framehex_program)
  add_test(NAME "paper: quick" COMMAND Python3::Interpreter ${PROJECT_SOURCE_DIR}/benchmarks/paper/run.py
                                       $<TARGET_FILE:framehex_program> --quick)
  set_tests_properties("paper: quick" PROPERTIES ENVIRONMENT PYTHONDONTWRITEBYTECODE=1 TIMEOUT 900)
endif()
foreach(script IN ITEMS run tables)
  add_test(NAME "paper: ${script}" COMMAND Python3::Interpreter ${CMAKE_CURRENT_LIST_DIR}/test_${script}.py)
  set_tests_properties("paper: ${script}" PROPERTIES ENVIRONMENT PYTHONDONTWRITEBYTECODE=1 TIMEOUT 900)
endforeach()
