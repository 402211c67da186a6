#!/usr/bin/env python3
# SPDX-License-Identifier: BSL-1.0
"""Laplace's equation by OpenFOAM: on the dome between its floor and its top, and against a harmonic function.

    openfoam_laplace.py PROGRAM [SURFACE] [--picture FILE.png]

Two answers are known. What flows in through one patch flows out through the other. And with the values of a harmonic
function prescribed on the boundary, the error in the cells falls with the second power of their size: on a box, and on
the mixed mesh of the dome. Needs Debian's packages openfoam and python3-numpy (and python3-matplotlib for the picture).
"""
import os
import pathlib
import re
import subprocess

import numpy as np

import common

FOAM = pathlib.Path("/usr/share/openfoam")
ENVIRONMENT = {**os.environ, "WM_PROJECT": "OpenFOAM", "WM_PROJECT_DIR": str(FOAM), "FOAM_ETC": str(FOAM / "etc")}

# `corrected` counts the part of the flux that goes along a face whose cells' centres are not straight across it, and
# needs gradients that linear fields have exactly, which Gauss' theorem does not give on skewed cells.
DICTIONARIES = {
    "system/controlDict": """application laplacianFoam; startFrom startTime; startTime 0; stopAt endTime; endTime 200;
        deltaT 1; writeControl timeStep; writeInterval 200; writePrecision 15; timePrecision 6;
        functions {{
            gradient {{ type grad; libs (fieldFunctionObjects); field T; writeControl writeTime; log false; }}
            {fluxes}
        }}""",
    "system/fvSchemes": """ddtSchemes {{ default steadyState; }} gradSchemes {{ default leastSquares; }} divSchemes {{}}
        laplacianSchemes {{ default Gauss linear corrected; }} interpolationSchemes {{ default linear; }}
        snGradSchemes {{ default corrected; }}""",
    "system/fvSolution": """solvers {{ T {{ solver PCG; preconditioner DIC; tolerance 1e-12; relTol 0; }} }}
        SIMPLE {{ nNonOrthogonalCorrectors 0; residualControl {{ T 1e-9; }} }}""",
    "constant/transportProperties": "DT [0 2 -1 0 0 0 0] 1;",
}
FLUX = """flux_{patch} {{ type surfaceFieldValue; libs (fieldFunctionObjects); fields (grad(T));
    operation areaNormalIntegrate; regionType patch; name {patch}; writeFields false; log false; }}"""


def numbers(text, n_columns):
    """The numbers of an OpenFOAM list in ASCII, as rows."""
    return np.array(re.findall(r"[-+.\deE]+", text), float).reshape(-1, n_columns)


def entry(text, keyword):
    """The list of a `nonuniform List` under a keyword, or the value of a `uniform` one."""
    found = re.search(rf"\b{keyword}\s+(?:uniform ([^;]+);|nonuniform List<\w+>\s*\d+\s*\((.*?)\)\s*;)", text, re.S)
    return found[1] if found[2] is None else found[2]


class PolyMesh:
    """Points (n x 3), faces (arrays of points), cells on both sides of each face, and the faces of each patch."""

    def __init__(self, folder):
        def inside(name):
            return (folder / name).read_text().split("\n(\n", 1)[1].rsplit("\n)", 1)[0]

        self.points = numbers(inside("points"), 3)
        self.faces = [np.array(corners.split(), int) for corners in re.findall(r"\(([\d ]+)\)", inside("faces"))]
        self.owner = np.array(inside("owner").split(), int)
        self.neighbour = np.array(inside("neighbour").split(), int)
        patch = r"(\w+)\s*\{[^}]*nFaces\s+(\d+);\s*startFace\s+(\d+);"
        self.patches = {name: range(int(start), int(start) + int(n))
                        for name, n, start in re.findall(patch, inside("boundary"))}

    def normal(self, face):
        """Unit normal, out of the face's owner."""
        p = self.points[self.faces[face]]
        area = np.cross(p, np.roll(p, -1, axis=0)).sum(axis=0)
        return area / np.linalg.norm(area)

    def surface_of(self, kept):
        """Faces between cells that are kept and cells that are not, or nothing, outward; and the kept cell of each."""
        faces, cells = [], []
        for i, face in enumerate(self.faces):
            front = kept[self.owner[i]]
            back = i < len(self.neighbour) and kept[self.neighbour[i]]
            if front != back:
                faces.append(face if front else face[::-1])
                cells.append(self.owner[i] if front else self.neighbour[i])
        return faces, cells


