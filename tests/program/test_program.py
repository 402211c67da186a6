#!/usr/bin/env python3
# SPDX-License-Identifier: BSL-1.0
"""Tests of the program `framehex` as users run it; its path is in the environment variable FRAMEHEX."""
import contextlib
import filecmp
import io
import itertools
import json
import os
import pathlib
import resource
import signal
import subprocess
import sys
import tempfile
import time
import unittest

import meshio
import numpy as np
from scipy.spatial import Delaunay

PROGRAM = os.environ["FRAMEHEX"]
BUNNY = pathlib.Path(__file__).resolve().parents[2] / "examples" / "data" / "bunny.stl"

OUTWARD = {
    "tetra": [(0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2)],
    "pyramid": [(0, 3, 2, 1), (0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4)],
    "wedge": [(0, 2, 1), (3, 4, 5), (0, 1, 4, 3), (1, 2, 5, 4), (2, 0, 3, 5)],
    "hexahedron": [(0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)],
}


def box(size=(1, 1, 1), origin=(0, 0, 0)):
    """Vertices and triangles of a box, outward."""
    points = [tuple(o + s * x for o, s, x in zip(origin, size, corner))
              for corner in itertools.product((0, 1), repeat=3)]
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    return points, [t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))]


def subdivided(points, triangles):
    """Each triangle cut into four at the middles of its edges."""
    points, middles, finer = list(points), {}, []

    def middle(a, b):
        edge = (min(a, b), max(a, b))
        if edge not in middles:
            middles[edge] = len(points)
            points.append(tuple((x + y) / 2 for x, y in zip(points[a], points[b])))
        return middles[edge]

    for a, b, c in triangles:
        ab, bc, ca = middle(a, b), middle(b, c), middle(c, a)
        finer += [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]
    return points, finer


def write_stl(path, points, triangles):
    with open(path, "w") as f:
        f.write("solid test\n")
        for t in triangles:
            corners = "".join("vertex %s %s %s\n" % tuple(points[i]) for i in t)
            f.write(f"facet normal 0 0 0\nouter loop\n{corners}endloop\nendfacet\n")
        f.write("endsolid test\n")


def write_vtk(path, points, tets):
    with open(path, "w") as f:
        f.write("# vtk DataFile Version 3.0\ntest\nASCII\nDATASET UNSTRUCTURED_GRID\n")
        f.write(f"POINTS {len(points)} double\n" + "".join("%s %s %s\n" % tuple(p) for p in points))
        f.write(f"CELLS {len(tets)} {5 * len(tets)}\n" + "".join("4 %d %d %d %d\n" % tuple(t) for t in tets))
        f.write(f"CELL_TYPES {len(tets)}\n" + "10\n" * len(tets))


def lattice(n):
    """n^3 cubes, each cut alike into six tetrahedra."""
    def vertex(p):
        return p[0] + (n + 1) * (p[1] + (n + 1) * p[2])
    points = [(i, j, k) for k in range(n + 1) for j in range(n + 1) for i in range(n + 1)]
    tets = []
    for cell in itertools.product(range(n), repeat=3):
        for order in itertools.permutations(range(3)):
            at, tet = list(cell), [vertex(cell)]
            for axis in order:
                at[axis] += 1
                tet.append(vertex(at))
            p = np.array([points[v] for v in tet], float)
            if np.linalg.det(p[1:] - p[0]) < 0:
                tet[2], tet[3] = tet[3], tet[2]
            tets.append(tet)
    return points, tets


def read(path):
    with contextlib.redirect_stdout(io.StringIO()):
        return meshio.read(path)


def audit(path):
    """Counts, least volume, and the faces of a mesh that do not match, from an independent reader."""
    mesh = read(path)
    counts, volumes, faces = {}, [], {}
    for block in mesh.cells:
        if block.type not in OUTWARD:
            continue
        counts[block.type] = counts.get(block.type, 0) + len(block.data)
        for cell in block.data:
            volume = 0.0
            for face in OUTWARD[block.type]:
                ids = [cell[i] for i in face]
                p = mesh.points[ids]
                centre = p.mean(axis=0)
                for i in range(len(p)):
                    volume += np.dot(centre, np.cross(p[i], p[(i + 1) % len(p)])) / 6
                faces[frozenset(ids)] = faces.get(frozenset(ids), 0) + 1
            volumes.append(volume)
    return {"counts": counts, "least_volume": min(volumes), "volume": sum(volumes),
            "used_over_twice": sum(1 for n in faces.values() if n > 2),
            "boundary": [f for f, n in faces.items() if n == 1]}


class Case(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="framehex_test_")
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def path(self, name):
        return str(self.folder / name)

    def run_program(self, *arguments, **options):
        return subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True, timeout=600, **options)

    def check_refused(self, result, *words):
        """Exit status 2, one line that holds the words, and nothing written but the inputs."""
        self.assertEqual(result.returncode, 2, result)
        self.assertEqual(result.stdout, "")
        lines = result.stderr.splitlines()
        remarks = ("were turned", "were welded", "--repair would mend", "--bodies regions would")
        errors = [line for line in lines if not any(words in line for words in remarks)]
        self.assertEqual(len(errors), 1, result.stderr)
        for word in words:
            self.assertIn(word, errors[0])
        left = [p.name for p in self.folder.iterdir() if p.name.startswith("out") or "partial" in p.name]
        self.assertEqual(left, [])

    def mesh(self, surface, *more):
        return self.run_program("mesh", self.path(surface), "-o", self.path("out.vtu"), "--report",
                                self.path("out.json"), *more)


class TestCommandLine(Case):
    def test_help_and_version(self):
        for arguments in (["--help"], ["mesh", "--help"], ["--version"]):
            result = self.run_program(*arguments)
            self.assertEqual(result.returncode, 0)
            self.assertNotEqual(result.stdout, "")

    def test_what_makes_no_sense(self):
        write_stl(self.path("box.stl"), *box())
        surface, out = self.path("box.stl"), self.path("out.vtu")
        for arguments, word in [([], "subcommand"), (["mesh"], "required"), (["mesh", surface], "--output"),
                                (["paint"], "subcommand"),
                                (["mesh", surface, "-o", out, "--field", "wrong"], "wrong"),
                                (["mesh", surface, "-o", out, "--order", "wrong"], "wrong"),
                                (["mesh", surface, "-o", out, "--select", "wrong"], "wrong"),
                                (["mesh", surface, "-o", out, "--interfaces", "wrong"], "wrong"),
                                (["mesh", surface, "-o", out, "--size", "x"], "--size"),
                                (["mesh", surface, "-o", out, "--size", "1", "--cells", "9"], "excludes"),
                                (["mesh", surface, "-o", out, "--cells", "0"], "--cells"),
                                (["mesh", surface, "-o", out, "--floor", "2"], "--floor"),
                                (["mesh", surface, "-o", out, "--floor", "nan"], "--floor"),
                                (["mesh", surface, "-o", out, "--features", "-1"], "--features"),
                                (["mesh", surface, "-o", out, "--budget", "-1"], "--budget"),
                                (["mesh", surface, "-o", out, "--gap", "101"], "--gap"),
                                (["mesh", surface, "-o", out, "--threads", "-1"], "--threads"),
                                (["mesh", surface, "-o", out, "--seed", "-1"], "--seed")]:
            self.check_refused(self.run_program(*arguments), word)


