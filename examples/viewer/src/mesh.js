// SPDX-License-Identifier: BSL-1.0
// The mesh as the page carries it, and what is derived from it once: volumes, centres, neighbours, layers.

export const KINDS = ["tetrahedron", "pyramid", "prism", "hexahedron"];
export const KIND_NAMES = ["tetrahedra", "pyramids", "prisms", "hexahedra"];
const N_CORNERS = [4, 5, 6, 8];

// Faces by local corners, anticlockwise seen from outside, in the library's numbering (geometry/cell_kinds.hpp).
export const FACES = [
  [[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]],
  [[0, 3, 2, 1], [0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]],
  [[0, 2, 1], [3, 4, 5], [0, 1, 4, 3], [1, 2, 5, 4], [2, 0, 3, 5]],
  [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]],
];

/** Bytes of a script element that holds base64; the element goes, so that the text is not kept twice. */
function takeBytes(id) {
  const element = document.getElementById(id);
  if (!element) return new Uint8Array(0);
  const text = atob(element.textContent);
  element.remove();
  const bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; ++i) bytes[i] = text.charCodeAt(i);
  return bytes;
}

const floats = (id) => new Float32Array(takeBytes(id).buffer);
const integers = (id) => new Uint32Array(takeBytes(id).buffer);

/** The mesh of the page. Coordinates are relative to `centre` and in units of `scale`, so that they fit the view. */
export function readMesh() {
  const info = JSON.parse(document.getElementById("framehex-info").textContent);
  const mesh = {
    ...info,
    points: floats("framehex-points"),
    kinds: takeBytes("framehex-kinds"),
    corners: integers("framehex-corners"),
    quality: floats("framehex-quality"),
    invalid: integers("framehex-invalid"),
    regions: integers("framehex-regions"),
    curves: integers("framehex-curves"),
    lines: floats("framehex-lines"),
    arrays: info.arrays.map((array, i) => ({ ...array, values: floats(`framehex-array-${i}`) })),
  };
  mesh.nCells = mesh.kinds.length;
  mesh.firstCorner = offsets(mesh.kinds, N_CORNERS);
  mesh.firstFace = offsets(mesh.kinds, FACES.map((faces) => faces.length));
  mesh.neighbours = findNeighbours(mesh);
  mesh.centres = cellCentres(mesh);
  mesh.volumes = cellVolumes(mesh);
  mesh.layers = cellLayers(mesh);
  for (const array of mesh.arrays)
    if (array.on === "points") array.values = meanOverCorners(mesh, array.values);
  return mesh;
}

function offsets(kinds, counts) {
  const first = new Uint32Array(kinds.length + 1);
  for (let c = 0; c < kinds.length; ++c) first[c + 1] = first[c] + counts[kinds[c]];
  return first;
}

/** By face of a cell: the cell on the other side, or -1. Faces match when they have the same vertices. */
function findNeighbours({ points, kinds, corners, nCells, firstCorner, firstFace }) {
  const nFaces = firstFace[nCells];
  // Sorted vertices of each face; a triangle's fourth is the greatest number.
  const keys = new Uint32Array(4 * nFaces);
  const cellOf = new Uint32Array(nFaces);
  const bucket = new Uint32Array(points.length / 3 + 1);
  const key = new Uint32Array(4);
  for (let c = 0, f = 0; c < nCells; ++c)
    for (const face of FACES[kinds[c]]) {
      for (let i = 0; i < 4; ++i) key[i] = i < face.length ? corners[firstCorner[c] + face[i]] : 0xffffffff;
      key.sort();
      keys.set(key, 4 * f);
      cellOf[f++] = c;
      ++bucket[key[0] + 1];
    }
  for (let v = 1; v < bucket.length; ++v) bucket[v] += bucket[v - 1];
  const end = bucket.slice();
  const inBucket = new Uint32Array(nFaces);  // faces that wait for their other side, by least vertex
  const neighbours = new Int32Array(nFaces).fill(-1);
  for (let f = 0; f < nFaces; ++f) {
    const v = keys[4 * f];
    let i = bucket[v];
    while (i < end[v] && !sameKey(keys, f, inBucket[i])) ++i;
    if (i < end[v]) {
      const other = inBucket[i];
      neighbours[f] = cellOf[other];
      neighbours[other] = cellOf[f];
      inBucket[i] = inBucket[--end[v]];
    } else {
      inBucket[end[v]++] = f;
    }
  }
  return neighbours;
}

