# SPDX-License-Identifier: BSL-1.0
# Against an integer programming solver; skipped where Python has no scipy.
add_executable(matching_cases quads/matching_cases.cpp)
target_include_directories(matching_cases PRIVATE ${CMAKE_CURRENT_SOURCE_DIR})
target_link_libraries(matching_cases PRIVATE framehex_development)
add_test(NAME "quads: LEMON's matchings equal scipy's integer programming"
         COMMAND ${Python3_EXECUTABLE} ${CMAKE_CURRENT_SOURCE_DIR}/quads/matching_oracle.py $<TARGET_FILE:matching_cases>)
set_tests_properties("quads: LEMON's matchings equal scipy's integer programming" PROPERTIES SKIP_RETURN_CODE 77)