class TestBadSurfaces(Case):
    def test_files(self):
        (self.folder / "empty.stl").write_bytes(b"")
        (self.folder / "text.stl").write_text("hello world\n")
        (self.folder / "none.stl").write_text("solid x\nendsolid x\n")
        (self.folder / "short.stl").write_bytes(BUNNY.read_bytes()[:1000])
        (self.folder / "box.step").write_text("ISO-10303-21;")
        (self.folder / "folder.stl").mkdir()
        for name, word in [("missing.stl", "No such file"), ("empty.stl", "empty"), ("text.stl", "cannot be understood"),
                           ("none.stl", "no triangles"), ("short.stl", "cannot be understood"),
                           ("box.step", "unknown extension"), ("folder.stl", "directory")]:
            with self.subTest(name):
                self.check_refused(self.mesh(name), self.path(name), word)

    def test_a_file_is_named_once(self):
        (self.folder / "nan.msh").write_text("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n4\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 nan 0 1\n"
                                             "$EndNodes\n$Elements\n1\n1 4 2 1 1 1 2 3 4\n$EndElements\n")
        result = self.mesh("nan.msh")
        self.check_refused(result, self.path("nan.msh"), "vertex 3")
        self.assertEqual(result.stderr.count("nan.msh"), 1, result.stderr)

    def test_unreadable(self):
        write_stl(self.path("box.stl"), *box())
        os.chmod(self.path("box.stl"), 0)
        if os.geteuid() == 0:
            self.folder.chmod(0o755)

            def become_nobody():
                os.setgroups([])
                os.setgid(65534)
                os.setuid(65534)
            # Nobody may not write here either: the output goes elsewhere, and never comes to be.
            result = self.run_program("mesh", self.path("box.stl"), "-o", "/tmp/framehex_never.vtu",
                                      preexec_fn=become_nobody)
        else:
            result = self.mesh("box.stl")
        self.check_refused(result, self.path("box.stl"), "Permission denied")

    def test_coordinates(self):
        for bad in ("nan", "inf", "-inf"):
            points, triangles = box()
            points[5] = (points[5][0], bad, points[5][2])
            write_stl(self.path("box.stl"), points, triangles)
            self.check_refused(self.mesh("box.stl"), self.path("box.stl"), "vertex", "not finite")

    def test_topology(self):
        points, triangles = box()
        write_stl(self.path("open.stl"), points, triangles[:-1])
        self.check_refused(self.mesh("open.stl"), self.path("open.stl"), "open along 3 edges", "polygon",
                           "from (")
        other, _ = box(origin=(1, 1, 0))
        both = points + other
        write_stl(self.path("touching.stl"), both, triangles + [tuple(i + 8 for i in t) for t in triangles])
        self.check_refused(self.mesh("touching.stl"), self.path("touching.stl"), "edge", "more than two")
        other, _ = box(origin=(1, 1, 1))
        write_stl(self.path("corner.stl"), points + other, triangles + [tuple(i + 8 for i in t) for t in triangles])
        self.check_refused(self.mesh("corner.stl"), self.path("corner.stl"), "touches itself at a vertex", "at (1, 1, 1)")
        write_stl(self.path("fan.stl"), points + [(2, 2, 2)], triangles + [(0, 1, 8)])
        self.check_refused(self.mesh("fan.stl"), self.path("fan.stl"), "edge")
        write_stl(self.path("flat.stl"), [(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2), (0, 2, 1)])
        self.check_refused(self.mesh("flat.stl", "--size", "0.1"))

    def test_crossing_itself(self):
        points, triangles = box()
        other, _ = box(origin=(0.5, 0.4, 0.3))
        write_stl(self.path("crossing.stl"), points + other, triangles + [tuple(i + 8 for i in t) for t in triangles])
        self.check_refused(self.mesh("crossing.stl", "--size", "0.25"), self.path("crossing.stl"), "overlapping or touching bodies",
                           "polygon 2 and polygon", "near (", "more")

    def test_repair(self):
        points, triangles = box((2, 2, 2))
        write_stl(self.path("twice.stl"), points, triangles + [triangles[5]])
        # The longest edge of one triangle gets a vertex of its own.
        a, b, c = triangles[0]
        middle = tuple((x + y) / 2 for x, y in zip(points[a], points[c]))
        write_stl(self.path("middle.stl"), points + [middle], triangles[1:] + [(a, b, 8), (b, c, 8)])
        noisy = [tuple(x + 2e-5 * np.sin(7 * i + k) for k, x in enumerate(points[v]))
                 for i, v in enumerate(v for t in triangles for v in t)]
        write_stl(self.path("noise.stl"), noisy, [(3 * i, 3 * i + 1, 3 * i + 2) for i in range(12)])
        for name, fault, word in [("twice.stl", "polygon 12 is polygon 5 again", "repeated triangles were dropped: 1"),
                                  ("middle.stl", "open along 3 edges", "split at vertices in their middle: 1"),
                                  ("noise.stl", "open along 36 edges", "were welded")]:
            with self.subTest(name):
                result = self.mesh(name, "--size", "1")
                self.check_refused(result, fault)
                self.assertIn("--repair would mend", result.stderr)
                result = self.mesh(name, "--size", "1", "--repair")
                self.assertEqual(result.returncode, 0, result)
                self.assertIn(word, result.stderr)
                self.assertEqual(audit(self.path("out.vtu"))["counts"], {"hexahedron": 8})
                for out in ("out.vtu", "out.json"):
                    (self.folder / out).unlink()
        result = self.mesh("noise.stl", "--size", "1", "--repair", "1e-9")
        self.check_refused(result, "open along 36 edges")

    def test_narrow_features(self):
        profile = [(0, 0), (1, 0), (1, 1), (0.99, 1), (0.99, 2), (0, 2)]
        n = len(profile)
        points = [(x, y, z) for z in (0, 1) for x, y in profile]
        triangles = [t for i in range(1, n - 1) for t in ((0, i + 1, i), (n, n + i, n + i + 1))]
        for i in range(n):
            j = (i + 1) % n
            triangles += [(i, j, n + j), (i, n + j, n + i)]
        write_stl(self.path("ledge.stl"), points, triangles)
        for least, n_merged in (("0.005", 0), ("0.02", 2)):
            with self.subTest(least):
                result = self.mesh("ledge.stl", "--size", "0.5", "--least-feature", least)
                self.assertEqual(result.returncode, 0, result)
                self.assertEqual("were merged" in result.stderr, n_merged > 0, result.stderr)
                self.assertEqual(json.loads((self.folder / "out.json").read_text())["merged_vertices"], n_merged)
                volume = audit(self.path("out.vtu"))["volume"]
                self.assertAlmostEqual(volume, 1.99, delta=0.0101 if n_merged else 1e-9)
        self.assertEqual(audit(self.path("out.vtu"))["counts"], {"hexahedron": 16})

    def test_the_poorest_cell_is_named(self):
        # A step of a ten-thousandth on one side of a box.
        profile = [(0, 0), (1, 0), (1, 1), (0.9999, 1), (0.9999, 2), (0, 2)]
        n = len(profile)
        points = [(x, y, z) for z in (0, 1) for x, y in profile]
        triangles = [t for i in range(1, n - 1) for t in ((0, i + 1, i), (n, n + i, n + i + 1))]
        triangles += [t for i in range(n) for j in [(i + 1) % n] for t in ((i, j, n + j), (i, n + j, n + i))]
        write_stl(self.path("step.stl"), points, triangles)
        result = self.mesh("step.stl", "--size", "0.5", "--least-feature", "0")
        self.assertEqual(result.returncode, 0, result)
        poor = json.loads((self.folder / "out.json").read_text())["quality"]["poor_cells"]
        poorest = min(poor, key=lambda cell: cell["scaled_jacobian"])
        self.assertIn("{:.2g} near ({:.4g}, {:.4g}, {:.4g})".format(poorest["scaled_jacobian"], *poorest["place"]), result.stderr)

    def test_size(self):
        write_stl(self.path("box.stl"), *box())
        for size in ("0", "-1", "nan", "inf", "1e9", "1e-9", "2"):
            with self.subTest(size):
                self.check_refused(self.mesh("box.stl", "--size", size), "size")

    def test_no_tetgen(self):
        write_stl(self.path("box.stl"), *box())
        result = self.run_program("mesh", self.path("box.stl"), "-o", self.path("out.vtu"), "--size", "0.5",
                                  env={**os.environ, "PATH": str(self.folder)})
        self.check_refused(result, "tetgen", "install")


class TestBadTetMeshes(Case):
    def refused(self, points, tets, *words):
        write_vtk(self.path("tets.vtk"), points, tets)
        for command in ("recombine", "field"):
            result = self.run_program(command, self.path("tets.vtk"), "-o", self.path("out.vtu"), "--report",
                                      self.path("out.json"))
            self.check_refused(result, self.path("tets.vtk"), *words)

    def test_cells(self):
        points, tets = lattice(2)
        turned = [list(t) for t in tets]
        turned[7][2:] = turned[7][:1:-1]
        self.refused(points, turned, "cell 7", "inverted")
        flat = [list(p) for p in points]
        self.refused(flat + [[0.5, 0.5, 0]], tets + [[0, 1, 3, len(flat)]], f"cell {len(tets)}", "no volume")
        self.refused(points, tets + [[0, 1, 2, len(points)]], f"cell {len(tets)}", f"vertex {len(points)}")
        self.refused(points, tets + [[0, 1, 1, 2]], f"cell {len(tets)}", "twice")
        self.refused(points, tets + [tets[3]], "")
        nan = [list(p) for p in points]
        nan[4][1] = "nan"
        self.refused(nan, tets, "vertex 4", "not finite")
        # Beyond these the powers of lengths that qualities are made of leave the numbers.
        far = [list(p) for p in points]
        far[4][1] = 1e60
        self.refused(far, tets, "vertex 4", "1e+60")
        self.refused([[1e-60 * x for x in p] for p in points], tets, "wide")

    def test_lengths_at_the_limits(self):
        points, tets = lattice(2)
        fields = []
        for scale in (1.0, 2.0 ** -98, 2.0 ** 98):
            with self.subTest(scale):
                write_vtk(self.path("tets.vtk"), [[scale * x for x in p] for p in points], tets)
                report = self.path("out.json")
                result = self.run_program("recombine", self.path("tets.vtk"), "-o", self.path("out.vtu"), "--report",
                                          report)
                self.assertEqual(result.returncode, 0, result.stderr)
                self.assertEqual(json.loads(pathlib.Path(report).read_text())["hex_ratio"]["number"], 1)
                result = self.run_program("field", self.path("tets.vtk"), "-o", self.path("out.vtu"), "--report", report)
                self.assertEqual(result.returncode, 0, result.stderr)
                fields.append(json.loads(pathlib.Path(report).read_text())["field"])
                self.assertAlmostEqual(fields[-1]["smoothness_mean"], fields[0]["smoothness_mean"])

    def test_files(self):
        (self.folder / "text.vtu").write_text("hello")
        (self.folder / "text.msh").write_text("hello")
        (self.folder / "empty.mesh").write_text("")
        for name in ("missing.vtk", "text.vtu", "text.msh", "empty.mesh", "mesh.xyz"):
            for command in ("recombine", "field"):
                self.check_refused(self.run_program(command, self.path(name), "-o", self.path("out.vtu")),
                                   self.path(name))
            self.check_refused(self.run_program("inspect", self.path(name), "--report", self.path("out.json")),
                               self.path(name))

    def test_other_cells(self):
        mesh = meshio.Mesh(np.array(lattice(1)[0], float), [("hexahedron", [[0, 1, 3, 2, 4, 5, 7, 6]])])
        mesh.write(self.path("hex.vtu"))
        self.check_refused(self.run_program("recombine", self.path("hex.vtu"), "-o", self.path("out.vtu")),
                           self.path("hex.vtu"), "cell 0 is not a tetrahedron")


