#!/usr/bin/env python3
# SPDX-License-Identifier: BSL-1.0
"""Linear elasticity by GetFEM on the piece: the patch test, and the balance of a load.

    getfem_elasticity.py PROGRAM [SURFACE] [--picture FILE.png]

Two answers are known, and exact whatever the mesh. A displacement that is linear, prescribed on the boundary of a mesh
of hexahedra, prisms, pyramids and tetrahedra, comes back at every vertex inside. And a body that is held at its first
patch is held with a force equal to its weight. Needs Debian's packages python3-getfem, python3-scipy and
python3-meshio (and python3-matplotlib for the picture).
"""
import contextlib
import io
import json

import getfem
import meshio
import numpy as np
from scipy.spatial import cKDTree

import common

# By meshio's name: the transformation and the order of its corners (GetFEM's own for hexahedra and pyramids), shape
# functions, and a quadrature that integrates their gradients exactly, without which no patch test holds.
METHODS = {
    "hexahedron": ("GT_QK(3,1)", [0, 1, 3, 2, 4, 5, 7, 6], "FEM_QK(3,1)", "IM_GAUSS_PARALLELEPIPED(3,3)"),
    "wedge": ("GT_PRISM(3,1)", [0, 1, 2, 3, 4, 5], "FEM_PRISM_PK(3,1)", "IM_PRODUCT(IM_TRIANGLE(4),IM_GAUSS1D(3))"),
    "pyramid": ("GT_PYRAMID(1)", [0, 1, 3, 2, 4], "FEM_PYRAMID_QK(1)", "IM_PYRAMID(IM_GAUSS_PARALLELEPIPED(3,5))"),
    "tetra": ("GT_PK(3,1)", [0, 1, 2, 3], "FEM_PK(3,1)", "IM_TETRAHEDRON(2)"),
}
LAMBDA, MU = 1.2, 0.8
STRESS = "(lambda*Trace(Grad_u)*Id(3) + mu*(Grad_u+Grad_u'))"
BOUNDARY, HELD = 1, 2


class Body:
    """A mesh file in GetFEM, with displacements at its vertices."""

    def __init__(self, path):
        with contextlib.redirect_stdout(io.StringIO()):
            file = meshio.read(path)
        getfem.util_trace_level(0)
        self.mesh = getfem.Mesh("empty", 3)
        self.mesh.add_point(file.points.T)
        self.displacements, self.quadrature = getfem.MeshFem(self.mesh, 3), getfem.MeshIm(self.mesh)
        for kind, (transformation, order, shapes, quadrature) in METHODS.items():
            corners = file.points[file.get_cells_type(kind)[:, order]]
            cells = self.mesh.add_convex(getfem.GeoTrans(transformation), corners.transpose(2, 1, 0).copy())
            self.displacements.set_fem(getfem.Fem(shapes), cells)
            self.quadrature.set_integ(getfem.Integ(quadrature), cells)
        self.points, self.counts = file.points, {kind: len(file.get_cells_type(kind)) for kind in METHODS}
        faces = [(face, label) for block, labels in zip(file.cells, file.cell_data["gmsh:physical"])
                 if block.type in ("triangle", "quad") for face, label in zip(block.data, labels)]
        self.faces = [face for face, _ in faces]
        first_patch = np.unique(np.concatenate([face for face, label in faces if label == 1]))
        self.mesh.set_region(BOUNDARY, self.mesh.outer_faces())
        self.mesh.set_region(HELD, self.mesh.faces_from_pid(first_patch))
        self.mesh.region_intersect(HELD, BOUNDARY)
        # In GetFEM's order, but where the file has them: GetFEM computes the apices of pyramids to six digits only.
        self.point_of = cKDTree(file.points).query(self.displacements.basic_dof_nodes()[:, ::3].T)[1]
        self.vertices = file.points[self.point_of]

    def solve(self, held_region, held, weight):
        """Displacements of the vertices (n x 3) from those on a region and the weight of a unit of volume."""
        model = getfem.Model("real")
        model.add_fem_variable("u", self.displacements)
        model.add_initialized_data("lambda", LAMBDA)
        model.add_initialized_data("mu", MU)
        model.add_initialized_data("weight", weight)
        model.add_linear_term(self.quadrature, f"{STRESS}:Grad_Test_u")
        model.add_source_term(self.quadrature, "weight.Test_u")
        model.add_initialized_fem_data("held", self.displacements, held.reshape(-1))
        model.add_Dirichlet_condition_with_simplification("u", held_region, "held")
        model.solve("lsolver", "mumps")
        self.model = model
        return model.variable("u").reshape(-1, 3)

    def vertices_on(self, region):
        return np.unique(self.displacements.basic_dof_on_region(region) // 3)

    def forces_on(self, region):
        """Sum of the forces (3) that the vertices of a region put on the body."""
        inner = getfem.asm_generic(self.quadrature, 1, f"{STRESS}:Grad_Test_u - weight.Test_u", -1, self.model)
        return inner.reshape(-1, 3)[self.vertices_on(region)].sum(axis=0)


def patch_test(body, answers):
    gradient = np.array([[0.010, 0.002, -0.003], [0.004, -0.006, 0.005], [-0.002, 0.001, 0.008]])
    linear = body.vertices @ gradient.T + (0.1, -0.2, 0.3)
    inside = np.setdiff1d(np.arange(len(body.vertices)), body.vertices_on(BOUNDARY))
    held = linear.copy()
    held[inside] = 0
    found = body.solve(BOUNDARY, held, np.zeros(3))
    answers.at_least("vertices inside", 1, len(inside))
    answers.at_most("patch test, error inside, relative", 1e-12, abs(found - linear)[inside].max() / abs(linear).max())


def hang(body, volume, answers):
    weight = np.array([0, 0, -0.001])
    found = body.solve(HELD, np.zeros_like(body.vertices), weight)
    missing = body.forces_on(HELD) + weight * volume
    answers.at_most("force that holds it - its weight, relative", 1e-9,
                    abs(missing).max() / (volume * abs(weight).max()))
    return found


def draw(path, body, displacements):
    u = np.empty_like(body.points)
    u[body.point_of] = displacements
    length = np.linalg.norm(u, axis=1)
    scale = 0.1 * np.ptp(body.points, axis=0).max() / length.max()
    common.draw(path, body.points + scale * u, body.faces, [length[face].mean() for face in body.faces],
                common.view_from(-50, 25), "GetFEM: held behind, bent by its weight", "displacement")


def solve(program, surface, folder, answers, picture):
    report = folder / "mesh.json"
    body = Body(common.mesh(program, surface, folder / "mesh.msh", 1300, "--report", report))
    volume = json.loads(report.read_text())["quality"]["volume"]
    answers.at_least("cells of each kind, " + ", ".join(body.counts), 1, min(body.counts.values()))
    outer = body.mesh.region(BOUNDARY).shape[1]
    answers.add("faces without a neighbour", f"the boundary's {len(body.faces)}", outer, outer == len(body.faces))
    error = abs(getfem.asm_generic(body.quadrature, 0, "1", -1) - volume) / volume
    answers.at_most("volume, relative error", 1e-12, error)
    patch_test(body, answers)
    displacements = hang(body, volume, answers)
    if picture:
        draw(picture, body, displacements)


if __name__ == "__main__":
    common.run(solve, __doc__, common.DATA / "piece.ply")
