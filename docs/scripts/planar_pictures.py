#!/usr/bin/python3
# SPDX-License-Identifier: BSL-1.0
"""Draws the pictures of docs/planar.md: planar_pictures.py PROGRAM [--models FOLDER]

PROGRAM is `framehex`; FOLDER holds bunny.stl and dome.ply (tests/data). Needs meshio and matplotlib.
"""
import argparse
import contextlib
import pathlib
import subprocess
import tempfile

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import meshio
import numpy as np
from matplotlib.collections import LineCollection, PolyCollection
from mpl_toolkits.mplot3d.art3d import Poly3DCollection

IMAGES = pathlib.Path(__file__).parent.parent / "images"


def circle(x, y, radius, n):
    angle = 2 * np.pi * np.arange(n) / n
    return np.c_[x + radius * np.cos(angle), y + radius * np.sin(angle)]


def plate():
    return [np.array([(0, 0), (4, 0), (4, 2), (0, 2)]), circle(0.8, 1, 0.35, 96), circle(2.1, 1.25, 0.25, 96),
            circle(3.2, 0.8, 0.45, 96)]


def section():
    """A cambered section, blunt behind, with two bores, like a hollow blade."""
    x = (1 + np.cos(np.pi * np.arange(161) / 80)) / 2
    half = 0.9 * (0.2969 * np.sqrt(x) - 0.126 * x - 0.3516 * x**2 + 0.2843 * x**3 - 0.1036 * x**4)
    side = np.where(np.arange(161) <= 80, half, -half)
    y = 0.5 * x * (1 - x) + side
    outer = 4 * np.c_[x, y][x < 0.96]
    return [outer, circle(0.8, 0.4, 0.22, 64), circle(1.75, 0.52, 0.2, 64)]


def gear(n=12):
    step = 2 * np.pi / n
    at = [(0, 0.8), (0.28, 0.8), (0.38, 1), (0.66, 1), (0.76, 0.8)]
    points = [(r * np.cos(step * (i + a)), r * np.sin(step * (i + a))) for i in range(n) for a, r in at]
    return [np.array(points), circle(0, 0, 0.3, 96)]


class Runner:
    def __init__(self, program, folder):
        self.program, self.folder = program, pathlib.Path(folder)

    def mesh(self, command, source, size, *options):
        if command == "plane":
            name = self.folder / "outline.txt"
            name.write_text("\n\n".join("\n".join(f"{x} {y}" for x, y in loop) for loop in source) + "\n")
            source = name
        out = self.folder / "mesh.vtu"
        subprocess.run([self.program, command, source, "-o", out, "--size", str(size), "--quiet", *map(str, options)],
                       check=True)
        return meshio.read(out)


def cells(mesh):
    return [mesh.points[row] for block in mesh.cells if block.type in ("quad", "triangle") for row in block.data]


def draw_plane(axes, mesh, title):
    axes.add_collection(PolyCollection([c[:, :2] for c in cells(mesh)], facecolor="0.93", edgecolor="k", linewidth=0.45))
    axes.set(title=title, aspect="equal")
    axes.autoscale()
    axes.axis("off")


def draw_shell(axes, mesh, title, view):
    polygons = np.array([c for c in cells(mesh) if len(c) == 4])
    normal = np.cross(polygons[:, 2] - polygons[:, 0], polygons[:, 3] - polygons[:, 1])
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    light = 0.55 + 0.4 * np.abs(normal @ np.array([0.4, -0.7, 0.59]))
    axes.add_collection3d(Poly3DCollection(polygons, facecolor=np.c_[light, light, light], edgecolor="k", linewidth=0.25))
    low, high = mesh.points.min(0), mesh.points.max(0)
    axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), zlim=(low[2], high[2]), title=title)
    axes.set_box_aspect(high - low)
    axes.view_init(*view)
    axes.axis("off")


def draw_crosses(runner):
    crosses = runner.folder / "crosses.vtu"
    runner.mesh("plane", section(), 0.09, "--crosses", crosses)
    field = meshio.read(crosses)
    triangles = field.cells_dict["triangle"]
    figure, axes = plt.subplots(figsize=(11, 3.6))
    colours = axes.tripcolor(field.points[:, 0], field.points[:, 1], triangles, field.point_data["smoothness"],
                             shading="gouraud", cmap="viridis", vmin=0.4, vmax=1)
    centres = field.points[triangles].mean(axis=1)[:, :2]
    w, x, y, z = field.cell_data["frame"][0].T
    direction = np.c_[1 - 2 * (y * y + z * z), 2 * (x * y + w * z)]
    lines = [(c - 0.035 * d, c + 0.035 * d) for a in (direction, direction @ np.array([[0, 1], [-1, 0]]))
             for c, d in zip(centres, a)]
    axes.add_collection(LineCollection(lines, color="w", linewidth=0.5))
    axes.set(aspect="equal")
    axes.axis("off")
    figure.colorbar(colours, label="smoothness", shrink=0.8)
    figure.savefig(IMAGES / "planar-crosses.png", dpi=110, bbox_inches="tight")


@contextlib.contextmanager
def command_line():
    """A runner of the program that the arguments name, and the folder of surfaces."""
    parser = argparse.ArgumentParser()
    parser.add_argument("program", type=pathlib.Path)
    parser.add_argument("--models", type=pathlib.Path, default=pathlib.Path(__file__).parents[2] / "tests" / "data")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        yield Runner(arguments.program.resolve(), folder), arguments.models


def main():
    with command_line() as (runner, models):
        draw_crosses(runner)

        figure, axes = plt.subplots(1, 2, figsize=(15, 3.4))
        for panel, order in zip(axes, ("fifo", "smoothness")):
            draw_plane(panel, runner.mesh("plane", section(), 0.05, "--order", order), order)
        figure.tight_layout()
        figure.savefig(IMAGES / "planar-orders.png", dpi=100)

        figure, axes = plt.subplots(1, 2, figsize=(12, 4), width_ratios=(1.7, 1))
        draw_plane(axes[0], runner.mesh("plane", plate(), 0.08), "plate with three holes")
        draw_plane(axes[1], runner.mesh("plane", gear(), 0.05), "gear")
        figure.tight_layout()
        figure.savefig(IMAGES / "planar-domains.png", dpi=100)

        figure = plt.figure(figsize=(12, 5.5))
        bunny = runner.mesh("shell", models / "bunny.stl", 0.26)
        dome = runner.mesh("shell", models / "dome.ply", 0.156)
        draw_shell(figure.add_subplot(1, 2, 1, projection="3d"), bunny, "bunny", (110, -80))
        draw_shell(figure.add_subplot(1, 2, 2, projection="3d"), dome, "dome", (25, -60))
        figure.tight_layout()
        figure.savefig(IMAGES / "planar-shells.png", dpi=100)


if __name__ == "__main__":
    main()