class TestBadOutput(Case):
    def setUp(self):
        super().setUp()
        write_vtk(self.path("tets.vtk"), *lattice(2))

    def recombine(self, output, *more, **options):
        return self.run_program("recombine", self.path("tets.vtk"), "-o", output, *more, **options)

    def test_names(self):
        for name, word in [("out.stl", "unknown extension"), ("out.vtk", "not written"), ("none/out.vtu", "No such file")]:
            self.check_refused(self.recombine(self.path(name)), self.path(name), word)
        self.check_refused(self.recombine(self.path("out.vtu"), "--report", self.path("none/out.json")), "out.json")
        self.check_refused(self.recombine(self.path("out.vtu"), "--report", self.path("./out.vtu")), "report", "out.vtu")
        self.check_refused(self.recombine(self.path("out.vtu"), "--report", self.path("tets.vtk")), "report", "input")
        inspected = self.run_program("inspect", self.path("tets.vtk"), "--report", self.path("tets.vtk"))
        self.check_refused(inspected, "report", "input")
        with open("/dev/full", "w") as full:
            inspected = subprocess.run([PROGRAM, "inspect", self.path("tets.vtk")], stdout=full,
                                       stderr=subprocess.PIPE, text=True)
        inspected.stdout = ""
        self.check_refused(inspected, "standard output")
        piped = subprocess.run([PROGRAM, "recombine", self.path("tets.vtk"), "-o", self.path("out.vtu"), "--quiet",
                                "--report", "/dev/stdout"], capture_output=True, text=True)
        self.assertEqual(json.loads(piped.stdout)["counts"]["hexahedra"], 8)
        (self.folder / "out.vtu").unlink()
        self.check_refused(self.run_program("field", self.path("tets.vtk"), "-o", self.path("out.msh")), "out.msh")

    def test_several_ranks(self):
        """Started by mpirun, with MPI or without, the first says that all would write one file; the others say nothing."""
        for name in ("OMPI_COMM_WORLD", "PMI"):
            first, second = (dict(os.environ, **{f"{name}_SIZE": "2", f"{name}_RANK": str(rank)}) for rank in (0, 1))
            self.check_refused(self.recombine(self.path("out.vtu"), env=first), "2 ranks would each write it", "out.pvtu")
            self.check_refused(self.run_program("inspect", self.path("tets.vtk"), env=first), "2 ranks would each do")
            silent = self.recombine(self.path("out.vtu"), env=second)
            self.assertEqual((silent.returncode, silent.stdout, silent.stderr), (0, "", ""))
            self.assertFalse((self.folder / "out.vtu").exists())
            alone = self.recombine(self.path("out.vtu"), env=dict(first, **{f"{name}_SIZE": "1"}))
            self.assertEqual(alone.returncode, 0)
            (self.folder / "out.vtu").unlink()

    def test_no_permission(self):
        self.folder.chmod(0o555)
        os.chmod(self.path("tets.vtk"), 0o444)

        def become_nobody():
            if os.geteuid() == 0:
                os.setgroups([])
                os.setgid(65534)
                os.setuid(65534)
        self.addCleanup(self.folder.chmod, 0o755)
        result = self.recombine(self.path("out.vtu"), preexec_fn=become_nobody)
        self.check_refused(result, self.path("out.vtu"), "Permission denied")

    def test_full_disk(self):
        def small_files():  # stands in for a full disk: writing beyond fails in the same way
            signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
            resource.setrlimit(resource.RLIMIT_FSIZE, (600, 600))
        for extension in ("vtu", "msh", "mesh"):
            result = self.recombine(self.path("out." + extension), preexec_fn=small_files)
            self.check_refused(result, "out." + extension, "cannot be written whole")
        result = self.recombine(self.path("out.mesh"), "--report", self.path("out.json"), preexec_fn=small_files)
        self.check_refused(result, "cannot be written whole")
        self.check_refused(self.recombine(self.path("out.mesh"), "--report", "/dev/full"), "/dev/full", "No space left")


class TestRecombine(Case):
    def test_lattice_becomes_cubes(self):
        write_vtk(self.path("tets.vtk"), *lattice(3))
        for extension in ("vtu", "msh", "mesh"):
            out = self.path("out." + extension)
            result = self.run_program("recombine", self.path("tets.vtk"), "-o", out, "--report", self.path("out.json"))
            self.assertEqual(result.returncode, 0, result)
            found = audit(out)
            self.assertEqual(found["counts"], {"hexahedron": 27})
            self.assertGreater(found["least_volume"], 0)
            self.assertAlmostEqual(found["volume"], 27)
            inspected = self.run_program("inspect", out, "--report", self.path("in.json"))
            self.assertEqual(inspected.returncode, 0, inspected)
            self.assertEqual(json.loads((self.folder / "in.json").read_text())["counts"]["hexahedra"], 27)
        report = json.loads((self.folder / "out.json").read_text())
        self.assertEqual(report["counts"]["hexahedra"], 27)
        self.assertEqual(report["counts"]["cells"], 27)
        self.assertEqual(report["hex_ratio"], {"number": 1.0, "volume": 1.0, "floor": 0.2})
        self.assertAlmostEqual(report["quality"]["least"], 1)
        self.assertEqual(report["candidates"], 453)  # counted by independent programs
        self.assertEqual(report["selection"]["gap_percent"], 0)
        self.assertEqual(report["selection"]["status"], "optimal")
        self.assertEqual(report["conformity"]["open_quads"], 0)
        for key in ("seconds", "peak_memory_bytes", "options", "version"):
            self.assertIn(key, report)

    def test_options(self):
        write_vtk(self.path("tets.vtk"), *lattice(2))
        for more in (["--select", "greedy"], ["--select", "exact"], ["--gap", "5"], ["--budget", "0"], ["--seed", "7"],
                     ["--threads", "2"], ["--interfaces", "open"], ["--interfaces", "no-pyramids"], ["--floor", "0.9"]):
            with self.subTest(more):
                result = self.run_program("recombine", self.path("tets.vtk"), "-o", self.path("out.vtu"), *more)
                self.assertEqual(result.returncode, 0, result)
                self.assertEqual(audit(self.path("out.vtu"))["counts"], {"hexahedron": 8})

    def test_labels_are_carried(self):
        points, tets = lattice(2)
        regions = [0 if sum(points[v][0] for v in t) / 4 < 1 else 3 for t in tets]
        mesh = meshio.Mesh(np.array(points, float), [("tetra", tets)], cell_data={"label": [np.array(regions)]})
        mesh.write(self.path("tets.vtu"))
        result = self.run_program("recombine", self.path("tets.vtu"), "-o", self.path("out.vtu"))
        self.assertEqual(result.returncode, 0, result)
        out = read(self.path("out.vtu"))
        labels = [int(x) for k, block in enumerate(out.cells) if block.type == "hexahedron"
                  for x in np.ravel(out.cell_data["label"][k])]
        self.assertEqual(sorted(labels), [0] * 4 + [3] * 4)


class TestImprovement(Case):
    def test_vertices_of_the_host(self):
        points = np.random.default_rng(7).random((80, 3))
        tets = Delaunay(points).simplices
        edges = points[tets[:, 1:]] - points[tets[:, :1]]
        turned = np.linalg.det(edges) < 0
        tets[turned] = tets[turned][:, [1, 0, 2, 3]]
        write_vtk(self.path("tets.vtk"), [tuple(map(repr, map(float, p))) for p in points], tets)
        given = set(map(tuple, points))
        for more in ([], ["--no-improvement"]):
            result = self.run_program("recombine", self.path("tets.vtk"), "-o", self.path("out.vtu"), "--report",
                                      self.path("out.json"), "--floor", "0.9", *more)
            self.assertEqual(result.returncode, 0, result)
            assembly = json.loads((self.folder / "out.json").read_text())["assembly"]
            written = meshio.read(self.path("out.vtu")).points
            self.assertEqual(len(written) + assembly["removed_vertices"], len(points) + assembly["new_vertices"])
            kept = given <= set(map(tuple, written))
            self.assertEqual(kept, bool(more))


