#!/usr/bin/env python3
# SPDX-License-Identifier: BSL-1.0
"""A bracket bent by CalculiX, against a refined mesh of quadratic tetrahedra.

    calculix_bracket.py PROGRAM [--picture FILE.png]

An L of steel with a rounded corner, 2 x 2 x 0.8 and 0.4 thick, held at its back, is pressed on from below. The
hexahedra are elements with incompatible modes (C3D8I), which bend; pyramids are bricks with a repeated node. The
answer, how far the tip rises and the elastic energy, is that of TetGen's second-order tetrahedra (C3D10), which know
nothing of the mesh. Needs Debian's packages calculix-ccx, tetgen and python3-numpy (and python3-matplotlib for the
picture).
"""
import os
import re
import subprocess

import numpy as np

import common

LENGTH, THICKNESS, WIDTH, RADIUS = 2, 0.4, 0.8, 0.3

# Faces of elements as CalculiX numbers them, from 1; its order of corners looks inward.
FACES = {
    "C3D4": [(0, 1, 2), (0, 3, 1), (1, 3, 2), (2, 3, 0)],
    "C3D6": [(0, 1, 2), (3, 5, 4), (0, 3, 4, 1), (1, 4, 5, 2), (2, 5, 3, 0)],
    "C3D8": [(0, 1, 2, 3), (4, 7, 6, 5), (0, 4, 5, 1), (1, 5, 6, 2), (2, 6, 7, 3), (3, 7, 4, 0)],
}
FACES["C3D8I"], FACES["C3D10"] = FACES["C3D8"], FACES["C3D4"]

STEP = """*NSET, NSET=N_held
{held}
*MATERIAL, NAME=steel
*ELASTIC
210000, 0.3
*SOLID SECTION, ELSET=E_ALL, MATERIAL=steel
*BOUNDARY
N_held, 1, 3
*STEP
*STATIC
*DLOAD
{load}
*NODE PRINT, NSET=N_ALL
U
*EL PRINT, ELSET=E_ALL, TOTALS=ONLY
ELSE
*END STEP
"""


class Model:
    """Nodes (n x 3) and blocks of elements (type, numbers, nodes from 0) of a file."""

    def __init__(self, text):
        self.text, self.blocks = text, []
        for keyword, body in re.findall(r"^\*(\w.*)\n((?:[^*].*\n)*)", text, re.M):
            rows = [line.split(",") for line in body.splitlines()]
            if keyword.startswith("NODE"):
                self.points = np.array([row[1:] for row in rows], float)
            elif keyword.startswith("ELEMENT"):
                numbers = np.array(rows, int)
                self.blocks.append((re.search(r"TYPE=(\w+)", keyword)[1], numbers[:, 0], numbers[:, 1:] - 1))

    def faces(self):
        """(element, number of the face, corners) of each face that only one element has, outward."""
        found = {}
        for kind, numbers, corners in self.blocks:
            for number, local in enumerate(FACES[kind], 1):
                for element, face in zip(numbers, corners[:, local[::-1]]):
                    face = list(dict.fromkeys(face.tolist()))  # of a brick with a repeated node
                    if len(face) > 2:
                        found.setdefault(tuple(sorted(face)), []).append((element, number, face))
        return [entries[0] for entries in found.values() if len(entries) == 1]

    def solve(self, folder, job):
        """Displacements of the nodes (n x 3), and the elastic energy."""
        load = "\n".join(f"{element}, P{number}, 1" for element, number, face in self.faces()
                         if np.allclose(self.points[face, 1], 0))
        held = "\n".join(f"{node + 1}," for node in np.flatnonzero(np.isclose(self.points[:, 0], 0)))
        (folder / f"{job}.inp").write_text(self.text + STEP.format(held=held, load=load))
        with open(folder / f"{job}.log", "w") as log:
            subprocess.run(["ccx", job], cwd=folder, env={**os.environ, "OMP_NUM_THREADS": "1"}, stdout=log, check=True)
        printed = (folder / f"{job}.dat").read_text()
        rows = re.findall(r"^ +\d+" + 3 * r" +([-+.\dE]+)" + "$", printed, re.M)
        return np.array(rows, float), float(re.search(r"energy.*\n\s*(\S+)", printed)[1])

    def tip(self, displacements):
        """How far the lower corners of the free end have risen."""
        corners = [(LENGTH, 0, 0), (LENGTH, 0, WIDTH)]
        return displacements[[np.linalg.norm(self.points - corner, axis=1).argmin() for corner in corners], 1].mean()


