#!/usr/bin/python3
# SPDX-License-Identifier: BSL-1.0
"""Pictures and table of docs/frame-field.md.

    frame_field_pictures.py MODELS_DIR [--work DIR] [--compiler CXX]

MODELS_DIR holds closed surfaces (dome.stl, naca.stl, ...). Fills each, a ball and a cylinder, with about 50,000
tetrahedra by TetGen, runs frame_field_states.cpp on them, writes docs/images/frame-field-*.png and prints the table.
Needs a compiler, Debian's tetgen, python3-numpy, python3-scipy, python3-meshio and python3-matplotlib.
"""
import argparse
import pathlib
import subprocess

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import meshio
import numpy as np
from matplotlib.collections import PolyCollection
from mpl_toolkits.mplot3d.art3d import Line3DCollection, Poly3DCollection
from scipy.spatial import ConvexHull, Delaunay

ROOT = pathlib.Path(__file__).resolve().parents[2]
MODELS = ["dome", "bunny", "blade", "piece", "fuselage", "naca"]
STATES = ["nearest", "constant", "variable", "best"]


def welded(path):
    mesh = meshio.read(path)
    points = np.asarray(mesh.points, float)
    key = np.round((points - points.min(0)) / np.ptp(points, axis=0).max() * 1e6).astype(np.int64)
    _, first, inverse = np.unique(key, axis=0, return_index=True, return_inverse=True)
    triangles = inverse.reshape(-1)[mesh.cells_dict["triangle"]]
    return points[first], triangles[[len(set(t)) == 3 for t in triangles]]


def ball(n=2000, radius=0.5):
    """Points along a spiral, not symmetric in any way that the field could follow."""
    i = np.arange(n) + 0.5
    polar, turn = np.arccos(1 - 2 * i / n), np.pi * (1 + 5**0.5) * i
    points = radius * np.c_[np.cos(turn) * np.sin(polar), np.sin(turn) * np.sin(polar), np.cos(polar)]
    triangles = ConvexHull(points).simplices
    a, b, c = (points[triangles[:, k]] for k in range(3))
    inward = np.einsum("ij,ij->i", np.cross(b - a, c - a), a) < 0
    triangles[inward] = triangles[inward][:, ::-1]
    return points, triangles


def cylinder(n=48, radius=0.5, height=2.0):
    edge = 2 * np.pi * radius / n
    around = 2 * np.pi * np.arange(n) / n
    ring = radius * np.c_[np.cos(around), np.sin(around)]
    m = int((radius / edge) ** 2 * np.pi * 1.1)
    k = np.arange(m) + 0.5
    r, turn = (radius - 0.8 * edge) * np.sqrt(k / m), np.pi * (1 + 5**0.5) * k
    disk = np.r_[ring, np.c_[r * np.cos(turn), r * np.sin(turn)]]
    layers = round(height / edge)
    points = [(x, y, height * j / layers) for j in range(layers + 1) for x, y in ring]
    triangles = []
    for j in range(layers):
        for i in range(n):
            a, b = j * n + i, j * n + (i + 1) % n
            triangles += [[a, b, b + n], [a, b + n, a + n]] if (i + j) % 2 else [[a, b, a + n], [b, b + n, a + n]]
    for lid in (0, layers):
        ids = [lid * n + i for i in range(n)] + list(range(len(points), len(points) + m))
        points += [(x, y, height * lid / layers) for x, y in disk[n:]]
        for t in Delaunay(disk).simplices:
            (ax, ay), (bx, by), (cx, cy) = disk[t]
            up = (bx - ax) * (cy - ay) > (by - ay) * (cx - ax)
            t = t if up == bool(lid) else t[::-1]
            triangles.append([ids[v] for v in t])
    return np.array(points), np.array(triangles)


def background(work, name, points, triangles, cells):
    with open(work / f"{name}.smesh", "w") as file:
        file.write(f"{len(points)} 3 0 0\n")
        file.writelines("%d %.17g %.17g %.17g\n" % (i, *p) for i, p in enumerate(points))
        file.write(f"{len(triangles)} 0\n")
        file.writelines("3 %d %d %d\n" % tuple(t) for t in triangles)
        file.write("0\n0\n")
    volume = sum(np.einsum("ij,ij->i", points[triangles[:, 0]], np.cross(points[triangles[:, 1]], points[triangles[:, 2]]))) / 6
    subprocess.run(["tetgen", f"-pq1.3Ya{volume / cells:g}", f"{name}.smesh"], cwd=work, check=True, stdout=subprocess.DEVNULL)


def rows(path, columns):
    return np.loadtxt(path, skiprows=1, comments="#", usecols=columns)


def lines(path):
    blocks = path.read_text().split("\n\n")
    return [np.array([[float(x) for x in row.split()] for row in b.splitlines()]) for b in blocks if b.strip()]