class TestLabels(Case):
    """Regions, patches and their names, from the file to the file."""

    def tets(self):
        points, tets = lattice(2)
        regions = np.array([1 if sum(points[v][0] for v in t) / 4 < 1 else 4 for t in tets])
        return np.array(points, float), np.array(tets), regions

    def recombine(self, name, *more):
        return self.run_program("recombine", self.path(name), "-o", self.path("out.vtu"), "--report",
                                self.path("out.json"), *more)

    def labels(self):
        out = read(self.path("out.vtu"))
        return sorted(int(x) for k, block in enumerate(out.cells) if block.type == "hexahedron"
                      for x in np.ravel(out.cell_data["label"][k]))

    def test_arrays(self):
        points, tets, regions = self.tets()
        for name, form in (("material", "in.vtu"), ("CellEntityIds", "in.vtk"), ("my_part", "in.vtu")):
            with self.subTest(name):
                meshio.Mesh(points, [("tetra", tets)], cell_data={name: [regions]}).write(self.path(form))
                result = self.recombine(form)
                self.assertEqual(result.returncode, 0, result)
                self.assertEqual(self.labels(), [0] * 8 if name == "my_part" else [1] * 4 + [4] * 4)
                self.assertEqual(name == "my_part", "not used: \"my_part\"" in result.stderr, result.stderr)
                self.assertEqual(self.recombine(form, "--regions", name).returncode, 0)
                self.assertEqual(self.labels(), [1] * 4 + [4] * 4)
        os.remove(self.path("out.vtu")), os.remove(self.path("out.json"))
        self.check_refused(self.recombine("in.vtu", "--regions", "other"), self.path("in.vtu"), "other", "my_part")

    def test_names(self):
        points, tets, regions = self.tets()
        with open(self.path("in.msh"), "w") as f:
            f.write("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n2\n3 1 \"steel part\"\n3 4 \"copper\"\n"
                    f"$EndPhysicalNames\n$Nodes\n{len(points)}\n")
            for i, p in enumerate(points):
                f.write(f"{i + 1} {p[0]} {p[1]} {p[2]}\n")
            f.write(f"$EndNodes\n$Elements\n{len(tets)}\n")
            for i, t in enumerate(tets):
                f.write(f"{i + 1} 4 2 {regions[i]} {regions[i]} " + " ".join(str(v + 1) for v in t) + "\n")
            f.write("$EndElements\n")
        result = self.recombine("in.msh")
        self.assertEqual(result.returncode, 0, result)
        groups = json.loads((self.folder / "out.json").read_text())["groups"]
        self.assertEqual([(g["name"], g["labels"], g["elements"]) for g in groups],
                         [("steel part", [0], 4), ("copper", [3], 4)])
        field_data = read(self.path("out.vtu")).field_data
        self.assertEqual(field_data["regions:steel part"].tolist(), [0])
        self.assertEqual(self.run_program("recombine", self.path("in.msh"), "-o", self.path("out.msh")).returncode, 0)
        names = {name: tuple(map(int, value)) for name, value in read(self.path("out.msh")).field_data.items()}
        # Boundary faces without a label get one of their own.
        self.assertEqual(names, {"steel part": (1, 3), "copper": (4, 3), "patch_0": (1, 2)})

    def test_files_that_list_everything(self):
        points, tets, _ = self.tets()
        faces = np.unique(np.sort(np.concatenate([tets[:, [1, 2, 3]], tets[:, [0, 2, 3]], tets[:, [0, 1, 3]],
                                                  tets[:, [0, 1, 2]]]), axis=1), axis=0)
        edges = np.unique(np.sort(np.concatenate([tets[:, list(e)] for e in itertools.combinations(range(4), 2)]),
                                  axis=1), axis=0)
        meshio.Mesh(points, [("line", edges), ("triangle", faces), ("tetra", tets)]).write(self.path("in.mesh"))
        result = self.recombine("in.mesh")
        self.assertEqual(result.returncode, 0, result)
        self.assertIn("lists every face", result.stderr)
        self.assertIn("lists every edge", result.stderr)
        self.assertEqual(audit(self.path("out.vtu"))["counts"], {"hexahedron": 8})
        # Edges that all but one are listed are taken at their word, unless told otherwise.
        meshio.Mesh(points, [("line", edges[1:]), ("tetra", tets)]).write(self.path("in.mesh"))
        self.assertEqual(self.recombine("in.mesh").returncode, 0)
        self.assertNotIn("hexahedron", audit(self.path("out.vtu"))["counts"])
        self.assertEqual(self.recombine("in.mesh", "--ignore-edges").returncode, 0)
        self.assertEqual(audit(self.path("out.vtu"))["counts"], {"hexahedron": 8})

    def test_patches_of_the_surface(self):
        points, triangles = box((2, 1, 1))
        with open(self.path("box.obj"), "w") as f:
            f.write("".join("v %s %s %s\n" % p for p in points + [(1, 0, 1), (1, 1, 1)]))
            f.write("g hot side\nf 1 2 4 3\ng lid a\nf 2 9 10 4\ng lid b\nf 9 6 8 10\ng rest\n")
            f.write("f 5 7 8 6\nf 1 5 6 9 2\nf 3 4 10 8 7\nf 1 3 7 5\n")
        result = self.mesh("box.obj", "--size", "0.5", "--compress")
        self.assertEqual(result.returncode, 0, result)
        groups = json.loads((self.folder / "out.json").read_text())["groups"]
        self.assertEqual([(g["name"], g["elements"]) for g in groups],
                         [("hot side", 4), ("lid a", 4), ("lid b", 4), ("rest", 4 + 8 + 8 + 8)])

    def test_far_from_the_origin(self):
        points, triangles = box((0.7, 0.7, 0.7), (500000.3, 4649776.3, 100))
        with open(self.path("far.obj"), "w") as f:
            f.write("".join("v %.3f %.3f %.3f\n" % p for p in points))
            f.write("".join("f %d %d %d\n" % tuple(v + 1 for v in t) for t in triangles))
        result = self.mesh("far.obj", "--size", "0.35")
        self.assertEqual(result.returncode, 0, result)
        report = json.loads((self.folder / "out.json").read_text())
        self.assertAlmostEqual(report["quality"]["volume"] / 0.343, 1, places=6)
        self.assertEqual(report["counts"]["hexahedra"], 8)
        # Single precision cannot tell such a cube; that is said.
        triangle = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
        body = np.zeros(len(triangles), triangle)
        body["corners"] = np.array([[points[v] for v in t] for t in triangles])
        (self.folder / "far.stl").write_bytes(bytes(80) + np.uint32(len(triangles)).tobytes() + body.tobytes())
        self.assertIn("single precision", self.mesh("far.stl", "--size", "0.35").stderr)


class TestSizes(Case):
    """Sizes that vary, by what the command line says."""

    def edges(self):
        """Lengths and middles of the edges of the hexahedra."""
        out = read(self.path("out.vtu"))
        sides = [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7)]
        hexes = np.concatenate([b.data for b in out.cells if b.type == "hexahedron"])
        ends = out.points[np.concatenate([hexes[:, s] for s in sides])]
        return np.linalg.norm(ends[:, 0] - ends[:, 1], axis=1), ends.mean(axis=1)

    def report(self):
        return json.loads((self.folder / "out.json").read_text())

    def test_lengths_at_the_points_of_tetrahedra_and_of_triangles(self):
        points, triangles = box((4, 2, 2))
        write_stl(self.path("box.stl"), points, triangles)
        where, tets = lattice(4)
        where = np.array(where, float) * (1, 0.5, 0.5)
        faces = np.unique(np.sort(np.concatenate([np.array(tets)[:, list(f)] for f in itertools.combinations(range(4), 3)]),
                                  axis=1), axis=0)

        def wished(x):
            return 0.25 + 0.125 * x

        for name, cells in (("tets.vtu", [("tetra", np.array(tets))]), ("faces.vtu", [("triangle", faces)])):
            with self.subTest(name):
                meshio.Mesh(where, cells, point_data={"h": wished(where[:, 0]), "x": where[:, 0]}).write(self.path(name))
                result = self.mesh("box.stl", "--size-field", self.path(name), "--gradation", "0.5")
                self.assertEqual(result.returncode, 0, result)
                length, middle = self.edges()
                ratio = length / wished(middle[:, 0])
                self.assertGreater(len(ratio), 1000)
                self.assertAlmostEqual(np.median(ratio), 1, delta=0.12)
                self.assertGreater(np.quantile(ratio, 0.03), 0.5)
                self.assertLess(np.quantile(ratio, 0.97), 1.6)
                self.assertEqual(self.report()["sizes"]["wished"], 0.75)
                self.assertEqual(self.report()["sizes"]["size-field"]["array"], "h")
        # The same field, bounded.
        result = self.mesh("box.stl", "--size-field", self.path("tets.vtu"), "--least", "0.5", "--most", "0.5")
        self.assertEqual(result.returncode, 0, result)
        self.assertEqual(audit(self.path("out.vtu"))["counts"], {"hexahedron": 128})
        # A field that does not reach over the body.
        write_stl(self.path("large.stl"), *box((6, 2, 2)))
        self.assertIn("do not reach over", self.mesh("large.stl", "--size-field", self.path("tets.vtu")).stderr)

    def test_patches_curvature_and_walls(self):
        write_stl(self.path("box.stl"), *box((2, 2, 2)))
        result = self.mesh("box.stl", "--size", "0.5", "--size-on", "0=0.1", "--size-on", "patch_1=0.2")
        self.assertEqual(result.returncode, 0, result)
        length, _ = self.edges()
        self.assertLess(length.min(), 0.13)
        self.assertGreater(length.max(), 0.35)

        angles = 2 * np.pi * np.arange(64) / 64
        ring = [(np.cos(a), np.sin(a)) for a in angles]
        points = [(x, y, z) for z in (0, 2) for x, y in ring] + [(0, 0, 0), (0, 0, 2)]
        triangles = []
        for i in range(64):
            j = (i + 1) % 64
            triangles += [(i, j, 64 + j), (i, 64 + j, 64 + i), (128, j, i), (129, 64 + i, 64 + j)]
        write_stl(self.path("round.stl"), points, triangles)
        result = self.mesh("round.stl", "--size", "0.6", "--curvature", "24")
        self.assertEqual(result.returncode, 0, result)
        self.assertAlmostEqual(self.report()["sizes"]["curvature"]["least"], 2 * np.pi / 24, delta=0.01)
        out = read(self.path("out.vtu"))
        rim = [p for p in out.points if abs(np.hypot(p[0], p[1]) - 1) < 0.01 and abs(p[2]) < 1e-9]
        self.assertAlmostEqual(len(rim), 24, delta=2)

        write_stl(self.path("plate.stl"), *box((2, 2, 0.3)))
        result = self.mesh("plate.stl", "--size", "0.3", "--cells-across", "3")
        self.assertEqual(result.returncode, 0, result)
        self.assertAlmostEqual(self.report()["sizes"]["cells-across"]["least"], 0.1)
        heights = read(self.path("out.vtu")).points[:, 2] / 0.1
        layers = np.round(heights).astype(int)
        self.assertGreater((np.abs(heights - layers) < 0.2).mean(), 0.9)
        self.assertGreater(np.bincount(layers, minlength=4).min(), len(layers) / 8)
        # Thinner than any cell may be.
        write_stl(self.path("foil.stl"), *box((2, 2, 0.02)))
        result = self.mesh("foil.stl", "--size", "0.3", "--cells-across", "3", "--least", "0.1")
        self.assertEqual(result.returncode, 0, result)
        self.assertIn("--cells-across asks for sizes down to 0.006667", result.stderr)

    def test_what_makes_no_sense(self):
        write_stl(self.path("box.stl"), *box())
        where, tets = lattice(1)
        for name, data in (("none.vtu", {}), ("two.vtu", {"a": [1.0] * 8, "b": [1.0] * 8}),
                           ("negative.vtu", {"h": [1.0] * 7 + [-1.0]})):
            meshio.Mesh(np.array(where, float), [("tetra", np.array(tets))],
                        point_data={k: np.array(v) for k, v in data.items()}).write(self.path(name))
        size = ("--size", "0.5")
        for arguments, words in (((*size, "--size-on", "lid=0.1"), ["no patch \"lid\"", "it has 6"]),
                                 ((*size, "--size-on", "7=0.1"), ["no patch \"7\""]),
                                 ((*size, "--size-on", "lid"), ["PATCH=H"]),
                                 ((*size, "--size-on", "lid=-1"), ["PATCH=H"]),
                                 ((*size, "--least", "0.6"), ["--least"]),
                                 ((*size, "--curvature", "2"), ["3"]),
                                 ((*size, "--size-array", "h"), ["--size-field"]),
                                 ((*size, "--size-field", "negative.vtu"), ["excludes"]),
                                 (("--size-field", self.path("absent.vtu")), ["absent.vtu"]),
                                 (("--size-field", self.path("none.vtu")), ["none.vtu", "has none"]),
                                 (("--size-field", self.path("two.vtu")), ["two.vtu", "a, b"]),
                                 (("--size-field", self.path("two.vtu"), "--size-array", "c"), ["\"c\"", "a, b"]),
                                 (("--size-field", self.path("negative.vtu")), ["negative.vtu", "point 7"])):
            with self.subTest(arguments):
                self.check_refused(self.mesh("box.stl", *arguments), *words)


