#!/usr/bin/env python3
# SPDX-License-Identifier: BSL-1.0
"""Makes the pictures of README.md, docs/viewer.md and docs/results.md from pages that framehex writes, in headless Chromium.

    viewer_pictures.py PROGRAM [NAME...]      without names: all

Pages of the paper's figures show the paper's variants in the paper's terms, and the program's lattice, side by side. Needs
Debian's chromium and tetgen, and paper_cube beside the program (target `benchmarks`) for results-cube.

What the pages say of the meshes in the pictures is noted in benchmarks/paper/pictures.json, with the pictures' SHA-256:
tables.py makes the captions from it, and a test compares it with the stored results.
"""
import base64
import hashlib
import json
import math
import pathlib
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "examples" / "viewer"), str(ROOT / "benchmarks" / "paper")]
import run  # noqa: E402
import shapes  # noqa: E402
from chromium import Page  # noqa: E402

IMAGES = ROOT / "docs" / "images"
NOTES = ROOT / "benchmarks" / "paper" / "pictures.json"
WIDTH, HEIGHT = 560, 420  # of one panel

# Name: model, address of the view, variants. Those of the paper's figures are cut like there.
FIGURES = {
    "results-dome": ("dome", "cut=y,0.5,flip&view=-75,14,1.65", ["NN-Fr", "Sm-FB", "lattice"]),
    "results-bunny": ("bunny", "cut=z,0.55&view=-90,60,1.3", ["NN-Fr", "Sm-FB", "lattice"]),
    "results-blade": ("blade", "cut=z,0.5&view=-60,40,1.3", ["NN-Fr", "Sm-FB", "lattice"]),
    "results-fuselage": ("fuselage", "cut=y,0.5,flip&view=-75,14,1.25", ["NN-Fr", "Sm-FB", "lattice"]),
    "results-piece": ("piece", "cut=z,0.3&view=-60,45,1.0", ["NN-Fr", "Sm-FB", "lattice"]),
    "results-naca": ("naca", "cut=z,0.5&view=-80,50,1.0", ["NN-Fr", "Sm-FB", "lattice"]),
    "results-placement": ("dome", "cut=y,0.5,flip&view=-75,14,1.65", ["fronts", "lattice"]),
    "results-smoothness": ("dome", "cut=y,0.5,flip&view=-75,14,1.65&colour=smoothness", ["NN-FB", "Sm-FB", "fronts, paper's terms"]),
}
CAPTIONS = {"NN-Fr": "nearest, first in first out", "NN-FB": "nearest, smoothest first", "Sm-FB": "smoothed, smoothest first",
            "fronts, paper's terms": "best field, fronts, paper's terms", "fronts": "best field, fronts", "lattice": "best field, lattice"}
# Whole pages as a user sees them: model, variant, address.
VIEWS = {
    "viewer-bunny": ("bunny", "lattice", "theme=light&cut=z,0.55&view=-70,35,1.35"),
    "viewer-blade": ("blade", "lattice", "theme=dark&cut=z,0.7&view=-60,35,1.2&colour=quality"),
}


def page_of(program, model, variant, folder):
    path = folder / variant / f"{model}.html"
    path.parent.mkdir(exist_ok=True)
    if not path.exists():
        surface = run.surface_file(run.MODELS, model, folder)
        subprocess.run([program, "mesh", surface, "--size", str(run.SMALL[model]), "-o", path, "--quiet",
                        *run.VARIANTS[variant]], check=True)
    return path


def side_by_side(page, pictures, captions, out):
    """One picture of several, each over its caption."""
    figures = "".join(f'<figure><img src="data:image/png;base64,{base64.b64encode(png).decode()}"><figcaption>{caption}'
                      "</figcaption></figure>" for png, caption in zip(pictures, captions))
    html = out.with_suffix(".html")
    html.write_text('<!DOCTYPE html><meta charset="utf-8"><style>body{margin:0;display:flex;background:#f6f7f9}figure{margin:0}'
                    f"img{{width:{WIDTH}px;height:{HEIGHT}px;display:block}}figcaption{{font:18px system-ui,sans-serif;"
                    f"text-align:center;padding:6px 0 10px}}</style>{figures}")
    page.call("Emulation.setDeviceMetricsOverride", width=WIDTH * len(pictures), height=HEIGHT + 42, deviceScaleFactor=1,
              mobile=False)
    page.open(html)
    page.picture(out)
    html.unlink()


