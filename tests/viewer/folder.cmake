# SPDX-License-Identifier: BSL-1.0
# The page that shows a mesh, in headless Chromium. Each class of the script is a test.
if(NOT TARGET framehex_program)
  return()
endif()
foreach(class IN ITEMS TestModel TestRegions TestView TestBrowser TestSources)
  add_test(NAME "viewer: ${class}" COMMAND Python3::Interpreter ${CMAKE_CURRENT_LIST_DIR}/test_viewer.py ${class})
  set_tests_properties("viewer: ${class}" PROPERTIES ENVIRONMENT
                                                     "FRAMEHEX=$<TARGET_FILE:framehex_program>;PYTHONDONTWRITEBYTECODE=1"
                                                     TIMEOUT 900)
endforeach()
