#!/usr/bin/env python3
# SPDX-License-Identifier: BSL-1.0
"""What run.py keeps of a surface beside its results: how many triangles it has and the volume that they enclose.

    surfaces.py FILE        as JSON

A program of its own, as NumPy's memory would count as that of the programs that run.py measures.
"""
import json
import sys

import meshio


def describe(path):
    surface = meshio.read(path)
    n, volume = 0, 0.0
    for block in surface.cells:
        for i in range(1, block.data.shape[1] - 1):  # faces as fans
            a, b, c = (surface.points[block.data[:, k]].astype(float) for k in (0, i, i + 1))
            n += len(a)
            volume += float((a[:, 0] * (b[:, 1] * c[:, 2] - b[:, 2] * c[:, 1]) + a[:, 1] * (b[:, 2] * c[:, 0] - b[:, 0] * c[:, 2])
                             + a[:, 2] * (b[:, 0] * c[:, 1] - b[:, 1] * c[:, 0])).sum()) / 6
    if n == 0:
        raise ValueError("it has no triangles")
    return {"triangles": n, "volume": volume}


if __name__ == "__main__":
    try:
        print(json.dumps(describe(sys.argv[1])))
    except BaseException as failure:  # meshio ends the program for some files
        sys.exit(f"surfaces.py: {sys.argv[1]} cannot be read: {failure}")