def text(page, id):
    return page.evaluate(f"document.getElementById('{id}').firstChild.textContent")


def told(page, caption, row=None):
    """What an open page says of its mesh. `row`: the key of the stored run that it is of."""
    panel = {"caption": caption, "cells": int(text(page, "total-cells").replace(",", "")),
             **{what: text(page, f"{what}-hexahedron")[:-2] for what in ("number", "volume")}}
    return panel | ({"row": row} if row else {})


def note(program, name, panels):
    """Keeps what a picture shows and which file it is, in the order of the script."""
    notes = json.loads(NOTES.read_text()) if NOTES.exists() else {}
    digest = hashlib.sha256((IMAGES / f"{name}.png").read_bytes()).hexdigest()
    notes[name] = {"program": run.fingerprint(pathlib.Path(program)), "sha256": digest, "panels": panels}
    NOTES.write_text(json.dumps({key: notes[key] for key in KNOWN if key in notes}, indent=1) + "\n")


def make_figure(program, name, folder):
    model, address, variants = FIGURES[name]
    with Page(WIDTH, HEIGHT) as page:
        pictures, panels = [], []
        for variant in variants:
            page.open(page_of(program, model, variant, folder), f"panel=0&theme=light&curves=0&{address}")
            page.evaluate("document.getElementById('show').remove()")
            pictures.append(page.picture())
            panels.append(told(page, CAPTIONS[variant], f"{model} | small | {variant}"))
        captions = [f"{panel['caption']}: {panel['number']} / {panel['volume']} %" for panel in panels]
        side_by_side(page, pictures, captions, IMAGES / f"{name}.png")
    note(program, name, panels)


def ball_in_a_box(program, folder):
    """A page of tetrahedra of two regions, recombined."""
    points, faces = shapes.icosphere(3)
    box = [(x, y, z) for x in (-1.6, 1.6) for y in (-1.6, 1.6) for z in (-1.6, 1.6)]
    sides = [(0, 1, 3, 2), (4, 5, 7, 6), (0, 1, 5, 4), (2, 3, 7, 6), (0, 2, 6, 4), (1, 3, 7, 5)]
    faces = faces + [tuple(v + len(points) for v in side) for side in sides]
    points = points + box
    lines = [f"{len(points)} 3 0 0", *(f"{i} {x} {y} {z}" for i, (x, y, z) in enumerate(points)), f"{len(faces)} 0"]
    for face in faces:
        lines += ["1", " ".join(map(str, (len(face), *face)))]
    lines += ["0", "2", "0 0 0 0 1 -1", "1 1.5 1.5 1.5 2 -1"]
    (folder / "ball.poly").write_text("\n".join(lines) + "\n")
    subprocess.run(["tetgen", "-pqAa0.002gQ", folder / "ball.poly"], check=True, stdout=subprocess.DEVNULL)
    page = folder / "ball in a box.html"
    subprocess.run([program, "recombine", folder / "ball.1.mesh", "-o", page, "--quiet"], check=True)
    return page


RADIUS = 16  # of a node of the graph


def layout(graph):
    """Places for the nodes in a picture: springs along conflicts, all nodes pushing each other, then none nearer than a node
    is wide."""
    n = graph["candidates"]
    at = [complex(math.cos(2 * math.pi * i / n), math.sin(2 * math.pi * i / n)) for i in range(n)]
    for _ in range(2000):
        push = [sum((at[i] - at[j]) / abs(at[i] - at[j]) ** 2 for j in range(n) if j != i) * 0.05 for i in range(n)]
        for a, b in graph["conflicts"]:
            pull = (at[b] - at[a]) * 0.1
            push[a] += pull
            push[b] -= pull
        at = [z + 0.2 * p for z, p in zip(at, push)]
    middle, reach = sum(at) / n, max(abs(z - sum(at) / n) for z in at)
    most = HEIGHT / 2 - 1.5 * RADIUS
    at = [(z - middle) / reach * most for z in at]
    for _ in range(2000):
        for i in range(n):
            for j in range(i):
                apart, least = at[i] - at[j], 3 * RADIUS
                if abs(apart) < least:
                    step = apart / abs(apart) * (least - abs(apart)) / 2
                    at[i] += step
                    at[j] -= step
        at = [z if abs(z) < most else z / abs(z) * most for z in at]
    return at