class TestMemory(Case):
    def test_refused_before_any_work(self):
        write_stl(self.path("box.stl"), *box())
        # 10^6 points, 17 kB each.
        self.check_refused(self.mesh("box.stl", "--size", "0.01", "--memory", "2GB"), "1.8e+04 MB", "1.06e+06 points")
        self.check_refused(self.mesh("box.stl", "--size", "0.1", "--memory", "2"), "--memory")
        self.check_refused(self.mesh("box.stl", "--size", "0.1", "--memory", "two"), "--memory")
        result = self.mesh("box.stl", "--size", "0.1", "--memory", "500MB")
        self.assertEqual(result.returncode, 0, result)


class TestBodies(Case):
    """Bodies that lie in each other, or touch."""

    def test_a_body_within_another_is_a_void_or_a_region(self):
        outer, triangles = box((3, 3, 3))
        inner = box((1, 1, 1), (1, 1, 1))[0]
        write_stl(self.path("nested.stl"), outer + inner, triangles + [tuple(i + 8 for i in t) for t in triangles])
        for bodies, volumes in (("void", [26]), ("regions", [26, 1])):
            with self.subTest(bodies):
                result = self.mesh("nested.stl", "--size", "0.5", "--bodies", bodies)
                self.assertEqual(result.returncode, 0, result)
                self.assertEqual("--bodies regions" in result.stderr, bodies == "void")
                self.check_regions(volumes)

    def test_bodies_that_touch_share_what_is_between_them(self):
        points, triangles = box()
        second = box((1, 1, 1), (1, 0, 0))[0]
        mirrored = [tuple((i ^ 1) + 8 for i in t)[::-1] for t in triangles]  # cuts the face between along the other diagonal
        for other, fault in (([tuple(i + 8 for i in t)[::-1] for t in triangles], "stand"), (mirrored, "4 edges")):
            write_stl(self.path("two.stl"), points + second, triangles + other)
            result = self.mesh("two.stl", "--size", "0.5")
            self.check_refused(result, fault)
            self.assertIn("--bodies regions would make a region of each body", result.stderr)
            result = self.mesh("two.stl", "--size", "0.5", "--bodies", "regions")
            self.assertEqual(result.returncode, 0, result)
            self.assertIn("2 triangles in which bodies touch", result.stderr)
            self.check_regions([1, 1])
            found = audit(self.path("out.vtu"))
            self.assertEqual(found["counts"], {"hexahedron": 16})
            self.assertEqual(len(found["boundary"]), 40)
            os.remove(self.path("out.vtu")), os.remove(self.path("out.json"))

    def test_boxes_that_touch_in_an_edge_are_meshed_at_every_size(self):
        points, triangles = box()
        write_stl(self.path("two.stl"), points + box(origin=(1, 1, 0))[0], triangles + [tuple(i + 8 for i in t) for t in triangles])
        for n in (10, 60, 100, 130, 200):
            with self.subTest(n):
                result = self.mesh("two.stl", "--cells", str(n), "--bodies", "regions")
                self.assertEqual(result.returncode, 0, result)
                self.check_regions([1, 1])
                os.remove(self.path("out.vtu")), os.remove(self.path("out.json"))

    def test_repair_makes_regions_of_bodies_that_touch(self):
        points, triangles = box()
        again = [tuple(i + 8 for i in t) for t in triangles]
        a, b, c = triangles[0]
        middle = tuple((x + y) / 2 for x, y in zip(points[a], points[c]))
        for name, at in (("an edge", (1, 1, 0)), ("a vertex", (1, 1, 1)), ("a face", (1, 0, 0))):
            for bodies in ([], ["--bodies", "regions"]):
                become_one = name == "a face" and not bodies
                with self.subTest(name, bodies=bodies):
                    write_stl(self.path("two.stl"), points + box(origin=at)[0] + [middle], triangles[1:] + again + [(a, b, 16), (b, c, 16)])
                    self.check_refused(self.mesh("two.stl", "--size", "0.5"), "two.stl")
                    result = self.mesh("two.stl", "--size", "0.5", "--repair", *bodies)
                    self.assertEqual(result.returncode, 0, result)
                    self.assertIn("edges were split", result.stderr)
                    self.assertEqual("each is a region" in result.stderr, not bodies and not become_one, result.stderr)
                    self.check_regions([2] if become_one else [1, 1])
                    os.remove(self.path("out.vtu")), os.remove(self.path("out.json"))

    def check_regions(self, volumes):
        out = read(self.path("out.vtu"))
        found = {}
        for k, block in enumerate(out.cells):
            for cell, label in zip(block.data, np.ravel(out.cell_data["label"][k])):
                if block.type not in OUTWARD:
                    continue
                for face in OUTWARD[block.type]:
                    p = out.points[[cell[i] for i in face]]
                    for i in range(len(p)):
                        found[label] = found.get(label, 0) + np.dot(p.mean(axis=0), np.cross(p[i], p[(i + 1) % len(p)])) / 6
        np.testing.assert_allclose([found[k] for k in sorted(found)], volumes, rtol=1e-9)
        self.assertEqual(json.loads((self.folder / "out.json").read_text())["regions"], len(volumes))


class TestSurfaceMeshes(Case):
    def test_labels_of_a_vtu_are_patches(self):
        points, triangles = box((2, 1, 1))
        labels = [0 if all(points[v][0] == 0 for v in t) else 2 for t in triangles]
        meshio.Mesh(np.array(points, float), [("triangle", np.array(triangles))],
                    cell_data={"patch": [np.array(labels)], "other": [np.arange(12)]}).write(self.path("box.vtu"))
        result = self.mesh("box.vtu", "--size", "0.5")
        self.assertEqual(result.returncode, 0, result)
        self.assertIn("patches are those of \"patch\"", result.stderr)
        groups = json.loads((self.folder / "out.json").read_text())["groups"]
        self.assertEqual(sorted((g["name"], g["elements"]) for g in groups), [("patch_0", 4), ("patch_2", 36)])
        result = self.mesh("box.vtu", "--size", "0.5", "--patches", "other")
        self.assertEqual(result.returncode, 0, result)
        self.assertEqual(len(json.loads((self.folder / "out.json").read_text())["groups"]), 12)
        # What the program writes of a volume has named patches, which it reads again.
        os.remove(self.path("out.json"))
        with open(self.path("named.msh"), "w") as f:
            f.write("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n2 1 \"hot end\"\n$EndPhysicalNames\n")
            f.write("$Nodes\n8\n" + "".join(f"{i + 1} %s %s %s\n" % p for i, p in enumerate(points)))
            f.write("$EndNodes\n$Elements\n12\n" + "".join(
                f"{i + 1} 2 2 {l + 1} {l + 1} " + " ".join(str(v + 1) for v in t) + "\n"
                for i, (t, l) in enumerate(zip(triangles, labels))) + "$EndElements\n")
        result = self.mesh("named.msh", "--size", "0.5")
        self.assertEqual(result.returncode, 0, result)
        self.assertIn("hot end", [g["name"] for g in json.loads((self.folder / "out.json").read_text())["groups"]])


