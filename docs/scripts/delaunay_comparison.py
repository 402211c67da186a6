#!/usr/bin/python3
# SPDX-License-Identifier: BSL-1.0
"""docs/images/insertion-delaunay.png: tetrahedra of Delaunay refinement against those through lattice points, and what
recombination makes of both.

    delaunay_comparison.py FRAMEHEX SURFACE SIZE OUT.png

FRAMEHEX is the program; the refinement is `tetgen -pq` with a largest volume that gives about as many points.
"""
import json
import pathlib
import subprocess
import sys
import tempfile

import matplotlib

matplotlib.use("Agg")
import matplotlib.image as image
import matplotlib.pyplot as plt
import meshio

program, surface, size, out = sys.argv[1], sys.argv[2], float(sys.argv[3]), sys.argv[4]
cut_view = pathlib.Path(__file__).with_name("cut_view.py")


def run(*command):
    subprocess.run([str(c) for c in command], check=True, stdout=subprocess.DEVNULL)


def write_off(mesh, name):
    triangles = mesh.get_cells_type("triangle")
    lines = ["OFF", f"{len(mesh.points)} {len(triangles)} 0"]
    lines += [" ".join(repr(float(x)) for x in p) for p in mesh.points]
    lines += ["3 " + " ".join(str(v) for v in t) for t in triangles]
    name.write_text("\n".join(lines) + "\n")


with tempfile.TemporaryDirectory() as folder:
    folder = pathlib.Path(folder)
    write_off(meshio.read(surface), folder / "surface.off")
    # Points through the lattice, and the tetrahedra of the same points.
    run(program, "mesh", surface, "-o", folder / "ours.vtu", "--size", size, "--select", "greedy", "--report", folder / "ours.json", "--quiet")
    ours = meshio.read(folder / "ours.vtu")
    rows = [("lattice points", folder / "ours.vtu", folder / "ours.json")]
    # Refinement.
    run("tetgen", f"-pqka{size ** 3 / 2.5:.9f}", folder / "surface.off")
    tets = meshio.read(folder / "surface.1.vtk")
    meshio.Mesh(tets.points, [("tetra", tets.get_cells_type("tetra"))]).write(folder / "tets.vtu")
    run(program, "recombine", folder / "tets.vtu", "-o", folder / "refined.vtu", "--select", "greedy",
        "--report", folder / "refined.json", "--quiet")
    rows = [("Delaunay refinement", folder / "tets.vtu", None),
            ("Delaunay refinement, recombined", folder / "refined.vtu", folder / "refined.json")] + rows
    figure, axes = plt.subplots(1, len(rows), figsize=(4.2 * len(rows), 4))
    for axis, (title, mesh, report) in zip(axes, rows):
        picture = mesh.with_suffix(".png")
        run("/usr/bin/python3", cut_view, mesh, picture, "--axis", "y", "--at", "0.5")
        axis.imshow(image.imread(picture))
        if report:
            ratio = json.loads(report.read_text())["hex_ratio"]
            title += f"\nhexahedra {100 * ratio['number']:.0f} % by number, {100 * ratio['volume']:.0f} % by volume"
        axis.set_title(title, fontsize=10)
        axis.axis("off")
    figure.tight_layout()
    figure.savefig(out, dpi=75)
    print(f"{len(tets.points)} points of the refinement;", {str(r[0]): json.loads(r[2].read_text())["counts"] for r in rows if r[2]})
