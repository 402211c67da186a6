# SPDX-License-Identifier: BSL-1.0
# The predicates once more as a host may compile them: products and sums fused to one operation where that exists.
include(CheckCXXSourceRuns)
set(CMAKE_REQUIRED_FLAGS -mfma)
check_cxx_source_runs("int main() { return __builtin_cpu_supports(\"fma\") ? 0 : 1; }" framehex_has_fma)
unset(CMAKE_REQUIRED_FLAGS)
add_executable(test_geometry_contracted ${CMAKE_CURRENT_LIST_DIR}/test_predicates.cpp)
target_include_directories(test_geometry_contracted PRIVATE ${CMAKE_CURRENT_SOURCE_DIR})
target_link_libraries(test_geometry_contracted PRIVATE framehex_development Catch2::Catch2WithMain rapidcheck)
# After the option of framehex_development, which it undoes.
target_compile_options(test_geometry_contracted PRIVATE -ffp-contract=fast $<$<BOOL:${framehex_has_fma}>:-mfma>)
catch_discover_tests(test_geometry_contracted TEST_PREFIX "geometry, contracted: ")
