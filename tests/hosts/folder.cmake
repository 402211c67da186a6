# SPDX-License-Identifier: BSL-1.0
# Adapters over the real libraries, those that are light to install; tests/heavy_hosts has the others.
target_sources(test_hosts PRIVATE ${CMAKE_CURRENT_LIST_DIR}/reference.cpp)
foreach(adapter IN ITEMS tetgen openmesh tbb)
  framehex_find_adapter(${adapter})
  target_link_libraries(test_hosts PRIVATE framehex::${adapter})
endforeach()
target_include_directories(test_hosts SYSTEM PRIVATE ${CMAKE_CURRENT_LIST_DIR}/fakes)
# Much is instantiated for little that is run.
target_compile_options(test_hosts PRIVATE -O0)
set_target_properties(test_hosts PROPERTIES DISABLE_PRECOMPILE_HEADERS ON) # theirs are made at -O2
