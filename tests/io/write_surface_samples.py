#!/usr/bin/env python3
# SPDX-License-Identifier: BSL-1.0
"""Writes a box and an outline in every format of surfaces that is read: write_surface_samples.py FOLDER"""
import pathlib
import sys

import meshio
import numpy as np

points = np.array([(x, y, z) for z in (0, 1) for y in (0, 1) for x in (0, 1)], float)
quads = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
triangles = np.array([t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))])

folder = pathlib.Path(sys.argv[1])
mesh = meshio.Mesh(points, [("triangle", triangles)])
meshio.stl.write(folder / "text.stl", mesh, binary=False)
meshio.stl.write(folder / "binary.stl", mesh, binary=True)
meshio.write(folder / "box.off", mesh)
meshio.ply.write(folder / "text.ply", mesh, binary=False)
meshio.ply.write(folder / "binary.ply", mesh, binary=True)
with open(folder / "groups.obj", "w") as f:
    f.writelines("v %g %g %g\n" % tuple(p) for p in points)
    for i, quad in enumerate(quads):
        f.write(f"g side{i // 2}\nusemtl m{i % 2}\nf " + " ".join(str(v + 1) for v in quad) + "\n")
with open(folder / "outline.txt", "w") as f:
    f.write("0 0\n4 0\n4 3\n0 3\n\n1 1\n2 1\n2 2\n\ninner\n3 1\n3 2\n")
