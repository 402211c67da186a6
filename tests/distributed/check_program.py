#!/usr/bin/env python3
# SPDX-License-Identifier: BSL-1.0
"""Runs the program over MPI: check_program.py FRAMEHEX MPIRUN...

The same cells and frames on 1, 2, 3 and 5 ranks; the joined mesh is sound by `inspect`; a rank that is killed, a full
disk and a NaN in one piece end with a message, and leave no file.
"""
import json
import os
import pathlib
import re
import signal
import subprocess
import sys
import tempfile
import time

import meshio
import numpy as np

FRAMEHEX, MPIRUN = sys.argv[1], sys.argv[2:]
ORDERS = [(0, 1, 2), (1, 2, 0), (2, 0, 1), (0, 2, 1), (2, 1, 0), (1, 0, 2)]


def lattice(n, seed=1):
    """A cube of n^3 cubes, six tetrahedra each, its inner vertices moved."""
    number = np.arange((n + 1) ** 3).reshape(n + 1, n + 1, n + 1)
    points = np.stack(np.meshgrid(*3 * [np.arange(n + 1.0)], indexing="ij"), -1).reshape(-1, 3)
    inner = ((points > 0) & (points < n)).all(1)
    points[inner] += np.random.default_rng(seed).uniform(-0.1, 0.1, (inner.sum(), 3))
    tets = []
    for corner in np.ndindex(n, n, n):
        for o, order in enumerate(ORDERS):
            at, tet = list(corner), [number[corner]]
            for axis in order:
                at[axis] += 1
                tet.append(number[tuple(at)])
            if o >= 3:
                tet[2], tet[3] = tet[3], tet[2]
            tets.append(tet)
    return with_centres(points, np.array(tets), np.random.default_rng(seed).random(n**3) < 0.2)


def with_centres(points, tets, has_centre):
    """Cubes with a vertex in the middle, round which twelve tetrahedra stand: not all become hexahedra."""
    kept, centres = [], []
    for cube, six in enumerate(tets.reshape(-1, 6, 4)):
        if not has_centre[cube]:
            kept.extend(six)
            continue
        faces = {}
        for a, b, c, d in six:
            for face in ((b, c, d), (a, d, c), (a, b, d), (a, c, b)):  # anticlockwise seen from outside
                faces.setdefault(tuple(sorted(face)), []).append(face)
        kept.extend((a, c, b, len(points) + len(centres)) for (a, b, c), *others in faces.values() if not others)
        centres.append(points[np.unique(six)].mean(0))
    return np.concatenate([points, np.array(centres)]), np.array(kept)


def command(n_ranks, source, output, *more):
    return [*MPIRUN, "-n", str(n_ranks), FRAMEHEX, "recombine", str(source), "-o", str(output), "--quiet", *more]


def pieces(path, n_ranks):
    return [meshio.read(path.with_name(f"{path.stem}_{rank}.vtu")) for rank in range(n_ranks)]


def cells_and_frames(path, n_ranks, with_frames=True):
    """Cells as tuples of corners' places, and frames by place; and all as one mesh."""
    cells, frames, points, joined, of_ghosts = [], {}, {}, {}, []
    for piece in pieces(path, n_ranks):
        ids = piece.point_data["GlobalPointIds"]
        for v, p in enumerate(piece.points):
            if points.setdefault(ids[v], tuple(p)) != tuple(p):
                sys.exit(f"{path}: point {ids[v]} has two places")
            if with_frames and piece.point_data["vtkGhostType"][v] == 0:
                frames[tuple(p)] = tuple(piece.point_data["frame"][v])
            elif with_frames:
                of_ghosts.append((tuple(p), piece.point_data["frame"][v]))
        for block, ghosts in zip(piece.cells, piece.cell_data["vtkGhostType"]):
            for row in block.data[np.asarray(ghosts) == 0]:
                cells.append((block.type, *(tuple(piece.points[v]) for v in row)))
                joined.setdefault(block.type, []).append([ids[v] for v in row])
    for p, frame in of_ghosts:
        assert np.array_equal(frame, frames[p], equal_nan=True), f"{path}: another frame at the ghost point {p}"
    order = sorted(points)
    place = {v: i for i, v in enumerate(order)}
    mesh = meshio.Mesh(np.array([points[v] for v in order]),
                       [(kind, np.vectorize(place.get)(np.array(rows))) for kind, rows in joined.items()])
    return sorted(cells), frames, mesh


