#!/usr/bin/env python3
# SPDX-License-Identifier: BSL-1.0
"""Reads the files of the test's one-cell-of-each-kind mesh with meshio and says what is wrong with them.

judge.py FILE...            Exit status 0: every file has the four cells right side out, and the labels and arrays wanted.
judge.py --arrays FILE...   Exit status 0: every array by point counts on from the number that its name is.
"""
import contextlib
import io
import sys

import meshio
import numpy as np

# Faces by corner, outward. meshio turns the prisms of VTK's manual into Gmsh's order when it reads .vtu.
OUTWARD = {
    "tetra": [(0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2)],
    "pyramid": [(0, 3, 2, 1), (0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4)],
    "wedge": [(0, 2, 1), (3, 4, 5), (0, 1, 4, 3), (1, 2, 5, 4), (2, 0, 3, 5)],
    "hexahedron": [(0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)],
}
VOLUMES = {"hexahedron": 1.0, "wedge": 0.5, "pyramid": 1 / 3, "tetra": 1 / 6}
LABELS = {"hexahedron": [0], "wedge": [0], "pyramid": [2], "tetra": [1], "quad": [0], "triangle": [0, 3],
          "line": [0, 4]}


def volume(points, cell, faces):
    total = 0.0
    for face in faces:
        p = points[[cell[i] for i in face]]
        centre = p.mean(axis=0)  # the faces are plane
        for i in range(len(p)):
            total += np.dot(centre, np.cross(p[i], p[(i + 1) % len(p)])) / 6
    return total


def check(name):
    with contextlib.redirect_stdout(io.StringIO()):
        mesh = meshio.read(name)
    wrong = []
    kind = name.rsplit(".", 1)[1]
    cells, labels = {}, {}
    key = {"vtu": "label", "msh": "gmsh:physical", "mesh": "medit:ref"}[kind]
    for k, block in enumerate(mesh.cells):
        cells.setdefault(block.type, []).extend(block.data.tolist())
        values = [int(x) - (0 if kind == "vtu" else 1) for x in mesh.cell_data[key][k]]
        labels.setdefault(block.type, []).extend(values)
    for cell_type, expected in VOLUMES.items():
        found = [volume(mesh.points, cell, OUTWARD[cell_type]) for cell in cells.get(cell_type, [])]
        if len(found) != 1 or abs(found[0] - expected) > 1e-12:
            wrong.append(f"{cell_type}: volumes {found} instead of {expected}")
    if labels != LABELS:
        wrong.append(f"labels {labels} instead of {LABELS}")
    if kind == "vtu":
        kinds = np.concatenate([np.ravel(k) for k in mesh.cell_data["kind"]])
        if sorted(kinds.tolist()) != [0, 1, 2, 3, 4, 4, 5, 6, 6]:
            wrong.append(f"kinds {kinds}")
        quality = np.concatenate([np.ravel(q) for q in mesh.cell_data["scaled_jacobian"]])
        if np.isnan(quality).sum() != 5 or sorted(quality[~np.isnan(quality)].tolist()) != [0.25, 0.5, 0.75, 1.0]:
            wrong.append(f"scaled Jacobians {quality}")
        if mesh.point_data["frame"].shape != (12, 4) or mesh.point_data["frame"][5].tolist() != [1, 5, 0, 0]:
            wrong.append("frames")
        if mesh.point_data["smoothness"].ravel().tolist() != [i / 16 for i in range(12)]:
            wrong.append("smoothness")
    for w in wrong:
        print(f"{name}: {w}")
    return not wrong


def check_arrays(name):
    with contextlib.redirect_stdout(io.StringIO()):
        mesh = meshio.read(name)
    wrong = [array for array, values in mesh.point_data.items()
             if np.ravel(values).tolist() != list(range(int(array), int(array) + values.size))]
    if [len(block.data) for block in mesh.cells if block.type == "hexahedron"] != [1]:
        wrong.append("cells")
    if wrong:
        print(f"{name}: wrong are {wrong}")
    return not wrong


if __name__ == "__main__":
    if sys.argv[1] == "--arrays":
        sys.exit(0 if all([check_arrays(name) for name in sys.argv[2:]]) else 1)
    sys.exit(0 if all([check(name) for name in sys.argv[1:]]) else 1)
