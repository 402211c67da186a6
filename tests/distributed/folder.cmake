# SPDX-License-Identifier: BSL-1.0
# What runs over MPI, each program on several numbers of ranks: with the option FRAMEHEX_BUILD_MPI, as scripts/mpi.sh
# sets it.
if(NOT FRAMEHEX_BUILD_MPI)
  return()
endif()
framehex_find_adapter(distributed)
add_custom_target(distributed)

add_library(distributed_test_main OBJECT ${CMAKE_CURRENT_LIST_DIR}/main.cpp)
target_link_libraries(distributed_test_main PRIVATE framehex::distributed Catch2::Catch2)

# Of more ranks than there are processors, which waiting ranks must give to others; mpirun asks to be told that root may
# run it.
set(mpirun ${CMAKE_COMMAND} -E env OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 OMPI_MCA_mpi_yield_when_idle=1
           ${MPIEXEC_EXECUTABLE} --oversubscribe)
foreach(name IN ITEMS transport validation frame_field files recombine repartition)
  add_executable(test_distributed_${name} ${CMAKE_CURRENT_LIST_DIR}/${name}.cpp)
  target_include_directories(test_distributed_${name} PRIVATE ${CMAKE_CURRENT_SOURCE_DIR})
  target_link_libraries(test_distributed_${name} PRIVATE framehex_development framehex::distributed distributed_test_main
                                                         Catch2::Catch2)
  add_dependencies(distributed test_distributed_${name})
  foreach(n_ranks IN ITEMS 1 2 3 5)
    set(test_name "distributed: ${name} on ${n_ranks} ranks")
    add_test(NAME ${test_name} COMMAND ${mpirun} -n ${n_ranks} $<TARGET_FILE:test_distributed_${name}>)
    set_tests_properties(${test_name} PROPERTIES TIMEOUT 600 PROCESSORS 2)
  endforeach()
endforeach()
framehex_find_adapter(mesh_reader)
framehex_find_adapter(ptscotch)
target_link_libraries(test_distributed_repartition PRIVATE framehex::ptscotch)
target_link_libraries(test_distributed_files PRIVATE framehex::mesh_reader)

# What a rank spends: for docs/distributed.md, run by hand.
add_executable(weak_scaling ${CMAKE_CURRENT_LIST_DIR}/weak_scaling.cpp)
target_include_directories(weak_scaling PRIVATE ${CMAKE_CURRENT_SOURCE_DIR})
target_link_libraries(weak_scaling PRIVATE framehex_development framehex::distributed)
add_dependencies(distributed weak_scaling)

# The program and the example, where they are built.
if(FRAMEHEX_BUILD_EXAMPLES)
  add_dependencies(distributed framehex_program distributed_host)
  add_test(NAME "distributed: the program on several ranks"
           COMMAND Python3::Interpreter ${CMAKE_CURRENT_LIST_DIR}/check_program.py $<TARGET_FILE:framehex_program> ${mpirun})
  add_test(NAME "distributed: example of a host" COMMAND ${mpirun} -n 3 $<TARGET_FILE:distributed_host>)
  set(program_tests "distributed: the program on several ranks" "distributed: example of a host")
  find_program(laplacianFoam laplacianFoam)
  if(laplacianFoam)
    list(APPEND program_tests "distributed: OpenFOAM on two ranks")
    add_test(NAME "distributed: OpenFOAM on two ranks"
             COMMAND Python3::Interpreter ${CMAKE_CURRENT_LIST_DIR}/check_openfoam.py $<TARGET_FILE:framehex_program> ${mpirun})
  endif()
  set_tests_properties(${program_tests} PROPERTIES TIMEOUT 600 PROCESSORS 2)
endif()
