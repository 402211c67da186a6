# SPDX-License-Identifier: BSL-1.0
# What our own programs, tests and benchmarks are compiled with. Never linked by `framehex::framehex`.
add_library(framehex_development INTERFACE)
target_link_libraries(framehex_development INTERFACE framehex::framehex)
# EIGEN_MPL2_ONLY: no LGPL code slips in through Eigen.
target_compile_definitions(framehex_development INTERFACE EIGEN_MPL2_ONLY)
# No contraction to fused multiply-adds: results are the same from every compiler and processor.
target_compile_options(framehex_development INTERFACE -ffp-contract=off)
if(PROJECT_IS_TOP_LEVEL)
  target_compile_options(framehex_development INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Wconversion
                                                        -Wsign-conversion -Werror)
  # What g++ derives from the flow of optimised code has false alarms (Eigen, std::vector): shown, but no error.
  target_compile_options(
    framehex_development
    INTERFACE $<$<CXX_COMPILER_ID:GNU>:-Wno-error=maybe-uninitialized;-Wno-error=array-bounds;-Wno-error=stringop-overflow;-Wno-error=stringop-overread;-Wno-error=restrict;-Wno-error=dangling-pointer;-Wno-error=free-nonheap-object>)
endif()
