#!/usr/bin/python3
# SPDX-License-Identifier: BSL-1.0
"""Prints the table of docs/lattice.md: fronts against the lattice on models, shapes and other people's surfaces.

    lattice_table.py PROGRAM [--models FOLDER] [--only NAME ...] [--audit COMMAND] [SURFACE ...]

PROGRAM is `framehex`. FOLDER has dome.stl and so on, run at their small sizes; shapes with a known block structure are made
here; each SURFACE is run at a sixtieth of its box's diagonal. COMMAND, if given, is a second opinion: it is called with the
mesh, `--surface` and the surface, and `--json`. A row ends with `worse` where the lattice has fewer hexahedra by volume,
and the exit status is then 1.
"""
import argparse
import itertools
import json
import math
import pathlib
import shlex
import subprocess
import sys
import tempfile

import meshio
import numpy

MODELS = {"dome": 0.156, "naca": 0.038, "piece": 0.108, "fuselage": 0.156, "blade": 0.026, "bunny": 0.26}


def extruded(polygon, height):
    n = len(polygon)
    points = [(x, y, z) for z in (0, height) for x, y in polygon]
    triangles = [t for i in range(1, n - 1) for t in ((0, i + 1, i), (n, n + i, n + i + 1))]
    for i in range(n):
        j = (i + 1) % n
        triangles += [(i, j, n + j), (i, n + j, n + i)]
    return points, triangles


def grid(n_u, n_v, point):
    """A surface closed in both directions."""
    points = [point(2 * math.pi * i / n_u, j) for i in range(n_u) for j in range(n_v)]
    at = lambda i, j: i % n_u * n_v + j % n_v
    triangles = [t for i, j in itertools.product(range(n_u), range(n_v))
                 for t in ((at(i, j), at(i + 1, j), at(i + 1, j + 1)), (at(i, j), at(i + 1, j + 1), at(i, j + 1)))]
    return points, triangles


def torus(major, minor, n_u, n_v):
    def point(u, j):
        v = 2 * math.pi * j / n_v
        r = major + minor * math.cos(v)
        return r * math.cos(u), r * math.sin(u), minor * math.sin(v)
    return grid(n_u, n_v, point)


def tube(inner, outer, height, n):
    section = [(inner, 0), (outer, 0), (outer, height), (inner, height)]
    return grid(n, 4, lambda u, j: (section[j][0] * math.cos(u), section[j][0] * math.sin(u), section[j][1]))


def ball(levels):
    """A cube's surface cut in squares, blown up."""
    n = 2 ** levels
    known, triangles = {}, []
    def vertex(p):
        return known.setdefault(p, len(known))
    for axis, side, i, j in itertools.product(range(3), (0, n), range(n), range(n)):
        def at(di, dj):
            p = [0, 0, 0]
            p[axis], p[(axis + 1) % 3], p[(axis + 2) % 3] = side, i + di, j + dj
            return vertex(tuple(p))
        a, b, c, d = at(0, 0), at(1, 0), at(1, 1), at(0, 1)
        triangles += [(a, b, c), (a, c, d)] if side else [(a, c, b), (a, d, c)]
    points = numpy.tan((2 * numpy.array(list(known)) / n - 1) * math.pi / 4)
    return points / numpy.linalg.norm(points, axis=1)[:, None], triangles


def shapes():
    circle = [(math.cos(2 * math.pi * i / 96) / 2, math.sin(2 * math.pi * i / 96) / 2) for i in range(96)]
    s = 1 / math.sqrt(8)
    return {"tube": (0.05, tube(0.25, 0.5, 1, 96)),
            "cylinder": (0.05, extruded(circle, 2)),
            "torus": (0.07, torus(1, 0.35, 120, 60)),
            "prism": (0.05, extruded([(0, 0), (1, 0), (0.5, math.sqrt(0.75))], 1)),
            "tetrahedron": (0.05, ([(s, s, s), (s, -s, -s), (-s, s, -s), (-s, -s, s)],
                                   [(0, 1, 2), (0, 2, 3), (0, 3, 1), (1, 3, 2)])),
            "ball": (0.1, ball(5)),
            "L": (0.1, extruded([(1, 1), (1, 3), (0, 3), (0, 0), (3, 0), (3, 1)], 1))}