class Case:
    """A case of laplacianFoam on the mesh of a surface."""

    def __init__(self, folder, program, surface, cells):
        self.folder = folder
        for part in ("0", "constant", "system"):
            (folder / part).mkdir(parents=True)
        common.mesh(program, surface, folder / "constant" / "polyMesh", cells, "--finite-volume")
        self.mesh = PolyMesh(folder / "constant" / "polyMesh")
        fluxes = "\n".join(FLUX.format(patch=patch) for patch in self.mesh.patches)
        for name, body in DICTIONARIES.items():
            self.write(name, "dictionary", body.format(fluxes=fluxes))

    def write(self, name, kind, body):
        header = f"FoamFile {{ version 2.0; format ascii; class {kind}; object {pathlib.Path(name).name}; }}\n"
        (self.folder / name).write_text(header + body + "\n")

    def run(self, *command):
        with open(self.folder / f"log.{command[0]}", "w") as log:
            subprocess.run([*command, "-case", self.folder], env=ENVIRONMENT, stdout=log, stderr=log, check=True)

    def geometry(self):
        """Centres of the cells (n x 3), volumes, and the centres of each patch's faces, as OpenFOAM has them."""
        self.run("postProcess", "-funcs", "(writeCellCentres writeCellVolumes)", "-time", "0")
        centres, volumes = ((self.folder / "0" / name).read_text() for name in ("C", "V"))
        faces = {patch: numbers(entry(centres[centres.index(f"\n    {patch}\n"):], "value"), 3)
                 for patch in self.mesh.patches}
        return numbers(entry(centres, "internalField"), 3), numbers(entry(volumes, "internalField"), 1)[:, 0], faces

    def solve(self, conditions):
        """Temperatures of the cells, and flux into the body through each patch, from the condition on each patch."""
        patches = "\n".join(f"{name} {{ {conditions[name]} }}" for name in self.mesh.patches)
        self.write("0/T", "volScalarField", f"dimensions [0 0 0 1 0 0 0]; internalField uniform 0;"
                                            f" boundaryField {{ {patches} }}")
        self.run("laplacianFoam")
        if "SIMPLE solution converged" not in (self.folder / "log.laplacianFoam").read_text():
            raise SystemExit(f"laplacianFoam did not converge in {self.folder}")
        last = max((p for p in self.folder.iterdir() if p.name.isdigit()), key=lambda p: int(p.name))
        fluxes = {}
        for name in self.mesh.patches:
            table = self.folder / "postProcessing" / f"flux_{name}" / "0" / "surfaceFieldValue.dat"
            fluxes[name] = float(table.read_text().split()[-1])
        return numbers(entry((last / "T").read_text(), "internalField"), 1)[:, 0], fluxes


def prescribed(values):
    return f"type fixedValue; value nonuniform List<scalar> {len(values)}({' '.join(map(repr, values.tolist()))});"


def harmonic(points, unit):
    x, y, z = points.T / unit
    return np.exp(x) * np.cos(0.6 * y) * np.cos(0.8 * z)


def feet(mesh, patch, cell_centres, face_centres):
    """Where the boundary's values stand for OpenFOAM, whose flux through a boundary face goes straight across it."""
    normals = np.array([mesh.normal(face) for face in mesh.patches[patch]])
    cells = cell_centres[mesh.owner[mesh.patches[patch]]]
    return cells + normals * np.sum((face_centres - cells) * normals, axis=1, keepdims=True)


def error_against_harmonic(case, unit):
    """Mean size of a cell, and the error's quadratic mean over the volume."""
    centres, volumes, faces = case.geometry()
    temperatures, _ = case.solve({patch: prescribed(harmonic(feet(case.mesh, patch, centres, faces[patch]), unit))
                                  for patch in case.mesh.patches})
    error = temperatures - harmonic(centres, unit)
    return np.cbrt(volumes.mean()), np.sqrt(volumes @ error**2 / volumes.sum())


def order_of_convergence(cases):
    """Of the error against a harmonic function that grows by e^2 along the longest side of the box."""
    unit = np.ptp(cases[0].mesh.points, axis=0).max() / 2
    sizes_and_errors = [error_against_harmonic(case, unit) for case in cases]
    for case, (size, error) in zip(cases, sizes_and_errors):
        print(f"{case.folder.name}: mean size {size:.4f}, error {error:.3e}", flush=True)
    logarithms = np.log(sizes_and_errors)
    return np.polyfit(logarithms[:, 0], logarithms[:, 1], 1)[0]


def draw(path, case, temperatures):
    """The half behind the middle across y, of whole cells."""
    centres, _, _ = case.geometry()
    points = case.mesh.points
    faces, cells = case.mesh.surface_of(centres[:, 1] > (points[:, 1].min() + points[:, 1].max()) / 2)
    common.draw(path, points, faces, temperatures[cells], common.view_from(-70, 20),
                "OpenFOAM: temperature between floor and top", "temperature")


def between_two_patches(case, answers):
    """1 on the first patch, 0 on the last, and no flux through the others."""
    first, *others, last = case.mesh.patches
    conditions = {first: "type fixedValue; value uniform 1;", last: "type fixedValue; value uniform 0;"}
    temperatures, fluxes = case.solve({**conditions, **{patch: "type zeroGradient;" for patch in others}})
    print(f"flux in through {first}: {fluxes[first]:.9f}, out through {last}: {-fluxes[last]:.9f}")
    answers.at_most("what flows in and not out, relative", 1e-6, abs(sum(fluxes.values()) / fluxes[first]))
    return temperatures


def solve(program, surface, folder, answers, picture):
    case = Case(folder / "two_patches", program, surface, 1400)
    if len(case.mesh.patches) < 2:
        raise SystemExit(f"{surface}: two patches are needed")
    temperatures = between_two_patches(case, answers)
    if picture:
        draw(picture, case, temperatures)
    box = common.write_extrusion(folder / "box.off", [(0, 0), (1.2, 0), (1.2, 1), (0, 1)], 0.8)
    for name, shape, sizes, least in (("box", box, (1000, 8000, 27000), 1.9),
                                      ("surface", surface, (400, 1400, 4000), 1.8)):
        order = order_of_convergence([Case(folder / f"{name}_{cells}", program, shape, cells) for cells in sizes])
        answers.at_least(f"order of convergence, {name}", least, order)


if __name__ == "__main__":
    common.run(solve, __doc__, common.DATA / "dome.ply")
