# SPDX-License-Identifier: BSL-1.0
# Every C++ snippet of the documentation compiles; its links lead somewhere; words are spelled as aspell has them;
# Doxygen has no complaint, and no public name is without words.
get_target_property(eigen_directories Eigen3::Eigen INTERFACE_INCLUDE_DIRECTORIES)
list(TRANSFORM eigen_directories PREPEND "-isystem;")
add_test(NAME "docs: snippets compile, links lead somewhere"
         COMMAND Python3::Interpreter ${CMAKE_CURRENT_LIST_DIR}/check_snippets.py ${PROJECT_SOURCE_DIR} --compiler
                 ${CMAKE_CXX_COMPILER} --flags ${eigen_directories})
set_tests_properties("docs: snippets compile, links lead somewhere" PROPERTIES TIMEOUT 900)
add_test(NAME "docs: the executor over a thread pool waits for its tasks, whatever throws"
         COMMAND Python3::Interpreter ${CMAKE_CURRENT_LIST_DIR}/run_pool_executor.py ${PROJECT_SOURCE_DIR} ${CMAKE_CXX_COMPILER}
                 ${eigen_directories})
add_test(NAME "docs: spelling of pages and comments" COMMAND Python3::Interpreter ${CMAKE_CURRENT_LIST_DIR}/check_spelling.py
                                                            ${PROJECT_SOURCE_DIR})
add_test(NAME "docs: reference of all public names" COMMAND ${PROJECT_SOURCE_DIR}/scripts/reference.sh
                                                           ${CMAKE_CURRENT_BINARY_DIR}/reference)
