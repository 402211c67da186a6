#!/usr/bin/env python3
# SPDX-License-Identifier: BSL-1.0
"""A distributed client: check_openfoam.py FRAMEHEX MPIRUN...

OpenFOAM solves Laplace's equation on two ranks, each on the piece that a rank of the program wrote, coupled by the faces
that both have; and on the mesh of one rank. The temperatures agree cell by cell.
"""
import os
import pathlib
import re
import subprocess
import sys
import tempfile

import meshio
import numpy as np

from check_program import lattice

FRAMEHEX, MPIRUN = sys.argv[1], sys.argv[2:]
SIDE = 8
FOAM = pathlib.Path("/usr/share/openfoam")
ENVIRONMENT = {**os.environ, "WM_PROJECT": "OpenFOAM", "WM_PROJECT_DIR": str(FOAM), "FOAM_ETC": str(FOAM / "etc"),
               "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}
FACES = {
    "tetra": [(0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2)],
    "pyramid": [(0, 3, 2, 1), (0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4)],
    "wedge": [(0, 1, 2), (3, 5, 4), (0, 3, 4, 1), (1, 4, 5, 2), (2, 5, 3, 0)],
    "hexahedron": [(0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)],
}


class Piece:
    """A rank's own cells, and their faces by the global numbers of their corners."""

    def __init__(self, path):
        mesh = meshio.read(path)
        self.points, self.ids = mesh.points, mesh.point_data["GlobalPointIds"]
        self.cells, self.uses = [], {}
        for block, ghosts in zip(mesh.cells, mesh.cell_data["vtkGhostType"]):
            for row in block.data[np.asarray(ghosts) == 0]:
                centre = self.points[row].mean(0)
                for local in FACES[block.type]:
                    face = row[list(local)]
                    p = self.points[face]
                    if np.dot(np.cross(p[1] - p[0], p[-1] - p[0]), p.mean(0) - centre) < 0:
                        face = face[::-1]
                    face = np.roll(face, -int(np.argmin(self.ids[face])))  # both sides begin at the same corner
                    self.uses.setdefault(tuple(sorted(self.ids[face])), []).append((len(self.cells), face))
                self.cells.append(tuple(sorted(tuple(p) for p in self.points[row])))

    def once(self):
        return {key for key, uses in self.uses.items() if len(uses) == 1}


def header(kind, name):
    return f"FoamFile {{ version 2.0; format ascii; class {kind}; object {name}; }}\n"


def write_list(path, kind, rows):
    path.write_text(header(kind, path.name) + f"{len(rows)}\n(\n" + "\n".join(rows) + "\n)\n")


def write_case(folder, piece, couplings, rank):
    """polyMesh and the field T of a piece; `couplings`: other rank -> keys of the faces that both have."""
    inner = []
    for uses in piece.uses.values():
        if len(uses) == 2:
            low, high = sorted(uses, key=lambda use: use[0])
            inner.append((low[0], high[0], low[1]))
    inner.sort(key=lambda face: face[:2])
    coupled = {key for keys in couplings.values() for key in keys}
    patches = {"left": [], "right": [], "rest": []}
    for key in piece.once() - coupled:
        cell, face = piece.uses[key][0]
        x = piece.points[face][:, 0]
        patches["left" if (x == 0).all() else "right" if (x == SIDE).all() else "rest"].append((cell, key, face))
    for patch in patches.values():
        patch.sort(key=lambda entry: entry[:2])
    names = {}
    for other, keys in couplings.items():
        names[f"procBoundary{rank}to{other}"] = other
        patches[f"procBoundary{rank}to{other}"] = [(piece.uses[k][0][0], k, piece.uses[k][0][1]) for k in sorted(keys)]

    mesh = folder / "constant" / "polyMesh"
    mesh.mkdir(parents=True)
    faces = [face for _, _, face in inner] + [face for patch in patches.values() for _, _, face in patch]
    owners = [owner for owner, _, _ in inner] + [cell for patch in patches.values() for cell, _, _ in patch]
    write_list(mesh / "points", "vectorField", [f"({p[0]:.17g} {p[1]:.17g} {p[2]:.17g})" for p in piece.points])
    write_list(mesh / "faces", "faceList", [f"{len(f)}({' '.join(map(str, f))})" for f in faces])
    write_list(mesh / "owner", "labelList", [str(o) for o in owners])
    write_list(mesh / "neighbour", "labelList", [str(n) for _, n, _ in inner])
    start, boundary, conditions = len(inner), [], []
    values = {"left": "fixedValue; value uniform 0", "right": "fixedValue; value uniform 1", "rest": "zeroGradient"}
    for name, patch in patches.items():
        more = f"myProcNo {rank}; neighbProcNo {names[name]};" if name in names else ""
        kind = "processor" if name in names else "patch"
        boundary.append(f"{name} {{ type {kind}; nFaces {len(patch)}; startFace {start}; {more} }}")
        conditions.append(f"{name} {{ type {values.get(name, 'processor; value uniform 0')}; }}")
        start += len(patch)
    write_list(mesh / "boundary", "polyBoundaryMesh", boundary)
    (folder / "0").mkdir()
    (folder / "0" / "T").write_text(header("volScalarField", "T") + "dimensions [0 0 0 1 0 0 0];\n"
                                    "internalField uniform 0;\nboundaryField {\n" + "\n".join(conditions) + "\n}\n")


def write_control(case, n_ranks):
    (case / "system").mkdir()
    (case / "constant").mkdir(exist_ok=True)
    (case / "constant" / "transportProperties").write_text(
        header("dictionary", "transportProperties") + "DT DT [0 2 -1 0 0 0 0] 1;\n")
    (case / "system" / "controlDict").write_text(
        header("dictionary", "controlDict") + "application laplacianFoam; startFrom startTime; startTime 0; stopAt endTime;"
        " endTime 1; deltaT 1; writeControl timeStep; writeInterval 1; writeFormat ascii; writePrecision 14;\n")
    (case / "system" / "fvSchemes").write_text(
        header("dictionary", "fvSchemes") + "ddtSchemes { default steadyState; }\ngradSchemes { default Gauss linear; }\n"
        "divSchemes { default none; }\nlaplacianSchemes { default Gauss linear corrected; }\n"
        "interpolationSchemes { default linear; }\nsnGradSchemes { default corrected; }\n")
    (case / "system" / "fvSolution").write_text(
        header("dictionary", "fvSolution") + "solvers { T { solver PCG; preconditioner diagonal; tolerance 1e-13;"
        " relTol 0; maxIter 5000; } }\nSIMPLE { nNonOrthogonalCorrectors 20; }\n")
    (case / "system" / "decomposeParDict").write_text(
        header("dictionary", "decomposeParDict") + f"numberOfSubdomains {n_ranks}; method simple;\n")


def temperatures(folder, piece):
    text = (folder / "1" / "T").read_text()
    values = re.search(r"internalField\s+nonuniform List<scalar>\s*\d+\s*\(([^)]*)\)", text)[1].split()
    assert len(values) == len(piece.cells)
    return dict(zip(piece.cells, map(float, values)))


def run(words, folder):
    result = subprocess.run([str(word) for word in words], cwd=folder, env=ENVIRONMENT, capture_output=True,
                            text=True)
    if result.returncode != 0:
        sys.exit(f"{words}:\n{result.stdout[-3000:]}{result.stderr[-3000:]}")
    return result.stdout


def solved(folder, n_ranks):
    out = folder / f"out{n_ranks}.pvtu"
    run([*MPIRUN, "-n", n_ranks, pathlib.Path(FRAMEHEX).absolute(), "recombine", folder / "in.vtu", "-o", out, "--quiet",
         "--part-size", 700], folder)
    pieces = [Piece(folder / f"out{n_ranks}_{rank}.vtu") for rank in range(n_ranks)]
    case = folder / f"case{n_ranks}"
    case.mkdir()
    write_control(case, n_ranks)
    if n_ranks == 1:
        write_case(case, pieces[0], {}, 0)
        run(["laplacianFoam"], case)
        return temperatures(case, pieces[0])
    for rank, piece in enumerate(pieces):
        couplings = {other: piece.once() & pieces[other].once() for other in range(n_ranks) if other != rank}
        write_case(case / f"processor{rank}", piece, {o: keys for o, keys in couplings.items() if keys}, rank)
    check = run([*MPIRUN, "-n", n_ranks, "checkMesh", "-parallel"], case)
    assert "Number of regions: 1" in check or "Mesh OK" in check, check
    run([*MPIRUN, "-n", n_ranks, "laplacianFoam", "-parallel"], case)
    result = {}
    for rank, piece in enumerate(pieces):
        result.update(temperatures(case / f"processor{rank}", piece))
    return result


with tempfile.TemporaryDirectory() as name:
    folder = pathlib.Path(name)
    points, tets = lattice(SIDE)
    meshio.Mesh(points, [("tetra", tets)]).write(folder / "in.vtu")
    serial, parallel = solved(folder, 1), solved(folder, 2)
    assert serial.keys() == parallel.keys()
    difference = max(abs(serial[cell] - parallel[cell]) for cell in serial)
    spread = max(serial.values()) - min(serial.values())
    print(f"{len(serial)} cells, {sum(len(cell) == 8 for cell in serial)} of them hexahedra, temperatures over {spread:.3f}, largest difference {difference:.1e}")
    assert spread > 0.8 and difference < 1e-9
