#!/usr/bin/env python3
# SPDX-License-Identifier: BSL-1.0
"""The page that shows a mesh, in headless Chromium; what it counts is counted here again from the .vtu file.

FRAMEHEX is the program. Needs Debian's chromium, python3-meshio and python3-numpy.
"""
import base64
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
import urllib.parse
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

    def test_a_new_size_is_drawn_before_it_is_seen(self):
        self.open("theme=light")
        # This observer comes after the page's own, in the same frame: what it reads is what is seen.
        middle = self.page.evaluate("""new Promise((done) => {
            const canvas = document.getElementById("picture"), gl = canvas.getContext("webgl2"), pixel = new Uint8Array(4);
            let n = 0;
            new ResizeObserver(() => {
                if (n++ === 0) return document.getElementById("hide").click();
                gl.readPixels(canvas.width / 2, canvas.height / 2, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel);
                done([...pixel]);
            }).observe(canvas);
        })""")
        self.assertEqual(middle[3], 255)  # a cleared picture is transparent and black
        self.assertGreater(sum(middle[:3]), 0)

    def test_the_mesh_fits_in_tall_pictures(self):
        self.addCleanup(self.resize, 900, 600)
        for width, height in ((800, 900), (1000, 700), (300, 900)):
            self.resize(width, height)
            for address in ("theme=light", "theme=light&panel=0"):
                for azimuth in (0, -55):
                    self.open(f"{address}&view={azimuth},25")
                    self.check_fits()
        self.resize(900, 600)
        self.open("theme=light&panel=0")
        self.resize(400, 800)  # of a page that is open
        self.page.settle()
        self.check_fits()

    def resize(self, width, height):
        self.page.call("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=False)

    def check_fits(self):
        """Nothing at the rim of the picture, and something within, without what stands over it."""
        self.page.evaluate("document.getElementById('show').style.display = 'none'")
        self.page.settle()
        width, height = (self.page.evaluate(f"document.getElementById('picture').client{what}") for what in ("Width", "Height"))
        rim = [(3, 3, width - 6, 1), (3, height - 4, width - 6, 1), (3, 3, 1, height - 6), (width - 4, 3, 1, height - 6)]
        for strip in rim:
            self.assertEqual(self.n_colours(*strip), 1, (width, height, strip))
        self.assertGreater(self.n_colours(3, height // 2, width - 6, 1), 10)

    def n_colours(self, x, y, width, height):
        clip = {"x": x, "y": y, "width": width, "height": height, "scale": 1}
        png = base64.b64decode(self.page.call("Page.captureScreenshot", format="png", clip=clip)["data"])
        return len(np.unique(pixels(png)[:, :, :3].reshape(-1, 3), axis=0))

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


FLAT_AND_TURNED = """<?xml version="1.0"?>
<VTKFile type="UnstructuredGrid" version="0.1"><UnstructuredGrid>
<Piece NumberOfPoints="8" NumberOfCells="{n}">
<Points><DataArray type="Float64" NumberOfComponents="3" format="ascii">
{points}</DataArray></Points>
<Cells><DataArray type="Int64" Name="connectivity" format="ascii">{corners}</DataArray>
<DataArray type="Int64" Name="offsets" format="ascii">{offsets}</DataArray>
<DataArray type="UInt8" Name="types" format="ascii">{types}</DataArray></Cells>
<PointData>{point_data}</PointData><CellData>{cell_data}</CellData>
</Piece></UnstructuredGrid></VTKFile>
"""
UNIT_CUBE = "0 0 0  1 0 0  1 1 0  0 1 0  0 0 1  1 0 1  1 1 1  0 1 1"


def grid(points=UNIT_CUBE, corners="0 1 2 3 4 5 6 7", offsets="8", types="12", n=1, point_data="", cell_data=""):
    return FLAT_AND_TURNED.format(points=points, corners=corners, offsets=offsets, types=types, n=n, point_data=point_data,
                                  cell_data=cell_data)


def array(name, values, kind="Float64", components=1):
    name = name.replace("&", "&amp;").replace("<", "&lt;").replace('"', "&quot;")
    return f'<DataArray type="{kind}" Name="{name}" NumberOfComponents="{components}" format="ascii">{values}</DataArray>'


def msh_with_values(binary):
    """A quadrilateral and a cube in Gmsh's format 2, values at nodes and elements, in steps, and vectors."""
    out = b"$MeshFormat\n2.2 %d 8\n" % binary + (struct.pack("<i", 1) + b"\n" if binary else b"") + b"$EndMeshFormat\n"

    def numbers(kinds, *values):
        return struct.pack(f"<{kinds}", *values) if binary else (" ".join(map(repr, values)) + "\n").encode()

    def section(name, head, *rows):
        return f"${name}\n{head}\n".encode() + b"".join(rows) + (b"\n" if binary else b"") + f"$End{name}\n".encode()

    def values(name, title, step, components, rows):
        head = f'1\n"{title}"\n1\n0.5\n3\n{step}\n{components}\n{len(rows)}'
        return section(name, head, *(numbers("i" + "d" * components, *row) for row in rows))

    points = [[float(x) for x in point.split()] for point in UNIT_CUBE.split("  ")]
    out += section("Nodes", 8, *(numbers("iddd", 10 + i, *point) for i, point in enumerate(points)))
    corners = [range(10, 14), range(10, 18)]
    if binary:
        elements = [struct.pack("<3i", kind, 1, 2) + struct.pack(f"<{3 + len(c)}i", number, 0, 1, *c)
                    for number, kind, c in zip((5, 9), (3, 5), corners)]
    else:
        elements = [(f"{number} {kind} 2 0 1 " + " ".join(map(str, c)) + "\n").encode()
                    for number, kind, c in zip((5, 9), (3, 5), corners)]
    out += section("Elements", 2, *elements)
    out += values("ElementData", "stress", 0, 1, [(5, 1.0), (9, 2.0)]) + values("ElementData", "stress", 1, 1, [(5, 5.0), (9, 6.0)])
    out += values("NodeData", 'a "view"', 0, 1, [(10 + i, float(i)) for i in range(8)])
    return out + values("NodeData", "flow", 0, 3, [(10, 1.0, 2.0, 3.0)])


class TestView(Case):
    """Pages of `framehex view`: arrays of the file, bad cells, bad addresses."""

    def view(self, text, address="", name="mesh.vtu"):
        (self.path / name).write_text(text)
        framehex("view", self.path / name, "-o", self.path / "page.html")
        self.page.open(self.path / "page.html", address)

    def colours(self):
        return self.page.evaluate("[...document.getElementById('colour').options].map((x) => x.textContent)")

    def legend(self):
        return [self.text(f"scale-{what}") for what in ("name", "low", "high")]

    def test_every_array_of_one_number_is_kept(self):
        nasty = """</script><b>"quoted" & 'so'"""
        self.view(grid(point_data=array("pressure", "1 2 3 4 5 6 7 8") + array("frame", "0 " * 32, components=4)
                       + array("names", "", kind="String") + array("", "0 0 0 0 0 0 0 9"),
                       cell_data=array(nasty, "-2.5") + array("count", "7", kind="Int32") + array("label", "3", kind="Int32")
                       + array("scaled_jacobian", "0.25")))
        self.assertEqual(self.colours(), ["Kind", "Scaled Jacobian", nasty, "Count", "Pressure", "(no name)"])
        for name, at in [(nasty, "-2.5"), ("count", "7"), ("pressure", "4.5")]:  # by point: the mean over the corners
            self.page.open(self.path / "page.html", "colour=" + urllib.parse.quote(name))
            self.assertEqual(self.legend()[1:], [at, at])
        self.assertEqual(self.page.evaluate("document.querySelectorAll('b').length"), 0)
        self.check_clean()

    def test_arrays_go_with_the_cells_of_the_volume(self):
        self.view(grid(corners="0 1 2 3  0 1 2 3 4 5 6 7", offsets="4 12", types="9 12", n=2, cell_data=array("q", "1 5")),
                  "colour=q")
        self.assertEqual(self.legend(), ["Q", "5", "5"])

    def test_arrays_of_legacy_files(self):
        self.view("# vtk DataFile Version 3.0\n\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 8 double\n" + UNIT_CUBE
                  + "\nCELLS 2 14\n4 0 1 2 3\n8 0 1 2 3 4 5 6 7\nCELL_TYPES 2\n9 12\nCELL_DATA 2\nSCALARS a%20b double 1\n"
                  "LOOKUP_TABLE default\n1 6\nPOINT_DATA 8\nSCALARS heat float\nLOOKUP_TABLE default\n0 0 0 0 1 1 1 1\n",
                  "colour=heat", "mesh.vtk")
        self.assertEqual(self.colours(), ["Kind", "Scaled Jacobian", "A b", "Heat"])
        self.assertEqual(self.legend(), ["Heat", "0.5", "0.5"])
        self.page.open(self.path / "page.html", "colour=a b")
        self.assertEqual(self.legend(), ["A b", "6", "6"])

    def test_values_of_gmsh_files(self):
        for binary in (False, True):
            (self.path / "mesh.msh").write_bytes(msh_with_values(binary))
            framehex("view", self.path / "mesh.msh", "-o", self.path / "page.html")
            self.page.open(self.path / "page.html", "colour=a \"view\"")
            self.assertEqual(self.colours(), ["Kind", "Scaled Jacobian", "Stress", 'A "view"'])
            self.assertEqual(self.legend()[1:], ["3.5", "3.5"])  # of nodes 10 to 17 with values 0 to 7
            self.page.open(self.path / "page.html", "colour=stress")
            self.assertEqual(self.legend()[1:], ["6", "6"])  # of the second step, and not of the quadrilateral

    def test_smoothness_survives_and_has_the_same_ends_everywhere(self):
        framehex("mesh", ROOT / "examples" / "data" / "bunny.stl", "--cells", 300, "-o", self.path / "bunny.vtu")
        framehex("view", self.path / "bunny.vtu", "-o", self.path / "bunny.html")
        self.page.open(self.path / "bunny.html", "colour=smoothness")
        self.assertEqual(self.legend(), ["Smoothness", "0", "1"])
        self.page.open(self.path / "bunny.html", "colour=smoothness&range=0.25,0.75")
        self.assertEqual(self.legend(), ["Smoothness", "0.25", "0.75"])

    def test_only_smoothness_has_the_ends_of_smoothness(self):
        two = dict(corners="0 1 2 3 4 5 6 7  4 5 6 7 0 1 2 3", offsets="8 16", types="12 12", n=2)
        for values, ends in (("3 40", ["3", "40"]), ("-0.5 0.5", ["-0.5", "0.5"]), ("0.25 0.75", ["0", "1"])):
            self.view(grid(**two, cell_data=array("smoothness", values)), "colour=smoothness")
            self.assertEqual(self.legend(), ["Smoothness", *ends])

    def test_arrays_do_not_take_over_the_names_of_the_page(self):
        names = ["kind", "quality", "Scaled_Jacobian", "array-0"]
        self.view(grid(cell_data="".join(array(name, i + 2) for i, name in enumerate(names))), "colour=kind")
        self.assertEqual(self.colours(), ["Kind", "Scaled Jacobian", "Kind (array)", "Quality (array)",
                                          "Scaled Jacobian (array)", "Array-0"])
        for name, chosen in [("kind", "kind"), ("quality", "quality"), ("kind (array)", "array-0"), ("array-0", "array-3"),
                             ("quality (array)", "array-1")]:
            self.page.open(self.path / "page.html", "colour=" + urllib.parse.quote(name))
            self.assertEqual(self.page.evaluate("document.getElementById('colour').value"), chosen)
            self.assertTrue(self.page.evaluate("document.getElementById('remarks').hidden"))

    def test_the_panel_holds_its_tables(self):
        self.view(grid())
        for gutter in (0, 20):  # without and with the room that a scrollbar takes
            self.page.evaluate(f"document.getElementById('panel').style.borderRight = '{gutter}px solid'")
            for total in ("1", "12,345", "12,345,678"):
                self.page.evaluate("for (const what of ['shown', 'total']) for (const of of ['hexahedron', 'prism', 'cells'])"
                                   f"document.getElementById(`${{what}}-${{of}}`).textContent = '{total}'")
                panel = self.page.evaluate("(({scrollWidth, clientWidth}) => [scrollWidth, clientWidth])"
                                           "(document.getElementById('panel'))")
                self.assertLessEqual(*panel, (gutter, total))
                edges = self.page.evaluate("['counts', 'panel'].map((id) => document.getElementById(id)"
                                           ".getBoundingClientRect().right)")
                self.assertLessEqual(edges[0], edges[1] - gutter - 16)

    def test_bad_cells_are_named(self):
        self.view(grid())
        self.assertTrue(self.page.evaluate("document.getElementById('invalid-text').hidden"))
        self.view(grid(UNIT_CUBE.replace(" 1  ", " 0  ").removesuffix("1") + "0"))
        self.assertIn("1 cell is invalid", self.text("invalid-text"))
        self.assertEqual(self.text("volume-hexahedron"), "–")
        widths = self.page.evaluate("[...document.querySelectorAll('#counts .bar')].map((x) => x.getBoundingClientRect().width)")
        self.assertEqual([w > 2 for w in widths], [True] + 7 * [False])  # hexahedra by number alone
        self.view(grid(corners="0 1 2 3 4 5 6 7  4 5 6 7 0 1 2 3", offsets="8 16", types="12 12", n=2))
        self.assertRegex(self.text("invalid-text"), r"1 cell is invalid .*: 1$")

    def test_one_is_no_plural(self):
        self.view(grid())
        self.assertIn("1 cell shown", self.text("shown-text"))
        self.assertIn("6 faces seen", self.text("shown-text"))

    def test_a_plane_through_zero_is_at_zero(self):
        points = [f"{x} {[-0.1, 0.3][y]} {z}" for z in (0, 1) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))]
        self.view(grid("  ".join(points)), "cut=y,0.25")
        self.assertEqual(self.text("at-value"), "y = 0")

    def test_addresses_that_cannot_be_followed(self):
        for address in ("cut=x,nan", "cut=x,", "cut=q,0.5", "cut=toString,0.5", "cut=x,2", "cut=x,0.5,flop", "peel=1e9", "peel=-1",
                        "peel=1.5", "view=1", "view=a,b", "colour=nothing", "colour=toString", "range=0,1", "kut=x,0.5", "theme=blue", "panel=7",
                        "panel=", "lines=yes", "lines=1", "curves=abc", "curves=1", "peel=1,7", "view=10,20,1,5",
                        "cut=x,0.9,flip,flip"):
            self.view(grid(), address)
            self.assertIn(f"{address}: ", self.text("remarks"), address)
            self.assertFalse(self.page.evaluate("document.getElementById('remarks').hidden"), address)
            self.assertIn("1 cell shown", self.text("shown-text"), address)
        self.view(grid(), "cut=x,0.9&cut=y,0.1")
        self.assertIn("cut=y,0.1: ", self.text("remarks"))
        self.assertNotIn("cut=x", self.text("remarks"))
        self.assertEqual(self.page.evaluate("document.getElementById('cut').value"), "x")
        self.view(grid(), "cut=x,0.9&view=30,20&peel=0&colour=quality&range=0,0.5&theme=dark&lines=0&curves=0&panel=1")
        self.assertTrue(self.page.evaluate("document.getElementById('remarks').hidden"))
        self.check_clean()

    def test_coordinates_out_of_range(self):
        (self.path / "far.vtu").write_text(grid(UNIT_CUBE.replace("1", "1e300")))
        done = self.refused("view", self.path / "far.vtu", "-o", self.path / "far.html")
        self.assertIn("vertex 1", done.stderr)
        self.assertFalse((self.path / "far.html").exists())

    def test_what_can_be_read_is_told(self):
        done = self.refused("view", ROOT / "examples" / "data" / "bunny.stl", "-o", self.path / "far.html")
        self.assertIn(".vtu .vtk .msh .mesh .meshb", done.stderr)
        self.assertNotIn(".html,", done.stderr.split("bunny.stl")[1])
        self.assertNotIn(" .html", done.stderr.split("bunny.stl")[1])

    def refused(self, *arguments):
        done = subprocess.run([os.environ["FRAMEHEX"], *map(str, arguments)], capture_output=True, text=True)
        self.assertEqual(done.returncode, 2, done.stderr)
        return done


class LatePage(Page):
    """A browser that is still loading an empty page when it is told to go on; without the browser."""

    def __init__(self):
        self.seconds, self.errors, self.requests, self.loaded, self.n, self.at = 10, [], [], set(), 0, "about:blank"
        self.events, self.to_come, self.settled_at = [], [], None

    def call(self, method, **parameters):
        if method == "Page.navigate":
            self.n += 1
            self.to_come.append((self.n, parameters["url"]))
            return {"loaderId": str(self.n), "frameId": "frame"}
        return {}

    def listen(self, until):
        number, self.at = self.to_come.pop(0)
        self.note("Page.loadEventFired", {"timestamp": 0})
        self.note("Page.lifecycleEvent", {"name": "load", "loaderId": str(number), "frameId": "frame"})

    def evaluate(self, expression):
        return self.at

    def settle(self):
        self.settled_at = self.at


class TestBrowser(unittest.TestCase):
    def test_a_late_load_event_of_another_page_does_not_count(self):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "page.html"
            page = LatePage()
            for address in ("a", "b"):  # for the second, an empty page stands between
                page.open(path, address)
                self.assertEqual(page.settled_at, path.resolve().as_uri() + f"#{address}")


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
