#!/usr/bin/python3
# SPDX-License-Identifier: BSL-1.0
"""Draws docs/images/three_ways.png: how an open quadrilateral is closed."""
import pathlib

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
from mpl_toolkits.mplot3d.art3d import Poly3DCollection

Q = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)]
LOW = [(x, y, -1) for x, y, _ in Q]
HEX = [Q, LOW] + [[Q[i], Q[(i + 1) % 4], LOW[(i + 1) % 4], LOW[i]] for i in range(4)]


def draw(axes, faces, colour, alpha):
    axes.add_collection3d(Poly3DCollection(faces, facecolor=colour, edgecolor="k", alpha=alpha, linewidth=0.8))


def fan(apex, faces):
    return [[face[i], face[(i + 1) % len(face)], apex] for face in faces for i in range(len(face))]


def panel(position, title, pieces):
    axes = figure.add_subplot(1, 3, position, projection="3d")
    for faces, colour, alpha in pieces:
        draw(axes, faces, colour, alpha)
    axes.set(xlim=(-0.2, 1.2), ylim=(-0.2, 1.2), zlim=(-1, 1), title=title)
    axes.set_box_aspect((1.4, 1.4, 2))
    axes.view_init(18, -62)
    axes.axis("off")


figure = plt.figure(figsize=(10, 4.2))
apex, left, right, middle = (0.5, 0.5, 0.8), (0.2, 0.75, 0.9), (0.8, 0.25, 0.9), (0.5, 0.5, 0.45)
top = [(Q[0], Q[1], right), (Q[1], Q[2], right), (Q[2], left, right), (Q[0], right, left), (Q[2], Q[3], left), (Q[3], Q[0], left)]
panel(1, "merge: one apex", [(HEX, "0.75", 0.35), (fan(apex, [Q]), "tab:green", 0.45)])
panel(2, "raise: a new vertex in the hole", [(HEX, "0.75", 0.35), (fan(middle, [Q]), "tab:green", 0.6), (top, "gold", 0.15)])
panel(3, "split the hexahedron", [(HEX, "0.9", 0.1), (fan((0.5, 0.5, -0.5), HEX), "tab:green", 0.12), ([[Q[0], Q[1], Q[2]], [Q[0], Q[2], Q[3]]], "gold", 0.4)])
figure.tight_layout()
figure.savefig(pathlib.Path(__file__).parent.parent / "images" / "three_ways.png", dpi=80)
