#!/usr/bin/env python3
# SPDX-License-Identifier: BSL-1.0
"""What OpenFOAM's checkMesh says of meshes made for finite volumes.

    check_mesh.py PROGRAM SURFACE:SIZE... [-- OPTION...]

Each surface is meshed by `PROGRAM mesh --finite-volume`, with the options after `--`, written as a polyMesh and judged by
`checkMesh -allGeometry -allTopology` (Debian's package openfoam). One line of a table each; exits with 1 unless all are "Mesh OK".
"""
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile

FOAM = pathlib.Path("/usr/share/openfoam")
ENVIRONMENT = {**os.environ, "WM_PROJECT": "OpenFOAM", "WM_PROJECT_DIR": str(FOAM), "FOAM_ETC": str(FOAM / "etc")}

# checkMesh reads these although it solves nothing.
DICTIONARIES = {
    "controlDict": "application none; startFrom startTime; startTime 0; stopAt endTime; endTime 1; deltaT 1;"
                   " writeControl timeStep; writeInterval 1;",
    "fvSchemes": "ddtSchemes { default steadyState; } gradSchemes { default Gauss linear; } divSchemes {}"
                 " laplacianSchemes {} interpolationSchemes {} snGradSchemes {}",
    "fvSolution": "",
}


def write_case(folder):
    for part in ("constant", "system"):
        (folder / part).mkdir()
    for name, body in DICTIONARIES.items():
        header = f"FoamFile {{ version 2.0; format ascii; class dictionary; object {name}; }}\n"
        (folder / "system" / name).write_text(header + body + "\n")


def check(program, surface, size, options):
    """The program's report, and the lines in which checkMesh complains (none: Mesh OK)."""
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        write_case(folder)
        report = folder / "report.json"
        subprocess.run([program, "mesh", surface, "-o", folder / "constant" / "polyMesh", "--size", size, "--finite-volume",
                        "--quiet", "--report", report, *options], check=True)
        judged = subprocess.run(["checkMesh", "-allGeometry", "-allTopology", "-case", folder], env=ENVIRONMENT,
                                capture_output=True, text=True)
        complaints = re.findall(r"^ *\*\*\*(.*)$", judged.stdout, re.MULTILINE)
        if judged.returncode != 0 or (not complaints and "Mesh OK." not in judged.stdout):
            complaints.append("checkMesh failed: " + (judged.stderr or judged.stdout)[-300:])
        return json.loads(report.read_text()), complaints


def main():
    arguments = sys.argv[1:]
    if len(arguments) < 2 or arguments[0].startswith("-"):
        raise SystemExit(__doc__)
    options = []
    if "--" in arguments:
        at = arguments.index("--")
        arguments, options = arguments[:at], arguments[at + 1:]
    all_fine = True
    print("| surface | size | cells | hexahedra, % of volume | least scaled Jacobian | checkMesh |")
    print("| --- | ---: | ---: | ---: | ---: | --- |", flush=True)
    for argument in arguments[1:]:
        surface, _, size = argument.rpartition(":")
        report, complaints = check(arguments[0], surface, size, options)
        all_fine = all_fine and not complaints
        print(f"| {pathlib.Path(surface).stem} | {size} | {report['counts']['cells']} "
              f"| {100 * report['hex_ratio']['volume']:.2f} | {report['quality']['least']:.3f} "
              f"| {'; '.join(complaints) or 'Mesh OK'} |", flush=True)
    raise SystemExit(0 if all_fine else 1)


if __name__ == "__main__":
    main()