class TestQuadratic(Case):
    """A node on each edge, on the surface where that leaves cells valid."""

    # meshio 5.0 reads these, but does not know their dimension.
    meshio._mesh.topological_dimension.update({"wedge15": 3, "pyramid13": 3})
    NODES = {"tetra10": 10, "pyramid13": 13, "wedge15": 15, "hexahedron20": 20}

    def test_nodes_on_the_surface_in_all_formats(self):
        angles = 2 * np.pi * np.arange(96) / 96
        points = [(np.cos(a), np.sin(a), z) for z in (0, 1) for a in angles] + [(0, 0, 0), (0, 0, 1)]
        triangles = []
        for i in range(96):
            j = (i + 1) % 96
            triangles += [(i, j, 96 + j), (i, 96 + j, 96 + i), (192, j, i), (193, 96 + i, 96 + j)]
        write_stl(self.path("round.stl"), points, triangles)
        counts = None
        for out, more in (("q.vtu", ()), ("q.msh", ()), ("q22.msh", ("--msh", "2.2")), ("q.inp", ("--pyramids", "bricks"))):
            with self.subTest(out):
                result = self.run_program("mesh", self.path("round.stl"), "-o", self.path(out), "--size", "0.3",
                                          "--quadratic", "--report", self.path("q.json"), *more)
                self.assertEqual(result.returncode, 0, result)
                mesh = read(self.path(out))
                found = {}
                for block in mesh.cells:
                    found[block.type] = found.get(block.type, 0) + len(block.data)
                    self.assertTrue(block.type in self.NODES or block.type in ("triangle6", "quad8", "line3"), block.type)
                self.judge_volume(mesh)
                cells = {k: n for k, n in found.items() if k in self.NODES}
                if out.endswith("inp"):  # pyramids are bricks
                    cells = {k: n for k, n in cells.items() if k in ("tetra10", "wedge15")}
                    self.assertEqual(cells, {k: n for k, n in counts.items() if k in ("tetra10", "wedge15")})
                    continue
                counts = counts or cells
                self.assertEqual(cells, counts)
        told = json.loads((self.folder / "q.json").read_text())["quadratic"]
        self.assertGreater(told["curved"], 50)
        self.assertLess(told["straightened"], 0.05 * told["curved"])

    def judge_volume(self, mesh):
        """Six-node triangles and eight-node quadrilaterals of the boundary enclose a body much rounder than the plain ones."""
        faces = {"triangle6": [(0, 3, 1, 4, 2, 5)], "quad8": [(0, 4, 1, 5, 2, 6, 3, 7)]}
        volume, n = 0.0, 0
        for block in mesh.cells:
            for face in block.data if block.type in faces else []:
                p = mesh.points[[face[i] for i in faces[block.type][0]]]
                n += 1
                on_side = np.abs(np.hypot(p[:, 0], p[:, 1]) - 1) < 1e-3
                if on_side.all():  # between corners, too
                    self.assertLess(np.abs(np.hypot(p[:, 0], p[:, 1]) - np.cos(np.pi / 96)).min(), 2e-3)
                # What the shape functions make of the middle.
                corner, middle = (-1 / 9, 4 / 9) if len(p) == 6 else (-1 / 4, 1 / 2)
                centre = corner * p[0::2].sum(axis=0) + middle * p[1::2].sum(axis=0)
                for i in range(len(p)):
                    volume += np.dot(centre, np.cross(p[i], p[(i + 1) % len(p)])) / 6
        if n > 0:
            # Plain cells of size 0.3 leave out 2.5 % of the disc.
            self.assertAlmostEqual(abs(volume) / np.pi, 1, delta=0.01)

    def test_formats_that_hold_none_are_refused(self):
        write_stl(self.path("box.stl"), *box())
        for name in ("out.mesh", "out.html"):
            result = self.run_program("mesh", self.path("box.stl"), "-o", self.path(name), "--size", "0.5", "--quadratic")
            self.check_refused(result, "quadratic", ".vtu, .msh and .inp")


class TestField(Case):
    def test_box(self):
        write_vtk(self.path("tets.vtk"), *lattice(3))
        for method in ("nearest", "smoothed", "best"):
            result = self.run_program("field", self.path("tets.vtk"), "-o", self.path("out.vtu"), "--field", method,
                                      "--report", self.path("out.json"))
            self.assertEqual(result.returncode, 0, result)
            report = json.loads((self.folder / "out.json").read_text())
            self.assertAlmostEqual(report["field"]["smoothness_mean"], 1, places=3)
            self.assertEqual(report["field"]["singular_edges"], 0)
            out = read(self.path("out.vtu"))
            self.assertEqual(out.point_data["frame"].shape, (64, 4))
            np.testing.assert_allclose(np.linalg.norm(out.point_data["frame"], axis=1), 1, atol=1e-12)
            # The axes are those of the box, in some order.
            np.testing.assert_allclose(np.abs(out.point_data["frame_x"]).max(axis=1), 1, atol=1e-6)


class TestCampaign(Case):
    CAMPAIGN = pathlib.Path(__file__).resolve().parents[2] / "benchmarks" / "campaign.py"

    def campaign(self, *surfaces):
        return subprocess.run([sys.executable, self.CAMPAIGN, "--program", PROGRAM, "--results", self.path("results"), "--cells",
                               "60", "300", "--limit", "120", "--as-given", *surfaces], capture_output=True, text=True)

    def test_surfaces_are_meshed_once_and_judged(self):
        write_stl(self.path("box.stl"), *box((2, 1, 1)))
        write_stl(self.path("thin.stl"), *box((2, 1, 0.001)))
        points, triangles = box()
        write_stl(self.path("open.stl"), points, triangles[1:])
        write_stl(self.path("wedge.stl"), [(0, 0, 0), (1, 0, 0), (1, 0.03, 0), (0, 0, 1), (1, 0, 1), (1, 0.03, 1)],
                  [(0, 2, 1), (3, 4, 5), (0, 1, 4), (0, 4, 3), (1, 2, 5), (1, 5, 4), (2, 0, 3), (2, 3, 5)])
        names = [self.path(n) for n in ("box.stl", "thin.stl", "open.stl", "wedge.stl")]
        first = self.campaign(*names)
        self.assertEqual(first.returncode, 0, first.stdout)
        for size in (60, 300):
            self.assertIn(f"{size} cells, 4 surfaces: 1 listed, 2 ok, 1 refused", first.stdout)
        start = time.monotonic()
        again = self.campaign(*names)
        self.assertEqual(again.stdout, first.stdout)
        self.assertLess(time.monotonic() - start, 10)  # reads what is there

    def test_a_wrong_result_is_told(self):
        write_stl(self.path("box.stl"), *box())
        (self.folder / "results").mkdir()
        told = {"surface": "box.stl", "asked": 60, "status": 0, "message": "", "seconds": 1, "cells": 1, "hexahedra": 1,
                "hexahedra_volume": 1, "least": 1, "faults": 1, "unexplained": 0, "size_limits": 0}
        (self.folder / "results" / "box.stl-60.json").write_text(json.dumps(told))
        result = self.campaign(self.path("box.stl"))
        self.assertEqual(result.returncode, 1)
        self.assertIn("60 cells, 1 surfaces: 1 INVALID", result.stdout)
        self.assertIn("300 cells, 1 surfaces: 1 ok", result.stdout)


class TestInspect(Case):
    def test_faults_are_counted(self):
        points = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1), (0.5, 0.5, 2)]
        cells = [("hexahedron", [[0, 1, 2, 3, 4, 5, 6, 7]]), ("tetra", [[4, 5, 6, 8], [4, 6, 7, 8]])]
        meshio.Mesh(np.array(points, float), cells).write(self.path("open.vtu"))
        result = self.run_program("inspect", self.path("open.vtu"), "--report", self.path("open.json"))
        self.assertEqual(result.returncode, 0, result)
        report = json.loads((self.folder / "open.json").read_text())
        self.assertEqual(report["conformity"]["open_quads"], 1)
        self.assertEqual(report["counts"],
                         {"vertices": 9, "cells": 3, "tetrahedra": 2, "pyramids": 0, "prisms": 0, "hexahedra": 1})
        self.assertAlmostEqual(report["hex_ratio"]["number"], 1 / 3)
        self.assertAlmostEqual(report["hex_ratio"]["volume"], 3 / 4)
        self.assertIn("face two triangles: 1", result.stdout)

    def test_inverted_cells_are_named(self):
        points, tets = lattice(1)
        tets[2][2:] = tets[2][:1:-1]
        write_vtk(self.path("tets.vtk"), points, tets)
        result = self.run_program("inspect", self.path("tets.vtk"), "--report", self.path("in.json"))
        self.assertEqual(result.returncode, 0, result)
        quality = json.loads((self.folder / "in.json").read_text())["quality"]
        self.assertEqual(quality["inverted_cells"], [2])
        self.assertEqual(quality["invalid_cells"], [2])

    def test_quiet(self):
        write_vtk(self.path("tets.vtk"), *lattice(1))
        self.assertEqual(self.run_program("inspect", self.path("tets.vtk"), "--quiet").stdout, "")


