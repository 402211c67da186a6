# SPDX-License-Identifier: BSL-1.0
# Against an integer programming solver; skipped where Python has no scipy.
function(add_milp_test name)
  add_test(NAME "selection: ${name}" COMMAND ${Python3_EXECUTABLE} ${CMAKE_CURRENT_SOURCE_DIR}/selection/milp_oracle.py
           $<TARGET_FILE:select_graph> ${ARGN})
  set_tests_properties("selection: ${name}" PROPERTIES SKIP_RETURN_CODE 77)
endfunction()

if(TARGET select_graph)
  add_milp_test("the example equals scipy's integer programming")
  add_executable(candidate_graph selection/candidate_graph.cpp)
  target_include_directories(candidate_graph PRIVATE ${PROJECT_SOURCE_DIR}/benchmarks)
  target_link_libraries(candidate_graph PRIVATE framehex_development)
  add_milp_test("real graphs up to 10,000 candidates equal scipy's integer programming"
                $<TARGET_FILE:candidate_graph> 8:0.3 16:0.5 19:0.5)
  # Some minutes of integer programming: `ctest -C oracle -R HiGHS`.
  add_test(NAME "selection: the ball of 12 cells equals HiGHS" CONFIGURATIONS oracle
           COMMAND ${Python3_EXECUTABLE} ${CMAKE_CURRENT_SOURCE_DIR}/selection/milp_oracle.py
           $<TARGET_FILE:select_graph> $<TARGET_FILE:candidate_graph> 12:0.3)
endif()