def check_formats(folder):
    """A serial file of any format, as meshio writes it, makes the same mesh."""
    points, tets = lattice(4)
    points = np.round(points * 64) / 64  # few digits: what is written as text is what is read
    expected = None
    for number, (suffix, options) in enumerate((
            (".vtu", {"binary": False}), (".vtu", {"compression": None}), (".vtu", {"compression": "zlib"}),
            (".vtu", {"compression": "lzma"}), (".msh", {"file_format": "gmsh"}),
            (".msh", {"file_format": "gmsh", "binary": False}), (".msh", {"file_format": "gmsh22"}),
            (".msh", {"file_format": "gmsh22", "binary": False}), (".mesh", {}), (".meshb", {}), (".vtk", {}))):
        source = folder / f"in{number}{suffix}"
        meshio.Mesh(points, [("tetra", tets)]).write(source, **options)
        subprocess.run(command(2, source, folder / "out.pvtu", "--part-size", "200"), check=True)
        named = re.findall(r'<Piece Source="(.*?)"', (folder / "out.pvtu").read_text())
        cells = cells_and_frames(folder / "out.pvtu", len(named), with_frames=False)[0]
        expected = expected or cells
        assert cells == expected, f"other cells from {source.name} {options}"


def check_empty_ranks(folder):
    """One tetrahedron on three ranks: all pieces that are named can be read by meshio, and no others are there."""
    points = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.0]])
    meshio.Mesh(points, [("tetra", np.array([[0, 1, 2, 3]]))]).write(folder / "in.vtu")
    older = folder / "out_2.vtu"
    older.write_text("a piece of an older mesh, of more ranks")
    for n_ranks in (3, 2):
        subprocess.run(command(n_ranks, folder / "in.vtu", folder / "out.pvtu", "--field"), check=True)
        named = re.findall(r'<Piece Source="(.*?)"', (folder / "out.pvtu").read_text())
        read = [meshio.read(folder / name) for name in named]
        assert [sum(len(block.data) for block in piece.cells) for piece in read] == [1], read
        assert sorted(map(tuple, read[0].points)) == sorted(map(tuple, points))
    assert leftovers(folder, {"in.vtu", "out.pvtu"}) == named, leftovers(folder, set())
    subprocess.run(command(2, folder / "out.pvtu", folder / "again.pvtu"), check=True)  # and by us


def leftovers(folder, keep):
    return sorted(p.name for p in folder.iterdir() if p.name not in keep)


def check_same(folder):
    points, tets = lattice(9)
    meshio.Mesh(points, [("tetra", tets)]).write(folder / "in.vtu")
    expected = None
    for n_ranks in (1, 2, 3, 5):
        out = folder / f"out{n_ranks}.pvtu"
        subprocess.run(command(n_ranks, folder / "in.vtu", out, "--field", "--part-size", "900"), check=True)
        cells, frames, mesh = cells_and_frames(out, n_ranks)
        expected = expected or (cells, frames)
        assert cells == expected[0], f"other cells on {n_ranks} ranks"
        assert frames.keys() == expected[1].keys()
        for p, frame in frames.items():
            assert np.array_equal(frame, expected[1][p], equal_nan=True), f"another frame on {n_ranks} ranks at {p}"
        mesh.write(folder / "joined.vtu")
        subprocess.run([FRAMEHEX, "inspect", folder / "joined.vtu", "--report", folder / "report.json"], check=True,
                       stdout=subprocess.DEVNULL)
        report = json.loads((folder / "report.json").read_text())
        assert not report["quality"]["invalid_cells"] and report["conformity"]["open_quads"] == 0
        assert report["conformity"]["other_bad_faces"] == 0 and report["conformity"]["open_boundary_edges"] == 0
        assert abs(report["quality"]["volume"] - 9**3) < 1e-9, report["quality"]["volume"]
    kinds = {kind: sum(cell[0] == kind for cell in expected[0]) for kind in ("tetra", "pyramid", "wedge", "hexahedron")}
    print(f"the same on all ranks: {kinds}")


