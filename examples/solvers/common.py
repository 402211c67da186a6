# SPDX-License-Identifier: BSL-1.0
"""What the solves share: meshing, shapes, answers, pictures."""
import argparse
import pathlib
import subprocess
import sys
import tempfile

import numpy as np

DATA = pathlib.Path(__file__).resolve().parents[2] / "tests" / "data"


class Answers:
    """What is asked and what is measured, a line each."""

    def __init__(self):
        self.all_hold = True

    def add(self, what, asked, measured, holds):
        self.all_hold = self.all_hold and bool(holds)
        print(f"{what}: asked {asked}, measured {measured}: {'holds' if holds else 'FAILS'}", flush=True)

    def at_most(self, what, bound, measured):
        self.add(what, f"at most {bound:g}", f"{measured:.3g}", measured <= bound)

    def at_least(self, what, bound, measured):
        self.add(what, f"at least {bound:g}", f"{measured:.4g}", measured >= bound)


def run(solve, description, surface=None):
    """`solve(program, surface, folder, answers, picture)` in a folder of its own; exits with 1 unless all answers hold.

    A solve with a default `surface` takes another one.
    """
    parser = argparse.ArgumentParser(description=description, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", help="the program framehex")
    if surface is not None:
        parser.add_argument("surface", nargs="?", default=surface, help=f"a closed surface (default: {surface.name})")
    parser.add_argument("--picture", metavar="FILE.png", help="draw the solution")
    parser.add_argument("--keep", metavar="FOLDER", type=pathlib.Path, help="keep the solver's files here")
    arguments = parser.parse_args()
    answers = Answers()
    with tempfile.TemporaryDirectory(prefix="framehex-solve-") as temporary:
        folder = arguments.keep or pathlib.Path(temporary)
        folder.mkdir(parents=True, exist_ok=True)
        solve(arguments.program, getattr(arguments, "surface", None), folder, answers, arguments.picture)
    sys.exit(0 if answers.all_hold else 1)


def mesh(program, surface, out, cells, *options):
    """Of about so many cells, whatever the surface's unit."""
    subprocess.run([program, "mesh", surface, "-o", out, "--cells", str(cells), "--quiet", *options], check=True)
    return out


def write_off(path, points, polygons):
    with open(path, "w", encoding="ascii") as file:
        file.write(f"OFF\n{len(points)} {len(polygons)} 0\n")
        file.writelines("%.17g %.17g %.17g\n" % tuple(p) for p in points)
        file.writelines(" ".join(map(str, (len(p), *p))) + "\n" for p in polygons)
    return path


def write_extrusion(path, outline, height):
    """The closed surface over an outline in the plane of x and y, counterclockwise, from z = 0 to `height`."""
    n = len(outline)
    points = [(x, y, z) for z in (0, height) for x, y in outline]
    sides = [(i, (i + 1) % n, (i + 1) % n + n, i + n) for i in range(n)]
    return write_off(path, points, [tuple(range(n))[::-1], tuple(range(n, 2 * n)), *sides])


def view_from(azimuth, elevation):
    """Rows: right, up, and the direction towards the viewer; angles in degrees, z upwards."""
    a, e = np.radians([azimuth, elevation])
    towards = np.array([np.cos(e) * np.cos(a), np.cos(e) * np.sin(a), np.sin(e)])
    right = np.array([-np.sin(a), np.cos(a), 0])
    return np.array([right, np.cross(towards, right), towards])


def draw(path, points, faces, values, view, title, label):
    """Faces, outward, in the colours of their `values` as `view` sees them: what looks away is left out."""
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    from matplotlib.collections import PolyCollection
    projected = np.asarray(points) @ view.T

    def seen(corners):
        x, y = projected[corners, 0], projected[corners, 1]
        return x @ np.roll(y, -1) > y @ np.roll(x, -1)

    shown = [i for i, face in enumerate(faces) if seen(face)]
    shown.sort(key=lambda i: projected[faces[i], 2].mean())
    figure, axes = plt.subplots(figsize=(6.4, 5.2), dpi=100)
    patches = PolyCollection([projected[faces[i], :2] for i in shown], cmap="viridis", edgecolors="0.15",
                             linewidths=0.3)
    patches.set_array(np.asarray(values, float)[shown])
    axes.add_collection(patches)
    axes.set_aspect("equal")
    axes.autoscale_view()
    axes.axis("off")
    axes.set_title(title, fontsize=10)
    figure.colorbar(patches, ax=axes, shrink=0.75, label=label)
    figure.savefig(path, bbox_inches="tight", pad_inches=0.05)