def enclosed(points, triangles):
    a, b, c = (points[triangles[:, k]] for k in range(3))
    return (a * numpy.cross(b, c)).sum() / 6


def run(options, surface, size, order, folder):
    out, report = folder / "mesh.vtu", folder / "mesh.json"
    done = subprocess.run([options.program, "mesh", str(surface), "--size", str(size), "--order", order, "-o", str(out),
                           "--report", str(report), "--quiet"], capture_output=True, text=True)
    if done.returncode != 0:
        raise RuntimeError(done.stderr.strip())
    made, mesh = json.loads(report.read_text()), meshio.read(out)
    edges = []
    for block in mesh.cells:
        if block.type == "hexahedron":
            ends = [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7)]
            for a, b in ends:
                edges.append(numpy.linalg.norm(mesh.points[block.data[:, a]] - mesh.points[block.data[:, b]], axis=1))
    faults = []
    if options.audit:
        command = [*shlex.split(options.audit), str(out), "--surface", str(surface), "--json"]
        audit = json.loads(subprocess.run(command, capture_output=True, text=True, check=True).stdout)
        faults = [f"not {key} (audit)" for key in ("valid", "fills_surface") if not audit[key]]
    if made["quality"]["invalid_cells"] or made["conformity"]["open_quads"]:
        faults.append("not valid")
    return {"number": 100 * made["hex_ratio"]["number"], "volume": 100 * made["hex_ratio"]["volume"],
            "points": len(mesh.points), "inside": made["quality"]["volume"], "faults": faults,
            "edges": numpy.percentile(numpy.concatenate(edges) / size, (5, 50, 95)) if edges else (0, 0, 0),
            "seconds": made["seconds"], "replaced": made.get("lattice", {}).get("replaced_by_fronts", False)}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--models", type=pathlib.Path)
    parser.add_argument("--only", nargs="+", metavar="NAME")
    parser.add_argument("--audit", metavar="COMMAND")
    parser.add_argument("surfaces", nargs="*", type=pathlib.Path)
    options = parser.parse_args()
    print("| surface, size | fronts % | lattice % | points | edges 5 / 50 / 95 % | volume off, % | field / insertion, s |")
    print("| --- | --- | --- | --- | --- | --- | --- |", flush=True)
    failed = False
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        jobs = []
        if options.models:
            jobs += [(options.models / f"{model}.stl", size) for model, size in MODELS.items()]
        for shape, (size, (points, triangles)) in shapes().items():
            path = folder / f"{shape}.ply"
            meshio.Mesh(numpy.array(points, float), [("triangle", numpy.array(triangles, dtype=numpy.int32))]).write(path)
            jobs.append((path, size))
        jobs += [(path, None) for path in options.surfaces]
        for path, size in jobs:
            if options.only and path.stem not in options.only:
                continue
            surface = meshio.read(path)
            points, triangles = surface.points.astype(float), surface.get_cells_type("triangle")
            size = size or numpy.linalg.norm(numpy.ptp(points, axis=0)) / 60
            try:
                front, lattice = (run(options, path, size, order, folder) for order in ("smoothness", "lattice"))
            except RuntimeError as e:
                print(f"| {path.stem} | {e} |", flush=True)
                continue
            off = [100 * (r["inside"] / enclosed(points, triangles) - 1) for r in (front, lattice)]
            faults = lattice["faults"] + (["worse"] if lattice["volume"] < front["volume"] - 0.05 else [])
            faults += ["fronts took over"] if lattice["replaced"] else []
            failed |= bool(faults)
            print(f"| {path.stem} {size:.3g} | {front['number']:.1f} / {front['volume']:.2f} | "
                  f"{lattice['number']:.1f} / {lattice['volume']:.2f} | {front['points']:,} / {lattice['points']:,} | "
                  + " / ".join(f"{e:.2f}" for e in lattice["edges"]) + f" | {off[0]:+.2f} / {off[1]:+.2f} | "
                  f"{lattice['seconds']['field']:.1f} / {lattice['seconds']['insertion']:.1f} |" + ", ".join(faults),
                  flush=True)
    sys.exit(1 if failed else 0)


if __name__ == "__main__":
    main()
