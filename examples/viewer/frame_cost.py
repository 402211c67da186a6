#!/usr/bin/env python3
# SPDX-License-Identifier: BSL-1.0
"""What a frame costs a page of many cells, as far as that can be told without its graphics card.

    frame_cost.py FRAMEHEX [N]      N^3 hexahedra; without N 100, a million cells

Calls that draw are counted and not made, and so are uploads: what remains is the script's own work, as CPU time of the
page's main thread. Frames are those of a moving cut (each with a new set of cells) and of turning (nothing but the camera
changes). How long a card takes for as many triangles and bytes is not measured.
"""
import json
import pathlib
import statistics
import subprocess
import sys
import tempfile

import numpy as np

from chromium import Page

COUNTING = """
window.counted = { triangles: 0, bytes: 0, draws: 0 };
const gl = WebGL2RenderingContext.prototype;
gl.drawArrays = function (mode, first, n) { ++counted.draws; if (mode === this.TRIANGLES) counted.triangles += n / 3; };
gl.drawElementsInstanced = gl.drawArraysInstanced = gl.drawElements = () => { ++counted.draws; };
gl.bufferSubData = function (target, offset, data, from, n) { counted.bytes += (n || data.length) * data.BYTES_PER_ELEMENT; };
gl.bufferData = function (target, data) { counted.bytes += data.byteLength ?? data; };
"""


def write_grid(path, n):
    """n^3 cubes, as a .vtu with its arrays as they lie in memory."""
    x = np.arange(n + 1, dtype=np.float64)
    points = np.stack(np.meshgrid(x, x, x, indexing="ij"), axis=-1).reshape(-1, 3)
    corner = (np.arange(n)[:, None, None] * (n + 1) + np.arange(n)[:, None]) * (n + 1) + np.arange(n)
    steps = [((i * (n + 1)) + j) * (n + 1) + k for i, j, k in
             [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]]
    cells = np.stack([corner.ravel() + step for step in steps], axis=1).astype(np.int64)
    arrays = [("Points", "Float64", 3, points), ("connectivity", "Int64", 1, cells),
              ("offsets", "Int64", 1, np.arange(8, 8 * n**3 + 1, 8)), ("types", "UInt8", 1, np.full(n**3, 12, np.uint8))]
    offset, tags, data = 0, {}, []
    for name, kind, components, values in arrays:
        tags[name] = f'<DataArray type="{kind}" Name="{name}" NumberOfComponents="{components}" format="appended" offset="{offset}"/>'
        data.append(np.uint64(values.nbytes).tobytes() + values.tobytes())
        offset += len(data[-1])
    with open(path, "wb") as file:
        file.write(f'<?xml version="1.0"?><VTKFile type="UnstructuredGrid" version="1.0" byte_order="LittleEndian" '
                   f'header_type="UInt64"><UnstructuredGrid><Piece NumberOfPoints="{len(points)}" NumberOfCells="{n**3}">'
                   f'<Points>{tags["Points"]}</Points><Cells>{tags["connectivity"]}{tags["offsets"]}{tags["types"]}</Cells>'
                   '</Piece></UnstructuredGrid><AppendedData encoding="raw">_'.encode() + b"".join(data)
                   + b"</AppendedData></VTKFile>")


def main_thread(page):
    """Seconds of the processor that scripts of the page have taken."""
    metrics = page.call("Performance.getMetrics")["metrics"]
    return next(m["value"] for m in metrics if m["name"] == "ScriptDuration")


def frames(page, changes):
    """Does one change after the other; what each frame took."""
    rows = []
    for change in changes:
        page.evaluate("Object.assign(counted, { triangles: 0, bytes: 0, draws: 0 })")
        before = main_thread(page)
        page.evaluate(change)
        page.settle()
        counted = page.evaluate("counted")
        rows.append({"ms": 1000 * (main_thread(page) - before), **counted})
    return rows


def tell(what, rows):
    most, middle = ({key: of(row[key] for row in rows) for key in rows[0]} for of in (max, statistics.median))
    print(f"{what}: {middle['ms']:.1f} ms of the script (at most {most['ms']:.1f}), {middle['triangles']:,.0f} triangles "
          f"(at most {most['triangles']:,.0f}), {middle['bytes'] / 1e6:.2f} MB uploaded (at most {most['bytes'] / 1e6:.2f})")


def main():
    program, n = sys.argv[1], int(sys.argv[2]) if len(sys.argv) > 2 else 100
    with tempfile.TemporaryDirectory() as name, Page(1280, 860, 600) as page:
        folder = pathlib.Path(name)
        write_grid(folder / "grid.vtu", n)
        subprocess.run([program, "view", folder / "grid.vtu", "-o", folder / "grid.html", "--quiet"], check=True)
        page.call("Performance.enable", timeDomain="threadTicks")
        page.call("Page.addScriptToEvaluateOnNewDocument", source=COUNTING)
        page.open(folder / "grid.html", "cut=x,0.505")
        print(f"{n**3:,} cells, page of {(folder / 'grid.html').stat().st_size / 1e6:.0f} MB: loaded in {main_thread(page):.1f} s "
              "of the script")
        move = "const at = document.getElementById('at'); at.value = {}; at.dispatchEvent(new Event('input'))"
        for axis in ("x", "view"):
            page.evaluate(f"{{{{ const cut = document.getElementById('cut'); cut.value = {json.dumps(axis)}; cut.onchange(); }}}}")
            page.settle()
            tell(f"cut across {axis}, a step of the plane", frames(page, [f"{{{move.format(i / 21)}}}" for i in range(1, 21)]))
        turn = "document.dispatchEvent(new KeyboardEvent('keydown', { key: 'ArrowLeft' }))"
        tell("turning", frames(page, [turn] * 20))


if __name__ == "__main__":
    main()
