# SPDX-License-Identifier: BSL-1.0
target_compile_definitions(test_insertion PRIVATE FRAMEHEX_TEST_DATA="${CMAKE_CURRENT_SOURCE_DIR}/data")