def write_bracket(path):
    angles = np.radians(np.arange(0, 91, 10))
    inner = THICKNESS + RADIUS
    corner = [(inner - RADIUS * np.sin(a), inner - RADIUS * np.cos(a)) for a in angles]
    outline = [(0, 0), (LENGTH, 0), (LENGTH, THICKNESS), *corner, (THICKNESS, LENGTH), (0, LENGTH)]
    return common.write_extrusion(path, outline, WIDTH)


def mixed_model(program, surface, folder, cells):
    # By fronts: a lattice fits the bracket with hexahedra alone, and all kinds are to be shown.
    inp = common.mesh(program, surface, folder / "mesh.inp", cells, "--pyramids", "bricks", "--order", "smoothness")
    head, hexahedra = inp.read_text().rsplit("*ELEMENT, TYPE=C3D8,", 1)  # the block before is that of the pyramids
    return Model(f"{head}*ELEMENT, TYPE=C3D8I,{hexahedra}")


def refined_model(surface, largest_volume):
    """Of second-order tetrahedra by TetGen."""
    subprocess.run(["tetgen", f"-pq1.3a{largest_volume}o2", surface], stdout=subprocess.DEVNULL, check=True)

    def table(extension):
        return np.loadtxt(surface.with_suffix(extension), skiprows=1)

    points, tets = table(".1.node")[:, 1:4], table(".1.ele")[:, 1:11].astype(int)
    tets -= tets.min()
    if np.linalg.det(points[tets[:, 1:4]] - points[tets[:, :1]]).mean() < 0:
        tets[:, [0, 1]] = tets[:, [1, 0]]
    columns = [tets[:, :4]]
    for a, b in ((0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)):  # CalculiX's order of the nodes on edges
        middle = (points[tets[:, a]] + points[tets[:, b]]) / 2
        nearest = np.linalg.norm(points[tets[:, 4:]] - middle[:, None], axis=2).argmin(axis=1)
        columns.append(np.take_along_axis(tets[:, 4:], nearest[:, None], axis=1))
    lines = ["*NODE, NSET=N_ALL", *("%d, %.17g, %.17g, %.17g" % (i, *p) for i, p in enumerate(points, 1)),
             "*ELEMENT, TYPE=C3D10, ELSET=E_ALL",
             *(", ".join(map(str, (i, *nodes))) for i, nodes in enumerate(np.hstack(columns) + 1, 1))]
    return Model("\n".join(lines) + "\n")


def draw(path, model, displacements):
    length = np.linalg.norm(displacements, axis=1)
    scale = 0.1 * LENGTH / length.max()
    faces = [face for _, _, face in model.faces()]
    axes = [0, 2, 1]  # y is drawn upwards, which mirrors the body
    common.draw(path, (model.points + scale * displacements)[:, axes], [face[::-1] for face in faces],
                [length[face].mean() for face in faces], common.view_from(-60, 25),
                f"CalculiX: a bracket pressed on from below, displacements x {scale:.0f}", "displacement")


def solve(program, _, folder, answers, picture):
    surface = write_bracket(folder / "bracket.off")
    refined = refined_model(surface, 0.0005)
    u, energy = refined.solve(folder, "refined")
    expected = {"deflection of the tip": refined.tip(u), "elastic energy": energy}
    model = mixed_model(program, surface, folder, 5000)
    print(", ".join(f"{len(numbers)} {kind}" for kind, numbers, _ in model.blocks))
    answers.add("blocks of tetrahedra, pyramids, prisms, hexahedra", 4, len(model.blocks), len(model.blocks) == 4)
    u, energy = model.solve(folder, "mixed")
    for name, measured in (("deflection of the tip", model.tip(u)), ("elastic energy", energy)):
        print(f"{name}: refined {expected[name]:.6e}, measured {measured:.6e}")
        answers.at_most(f"{name}, relative error", 0.02, abs(measured / expected[name] - 1))
    if picture:
        draw(picture, model, u)


if __name__ == "__main__":
    common.run(solve, __doc__)
