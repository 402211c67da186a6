#!/usr/bin/env python3
# SPDX-License-Identifier: BSL-1.0
"""The page that shows a mesh, in headless Chromium; what it counts is counted here again from the .vtu file.

FRAMEHEX is the program. Needs Debian's chromium, python3-meshio and python3-numpy.
"""
import hashlib
import json
import os
import pathlib
import re
import struct
import subprocess
import sys
import tempfile
import unittest
import zlib

import meshio
import numpy as np

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "examples" / "viewer"))
from chromium import Page  # noqa: E402

KINDS = {"tetra": "tetrahedron", "pyramid": "pyramid", "wedge": "prism", "hexahedron": "hexahedron"}
FACES = {
    "tetra": [(0, 1, 2), (0, 1, 3), (1, 2, 3), (0, 2, 3)],
    "pyramid": [(0, 1, 2, 3), (0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4)],
    "wedge": [(0, 1, 2), (3, 4, 5), (0, 1, 4, 3), (1, 2, 5, 4), (2, 0, 3, 5)],
    "hexahedron": [(0, 1, 2, 3), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)],
}


def framehex(*arguments):
    subprocess.run([os.environ["FRAMEHEX"], *map(str, arguments), "--quiet"], check=True)


class Mesh:
    """The cells of a .vtu file, one after the other."""

    def __init__(self, path):
        mesh = meshio.read(path)
        self.points, self.kinds, self.cells, self.quality = mesh.points, [], [], []
        for block, quality in zip(mesh.cells, mesh.cell_data["scaled_jacobian"]):
            if block.type in KINDS:
                self.kinds += [block.type] * len(block.data)
                self.cells += list(block.data)
                self.quality += list(quality)
        self.quality = np.array(self.quality)
        self.centres = np.array([self.points[cell].mean(axis=0) for cell in self.cells])
        self.faces = [[frozenset(cell[list(face)]) for face in FACES[kind]] for kind, cell in zip(self.kinds, self.cells)]

    def extent(self, axis):
        return self.points[:, axis].min(), self.points[:, axis].max()

    def before(self, axis, at):
        low, high = self.extent(axis)
        distance = (self.centres[:, axis] - low) / (high - low) - at
        assert abs(distance).min() > 1e-6, "a cell whose centre lies in the plane: take another"
        return distance < 0

    def layers(self):
        users = {}
        for cell, faces in enumerate(self.faces):
            for face in faces:
                users.setdefault(face, []).append(cell)
        layer = {c: 0 for cells in users.values() if len(cells) == 1 for c in cells}
        front = list(layer)
        while front:
            beyond = {other for c in front for face in self.faces[c] for other in users[face] if other not in layer}
            layer.update({c: layer[front[0]] + 1 for c in beyond})
            front = list(beyond)
        return np.array([layer[c] for c in range(len(self.cells))])

    def count(self, shown):
        return {name: sum(1 for kind, s in zip(self.kinds, shown) if s and kind == vtk) for vtk, name in KINDS.items()}

    def n_seen(self, shown):
        n = {}
        for faces, s in zip(self.faces, shown):
            for face in faces if s else ():
                n[face] = n.get(face, 0) + 1
        return sum(1 for uses in n.values() if uses == 1)


def pixels(png):
    """Rows of a PNG of 8 bits a channel, without its filters, as an array (height, width, channels)."""
    position, data = 8, b""
    while position < len(png):
        length, kind = struct.unpack(">I4s", png[position:position + 8])
        body = png[position + 8:position + 8 + length]
        if kind == b"IHDR":
            width, height, _, colour = struct.unpack(">IIBB", body[:10])
        data += body if kind == b"IDAT" else b""
        position += 12 + length
    n = {2: 3, 6: 4}[colour]
    raw = np.frombuffer(zlib.decompress(data), np.uint8).reshape(height, 1 + n * width)
    rows = np.zeros((height, width, n), np.uint8)
    for y in range(height):
        above = rows[y - 1].astype(int) if y else np.zeros((width, n), int)
        line, left, corner = raw[y, 1:].reshape(width, n).astype(int), np.zeros(n, int), np.zeros(n, int)
        for x in range(width):
            p = left + above[x] - corner
            near = np.stack([abs(p - left), abs(p - above[x]), abs(p - corner)])
            guess = [0, left, above[x], (left + above[x]) // 2,
                     np.choose(near.argmin(axis=0), [left, above[x], corner])][raw[y, 0]]
            corner, left = above[x], (line[x] + guess) % 256
            rows[y, x] = left
    return rows


