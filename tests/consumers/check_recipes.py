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
options = (root / "CMakeLists.txt").read_text()
for recipe in ("vcpkg/framehex/portfile.cmake",):
    for option in re.findall(r"-D(FRAMEHEX_\w+)", (packaging / recipe).read_text()):
        if f"option({option}" not in options:
            errors.append(f"{recipe}: there is no option {option}")

print("\n".join(errors) if errors else f"recipes of framehex {version}")
sys.exit(1 if errors else 0)
