#!/usr/bin/python3
# SPDX-License-Identifier: BSL-1.0
"""Cut view of a mixed mesh in the paper's colours: hexahedra grey, tetrahedra yellow, prisms red, pyramids green.

    cut_view.py MESH OUT.png [--axis x|y|z] [--at FRACTION] [--up y|z] [--view AZIMUTH ELEVATION] [--title TEXT]

Cells whose centre lies beyond the plane are taken away whole, and what is then outside is drawn. Needs Debian's
python3-numpy, python3-meshio and python3-matplotlib.
"""
import argparse

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import meshio
import numpy as np
from matplotlib.collections import PolyCollection

FACES = {
    "tetra": [(0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2)],
    "pyramid": [(0, 3, 2, 1), (0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4)],
    "wedge": [(0, 2, 1), (3, 4, 5), (0, 1, 4, 3), (1, 2, 5, 4), (2, 0, 3, 5)],
    "hexahedron": [(0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)],
}
COLOURS = {"hexahedron": (0.80, 0.81, 0.83), "tetra": (0.98, 0.84, 0.24), "wedge": (0.86, 0.25, 0.22), "pyramid": (0.35, 0.70, 0.35)}


def visible_faces(points, blocks, axis, at):
    """Faces that one kept cell has and no other, with their colours."""
    low, high = points.min(axis=0), points.max(axis=0)
    limit = low[axis] + at * (high[axis] - low[axis])
    owners = {}
    for kind, cells in blocks:
        if kind not in FACES or not len(cells):
            continue
        for cell in cells[points[cells].mean(axis=1)[:, axis] <= limit]:
            for face in FACES[kind]:
                corners = cell[list(face)]
                owners.setdefault(tuple(sorted(corners)), []).append((corners, COLOURS[kind]))
    return [entry[0] for entry in owners.values() if len(entry) == 1]


def camera(azimuth, elevation):
    """Rows: right, up, and the direction towards the viewer."""
    a, e = np.radians([azimuth, elevation])
    towards = np.array([np.cos(e) * np.cos(a), np.cos(e) * np.sin(a), np.sin(e)])
    right = np.array([-np.sin(a), np.cos(a), 0])
    return np.array([right, np.cross(towards, right), towards])


def draw(points, faces, view, out, title):
    projected = points @ view.T
    light = np.array([0.3, 0.5, 0.81])
    polygons, colours, depths = [], [], []
    for corners, colour in faces:
        p = projected[corners]
        normal = np.cross(p[2] - p[0], (p[3] if len(p) == 4 else p[2]) - p[1])
        length = np.linalg.norm(normal)
        shade = 0.62 + 0.38 * abs(normal @ light) / length if length > 0 else 1.0
        polygons.append(p[:, :2])
        colours.append(np.array(colour) * shade)
        depths.append(p[:, 2].mean())
    order = np.argsort(depths)
    figure, axes = plt.subplots(figsize=(6.4, 6.4), dpi=110)
    axes.add_collection(PolyCollection([polygons[i] for i in order], facecolors=[colours[i] for i in order],
                                       edgecolors=(0.15, 0.15, 0.18), linewidths=0.35))
    axes.set_aspect("equal")
    axes.autoscale_view()
    axes.axis("off")
    if title:
        axes.set_title(title, fontsize=10)
    figure.savefig(out, bbox_inches="tight", pad_inches=0.05)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("mesh")
    parser.add_argument("out")
    parser.add_argument("--axis", choices="xyz", default="y")
    parser.add_argument("--at", type=float, default=0.5, help="0 to 1 along the bounding box")
    parser.add_argument("--up", choices="yz", default="z", help="the axis drawn upwards")
    parser.add_argument("--view", type=float, nargs=2, default=None, metavar=("AZIMUTH", "ELEVATION"), help="degrees")
    parser.add_argument("--title", default="")
    arguments = parser.parse_args()
    mesh = meshio.read(arguments.mesh)
    points = np.asarray(mesh.points, float)
    axis = "xyz".index(arguments.axis)
    if arguments.up == "y":  # a turn about x brings y where z is drawn
        points = points[:, [0, 2, 1]] * [1, -1, 1]
        axis = [0, 2, 1][axis]
    view = arguments.view or [(25, 20), (65, 20), (40, 60)][axis]
    faces = visible_faces(points, [(b.type, np.asarray(b.data)) for b in mesh.cells], axis, arguments.at)
    draw(points, faces, camera(*view), arguments.out, arguments.title)


if __name__ == "__main__":
    main()