class TestQuadrilaterals(Case):
    SQUARE = "0 0\n2 0\n2 1\n0 1\n"

    def outline(self, text, name="loops.txt"):
        (self.folder / name).write_text(text)
        return self.path(name)

    def plane(self, outline, *more):
        return self.run_program("plane", outline, "-o", self.path("out.vtu"), "--report", self.path("out.json"),
                                "--size", 0.125, *more)

    def test_a_rectangle_becomes_the_grid_in_all_formats(self):
        outline = self.outline(self.SQUARE)
        for name in ("out.vtu", "out.msh", "out.mesh", "out.inp"):
            with self.subTest(name=name):
                result = self.run_program("plane", outline, "-o", self.path(name), "--size", 0.125)
                self.assertEqual(result.returncode, 0, result)
                self.assertIn("128 quadrilaterals, 0 triangles", result.stdout)
                mesh = meshio.read(self.path(name))
                cells = {block.type: len(block.data) for block in mesh.cells if block.type != "line"}
                self.assertEqual(cells, {"quad": 128})
                self.assertEqual(len(mesh.points), 17 * 9)

    def test_holes_and_crosses(self):
        angle = 2 * np.pi * np.arange(64) / 64
        hole = "".join(f"{x} {y}\n" for x, y in zip(1 + 0.3 * np.cos(angle), 0.5 + 0.3 * np.sin(angle)))
        result = self.plane(self.outline(self.SQUARE + "\n# a hole\n" + hole), "--crosses", self.path("crosses.vtu"))
        self.assertEqual(result.returncode, 0, result)
        report = json.loads((self.folder / "out.json").read_text())
        self.assertEqual(report["quad_ratio"], {"number": 1.0, "area": 1.0})
        self.assertEqual(report["quality"]["euler_characteristic"], 0)
        self.assertEqual(report["quality"]["index_sum"], 0)
        self.assertEqual(report["quality"]["folded_cells"], [])
        self.assertGreater(report["quality"]["scaled_jacobian_min"], 0.3)
        crosses = meshio.read(self.path("crosses.vtu"))
        self.assertIn("smoothness", crosses.point_data)
        self.assertIn("frame", crosses.cell_data)

    def test_lines_of_files(self):
        points = [(0, 0, 0), (2, 0, 0), (2, 1, 0), (0, 1, 0)]
        lines = [(0, 1), (1, 2), (2, 3), (3, 0)]
        obj = "".join("v %g %g %g\n" % p for p in points) + "l 1 2 3 4 1\n"
        vtk = "# vtk DataFile Version 3.0\ntest\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 4 double\n"
        vtk += "".join("%g %g %g\n" % p for p in points) + "CELLS 4 12\n" + "".join("2 %d %d\n" % e for e in lines)
        self.outline(vtk + "CELL_TYPES 4\n3\n3\n3\n3\n", "a.vtk")
        self.outline(obj, "a.obj")
        meshio.write_points_cells(self.path("a.vtu"), np.array(points, float), [("line", np.array(lines))])
        meshio.write_points_cells(self.path("a.msh"), np.array(points, float), [("line", np.array(lines))],
                                  file_format="gmsh22")
        poly = vtk[:vtk.index("CELLS")].replace("UNSTRUCTURED_GRID", "POLYDATA") + "LINES 1 6\n5 0 1 2 3 0\n"
        self.outline(poly, "poly.vtk")
        for name in ("a.vtk", "a.obj", "a.vtu", "a.msh", "poly.vtk"):
            with self.subTest(name=name):
                result = self.plane(self.path(name), "--quiet")
                self.assertEqual(result.returncode, 0, result)
                self.assertEqual(json.loads((self.folder / "out.json").read_text())["counts"]["quadrilaterals"], 128)

    def test_an_interval_more_is_reported(self):
        result = self.run_program("plane", self.outline("0 0\n3 0\n1.2 2.4\n"), "-o", self.path("out.vtu"), "--size", 0.5)
        self.assertEqual(result.returncode, 0, result)
        self.assertRegex(result.stderr, r"loop 0, from \([^)]+\) to \([^)]+\), has one interval more")

    def test_how_far_the_mesh_is_from_its_outline_is_told(self):
        angle = 2 * np.pi * np.arange(200) / 200
        outline = self.outline("".join(f"{np.cos(a)} {np.sin(a)}\n" for a in angle))
        result = self.run_program("plane", outline, "-o", self.path("out.vtu"), "--size", 3, "--report", self.path("r.json"))
        self.assertEqual(result.returncode, 0, result)
        self.assertNotIn("away from", result.stderr)
        report = json.loads((self.folder / "r.json").read_text())
        self.assertLess(report["deviation"], 0.01)
        self.assertGreater(report["deviation"], 0.001)
        self.assertGreater(report["points"]["shrunk"], 0)

    def test_an_empty_size_is_refused_with_words(self):
        for word in ("--size=", "--size= "):
            result = self.run_program("plane", self.outline(self.SQUARE), "-o", self.path("out.vtu"), word)
            self.assertEqual(result.returncode, 2, result)
            self.assertRegex(result.stderr, r"--size: (1 required H|\S.* is not a positive number)")
        result = self.run_program("plane", self.outline(self.SQUARE), "-o", self.path("out.vtu"), "--size", "")
        self.assertIn("--size: nothing is not a positive number", result.stderr)

    def test_greedy_leaves_triangles(self):
        result = self.plane(self.outline("0 0\n3 0\n1.2 2.4\n"), "--match", "greedy", "--quiet")
        self.assertEqual(result.returncode, 0, result)
        self.assertGreater(json.loads((self.folder / "out.json").read_text())["counts"]["triangles"], 0)

    def test_without_improvement_there_is_a_mesh_all_the_same(self):
        angle = 2 * np.pi * np.arange(64) / 64
        result = self.plane(self.outline("".join(f"{np.cos(a)} {np.sin(a)}\n" for a in angle)), "--no-improvement", "--quiet")
        self.assertEqual(result.returncode, 0, result)
        report = json.loads((self.folder / "out.json").read_text())
        self.assertEqual(report["quality"]["folded_cells"], [])
        self.assertEqual(report["counts"]["triangles"], 0)

    def test_a_thin_wedge(self):
        result = self.plane(self.outline("0 0\n4 0\n4 0.05\n"), "--quiet")
        self.assertEqual(result.returncode, 0, result)
        report = json.loads((self.folder / "out.json").read_text())
        self.assertEqual(report["quality"]["folded_cells"], [])
        self.assertGreater(report["points"]["widened"], 0)
        self.assertGreater(report["quality"]["scaled_jacobian_min"], 0.01)  # the sine of the angle is 0.0125

    def test_a_wedge_too_sharp_for_quadrilaterals_keeps_triangles_and_says_so(self):
        for more in ((), ("--no-improvement",)):
            with self.subTest(more=more):
                result = self.plane(self.outline("0 0\n2 -1e-4\n2 -1\n4 -1\n4 1\n2 1\n2 1e-4\n"), *more)
                self.assertEqual(result.returncode, 0, result)
                report = json.loads((self.folder / "out.json").read_text())
                n_left = report["counts"]["triangles"]
                self.assertGreater(n_left, 0)
                self.assertEqual(report["points"]["left_triangles"], n_left)
                self.assertIn(f"{n_left} triangles are left", result.stderr)
                self.assertIn(f"{n_left} triangles are left", report["warnings"][0])
                self.assertEqual(report["quality"]["folded_cells"], [])
                found = meshio.read(self.folder / "out.vtu").cells_dict
                self.assertEqual((len(found["quad"]), len(found["triangle"])), (report["counts"]["quadrilaterals"], n_left))

    def test_faces_alone_are_inspected_and_not_shown(self):
        made = self.run_program("plane", self.outline(self.SQUARE), "-o", self.path("quads.vtu"), "--report",
                                self.path("told.json"), "--size", 0.125, "--quiet")
        self.assertEqual(made.returncode, 0, made)
        result = self.run_program("inspect", self.path("quads.vtu"), "--report", self.path("in.json"))
        self.assertEqual(result.returncode, 0, result)
        self.assertIn("128 quadrilaterals, 0 triangles", result.stdout)
        told, found = (json.loads((self.folder / name).read_text()) for name in ("told.json", "in.json"))
        for part in ("counts", "quad_ratio", "quality"):
            self.assertEqual(told[part], found[part])
        self.check_refused(self.run_program("view", self.path("quads.vtu"), "-o", self.path("out.html")), "quads.vtu",
                           "holds no tetrahedron, pyramid, prism or hexahedron")
        # Three corners of a cell at one side of the fourth: folded, and said so.
        points = np.array([(0, 0, 0), (2, 0, 0), (0, 2, 0), (0.2, 0.2, 0)], float)
        meshio.write_points_cells(self.path("bent.vtu"), points, [("quad", np.array([[0, 1, 3, 2]]))])
        self.assertIn("folded cells: 1", self.run_program("inspect", self.path("bent.vtu")).stdout)
        meshio.write_points_cells(self.path("line.vtu"), points, [("line", np.array([[0, 1]]))])
        self.check_refused(self.run_program("inspect", self.path("line.vtu")), "line.vtu", "neither cells nor faces")

    def test_loops_either_way_and_beside_each_other(self):
        beside = "".join(f"{x + 5} {y}\n" for x, y in ((0, 0), (2, 0), (2, 1), (0, 1)))
        backwards = "0 1\n2 1\n2 0\n0 0\n"
        for text, n in ((backwards, 128), (self.SQUARE + "\n" + beside, 256), (self.SQUARE + "0 0\n", 128)):
            with self.subTest(text=text):
                result = self.plane(self.outline(text), "--quiet")
                self.assertEqual(result.returncode, 0, result)
                self.assertEqual(json.loads((self.folder / "out.json").read_text())["counts"]["quadrilaterals"], n)

    def test_bad_outlines(self):
        for text, words in (("0 0\n1 1\n1 0\n0 1\n", ("segment (2, 3) of loop 0 and segment (0, 1) of loop 0 cross",)),
                            ("0 0\n1 0\n1 zero\n", ("line 3", "a coordinate")),
                            ("0 0\n1 nan\n1 1\n", ("vertex 1", "not finite")),
                            ("\n# nothing\n", ("holds no line",)),
                            ("0 0\n1 0\n1 1\n\ninner\n2 2\n3 3\n", ("polyline 1 lies outside",)),
                            ("inner\n0 0\n1 1\n", ("no loop",)),
                            ("0 0\n4 0\n4 4\n0 4\n\n1 0\n2 1\n1 1\n", ("vertex 4 of loop 1 lies on segment (0, 1) of loop 0",))):
            with self.subTest(text=text):
                self.check_refused(self.plane(self.outline(text)), "loops.txt", *words)
        obj = self.outline("v 0 0 0\nv 1 0 0\nv 1 1 0\nl 1 2 3\n", "open.obj")
        self.check_refused(self.plane(obj), "loop 0 is open")
        self.check_refused(self.run_program("plane", self.outline(self.SQUARE), "-o", self.path("polyMesh"), "--size", 1),
                           "for meshes of a volume")

    def test_features_tell_which_bends_of_an_outline_are_corners(self):
        angle = 2 * np.pi * np.arange(12) / 12
        corners = np.c_[np.cos(angle), np.sin(angle), 0 * angle]
        outline = self.outline("".join("%.17g %.17g\n" % (x, y) for x, y, _ in corners))
        for features, n_kept in (((), 12), (("--features", "1"), 12), (("--features", "150"), 0)):
            with self.subTest(features=features):
                result = self.plane(outline, "--quiet", *features)
                self.assertEqual(result.returncode, 0, result)
                points = meshio.read(self.folder / "out.vtu").points
                self.assertEqual(sum(min(np.linalg.norm(points - c, axis=1)) < 1e-12 for c in corners), n_kept)

    def test_outlines_too_near_to_themselves_are_refused_at_once(self):
        for distance in ("1e-9", "1e-11", "1e-14"):
            with self.subTest(distance=distance):
                begin = time.monotonic()
                self.check_refused(self.plane(self.outline(f"0 0\n1 0\n{1 + float(distance)!r} 0\n1 1\n0 1\n")), "loops.txt",
                                   "vertex 1 of loop 0", "vertex 2 of loop 0", "apart")
                self.check_refused(self.plane(self.outline(f"0 0\n5 0\n10 0\n7 {distance}\n2 {distance}\n")),
                                   "loop 0", "apart", "1e-08 of the outline's diagonal")
                self.assertLess(time.monotonic() - begin, 30)

    def test_files_that_are_written_are_different_ones(self):
        outline = self.outline(self.SQUARE)
        for more, words in ((("--crosses", self.path("out.vtu")), ("crosses", "cannot both be")),
                            (("--crosses", self.path("x/../out.vtu")), ("crosses", "cannot both be")),
                            (("--crosses", self.path("out.json")), ("crosses", "cannot both be")),
                            (("--crosses", outline), ("would replace the input",)),
                            (("--crosses", self.path("c.msh")), ("c.msh", "written as .vtu"))):
            with self.subTest(more=more):
                self.check_refused(self.plane(outline, *more), *words)

    def test_messages_name_the_option_and_what_is_allowed(self):
        outline = self.outline(self.SQUARE)
        for size in ("0", "-1", "nan", "inf", "abc"):
            for command in ("plane", "mesh"):
                self.check_refused(self.run_program(command, outline, "-o", self.path("out.vtu"), "--size", size), "--size", size,
                                   "not a positive number")
        for output in ("out.foo", "out", "out.vtk", "out.html"):
            self.check_refused(self.run_program("plane", outline, "-o", self.path(output), "--size", 1), output,
                               "quadrilaterals are written as .vtu, .msh, .mesh or .inp")
        for arguments in ((), ("plan", outline)):
            self.check_refused(self.run_program(*arguments), "subcommand", "mesh, recombine, plane, shell, field, inspect, view")
        self.check_refused(self.run_program("plan", outline), "plan is no subcommand")
        self.assertEqual(self.run_program("plane", outline, "-o", self.path("made.inp"), "--size", 0.5).returncode, 0)
        write_stl(self.path("box.stl"), *box())
        for name, word in (("made.inp", "is written but not read"), ("box.stl", "is a surface"), ("loops.txt", "unknown extension")):
            for command in (("inspect",), ("view", "-o", self.path("view.html"))):
                self.check_refused(self.run_program(command[0], self.path(name), *command[1:]), name, word,
                                   "read from .vtu .vtk .msh .mesh .meshb")
        self.check_refused(self.plane(self.outline("0 0\n1e-200 0\n1e-200 1e-200\n")), "smaller unit")

    def test_a_sphere_at_sizes_beyond_it(self):
        points, triangles = box((2, 2, 2))
        for _ in range(4):  # each triangle into four
            points, triangles = subdivided(points, triangles)
        points = [tuple(x) for x in (np.array(points) - 1) / np.linalg.norm(np.array(points) - 1, axis=1)[:, None]]
        write_stl(self.path("sphere.stl"), points, triangles)
        for size in (2, 100):
            with self.subTest(size=size):
                result = self.run_program("shell", self.path("sphere.stl"), "-o", self.path("out.vtu"), "--size", size,
                                          "--report", self.path("out.json"), "--features", 150)
                self.assertEqual(result.returncode, 0, result)
                report = json.loads((self.folder / "out.json").read_text())
                self.assertLess(report["deviation"], 0.01)
                self.assertGreater(report["points"]["shrunk"], 0)
                self.assertEqual(report["counts"]["triangles"], 0)
                self.assertNotIn("warnings", report)

    def test_shells_open_and_closed(self):
        points, triangles = box((2, 1, 1))
        write_stl(self.path("box.stl"), points, triangles)
        write_stl(self.path("open.stl"), points, triangles[2:])
        for name, characteristic in (("box.stl", 2), ("open.stl", 1)):
            with self.subTest(name=name):
                result = self.run_program("shell", self.path(name), "-o", self.path("out.vtu"), "--size", 0.125,
                                          "--report", self.path("out.json"), "--quiet")
                self.assertEqual(result.returncode, 0, result)
                report = json.loads((self.folder / "out.json").read_text())
                self.assertEqual(report["quality"]["euler_characteristic"], characteristic)
                self.assertGreater(report["quality"]["scaled_jacobian_min"], 0.999)


