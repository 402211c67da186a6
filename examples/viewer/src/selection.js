// SPDX-License-Identifier: BSL-1.0
// Which cells are shown, and the triangles of the faces that can be seen of them.
import { FACES } from "./mesh.js";

/** What is asked for. `normal` is null without a cut; else cells with normal . centre <= offset stay. */
export function selectCells(mesh, { normal, offset, peel, kinds, low, high, hiddenRegions }, shown) {
  const { centres, quality, layers, regions } = mesh;
  for (let c = 0; c < mesh.nCells; ++c)
    shown[c] =
      kinds[mesh.kinds[c]] && quality[c] >= low && quality[c] <= high && layers[c] >= peel &&
      (!normal || normal[0] * centres[3 * c] + normal[1] * centres[3 * c + 1] + normal[2] * centres[3 * c + 2] <= offset) &&
      !(hiddenRegions.size && hiddenRegions.has(regions[c]))
        ? 1 : 0;
}

/** Number and volume of the shown cells by kind. */
export function countShown(mesh, shown) {
  const count = { cells: [0, 0, 0, 0], volumes: [0, 0, 0, 0] };
  for (let c = 0; c < mesh.nCells; ++c)
    if (shown[c]) {
      ++count.cells[mesh.kinds[c]];
      count.volumes[mesh.kinds[c]] += mesh.volumes[c];
    }
  return count;
}

// Two triangles of a quadrilateral, and which of their sides, by the corner opposite, is its diagonal and not drawn.
const TRIANGLE = [[[0, 1, 2], 0]];
const QUADRILATERAL = [[[0, 1, 2], 2], [[0, 2, 3], 3]];

/** Triangles of the faces between a shown cell and nothing shown, in arrays that grow when they must and are used again. */
export class SeenFaces {
  nFaces = 0;
  nVertices = 0;
  positions = new Float32Array(0);
  colours = new Uint8Array(0);  // red, green, blue, and the undrawn side: 0 none, else the opposite corner + 1
  cells = new Uint32Array(0);   // of each seen face, and which of the cell's faces it is
  locals = new Uint8Array(0);

  /** @param colourOf  (cell, three bytes to set) */
  update(mesh, shown, colourOf) {
    this.find(mesh, shown);
    if (3 * this.nVertices > this.positions.length) {
      const capacity = Math.ceil(1.25 * this.nVertices);
      this.positions = new Float32Array(3 * capacity);
      this.colours = new Uint8Array(4 * capacity);
    }
    this.fill(mesh, colourOf);
  }

  find({ nCells, kinds, firstFace, neighbours }, shown) {
    if (!this.cells.length) {
      this.cells = new Uint32Array(neighbours.length);
      this.locals = new Uint8Array(neighbours.length);
    }
    let n = 0;
    this.nVertices = 0;
    for (let c = 0; c < nCells; ++c) {
      if (!shown[c]) continue;
      const first = firstFace[c], end = firstFace[c + 1];
      for (let f = first; f < end; ++f) {
        const other = neighbours[f];
        if (other >= 0 && shown[other]) continue;
        this.cells[n] = c;
        this.locals[n++] = f - first;
        this.nVertices += FACES[kinds[c]][f - first].length === 3 ? 3 : 6;
      }
    }
    this.nFaces = n;
  }

  fill({ points, kinds, corners, firstCorner }, colourOf) {
    const { positions, colours } = this, colour = [0, 0, 0];
    for (let i = 0, n = 0; i < this.nFaces; ++i) {
      const cell = this.cells[i], face = FACES[kinds[cell]][this.locals[i]], first = firstCorner[cell];
      colourOf(cell, colour);
      for (const [triangle, undrawn] of face.length === 3 ? TRIANGLE : QUADRILATERAL)
        for (const corner of triangle) {
          const v = 3 * corners[first + face[corner]];
          positions[3 * n] = points[v];
          positions[3 * n + 1] = points[v + 1];
          positions[3 * n + 2] = points[v + 2];
          colours[4 * n] = colour[0];
          colours[4 * n + 1] = colour[1];
          colours[4 * n + 2] = colour[2];
          colours[4 * n + 3] = undrawn;
          ++n;
        }
    }
  }
}
