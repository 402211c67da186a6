#!/usr/bin/env python3
# SPDX-License-Identifier: BSL-1.0
"""Checks what can be checked of packaging/ without the package managers: check_recipes.py SOURCE_DIR"""
import ast
import json
import pathlib
import re
import sys

root = pathlib.Path(sys.argv[1])
version = re.search(r'FRAMEHEX_VERSION "(.*)"', (root / "include/framehex/version.hpp").read_text())[1]
packaging = root / "packaging"
errors = []

for recipe in ("conan/conanfile.py", "spack/packages/framehex/package.py"):
    classes = [node for node in ast.parse((packaging / recipe).read_text()).body if isinstance(node, ast.ClassDef)]
    if [c.name for c in classes] != ["Framehex"]:
        errors.append(f"{recipe}: no class Framehex")
if f'version("{version}")' not in (packaging / "spack/packages/framehex/package.py").read_text():
    errors.append(f"Spack's recipe is not of version {version}")

port = json.loads((packaging / "vcpkg/framehex/vcpkg.json").read_text())
if (port["name"], port["version"]) != ("framehex", version):
    errors.append(f"vcpkg's port is not framehex {version}")
# A package of vcpkg is a library of Boost: those that the headers include, by their first folder or file.
used = set()
for header in (root / "include").rglob("*.hpp"):
    used |= set(re.findall(r"#include <boost/(\w+)", header.read_text()))
listed = {d.removeprefix("boost-") for d in port["dependencies"] if isinstance(d, str) and d.startswith("boost-")}
needed = {name.replace("_", "-") for name in used}
if needed != listed:
    errors.append(f"vcpkg's port lists Boost's {sorted(listed)}; the headers include {sorted(needed)}")
# What recipes name is there: options of the build, files of the tree, the folder of the installed package.
options = set(re.findall(r"option\((FRAMEHEX_\w+)", (root / "CMakeLists.txt").read_text()))
portfile = (packaging / "vcpkg/framehex/portfile.cmake").read_text()
spack = (packaging / "spack/packages/framehex/package.py").read_text()
parts = re.search(r'define\(f"FRAMEHEX_BUILD_\{part\}", False\) for part in \((.*)\)', spack)[1]
named = {"vcpkg": set(re.findall(r"-D(FRAMEHEX_\w+)", portfile)),
         "Spack": {f"FRAMEHEX_BUILD_{part}" for part in re.findall(r'"(\w+)"', parts)}}
heavy = {"FRAMEHEX_BUILD_EXAMPLES", "FRAMEHEX_BUILD_TESTS", "FRAMEHEX_BUILD_BENCHMARKS"}
for recipe, used_options in named.items():
    if used_options != heavy or not heavy <= options:
        errors.append(f"{recipe}'s recipe turns off {sorted(used_options)}, not {sorted(heavy)}")
config = re.search(r"CONFIG_PATH (\S+)\)", portfile)[1]
if f"framehex_package_dir ${{CMAKE_INSTALL_DATADIR}}/{config.removeprefix('share/')})" not in (root / "cmake/install.cmake").read_text():
    errors.append(f"vcpkg's port looks for the package in {config}")
conan = (packaging / "conan/conanfile.py").read_text()
for pattern in re.search(r'for pattern in \((.*)\):', conan)[1].replace('"', "").split(", "):
    if not list(root.glob(pattern)):
        errors.append(f"Conan's recipe exports {pattern}, which is not there")

# The forms that vcpkg's own schema asks of a manifest.
if set(port) - {"name", "version", "description", "license", "dependencies", "homepage", "documentation", "features", "supports"}:
    errors.append(f"vcpkg's manifest has members of no meaning: {sorted(port)}")
for dependency in port["dependencies"]:
    name = dependency if isinstance(dependency, str) else dependency["name"]
    if not re.fullmatch(r"[a-z0-9]+(-[a-z0-9]+)*", name):
        errors.append(f"vcpkg has no names like {name}")
    if isinstance(dependency, dict) and set(dependency) - {"name", "host", "version>=", "features", "platform", "default-features"}:
        errors.append(f"vcpkg's manifest: members of {name} that have no meaning")

print("\n".join(errors) if errors else f"recipes of framehex {version}")
sys.exit(1 if errors else 0)