def cut(points, tets, values, axis, at):
    """Polygons in which a plane cuts the tetrahedra, with the mean of the values at their corners."""
    polygons, colours = [], []
    keep = [i for i in range(3) if i != axis]
    side = points[:, axis] - at
    for tet in tets[(side[tets].min(1) < 0) & (side[tets].max(1) > 0)]:
        corners, found = [], []
        for i in range(4):
            for j in range(i):
                a, b = side[tet[i]], side[tet[j]]
                if (a < 0) != (b < 0):
                    w = a / (a - b)
                    corners.append((1 - w) * points[tet[i]][keep] + w * points[tet[j]][keep])
                    found.append((1 - w) * values[tet[i]] + w * values[tet[j]])
        corners = np.array(corners)
        centre = corners.mean(0)
        polygons.append(corners[np.argsort(np.arctan2(*(corners - centre).T))])
        colours.append(np.mean(found))
    return polygons, colours


def draw_smoothness(work, name, out):
    points, tets = rows(work / f"{name}.1.node", (1, 2, 3)), rows(work / f"{name}.1.ele", (1, 2, 3, 4)).astype(int)
    middle = 0.5 * (points[:, 1].min() + points[:, 1].max()) + 1e-4 * np.ptp(points[:, 1])
    figure, panels = plt.subplots(2, 2, figsize=(9, 6.6))
    titles = ["nearest boundary point", "smoothed, constant diffusivity", "smoothed, variable diffusivity", "best"]
    for panel, state, title in zip(panels.flat, STATES, titles):
        values = np.loadtxt(work / f"{name}.{state}.smoothness")
        polygons, colours = cut(points, tets, values, 1, middle)
        drawn = PolyCollection(polygons, array=np.array(colours), cmap="viridis", clim=(0.3, 1), edgecolors="face", linewidths=0.2)
        panel.add_collection(drawn)
        panel.autoscale()
        panel.set_aspect("equal")
        panel.set_axis_off()
        panel.set_title(title, fontsize=10)
    figure.colorbar(drawn, ax=panels, shrink=0.7, label="smoothness s")
    figure.savefig(out, dpi=90, bbox_inches="tight")
    plt.close(figure)


def draw_lines(work, models, out):
    figure = plt.figure(figsize=(11, 7))
    for k, (name, surface) in enumerate(models):
        points, triangles = surface
        panel = figure.add_subplot(2, 3, k + 1, projection="3d")
        panel.add_collection3d(Poly3DCollection(points[triangles], facecolors=(0.55, 0.6, 0.68, 0.04), edgecolors="none"))
        for line in lines(work / f"{name}.best.lines"):
            colour = "tab:red" if line[0, 3] == 0.25 else "tab:blue" if line[0, 3] == -0.25 else "black"
            # The facets that a line crosses zigzag about it: draw the running mean.
            path = line[:, :3].copy()
            for _ in range(10):
                path[1:-1] = 0.25 * path[:-2] + 0.5 * path[1:-1] + 0.25 * path[2:]
            panel.add_collection3d(Line3DCollection([path], colors=colour, linewidths=1.6))
        low, high = points.min(0), points.max(0)
        centre, half = (low + high) / 2, (high - low).max() / 2
        panel.set(xlim=(centre[0] - half, centre[0] + half), ylim=(centre[1] - half, centre[1] + half), zlim=(centre[2] - half, centre[2] + half))
        panel.set_box_aspect((1, 1, 1), zoom=1.35)
        panel.set_axis_off()
        panel.set_title(name, fontsize=10)
    figure.savefig(out, dpi=80, bbox_inches="tight")
    plt.close(figure)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("models", type=pathlib.Path)
    parser.add_argument("--work", type=pathlib.Path, default=pathlib.Path("/tmp/frame-field-pictures"))
    parser.add_argument("--compiler", default="g++")
    options = parser.parse_args()
    work = options.work
    work.mkdir(parents=True, exist_ok=True)
    images = ROOT / "docs" / "images"
    images.mkdir(exist_ok=True)
    program = work / "frame_field_states"
    subprocess.run([options.compiler, "-std=c++20", "-O2", "-DEIGEN_MPL2_ONLY", "-isystem", "/usr/include/eigen3", "-I", ROOT / "include",
                    ROOT / "docs/scripts/frame_field_states.cpp", "-o", program], check=True)
    surfaces = {name: welded(options.models / f"{name}.stl") for name in MODELS}
    surfaces |= {"ball": ball(), "cylinder": cylinder()}
    # The models' own triangles are fine enough to fill a mesh by themselves.
    cells = {"ball": 26000, "cylinder": 31000}
    print("| model | tets | field | mean s | s >= 0.85 | energy | singular facets | lines | on the boundary |")
    print("| --- | ---: | --- | ---: | ---: | ---: | ---: | ---: | ---: |")
    for name, (points, triangles) in surfaces.items():
        background(work, name, points, triangles, cells.get(name, 6000))
        report = subprocess.run([program, work / f"{name}.1", work / name], check=True, capture_output=True, text=True).stdout
        for line in report.splitlines():
            state, *rest = line.split()
            f = dict(zip(rest[::2], rest[1::2]))
            print(f"| {name} | {int(f['tets']):,} | {state} | {f['mean']} | {float(f['smooth']) * 100:.1f}% | {float(f['energy']):.2f} "
                  f"| {f['facets']} | {f['lines']} | {f['points']} |")
    draw_smoothness(work, "dome", images / "frame-field-dome-smoothness.png")
    shown = ["cylinder", "ball", "dome", "piece", "fuselage", "blade"]
    draw_lines(work, [(name, surfaces[name]) for name in shown], images / "frame-field-singular-lines.png")


if __name__ == "__main__":
    main()
