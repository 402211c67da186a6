# SPDX-License-Identifier: BSL-1.0
# `cmake --install` and what `find_package(framehex CONFIG)` reads.
include(CMakePackageConfigHelpers)
include(GNUInstallDirs)

set(framehex_package_dir ${CMAKE_INSTALL_DATADIR}/cmake/framehex)
install(TARGETS framehex EXPORT framehexTargets FILE_SET HEADERS COMPONENT headers)
install(EXPORT framehexTargets NAMESPACE framehex:: DESTINATION ${framehex_package_dir} COMPONENT headers)
configure_package_config_file(cmake/framehexConfig.cmake.in ${PROJECT_BINARY_DIR}/framehexConfig.cmake
                              INSTALL_DESTINATION ${framehex_package_dir})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/framehexConfigVersion.cmake COMPATIBILITY SameMinorVersion
                                 ARCH_INDEPENDENT)
install(FILES ${PROJECT_BINARY_DIR}/framehexConfig.cmake ${PROJECT_BINARY_DIR}/framehexConfigVersion.cmake
              cmake/framehexAdapters.cmake
        DESTINATION ${framehex_package_dir}
        COMPONENT headers)
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT headers)

# For builds without CMake. Boost has no file of its own for pkg-config; its headers are found by the compiler.
configure_file(cmake/framehex.pc.in ${PROJECT_BINARY_DIR}/framehex.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/framehex.pc DESTINATION ${CMAKE_INSTALL_DATADIR}/pkgconfig COMPONENT headers)

# Debian packages by `cpack -G DEB`: libframehex-dev (headers), framehex (the program).
if(PROJECT_IS_TOP_LEVEL)
  set(CPACK_PACKAGE_VENDOR "The framehex developers")
  set(CPACK_PACKAGE_CONTACT "The framehex developers <framehex@example.org>")
  set(CPACK_RESOURCE_FILE_LICENSE ${PROJECT_SOURCE_DIR}/LICENSE)
  set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
  set(CPACK_DEB_COMPONENT_INSTALL ON)
  set(CPACK_COMPONENTS_ALL headers program)
  set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
  set(CPACK_DEBIAN_PACKAGE_SECTION libdevel)
  set(CPACK_DEBIAN_HEADERS_PACKAGE_NAME libframehex-dev)
  set(CPACK_DEBIAN_HEADERS_PACKAGE_ARCHITECTURE all)
  set(CPACK_DEBIAN_HEADERS_PACKAGE_DEPENDS "libeigen3-dev (>= 3.4), libboost-dev (>= 1.74)")
  set(CPACK_DEBIAN_PROGRAM_PACKAGE_NAME framehex)
  set(CPACK_DEBIAN_PROGRAM_PACKAGE_SECTION math)
  set(CPACK_DEBIAN_PROGRAM_PACKAGE_SHLIBDEPS ON)
  set(CPACK_DEBIAN_PROGRAM_PACKAGE_RECOMMENDS tetgen)
  set(CPACK_COMPONENT_HEADERS_DESCRIPTION "Generic algorithms for hex-dominant meshing, headers")
  set(CPACK_COMPONENT_PROGRAM_DESCRIPTION "Hex-dominant meshes of closed surfaces, program")
  include(CPack)
endif()
