#!/usr/bin/env python3
# SPDX-License-Identifier: BSL-1.0
"""Does what a page of docs/hosts says, from an empty folder against an installed framehex: follow_page.py HOST PREFIX COMPILER

The program is the page's C++ block and the CMakeLists.txt that of docs/hosts.md with this host's name, or the page's own where it
has one; the command is the overview's as well. The cells that the program says it made must be those of the file that it wrote.
"""
import pathlib
import re
import subprocess
import sys
import tempfile

import meshio

host, prefix, compiler = sys.argv[1:]
pages = pathlib.Path(__file__).resolve().parents[2] / "docs"
overview, page = (pages / "hosts.md").read_text(), (pages / "hosts" / f"{host}.md").read_text()


def block(text, language):
    found = re.findall(rf"^```{language}\n(.*?)^```$", text, re.M | re.S)
    return found[0] if found else ""


def run(*command, folder):
    result = subprocess.run(list(map(str, command)), cwd=folder, capture_output=True, text=True)
    if result.returncode:
        sys.exit(f"{' '.join(map(str, command))}\n{result.stdout}{result.stderr}")
    return result.stdout


with tempfile.TemporaryDirectory() as name:
    folder = pathlib.Path(name)
    (folder / "main.cpp").write_text(block(page, "cpp"))
    lines = block(page, "cmake") or block(overview, "cmake").replace("eigen_matrices", host)
    (folder / "CMakeLists.txt").write_text(lines)
    commands = re.search(r"`(cmake -B build .*?)`", overview)[1].split(" && ")
    configure, build, program = (command.split() for command in commands)
    run(*configure, f"-Dframehex_ROOT={prefix}", f"-DCMAKE_CXX_COMPILER={compiler}", folder=folder)
    run(*build, folder=folder)
    said = run(*program, folder=folder)
    print(said, end="")
    numbers = [int(n) for n in re.findall(r"\d+", said)]
    for file in [*folder.glob("*.vtu"), *folder.glob("*.msh")]:
        n_cells = sum(len(cells.data) for cells in meshio.read(file).cells if cells.type in ("tetra", "pyramid", "wedge", "hexahedron"))
        if n_cells not in numbers:
            sys.exit(f"{file.name} has {n_cells} cells")
        print(f"{file.name}: {n_cells} cells")
