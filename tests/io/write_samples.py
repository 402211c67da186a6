#!/usr/bin/env python3
# SPDX-License-Identifier: BSL-1.0
"""Writes one mesh, a cell of each kind, in every format and encoding that meshio knows of ours: write_samples.py FOLDER"""
import pathlib
import sys

import meshio
import numpy as np

points = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1), (2, 0, 0),
          (2, 0, 1), (0, 0, 2), (-1, 0, 1)]
cells = [("line", [(0, 1), (1, 8)]), ("triangle", [(1, 2, 8), (5, 9, 6)]), ("quad", [(0, 3, 2, 1)]),
         ("hexahedron", [(0, 1, 2, 3, 4, 5, 6, 7)]), ("wedge", [(1, 8, 2, 5, 9, 6)]), ("pyramid", [(4, 5, 6, 7, 10)]),
         ("tetra", [(4, 10, 7, 11)])]
labels = [[0, 4], [0, 3], [0], [0], [0], [2], [1]]

folder = pathlib.Path(sys.argv[1])
mesh = meshio.Mesh(np.array(points, float), cells)
mesh.cell_data["label"] = [np.array(x) for x in labels]
meshio.vtu.write(folder / "ascii.vtu", mesh, binary=False)
meshio.vtu.write(folder / "raw.vtu", mesh, binary=True, compression=None)
meshio.vtu.write(folder / "zlib.vtu", mesh, binary=True, compression="zlib")
meshio.vtu.write(folder / "wide.vtu", mesh, binary=True, compression="zlib", header_type="UInt64")
meshio.vtu.write(folder / "lzma.vtu", mesh, binary=True, compression="lzma")
meshio.vtk.write(folder / "binary51.vtk", mesh, binary=True)
meshio.vtk.write(folder / "ascii51.vtk", mesh, binary=False)
meshio.write(folder / "binary42.vtk", mesh, file_format="vtk42", binary=True)
meshio.write(folder / "ascii42.vtk", mesh, file_format="vtk42", binary=False)
numbered = [np.array(x) + 1 for x in labels]
mesh.cell_data = {"medit:ref": numbered}
meshio.medit.write(folder / "text.mesh", mesh)
meshio.medit.write(folder / "binary.meshb", mesh)
mesh.cell_data = {"gmsh:physical": numbered, "gmsh:geometrical": numbered}
meshio.write(folder / "binary22.msh", mesh, file_format="gmsh22", binary=True)
meshio.write(folder / "ascii22.msh", mesh, file_format="gmsh22", binary=False)
# For 4.1 meshio wants an entity for each block, and one of its points for each entity.
blocks = [(kind, [row], label[i]) for (kind, rows), label in zip(cells, labels) for i, row in enumerate(rows)]
dimension = {"line": 1, "triangle": 2, "quad": 2}
entities = [(dimension.get(kind, 3), k + 1) for k, (kind, _, _) in enumerate(blocks)]
mesh = meshio.Mesh(np.array(points, float), [(kind, rows) for kind, rows, _ in blocks])
mesh.cell_data = {"gmsh:physical": [np.array([label + 1]) for _, _, label in blocks],
                  "gmsh:geometrical": [np.array([k + 1]) for k in range(len(blocks))]}
mesh.point_data["gmsh:dim_tags"] = np.array(entities + [entities[-1]] * (len(points) - len(entities)))
meshio.write(folder / "binary41.msh", mesh, file_format="gmsh", binary=True)
meshio.write(folder / "ascii41.msh", mesh, file_format="gmsh", binary=False)