class TestMeshBox(Case):
    def test_a_box_becomes_cubes_in_all_variants(self):
        write_stl(self.path("box.stl"), *box((2, 1, 1)))
        for field, order in itertools.product(("nearest", "smoothed", "best"), ("fifo", "smoothness", "lattice")):
            with self.subTest(field=field, order=order):
                result = self.mesh("box.stl", "--size", "0.25", "--field", field, "--order", order)
                self.assertEqual(result.returncode, 0, result)
                self.assertEqual(audit(self.path("out.vtu"))["counts"], {"hexahedron": 128})

    def test_cavities_stay_empty(self):
        points, triangles = box((4, 4, 4))
        for size, origin, volume, more in (((2, 2, 2), (1, 1, 1), 56, False), ((2, 1, 1), (1, 1, 1), 62.125, True)):
            inner, _ = box(size, origin)
            all_points, all_triangles = points + inner, triangles + [tuple(i + 8 for i in t) for t in triangles]
            if more:  # a body within the cavity
                all_points = all_points + box((0.5, 0.5, 0.5), (1.5, 1.25, 1.25))[0]
                all_triangles += [tuple(i + 16 for i in t) for t in triangles]
            write_stl(self.path("box.stl"), all_points, all_triangles)
            result = self.mesh("box.stl", "--size", "0.5", "--select", "greedy")
            self.assertEqual(result.returncode, 0, result)
            found = audit(self.path("out.vtu"))
            self.assertAlmostEqual(found["volume"], volume)
            self.assertGreater(found["least_volume"], 0)

    def test_triangles_of_mixed_orientation_are_turned_and_it_says_so(self):
        points, triangles = box()
        triangles[3] = triangles[3][::-1]
        write_stl(self.path("box.stl"), points, triangles)
        result = self.mesh("box.stl", "--size", "0.5")
        self.assertEqual(result.returncode, 0, result)
        self.assertIn("1 of 12 triangles were turned", result.stderr)
        self.assertEqual(audit(self.path("out.vtu"))["counts"], {"hexahedron": 8})

    def test_cells(self):
        write_stl(self.path("box.stl"), *box())
        result = self.mesh("box.stl", "--cells", "64")
        self.assertEqual(result.returncode, 0, result)
        self.assertEqual(audit(self.path("out.vtu"))["counts"], {"hexahedron": 64})


class TestMeshBunny(Case):
    """The whole way at its defaults, judged by another reader."""

    SIZE = ["--size", "0.26"]

    def mesh_and_judge(self, *variant):
        result = self.run_program("mesh", BUNNY, "-o", self.path("out.vtu"), "--report", self.path("out.json"),
                                  *self.SIZE, *variant)
        self.assertEqual(result.returncode, 0, result)
        self.assertEqual(result.stderr, "")
        found = audit(self.path("out.vtu"))
        report = json.loads((self.folder / "out.json").read_text())
        names = {"tetra": "tetrahedra", "pyramid": "pyramids", "wedge": "prisms", "hexahedron": "hexahedra"}
        for kind, name in names.items():
            self.assertEqual(found["counts"].get(kind, 0), report["counts"][name])
        self.assertGreater(found["least_volume"], 0)
        self.assertEqual(found["used_over_twice"], 0)
        self.assertAlmostEqual(found["volume"] / 194.29, 1, delta=0.01)
        self.assertEqual(report["conformity"]["open_quads"], 0)
        self.assertEqual(report["quality"]["invalid_cells"], [])
        return report

    def test_proven_to_half_a_percent(self):
        report = self.mesh_and_judge("--gap", "0.5")
        self.assertLessEqual(report["selection"]["gap_percent"], 0.5)

    def test_at_the_defaults(self):
        report = self.mesh_and_judge()
        self.assertGreater(report["hex_ratio"]["volume"], 0.55)
        self.assertLess(report["selection"]["gap_percent"], 15)  # the bound of a few iterations
        for key in ("smoothness_mean", "fraction_smooth", "dirichlet_energy", "singular_edges"):
            self.assertIn(key, report["field"])
        # The same file from another run, with other threads.
        again = self.run_program("mesh", BUNNY, "-o", self.path("again.vtu"), "--threads", "1", "--quiet", *self.SIZE)
        self.assertEqual((again.returncode, again.stdout, again.stderr), (0, "", ""))
        self.assertTrue(filecmp.cmp(self.path("out.vtu"), self.path("again.vtu"), shallow=False))
        self.assertEqual(len(list(self.folder.iterdir())), 3)

    def test_smoothness_order_is_ahead(self):
        first = self.mesh_and_judge("--field", "nearest", "--order", "fifo")
        second = self.mesh_and_judge("--field", "smoothed", "--order", "smoothness")
        self.assertGreater(second["hex_ratio"]["volume"], first["hex_ratio"]["volume"])


class TestInterruption(Case):
    def test_interrupted_within_a_second_without_a_partial_file(self):
        # At several moments, so that different stages are under way.
        for delay in (0.3, 1, 2.5, 5):
            process = subprocess.Popen([PROGRAM, "mesh", str(BUNNY), "-o", self.path("out.vtu"), "--size", "0.2"],
                                       stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
            time.sleep(delay)
            if process.poll() is not None:
                process.communicate()
                break
            process.send_signal(signal.SIGINT)
            start = time.monotonic()
            out, err = process.communicate(timeout=60)
            seconds = time.monotonic() - start
            self.assertEqual(process.returncode, 130, err)
            self.assertEqual((out, err), ("", "framehex: interrupted\n"))
            self.assertLess(seconds, 1)
            self.assertEqual(list(self.folder.iterdir()), [])


if __name__ == "__main__":
    unittest.main()
