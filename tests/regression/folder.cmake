# SPDX-License-Identifier: BSL-1.0
add_test(NAME "regression: every fault found outside has its test"
         COMMAND Python3::Interpreter ${CMAKE_CURRENT_LIST_DIR}/check_faults.py)
