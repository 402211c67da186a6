# SPDX-License-Identifier: BSL-1.0
# From this source tree: spack repo add packaging/spack; spack dev-build framehex@0.2.0
from spack.package import *


class Framehex(CMakePackage):
    """Header-only C++20 library of generic algorithms for hex-dominant meshing."""

    license("BSL-1.0")

    version("0.2.0")

    depends_on("cxx", type="build")
    depends_on("cmake@3.25:", type="build")
    depends_on("eigen@3.4:")
    depends_on("boost@1.74:")

    conflicts("%gcc@:11", msg="C++20 ranges are needed")

    def cmake_args(self):
        return [self.define(f"FRAMEHEX_BUILD_{part}", False) for part in ("EXAMPLES", "TESTS", "BENCHMARKS")]
