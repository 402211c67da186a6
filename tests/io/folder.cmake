# SPDX-License-Identifier: BSL-1.0
find_package(pugixml CONFIG REQUIRED)
find_package(ZLIB REQUIRED)
find_package(LibLZMA REQUIRED)
target_link_libraries(${test_target} PRIVATE pugixml::pugixml ZLIB::ZLIB LibLZMA::LibLZMA)
target_compile_definitions(
  ${test_target} PRIVATE PYTHON="${Python3_EXECUTABLE}" IO_SCRIPTS="${CMAKE_CURRENT_SOURCE_DIR}/io"
                         EXAMPLE_DATA="${PROJECT_SOURCE_DIR}/examples/data")
