#!/usr/bin/python3
# SPDX-License-Identifier: BSL-1.0
"""Pictures of docs/recombination.md: ways to cut a hexahedron into tetrahedra, taken apart.

    recombination_pictures.py [FOLDER]     (default: docs/images beside this script)
"""
import pathlib
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from mpl_toolkits.mplot3d.art3d import Poly3DCollection

# Corners a b c d (bottom) e f g h (top), as 0 to 7.
CUBE = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)], float)
EDGES = [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7)]
CUTS = {
    "5: a central tetrahedron\nand four corners": [(0, 2, 5, 7), (0, 1, 2, 5), (0, 2, 3, 7), (0, 5, 7, 4), (2, 5, 7, 6)],
    "6: round a body diagonal,\nno corner": [(0, 6, 1, 2), (0, 6, 2, 3), (0, 6, 3, 7), (0, 6, 7, 4), (0, 6, 4, 5), (0, 6, 5, 1)],
    "6: two prisms cut in three,\ntwo corners": [(0, 1, 3, 4), (1, 3, 4, 5), (3, 4, 5, 7), (1, 2, 3, 5), (2, 3, 5, 7), (2, 5, 7, 6)],
}


def draw_cut(axes, title, tets):
    for n, tet in enumerate(tets):
        p = CUBE[list(tet)]
        p = p + 0.45 * (p.mean(axis=0) - 0.5)
        p = p.mean(axis=0) + 0.97 * (p - p.mean(axis=0))
        faces = [p[[i for i in range(4) if i != k]] for k in range(4)]
        axes.add_collection3d(
            Poly3DCollection(faces, facecolor=plt.cm.Set2(n % 8), edgecolor="0.25", linewidth=0.7, alpha=0.75))
    finish(axes, title)


def draw_sliver(axes, title):
    """Two hexahedra side by side whose common face is cut both ways: a flat tetrahedron between them."""
    bend = 0.12
    points = np.vstack([CUBE, CUBE[[1, 2, 5, 6]] + (1, 0, 0)])
    points[[1, 6], 0] += bend
    points[[2, 5], 0] -= bend
    for i, j in EDGES + [(1, 8), (2, 9), (5, 10), (6, 11), (8, 9), (9, 11), (11, 10), (10, 8)]:
        axes.plot(*points[[i, j]].T, color="0.3", linewidth=1)
    p = points[[1, 2, 6, 5]]
    faces = [p[[0, 1, 2]], p[[0, 2, 3]], p[[0, 1, 3]], p[[1, 2, 3]]]
    axes.add_collection3d(Poly3DCollection(faces, facecolor="tab:red", edgecolor="darkred", linewidth=1, alpha=0.45))
    finish(axes, title, (2, 1, 1))


def finish(axes, title, shape=(1, 1, 1)):
    axes.set_title(title, fontsize=9)
    axes.set_axis_off()
    margin = 0.0 if shape[0] == 2 else 0.2
    axes.set(xlim=(-margin, shape[0] + margin), ylim=(-margin, 1 + margin), zlim=(-margin, 1 + margin))
    axes.set_box_aspect((shape[0] + 2 * margin, 1 + 2 * margin, 1 + 2 * margin))
    axes.view_init(elev=20, azim=-62)


def check(tets):
    """The tetrahedra fill the cube."""
    volume = sum(abs(np.linalg.det(CUBE[list(t[1:])] - CUBE[t[0]])) / 6 for t in tets)
    assert abs(volume - 1) < 1e-12, (tets, volume)


def main():
    folder = pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else pathlib.Path(__file__).parent.parent / "images"
    figure = plt.figure(figsize=(10, 2.9))
    for n, (title, tets) in enumerate(CUTS.items()):
        check(tets)
        draw_cut(figure.add_subplot(1, 4, n + 1, projection="3d"), title, tets)
    draw_sliver(figure.add_subplot(1, 4, 4, projection="3d"), "a face sliver (red)\nbetween two hexahedra")
    figure.subplots_adjust(left=0, right=1, bottom=0, top=0.86, wspace=0)
    figure.savefig(folder / "hexahedron-cuts.png", dpi=90)

    counts = [1, 5, 5, 7, 13, 20, 35, 30, 28, 19, 11]
    figure, axes = plt.subplots(figsize=(5.2, 2.4))
    axes.bar(range(5, 16), counts, color=["tab:orange" if n < 3 else "tab:blue" for n in range(11)])
    axes.set(xlabel="tetrahedra", ylabel="ways, of 174", xticks=range(5, 16))
    for x, y in zip(range(5, 16), counts):
        axes.text(x, y + 0.5, y, ha="center", fontsize=8)
    axes.set_ylim(0, 40)
    figure.tight_layout()
    figure.savefig(folder / "hexahedron-cut-counts.png", dpi=90)


if __name__ == "__main__":
    main()