def failed(run, folder, keep, *words):
    text = run.stderr + run.stdout
    assert run.returncode != 0, text
    for word in words:
        assert word in text, f"no '{word}' in: {text}"
    assert not leftovers(folder, keep), leftovers(folder, keep)


def check_failures(folder):
    points, tets = lattice(6)
    half = len(tets) // 2
    for name, some in (("a.vtu", tets[:half]), ("b.vtu", tets[half:])):
        meshio.Mesh(points, [("tetra", some)]).write(folder / name)
    (folder / "in.pvtu").write_text("<VTKFile type='PUnstructuredGrid'><PUnstructuredGrid><Piece Source='a.vtu'/>"
                                    "<Piece Source='b.vtu'/></PUnstructuredGrid></VTKFile>")
    keep = {"a.vtu", "b.vtu", "in.pvtu"}

    (folder / "out_1.vtu").symlink_to("/dev/full")
    run = subprocess.run(command(2, folder / "in.pvtu", folder / "out.pvtu"), capture_output=True, text=True)
    failed(run, folder, keep | {"out_1.vtu"}, "rank 1: ", "No space left on device")
    (folder / "out_1.vtu").unlink()

    broken = points.copy()
    broken[17, 1] = np.nan
    meshio.Mesh(broken, [("tetra", tets[half:])]).write(folder / "b.vtu")
    run = subprocess.run(command(2, folder / "in.pvtu", folder / "out.pvtu"), capture_output=True, text=True)
    failed(run, folder, keep, "rank 1: ", "vertex 17", "not finite")


def check_refused(folder):
    """What cannot be is said by one line of one rank, before any work; and no file is left."""
    points, tets = lattice(3)
    meshio.Mesh(points, [("tetra", tets)]).write(folder / "in.vtu")
    (folder / "in.pvtu").write_text("<VTKFile type='PUnstructuredGrid'><PUnstructuredGrid><Piece Source='in.vtu'/>"
                                    "</PUnstructuredGrid></VTKFile>")
    for output, more, words in (
            ("out.vtu", (), ("3 ranks would each write it", "out.pvtu")),
            ("out.pvtu", ("--report", str(folder / "none" / "r.json")), ("r.json: cannot be written",)),
            ("out.pvtu", ("--report", str(folder / "out.pvtu")), ("the mesh and the report cannot both be",)),
            ("none/out.pvtu", (), ("out_0.vtu: cannot be written",)),
            ("out.pvtu", ("--compress",), ("are not for parts of a mesh",)),
            ("out.pvtu", ("--regions", "matter"), ("in.vtu: has no array by cell \"matter\"",)),
            ("out.pvtu", ("--no-such-option",), ("not expected: --no-such-option",))):
        for source in ("in.vtu", "in.pvtu"):
            run = subprocess.run(command(3, folder / source, folder / output, *more), capture_output=True, text=True)
            failed(run, folder, {"in.vtu", "in.pvtu"}, *words)
            assert run.stderr.count("framehex: ") == 1, run.stderr
    run = subprocess.run([*MPIRUN, "-n", "2", FRAMEHEX, "inspect", str(folder / "in.vtu")], capture_output=True, text=True)
    failed(run, folder, {"in.vtu", "in.pvtu"}, "2 ranks would each do the same")
    assert run.stdout == "", run.stdout


