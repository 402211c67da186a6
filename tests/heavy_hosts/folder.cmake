# SPDX-License-Identifier: BSL-1.0
# Adapters over real libraries that are heavy to install; each has a program of its own, since Gmsh contains Netgen.
# With the option FRAMEHEX_BUILD_HOSTS, as scripts/hosts.sh sets it.
if(NOT FRAMEHEX_BUILD_HOSTS)
  return()
endif()
add_custom_target(heavy_hosts)
foreach(host IN ITEMS vtk cgal gmsh netgen)
  framehex_find_adapter(${host})
  set(host_target test_host_${host})
  add_executable(${host_target} ${CMAKE_CURRENT_LIST_DIR}/${host}.cpp ${CMAKE_CURRENT_LIST_DIR}/../hosts/reference.cpp)
  target_include_directories(${host_target} PRIVATE ${CMAKE_CURRENT_SOURCE_DIR})
  target_link_libraries(${host_target} PRIVATE framehex_development framehex::${host} Catch2::Catch2WithMain)
  target_compile_options(${host_target} PRIVATE -O0)
  add_dependencies(heavy_hosts ${host_target})
  catch_discover_tests(${host_target} TEST_PREFIX "heavy_hosts: " PROPERTIES TIMEOUT 900)
endforeach()
find_package(VTK 9 REQUIRED COMPONENTS FiltersCore FiltersSources FiltersVerdict IOXML)
target_link_libraries(test_host_vtk PRIVATE VTK::FiltersCore VTK::FiltersSources VTK::FiltersVerdict VTK::IOXML)

# As a new user: from an empty folder, by what the page says, against the installed library.
foreach(host IN ITEMS eigen_matrices tetgen openmesh vtk cgal gmsh netgen tbb)
  add_test(NAME "heavy_hosts: the page of ${host}, followed"
           COMMAND Python3::Interpreter ${CMAKE_CURRENT_LIST_DIR}/follow_page.py ${host}
                   ${CMAKE_CURRENT_BINARY_DIR}/consumers/prefix ${CMAKE_CXX_COMPILER})
  set_tests_properties("heavy_hosts: the page of ${host}, followed" PROPERTIES FIXTURES_REQUIRED installed TIMEOUT 900)
endforeach()

# As one who has no CMake.
get_target_property(eigen_directories Eigen3::Eigen INTERFACE_INCLUDE_DIRECTORIES)
list(TRANSFORM eigen_directories PREPEND "-isystem;")
foreach(host IN ITEMS eigen_matrices tetgen openmesh vtk cgal gmsh netgen tbb)
  add_test(NAME "heavy_hosts: the flags of ${host}, without CMake"
           COMMAND Python3::Interpreter ${CMAKE_CURRENT_LIST_DIR}/check_flags.py ${host} ${CMAKE_CXX_COMPILER} ${eigen_directories})
  set_tests_properties("heavy_hosts: the flags of ${host}, without CMake" PROPERTIES TIMEOUT 900)
endforeach()
