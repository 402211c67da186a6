# SPDX-License-Identifier: BSL-1.0
# Against an integer programming solver; skipped where Python has no scipy.
if(TARGET select_graph)
  add_test(NAME "selection: the example equals scipy's integer programming"
           COMMAND ${Python3_EXECUTABLE} ${CMAKE_CURRENT_SOURCE_DIR}/selection/milp_oracle.py $<TARGET_FILE:select_graph>)
  set_tests_properties("selection: the example equals scipy's integer programming" PROPERTIES SKIP_RETURN_CODE 77)
endif()