def check_report(folder):
    """The report tells what that of one process does; names of regions are in it and in the pieces."""
    points, tets = lattice(5)
    labels = (points[tets].mean(1)[:, 0] > 2.5).astype(np.int32)
    meshio.Mesh(points, [("tetra", tets)], cell_data={"label": [labels]}).write(folder / "in.vtu", binary=False)
    text = (folder / "in.vtu").read_text()
    names = "".join(f'<DataArray type="UInt32" Name="regions:{name}" format="ascii">{label}</DataArray>'
                    for label, name in enumerate(("steel part", "air")))
    (folder / "in.vtu").write_text(text.replace("<Piece", f"<FieldData>{names}</FieldData><Piece", 1))
    serial = [FRAMEHEX, "recombine", folder / "in.vtu", "-o", folder / "one.vtu", "--quiet", "--report", folder / "one.json"]
    subprocess.run(serial, check=True)
    subprocess.run(command(3, folder / "in.vtu", folder / "out.pvtu", "--part-size", "300", "--report",
                           str(folder / "out.json")), check=True)
    one, out = (json.loads((folder / f"{name}.json").read_text()) for name in ("one", "out"))
    assert out["seconds"].keys() == one["seconds"].keys() and out["seconds"]["assembly"] > 0, out["seconds"]
    assert out["assembly"].keys() < one["assembly"].keys()
    assert out["counts"]["vertices"] == len(points) + out["assembly"]["new_vertices"], out["assembly"]
    subprocess.run(command(2, folder / "in.vtu", folder / "whole.pvtu", "--report", str(folder / "whole.json")), check=True)
    whole = json.loads((folder / "whole.json").read_text())
    assert whole["parts"] == 1 and whole["assembly"].keys() == one["assembly"].keys()
    assert min(whole["seconds"][key] for key in ("search", "selection", "assembly")) > 0, whole["seconds"]
    assert out["selection"]["value"] <= out["selection"]["bound"] and out["selection"]["chosen"] > 0
    assert [g["name"] for g in out["groups"]] == [g["name"] for g in one["groups"]] == ["steel part", "air"]
    assert sum(g["elements"] for g in out["groups"]) == out["counts"]["cells"]
    for name in re.findall(r'<Piece Source="(.*?)"', (folder / "out.pvtu").read_text()):
        subprocess.run([FRAMEHEX, "inspect", folder / name, "--report", folder / "piece.json"], check=True,
                       stdout=subprocess.DEVNULL)
        groups = json.loads((folder / "piece.json").read_text())["groups"]
        assert [(g["name"], g["labels"]) for g in groups] == [("steel part", [0]), ("air", [1])], groups
        for element, numbers in ((b"CellData", b"GlobalCellIds"), (b"PointData", b"GlobalPointIds")):
            attribute = element + b' GlobalIds="' + numbers + b'"'
            assert b"<" + attribute in (folder / name).read_bytes()
            assert b"<P" + attribute in (folder / "out.pvtu").read_bytes()


def ranks_below(pid):
    """The processes that mpirun has started, however it was started itself."""
    found = subprocess.run(["ps", "-o", "pid=,comm=", "--ppid", str(pid)], capture_output=True, text=True).stdout
    children = [line.split() for line in found.splitlines()]
    ranks = [int(child) for child, name in children if name.startswith("framehex")]
    return ranks or [rank for child, _ in children for rank in ranks_below(int(child))]


def check_killed(folder):
    points, tets = lattice(24)
    meshio.Mesh(points, [("tetra", tets)]).write(folder / "in.vtu")
    run = subprocess.Popen(command(3, folder / "in.vtu", folder / "out.pvtu", "--part-size", "5000"),
                           stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    while len(ranks := ranks_below(run.pid)) < 3:
        assert run.poll() is None, run.communicate()[0]
        time.sleep(0.1)
    time.sleep(0.7)  # they have met, and are far from done
    os.kill(ranks[1], signal.SIGKILL)
    text, _ = run.communicate(timeout=60)
    assert run.returncode != 0 and "rank 1" in text and "signal 9" in text, text
    assert not leftovers(folder, {"in.vtu"}), leftovers(folder, {"in.vtu"})


if __name__ == "__main__":
    for check in (check_same, check_formats, check_empty_ranks, check_failures, check_refused,
                  check_report, check_killed):
        with tempfile.TemporaryDirectory() as name:
            check(pathlib.Path(name))
        print(check.__name__, "passed")