const sameKey = (keys, f, g) =>
  keys[4 * f + 1] === keys[4 * g + 1] && keys[4 * f + 2] === keys[4 * g + 2] && keys[4 * f + 3] === keys[4 * g + 3];

function cellCentres({ points, corners, nCells, firstCorner }) {
  const centres = new Float32Array(3 * nCells);
  for (let c = 0; c < nCells; ++c) {
    const n = firstCorner[c + 1] - firstCorner[c];
    for (let k = 0; k < 3; ++k) {
      let sum = 0;
      for (let i = firstCorner[c]; i < firstCorner[c + 1]; ++i) sum += points[3 * corners[i] + k];
      centres[3 * c + k] = sum / n;
    }
  }
  return centres;
}

function determinant(p, o, a, b, c) {
  const x = p[3 * o], y = p[3 * o + 1], z = p[3 * o + 2];
  const ax = p[3 * a] - x, ay = p[3 * a + 1] - y, az = p[3 * a + 2] - z;
  const bx = p[3 * b] - x, by = p[3 * b + 1] - y, bz = p[3 * b + 2] - z;
  const cx = p[3 * c] - x, cy = p[3 * c + 1] - y, cz = p[3 * c + 2] - z;
  return ax * (by * cz - bz * cy) + ay * (bz * cx - bx * cz) + az * (bx * cy - by * cx);
}

/** Volumes inside the faces, quadrilaterals taken as bilinear: the mean over their two diagonals. */
function cellVolumes({ points, kinds, corners, nCells, firstCorner }) {
  const volumes = new Float32Array(nCells);
  for (let c = 0; c < nCells; ++c) {
    const first = firstCorner[c], origin = corners[first];
    let sixfold = 0;
    for (const face of FACES[kinds[c]]) {
      const a = corners[first + face[0]], b = corners[first + face[1]], d = corners[first + face[2]];
      if (face.length === 3) {
        sixfold += determinant(points, origin, a, b, d);
        continue;
      }
      const e = corners[first + face[3]];
      sixfold += (determinant(points, origin, a, b, d) + determinant(points, origin, a, d, e) +
                  determinant(points, origin, a, b, e) + determinant(points, origin, b, d, e)) / 2;
    }
    volumes[c] = sixfold / 6;
  }
  return volumes;
}

/** Layers of cells from the boundary inward by common faces: 0 at the boundary. */
function cellLayers({ nCells, firstFace, neighbours }) {
  const layers = new Int32Array(nCells).fill(-1);
  const queue = new Uint32Array(nCells);
  let n = 0;
  for (let c = 0; c < nCells; ++c)
    for (let f = firstFace[c]; f < firstFace[c + 1]; ++f)
      if (neighbours[f] < 0 && layers[c] < 0) {
        layers[c] = 0;
        queue[n++] = c;
      }
  for (let i = 0; i < n; ++i)
    for (let f = firstFace[queue[i]]; f < firstFace[queue[i] + 1]; ++f) {
      const other = neighbours[f];
      if (other >= 0 && layers[other] < 0) {
        layers[other] = layers[queue[i]] + 1;
        queue[n++] = other;
      }
    }
  return layers;
}

function meanOverCorners({ corners, nCells, firstCorner }, values) {
  const means = new Float32Array(nCells);
  for (let c = 0; c < nCells; ++c) {
    for (let i = firstCorner[c]; i < firstCorner[c + 1]; ++i) means[c] += values[corners[i]];
    means[c] /= firstCorner[c + 1] - firstCorner[c];
  }
  return means;
}

/** Numbers of the `n` cells of least quality, the worst first. */
export function worstCells({ quality, nCells }, n) {
  const worst = [];
  for (let c = 0; c < nCells; ++c) {
    if (worst.length === n && !(quality[c] < quality[worst[n - 1]])) continue;
    let i = worst.length;
    while (i > 0 && quality[worst[i - 1]] > quality[c]) --i;
    worst.splice(i, 0, c);
    if (worst.length > n) worst.pop();
  }
  return worst;
}