def graph_picture(graph, members, page, folder):
    """The incompatibility graph with an independent set in grey."""
    at = layout(graph)
    parts = [f'<line x1="{at[a].real:.1f}" y1="{at[a].imag:.1f}" x2="{at[b].real:.1f}" y2="{at[b].imag:.1f}" stroke="#444"/>'
             for a, b in graph["conflicts"]]
    parts += [f'<circle cx="{z.real:.1f}" cy="{z.imag:.1f}" r="{RADIUS}" fill="{"#9aa0a8" if i in members else "#fff"}" stroke="#222"/>'
              for i, z in enumerate(at)]
    html = folder / "graph.html"
    html.write_text(f'<!DOCTYPE html><body style="margin:0;background:#f6f7f9"><svg width="{WIDTH}" height="{HEIGHT}" '
                    f'viewBox="{-WIDTH / 2} {-HEIGHT / 2} {WIDTH} {HEIGHT}">{"".join(parts)}</svg>')
    page.open(html)
    return page.picture()


def make_cube(program, folder):
    """The paper's Fig. 2: two sets of hexahedra that nothing can be added to, and their incompatibility graph."""
    printed = subprocess.run([pathlib.Path(program).with_name("paper_cube"), folder], check=True, capture_output=True)
    graph = json.loads(printed.stdout)["figure_2"]
    with Page(WIDTH, HEIGHT) as page:
        pictures = []
        for which in ("worse", "best"):
            page.open(folder / f"{which}.html", "panel=0&theme=light&curves=0&view=-60,25,0.85")
            page.evaluate("document.getElementById('show').remove()")
            pictures += [page.picture(), graph_picture(graph, graph[which], page, folder)]
        captions = [f"{len(graph['worse'])} hexahedra", f"{graph['candidates']} candidates, mean degree {graph['mean_degree']:g}",
                    f"{len(graph['best'])} hexahedra", "the greatest independent set"]
        side_by_side(page, pictures, captions, IMAGES / "results-cube.png")
    note(program, "results-cube", [{"caption": caption} for caption in captions])


def make_view(program, name, path, address, row=None):
    with Page(1280, 860) as page:
        page.open(path, address)
        page.picture(IMAGES / f"{name}.png")
        panels = [told(page, "whole page", row)]
    note(program, name, panels)


def make_demo(program, folder):
    """The second bunny of scripts/demo.sh, cut; it stands along y, which pages do not know."""
    variant, mesh, report = "fronts, smoothed field", folder / "bunny.vtu", folder / "bunny.json"
    run.measure(pathlib.Path(program), run.surface_file(run.MODELS, "bunny", folder), run.SMALL["bunny"], run.VARIANTS[variant], mesh)
    subprocess.run([sys.executable, ROOT / "docs" / "scripts" / "cut_view.py", mesh, IMAGES / "bunny.png", "--axis", "z", "--at", "0.5",
                    "--up", "y", "--view", "75", "12"], check=True)
    full = json.loads(report.read_text())
    panel = {"caption": "cut", "cells": full["counts"]["cells"], "row": f"bunny | small | {variant}",
             **{what: f"{100 * full['hex_ratio'][what]:.1f}" for what in ("number", "volume")}}
    note(program, "bunny", [panel])


KNOWN = ["bunny", *FIGURES, *VIEWS, "viewer-regions", "results-cube"]


def main():
    program = str(pathlib.Path(sys.argv[1]).resolve())
    unknown = [name for name in sys.argv[2:] if name not in KNOWN]
    if unknown:
        raise SystemExit(f"viewer_pictures.py: no picture is called {unknown[0]} (there are {', '.join(KNOWN)})")
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        for wanted in sys.argv[2:] or KNOWN:
            if wanted in FIGURES:
                make_figure(program, wanted, folder)
            elif wanted in VIEWS:
                model, variant, address = VIEWS[wanted]
                make_view(program, wanted, page_of(program, model, variant, folder), address, f"{model} | small | {variant}")
            elif wanted == "bunny":
                make_demo(program, folder)
            elif wanted == "viewer-regions":
                make_view(program, wanted, ball_in_a_box(program, folder),
                          "theme=light&cut=y,0.5,flip&view=-70,20,1.1&colour=region")
            else:
                make_cube(program, folder)
            print(wanted, flush=True)


if __name__ == "__main__":
    main()
