# SPDX-License-Identifier: BSL-1.0
# An overlay port of this source tree: vcpkg install framehex --overlay-ports=packaging/vcpkg
cmake_path(SET SOURCE_PATH NORMALIZE "${CMAKE_CURRENT_LIST_DIR}/../../..")
vcpkg_cmake_configure(
  SOURCE_PATH "${SOURCE_PATH}"
  OPTIONS -DFRAMEHEX_BUILD_EXAMPLES=OFF -DFRAMEHEX_BUILD_TESTS=OFF -DFRAMEHEX_BUILD_BENCHMARKS=OFF)
vcpkg_cmake_install()
vcpkg_cmake_config_fixup(CONFIG_PATH share/cmake/framehex)
file(REMOVE_RECURSE "${CURRENT_PACKAGES_DIR}/debug") # the same headers once more
vcpkg_install_copyright(FILE_LIST "${SOURCE_PATH}/LICENSE")