class Case(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.path = pathlib.Path(cls.folder.name)
        cls.page = Page(900, 600)
        cls.addClassCleanup(cls.page.__exit__)
        cls.addClassCleanup(cls.folder.cleanup)

    def text(self, id):
        return self.page.evaluate(f"document.getElementById({json.dumps(id)}).textContent")

    def shown(self):
        return {kind: int(self.text(f"shown-{kind}").replace(",", "")) for kind in KINDS.values()}

    def n_seen(self):
        return int(re.search(r"([\d,]+) faces seen", self.text("shown-text"))[1].replace(",", ""))

    def check_clean(self):
        self.assertEqual(self.page.errors, [])
        self.assertEqual([url for url in self.page.requests if not url.startswith(("file:", "about:", "data:,"))], [])


class TestModel(Case):
    """A page of `framehex mesh`."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        surface, cells = ROOT / "examples" / "data" / "bunny.stl", ("--cells", 1500)
        framehex("mesh", surface, *cells, "-o", cls.path / "bunny.vtu", "--report", cls.path / "bunny.json")
        framehex("mesh", surface, *cells, "-o", cls.path / "bunny.html")
        cls.mesh, cls.report = Mesh(cls.path / "bunny.vtu"), json.loads((cls.path / "bunny.json").read_text())

    def open(self, address=""):
        self.page.open(self.path / "bunny.html", address)

    def check_shown(self, shown):
        self.assertEqual(self.shown(), self.mesh.count(shown))
        self.assertEqual(self.n_seen(), self.mesh.n_seen(shown))

    def test_whole_mesh(self):
        self.open()
        counts, ratio = self.report["counts"], self.report["hex_ratio"]
        self.check_shown([True] * len(self.mesh.cells))
        self.assertEqual(int(self.text("total-cells").replace(",", "")), counts["cells"])
        self.assertEqual(self.text("number-hexahedron"), f"{100 * ratio['number']:.1f} %")
        self.assertAlmostEqual(float(self.text("volume-hexahedron")[:-2]), 100 * ratio["volume"], delta=0.0501)
        self.assertIn(f"least {self.report['quality']['least']:.3f}, mean {self.report['quality']['mean']:.3f}",
                      self.text("quality-summary"))
        rows = self.page.evaluate("[...document.querySelectorAll('#histogram tr td:last-child')].map(x => x.textContent)")
        expected, _ = np.histogram(self.mesh.quality.astype(np.float32), bins=np.linspace(0, 1, 11))
        self.assertEqual([int(row.replace(",", "")) for row in rows], list(expected))
        self.check_clean()

    def test_cuts(self):
        for axis, at, flip in [(0, 0.3737, False), (1, 0.6161, False), (2, 0.5252, True)]:
            self.open(f"cut={'xyz'[axis]},{at}" + (",flip" if flip else ""))
            before = self.mesh.before(axis, at)
            self.check_shown(~before if flip else before)
        self.check_clean()

    def test_peeling(self):
        layers = self.mesh.layers()
        for peel in range(1, layers.max() + 1):
            self.open(f"peel={peel}")
            self.check_shown(layers >= peel)

    def test_filters(self):
        self.open()
        self.page.evaluate("document.getElementById('kind-hexahedron').click()")
        self.page.settle()
        self.check_shown([kind != "hexahedron" for kind in self.mesh.kinds])
        self.page.evaluate("const high = document.getElementById('high'); high.value = 0.5;"
                           "high.dispatchEvent(new Event('input'))")
        self.page.settle()
        least, greatest = self.mesh.quality.min(), self.mesh.quality.max()
        self.check_shown([kind != "hexahedron" and q <= (least + greatest) / 2
                          for kind, q in zip(self.mesh.kinds, self.mesh.quality)])

    def test_something_is_drawn(self):
        self.open("panel=0&theme=light&lines=0&curves=0")
        image = pixels(self.page.picture())[:, :, :3].reshape(-1, 3)
        ground = image[0]
        share = (image != ground).any(axis=1).mean()
        self.assertGreater(share, 0.1)
        self.assertLess(share, 0.9)
        self.assertGreater(len(np.unique(image, axis=0)), 100)  # faces in different lights, edges

    def test_colours_follow_the_choice(self):
        seen = []
        for colour in ("kind", "quality", "smoothness"):
            self.open(f"panel=0&colour={colour}")
            seen.append(self.page.picture())
        self.assertEqual(len(set(seen)), 3)

    def test_themes(self):
        grounds = []
        for theme in ("light", "dark"):
            self.open(f"panel=0&theme={theme}")
            grounds.append(int(pixels(self.page.picture())[0, 0, :3].sum()))
        self.assertGreater(grounds[0], 600)
        self.assertLess(grounds[1], 150)

    def test_keyboard_reaches_everything(self):
        self.open()
        visible = set(self.page.evaluate(
            "[...document.querySelectorAll('canvas, button, input, select')].filter((x) => !x.disabled && "
            "x.checkVisibility()).map((x, i) => (x.dataset.order = i, String(i)))"))
        reached = set()
        for _ in range(2 * len(visible)):
            self.page.press("Tab")
            reached.add(self.page.evaluate("document.activeElement.dataset.order ?? null"))
        self.assertGreater(len(visible), 30)
        self.assertEqual(visible - reached, set())

    def test_keys(self):
        self.open()
        value = lambda id, what="value": self.page.evaluate(f"document.getElementById('{id}').{what}")  # noqa: E731
        self.page.press("x")
        self.assertEqual(value("cut"), "x")
        self.page.press("]")
        self.assertEqual(value("at"), "0.51")
        self.page.press("f")
        self.assertTrue(value("flip", "checked"))
        self.page.press("p")
        self.assertEqual(value("peel"), "1")
        self.page.press("?")
        self.assertTrue(value("help", "open"))
        self.page.press("Escape")
        self.assertFalse(value("help", "open"))
        self.page.press("h")
        self.assertFalse(self.page.evaluate("document.getElementById('panel').checkVisibility()"))
        self.page.press("h")
        before = self.page.picture()
        self.page.evaluate("document.getElementById('picture').focus()")
        self.page.press("ArrowLeft")
        self.assertNotEqual(self.page.picture(), before)
        self.page.press("r")
        self.assertEqual(value("cut"), "none")
        self.check_shown([True] * len(self.mesh.cells))

    def test_dragging(self):
        self.open("cut=x,0.5&view=-90,5")
        at = lambda: float(self.page.evaluate("document.getElementById('at').value"))  # noqa: E731
        self.page.drag((200, 300), (260, 300), shift=True)
        self.assertGreater(at(), 0.51)  # x points to the right in this view
        moved, before = at(), self.page.picture()
        self.page.drag((200, 300), (260, 300))
        self.assertEqual(at(), moved)
        self.assertNotEqual(self.page.picture(), before)  # turned

    def test_touch(self):
        self.open()
        before = self.page.picture()
        touch = lambda kind, *points: self.page.call(  # noqa: E731
            "Input.dispatchTouchEvent", type=kind, touchPoints=[{"x": x, "y": y} for x, y in points])
        touch("touchStart", (200, 300))
        touch("touchMove", (260, 320))
        touch("touchEnd")
        self.page.settle()
        self.assertNotEqual(self.page.picture(), before)

    def test_worst_cells(self):
        self.open()
        names = self.page.evaluate("[...document.querySelectorAll('#worst button')].map(x => x.textContent)")
        listed = [float(name.split()[0]) for name in names]
        for mine, theirs in zip(sorted(self.mesh.quality), listed):
            self.assertAlmostEqual(mine, theirs, delta=0.0006)
        worst = int(names[0].split()[-1])
        self.assertAlmostEqual(self.mesh.quality[worst], listed[0], delta=0.0006)
        self.page.evaluate("document.querySelector('#worst button').click()")
        self.page.evaluate("new Promise((done) => setTimeout(done, 700))")
        self.assertEqual(self.page.evaluate("document.getElementById('cut').value"), "view")
        self.assertGreaterEqual(self.shown()[KINDS[self.mesh.kinds[worst]]], 1)
        self.check_clean()


CUBE_OF_TWO = """<?xml version="1.0"?>
<VTKFile type="UnstructuredGrid" version="0.1"><UnstructuredGrid>
<FieldData><DataArray type="Int32" Name="regions:&lt;/script&gt; &quot;steel&quot;" NumberOfTuples="1" format="ascii">1</DataArray></FieldData>
<Piece NumberOfPoints="12" NumberOfCells="3">
<Points><DataArray type="Float64" NumberOfComponents="3" format="ascii">
0 0 0  1 0 0  1 1 0  0 1 0  0 0 1  1 0 1  1 1 1  0 1 1  2 0 0  2 1 0  2 0 1  2 1 1</DataArray></Points>
<Cells><DataArray type="Int64" Name="connectivity" format="ascii">0 1 2 3 4 5 6 7  1 5 8 2 6 9  5 10 8 6 11 9</DataArray>
<DataArray type="Int64" Name="offsets" format="ascii">8 14 20</DataArray>
<DataArray type="UInt8" Name="types" format="ascii">12 13 13</DataArray></Cells>
<CellData><DataArray type="Int32" Name="label" format="ascii">0 1 1</DataArray></CellData>
</Piece></UnstructuredGrid></VTKFile>
"""


class TestRegions(Case):
    """A page of `framehex view`, of two regions, one of which has a name that would end a script."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        (cls.path / "two.vtu").write_text(CUBE_OF_TWO)
        framehex("view", cls.path / "two.vtu", "-o", cls.path / "two & <b>.html")

    def test_regions(self):
        self.page.open(self.path / "two & <b>.html", "colour=region")
        self.assertEqual(self.text("title"), "two & <b>")
        self.assertIn("</script> \"steel\": 2 cells", self.text("regions"))
        self.assertEqual(self.shown(), {"tetrahedron": 0, "pyramid": 0, "prism": 2, "hexahedron": 1})
        self.assertEqual(self.n_seen(), 12)
        self.assertEqual(self.text("volume-hexahedron"), "50.0 %")
        self.page.evaluate("document.querySelector('#regions input').click()")
        self.page.settle()
        self.assertEqual(self.shown()["hexahedron"], 0)
        self.assertEqual(self.n_seen(), 8)
        self.check_clean()


    def test_same_mesh_same_bytes(self):
        first = (self.path / "two & <b>.html").read_bytes()
        framehex("view", self.path / "two.vtu", "-o", self.path / "two & <b>.html")
        self.assertEqual((self.path / "two & <b>.html").read_bytes(), first)

    def test_what_is_refused(self):
        for arguments, word in [(("view", self.path / "two.vtu", "-o", self.path / "two.msh"), "a view is a page"),
                                (("inspect", self.path / "two & <b>.html"), "written but not read")]:
            done = subprocess.run([os.environ["FRAMEHEX"], *map(str, arguments)], capture_output=True, text=True)
            self.assertEqual(done.returncode, 2)
            self.assertIn(word, done.stderr)
        self.assertFalse((self.path / "two.msh").exists())


class TestSources(unittest.TestCase):
    def test_header_is_made_from_the_sources(self):
        folder = ROOT / "examples" / "viewer"
        names = [f"src/{path.name}" for path in (folder / "src").iterdir()] + ["build.mjs", "package-lock.json"]
        digest = hashlib.sha256("".join(f"{name}\n{(folder / name).read_text()}" for name in sorted(names)).encode())
        header = (ROOT / "include" / "framehex" / "io" / "detail" / "viewer_page.hpp").read_text()
        self.assertEqual(re.search(r"sources: (\w+)", header)[1], digest.hexdigest(),
                         "run npm ci and npm run build in examples/viewer")
        self.assertIn("three.js authors", header)


if __name__ == "__main__":
    unittest.main()
