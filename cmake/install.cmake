# SPDX-License-Identifier: BSL-1.0
# `cmake --install` and what `find_package(framehex CONFIG)` reads.
include(CMakePackageConfigHelpers)
include(GNUInstallDirs)

set(framehex_package_dir ${CMAKE_INSTALL_DATADIR}/cmake/framehex)
install(TARGETS framehex EXPORT framehexTargets FILE_SET HEADERS)
install(EXPORT framehexTargets NAMESPACE framehex:: DESTINATION ${framehex_package_dir})
configure_package_config_file(cmake/framehexConfig.cmake.in ${PROJECT_BINARY_DIR}/framehexConfig.cmake
                              INSTALL_DESTINATION ${framehex_package_dir})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/framehexConfigVersion.cmake COMPATIBILITY SameMinorVersion
                                 ARCH_INDEPENDENT)
install(FILES ${PROJECT_BINARY_DIR}/framehexConfig.cmake ${PROJECT_BINARY_DIR}/framehexConfigVersion.cmake
              cmake/framehexAdapters.cmake
        DESTINATION ${framehex_package_dir})
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})
