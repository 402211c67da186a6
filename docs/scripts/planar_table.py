#!/usr/bin/python3
# SPDX-License-Identifier: BSL-1.0
"""Prints the rows of the table in docs/planar.md: planar_table.py PROGRAM [--models FOLDER]

PROGRAM is `framehex`; FOLDER holds the surfaces (tests/data). Counts and indices come from the program's report; the
deviation of shells is measured here, both ways. Needs meshio, numpy and scipy.
"""
import json

import meshio
import numpy as np
from scipy.spatial import cKDTree

from planar_pictures import circle, command_line, gear, plate

SHELLS = {"bunny.stl": 0.26, "dome.ply": 0.156, "piece.ply": 0.108, "blade.ply": 0.026, "fuselage.ply": 0.156, "naca.ply": 0.038}


def rectangle(degrees):
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    return [np.array([(0, 0), (2, 0), (2, 1), (0, 1)]) @ np.array([[c, s], [-s, c]])]


def section_in_box():
    angle = np.pi * np.arange(160) / 80
    x = (1 + np.cos(angle)) / 2
    y = 0.6 * (0.2969 * np.sqrt(x) - 0.126 * x - 0.3516 * x**2 + 0.2843 * x**3 - 0.1036 * x**4)
    return [np.array([(-1, -1), (2.5, -1), (2.5, 1), (-1, 1)]), np.c_[x, np.where(np.arange(160) <= 80, y, -y)]]


def planes():
    return {"rectangle 2 x 1, turned by 17 degrees": (rectangle(17), 0.1),
            "disc": ([circle(0, 0, 1, 256)], 0.1),
            "annulus": ([circle(0, 0, 1, 256), circle(0, 0, 0.4, 128)], 0.1),
            "L": ([np.array([(0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2)])], 0.1),
            "plate with three holes": (plate(), 0.1),
            "gear": (gear(), 0.06),
            "NACA 0012 section in a box": (section_in_box(), 0.06)}


def triangles_of(mesh):
    """Corners of the triangles of a mesh, quadrilaterals as two: an array (n, 3, 3)."""
    parts = []
    for block in mesh.cells:
        if block.type == "triangle":
            parts.append(block.data)
        if block.type == "quad":
            parts += [block.data[:, [0, 1, 2]], block.data[:, [0, 2, 3]]]
    return mesh.points[np.vstack(parts)]


def samples(triangles, spacing):
    """Points of triangles no farther apart than the spacing, and the triangle of each."""
    longest = np.linalg.norm(triangles - np.roll(triangles, 1, axis=1), axis=2).max(axis=1)
    steps = np.maximum(1, np.ceil(longest / spacing).astype(int))
    points, owner = [], []
    for n in np.unique(steps):
        which = np.flatnonzero(steps == n)
        weights = np.array([(i, j, n - i - j) for i in range(n + 1) for j in range(n + 1 - i)]) / n
        points.append(np.einsum("wk,tkx->twx", weights, triangles[which]).reshape(-1, 3))
        owner.append(np.repeat(which, len(weights)))
    return np.vstack(points), np.concatenate(owner)


def distance_to_triangle(p, t):
    """Of points (n, 3) to triangles (n, 3, 3), row by row."""
    best = np.full(len(p), np.inf)
    for i in range(3):
        a, d = t[:, i], t[:, (i + 1) % 3] - t[:, i]
        s = np.clip(np.einsum("nx,nx->n", p - a, d) / np.maximum(np.einsum("nx,nx->n", d, d), 1e-300), 0, 1)
        best = np.minimum(best, np.linalg.norm(p - a - s[:, None] * d, axis=1))
    normal = np.cross(t[:, 1] - t[:, 0], t[:, 2] - t[:, 0])
    size = np.linalg.norm(normal, axis=1)
    inside = size > 0
    for i in range(3):
        side = np.cross(t[:, (i + 1) % 3] - t[:, i], p - t[:, i])
        inside &= np.einsum("nx,nx->n", side, normal) >= 0
    height = np.abs(np.einsum("nx,nx->n", p - t[:, 0], normal)) / np.maximum(size, 1e-300)
    return np.where(inside, np.minimum(best, height), best)


def one_sided(points, triangles, spacing):
    """Greatest distance of points to the triangles, of which those of the nearest samples are tried."""
    places, owner = samples(triangles, spacing)
    _, near = cKDTree(places).query(points, k=12)
    best = np.full(len(points), np.inf)
    for column in near.T:
        best = np.minimum(best, distance_to_triangle(points, triangles[owner[column]]))
    return best.max()


def deviation(mesh, surface, size):
    """Greatest distance between a mesh and a surface, both ways, over the diagonal."""
    a, b = triangles_of(mesh), triangles_of(surface)
    spacing = size / 4
    both = max(one_sided(samples(a, spacing)[0], b, spacing), one_sided(samples(b, spacing)[0], a, spacing))
    return both / np.linalg.norm(surface.points.max(axis=0) - surface.points.min(axis=0))


def main():
    with command_line() as (runner, models):
        report = runner.folder / "report.json"

        def row(command, name, source, size):
            mesh = runner.mesh(command, source, size, "--report", report)
            found = json.loads(report.read_text())
            counts, quality = found["counts"], found["quality"]
            characteristic = quality["euler_characteristic"]
            off = "" if command == "plane" else f"{100 * deviation(mesh, meshio.read(source), size):.2f} %"
            print(f"| {name} {size} | {counts['quadrilaterals']:,} | {counts['triangles']} | {len(quality['folded_cells'])} | "
                  f"{quality['scaled_jacobian_min']:.3f} | {quality['scaled_jacobian_mean']:.3f} | {off} | "
                  f"{quality['irregular_vertices']} | {quality['index_sum']} = 4 x {characteristic} |", flush=True)

        for name, (outline, size) in planes().items():
            row("plane", name, outline, size)
        for name, size in SHELLS.items():
            row("shell", name.split(".")[0], models / name, size)


if __name__ == "__main__":
    main()
