#!/usr/bin/env python3
# SPDX-License-Identifier: BSL-1.0
"""Builds the Debian packages and tries what they hold: check_deb.py CPACK BUILD_DIR PREFIX COMPILER

PREFIX has what `cmake --install` installs, and the package of the headers must hold the same but for the program. It is unpacked,
not installed, and a unit is compiled by the flags that its pkg-config file gives. The program's package is made where the program
is built, and the program runs from it.
"""
import os
import pathlib
import subprocess
import sys
import tempfile

cpack, build, prefix, compiler = sys.argv[1:]


def run(*command, **options):
    return subprocess.run(list(map(str, command)), check=True, capture_output=True, text=True, **options).stdout


def files_below(folder):
    return {p.relative_to(folder).as_posix() for p in pathlib.Path(folder).rglob("*") if p.is_file()}


def make_package(work, component):
    run(cpack, "-G", "DEB", "-D", f"CPACK_COMPONENTS_ALL={component}", "-B", work / component, cwd=build)
    package, = work.glob(f"{component}/*.deb")
    return package


with tempfile.TemporaryDirectory() as name:
    work = pathlib.Path(name)
    package = make_package(work, "headers")
    field = lambda key: run("dpkg-deb", "--field", package, key).strip()
    version = field("Version")
    assert package.name == f"libframehex-dev_{version}_all.deb", package.name
    assert field("Package") == "libframehex-dev" and field("Architecture") == "all"
    assert "libeigen3-dev" in field("Depends") and "libboost-dev" in field("Depends"), field("Depends")

    run("dpkg-deb", "--extract", package, work / "root")
    unpacked = work / "root" / "usr"
    installed = {f for f in files_below(prefix) if not f.startswith("bin/")}
    assert files_below(unpacked) == installed, sorted(files_below(unpacked) ^ installed)[:5]

    environment = os.environ | {"PKG_CONFIG_PATH": str(unpacked / "share" / "pkgconfig")}
    assert run("pkg-config", "--modversion", "framehex", env=environment).strip() == version
    flags = run("pkg-config", "--cflags", "framehex", env=environment).split()
    unit = work / "unit.cpp"
    unit.write_text("#include <framehex/mesh/indexed_mesh.hpp>\n#include <framehex/version.hpp>\n"
                    f'static_assert(FRAMEHEX_VERSION == std::string_view("{version}"));\n'
                    "static_assert(FRAMEHEX_VERSION_NUMBER == " + str(sum(int(part) * 100**(2 - i) for i, part in
                                                                          enumerate(version.split(".")))) + ");\n")
    made = subprocess.run([compiler, "-std=c++20", "-fsyntax-only", "-H", *flags, unit], capture_output=True, text=True)
    assert made.returncode == 0, made.stderr[-2000:]
    assert str(unpacked) in made.stderr, f"compiled from elsewhere, with {flags}"
    print(f"{package.name}: {len(installed)} files")

    if pathlib.Path(build, "bin", "framehex").exists():
        package = make_package(work, "program")
        assert field("Package") == "framehex" and "libc6" in field("Depends") and "tetgen" in field("Recommends")
        run("dpkg-deb", "--extract", package, work / "program_root")
        assert version in run(work / "program_root" / "usr" / "bin" / "framehex", "--version")
        print(f"{package.name}: runs")
