// SPDX-License-Identifier: BSL-1.0
// Colours of cells, and of what explains them.

/** In the order of the kinds: tetrahedra yellow, pyramids green, prisms red, hexahedra grey. */
export const KIND_COLOURS = [[245, 208, 66], [96, 178, 96], [214, 69, 61], [202, 206, 212]];

// Colours that stay apart for most kinds of colour blindness (after Okabe and Ito), then repeated.
const CATEGORIES = [[86, 180, 233], [230, 159, 0], [0, 158, 115], [240, 228, 66], [0, 114, 178], [213, 94, 0],
                    [204, 121, 167], [150, 150, 150]];

// From low to high: dark blue, teal, yellow. Lightness rises evenly.
const SCALE = [[68, 1, 84], [65, 68, 135], [42, 120, 142], [34, 168, 132], [122, 209, 81], [253, 231, 37]];
const UNKNOWN = [128, 128, 128];

export function scaleColour(t, out) {
  if (!(t >= 0 || t < 0)) return set(out, UNKNOWN);
  const x = Math.min(Math.max(t, 0), 1) * (SCALE.length - 1), i = Math.min(Math.floor(x), SCALE.length - 2), w = x - i;
  for (let k = 0; k < 3; ++k) out[k] = SCALE[i][k] * (1 - w) + SCALE[i + 1][k] * w;
}

export function set(out, colour) {
  out[0] = colour[0];
  out[1] = colour[1];
  out[2] = colour[2];
}

export const categoryColour = (i) => CATEGORIES[i % CATEGORIES.length];
export const css = (colour) => `rgb(${colour.map(Math.round).join(" ")})`;
export const scaleCss = () => `linear-gradient(to right, ${SCALE.map(css).join(", ")})`;
