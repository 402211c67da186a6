# SPDX-License-Identifier: BSL-1.0
# A few rows of docs/results.md: no share of hexahedra may fall below what is stored there.
if(TARGET framehex_program)
  add_test(NAME "paper: quick" COMMAND Python3::Interpreter ${PROJECT_SOURCE_DIR}/benchmarks/paper/run.py
                                       $<TARGET_FILE:framehex_program> --quick)
  set_tests_properties("paper: quick" PROPERTIES ENVIRONMENT PYTHONDONTWRITEBYTECODE=1 TIMEOUT 900)
endif()
