#!/usr/bin/env python3
# SPDX-License-Identifier: BSL-1.0
"""What a translation unit that uses framehex costs to compile: compile_time.py [--compiler g++] [--flags=-O0] [--runs 1]

Prints a Markdown table of CPU seconds (user) and peak memory for headers that are included only, and for stages that are
used; the least of the runs. The last row is Eigen alone, by which tables of other machines can be compared.
"""
import argparse
import os
import pathlib
import resource
import subprocess
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent

OWN_MESH = ROOT / "examples" / "own_mesh" / "own_mesh.cpp"
FIELD = """#include "framehex/field/compute_frame_field.hpp"
#include "framehex/mesh/indexed_mesh.hpp"
auto f(const framehex::IndexedTetMesh& m) { return framehex::compute_frame_field(m); }
"""
MESH_SURFACE = """#include "framehex/adapters/tetgen_process.hpp"
#include "framehex/pipeline/mesh_surface.hpp"
auto f(const framehex::IndexedTriangleMesh& m) {
  return framehex::mesh_surface(m, framehex::ConstantSize{1}, framehex::TetgenProcess{});
}
"""
# Name, code or file, and whether the unit is linked to `framehex::compiled`.
UNITS = [
    ("`framehex.hpp` included", '#include "framehex/framehex.hpp"\n', False),
    ("`framehex.hpp` included, linked to `framehex::compiled`", '#include "framehex/framehex.hpp"\n', True),
    ("field header included", '#include "framehex/field/compute_frame_field.hpp"\n', False),
    ("finder used", '#include "framehex/mesh/indexed_mesh.hpp"\n'
                    '#include "framehex/recombination/potential_hex_finder.hpp"\n'
                    "auto f(const framehex::IndexedTetMesh& m) { return framehex::find_potential_hexahedra(m); }\n", False),
    ("selection used", '#include "framehex/selection/select.hpp"\n'
                       "auto f(const framehex::IncompatibilityGraph& g) { return framehex::select(g); }\n", False),
    ("field used", FIELD, False),
    ("field used, linked to `framehex::compiled`", FIELD, True),
    ("`own_mesh` (field and recombination of a host's mesh)", OWN_MESH, False),
    ("`own_mesh`, linked to `framehex::compiled`", OWN_MESH, True),
    ("`mesh_surface` used", MESH_SURFACE, False),
    ("`mesh_surface` used, linked to `framehex::compiled`", MESH_SURFACE, True),
    ("Eigen's Core and Geometry alone", "#include <Eigen/Core>\n#include <Eigen/Geometry>\n", False),
]


def compile_once(command):
    """CPU seconds and peak megabytes of one compiler run."""
    process = subprocess.Popen(command)
    _, status, usage = os.wait4(process.pid, 0)
    if status != 0:
        raise SystemExit(f"compile_time.py: failed: {' '.join(map(str, command))}")
    return usage.ru_utime, usage.ru_maxrss / 1024


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--compiler", default="g++")
    parser.add_argument("--flags", default="-O0")
    parser.add_argument("--runs", type=int, default=1)
    options = parser.parse_args()
    eigen = next(p for p in ("/usr/include/eigen3", "/usr/local/include/eigen3") if os.path.isdir(p))
    print(f"| {options.compiler} {options.flags} | CPU s | peak MB |\n| --- | ---: | ---: |")
    with tempfile.TemporaryDirectory() as folder:
        for name, unit, compiled in UNITS:
            source = unit
            if isinstance(unit, str):
                source = pathlib.Path(folder) / "unit.cpp"
                source.write_text(unit)
            command = [options.compiler, "-std=c++20", *options.flags.split(), f"-I{ROOT / 'include'}", "-isystem", eigen,
                       *(["-DFRAMEHEX_COMPILED"] if compiled else []),
                       "-c", str(source), "-o", os.path.join(folder, "unit.o")]
            runs = [compile_once(command) for _ in range(options.runs)]
            print(f"| {name} | {min(r[0] for r in runs):.1f} | {max(r[1] for r in runs):.0f} |", flush=True)


if __name__ == "__main__":
    main()
