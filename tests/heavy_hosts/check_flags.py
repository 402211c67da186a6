#!/usr/bin/env python3
# SPDX-License-Identifier: BSL-1.0
"""The example of a host is built by the flags that docs/packages.md lists, without CMake: check_flags.py HOST CXX [FLAGS...]"""
import pathlib
import re
import subprocess
import sys
import tempfile

OWN_MODULES = {"vtk": ["-lvtkFiltersCore-9.1", "-lvtkIOXML-9.1", "-lvtkCommonExecutionModel-9.1", "-lvtkIOCore-9.1"]}

host, compiler, *flags = sys.argv[1:]
root = pathlib.Path(__file__).resolve().parents[2]
page = (root / "docs" / "packages.md").read_text()
row = re.search(rf"^\|[^|]*`{host}`[^|]*\| (?:`(.*?)` )?\|$", page, re.M)
if not row:
    sys.exit(f"docs/packages.md has no flags of {host}")
with tempfile.TemporaryDirectory() as folder:
    command = [compiler, "-std=c++20", f"-I{root}/include", *flags, root / "examples" / "hosts" / f"{host}.cpp",
               "-o", f"{folder}/example", *OWN_MODULES.get(host, []), *(row[1] or "").split(), "-pthread"]
    sys.exit(subprocess.run(command).returncode)
