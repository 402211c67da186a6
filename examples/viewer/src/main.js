// SPDX-License-Identifier: BSL-1.0
// The page: reads the mesh, keeps what is asked for, and brings picture and numbers up to date with it.
import { readMesh } from "./mesh.js";
import { SeenFaces, countShown, selectCells } from "./selection.js";
import { KIND_COLOURS, categoryColour, scaleColour, set } from "./colours.js";
import { Picture } from "./scene.js";
import { Panel } from "./panel.js";
import { listenToKeys, listenToDragging } from "./input.js";

const AXES = { x: [1, 0, 0], y: [0, 1, 0], z: [0, 0, 1] };
const ADDRESS_NAMES = ["view", "cut", "peel", "colour", "range", "lines", "curves", "theme", "panel"];
const OWN_COLOURS = ["kind", "region", "quality"];
const OWN_NAMES = [...OWN_COLOURS, "scaled jacobian"];

class Viewer {
  constructor() {
    this.mesh = readMesh();
    this.shown = new Uint8Array(this.mesh.nCells);
    this.seen = new SeenFaces();
    const [least, greatest] = extremes(this.mesh.quality);
    this.labels = [...new Set(this.mesh.regions)].sort((a, b) => a - b);
    this.state = {
      cut: "none", at: 0.5, flip: false, viewNormal: null, peel: 0, colour: "kind",
      kinds: [true, true, true, true], low: least, high: greatest, hiddenRegions: new Set(), dragCuts: false,
    };
    this.scales = this.colourScales(least);
    this.remarks = [];
    this.picture = new Picture(document.getElementById("picture"));
    this.picture.addCurves(this.mesh);
    this.picture.addLines(this.mesh);
    this.panel = new Panel(this);
    listenToKeys(this);
    listenToDragging(this);
    this.readAddress();
    this.panel.showRemarks(this.remarks);
    this.panel.showState();
    this.update();
  }

  /** Values and ends of what cells can be coloured by beside their kind and region. */
  colourScales(least) {
    const scales = { quality: { name: "Scaled Jacobian", values: this.mesh.quality, low: Math.min(least, 0), high: 1 } };
    this.mesh.arrays.forEach(({ name, values }, i) => {
      let [low, high] = extremes(values);
      // Smoothness has the same ends in every mesh, so that pictures of several can be compared; other things of its name not.
      if (name === "smoothness" && low >= 0 && high <= 1) [low, high] = [0, 1];
      const taken = OWN_NAMES.includes(name.toLowerCase().replaceAll("_", " "));
      scales[`array-${i}`] = { name: taken ? `${name} (array)` : name, values, low, high };
    });
    return scales;
  }

  /** The cutting plane: cells whose centre has normal . centre <= offset stay. */
  plane() {
    const { cut, at, flip, viewNormal } = this.state;
    if (cut === "none") return { normal: null, offset: 0 };
    const direction = cut === "view" ? viewNormal : AXES[cut];
    const [low, high] = this.extent(direction);
    const offset = low + at * (high - low);
    return flip ? { normal: direction.map((x) => -x), offset: -offset } : { normal: direction, offset };
  }

  /** Least and greatest distance of the mesh's points along a direction. */
  extent(direction) {
    const { points } = this.mesh;
    if (this.extentOf === direction.join()) return this.knownExtent;
    let low = Infinity, high = -Infinity;
    for (let i = 0; i < points.length; i += 3) {
      const d = direction[0] * points[i] + direction[1] * points[i + 1] + direction[2] * points[i + 2];
      if (d < low) low = d;
      if (d > high) high = d;
    }
    this.extentOf = direction.join();
    return (this.knownExtent = [low, high]);
  }

  /** Cuts across "x", "y", "z", the "view" or "none", so that the eye looks at the cut. */
  cutAcross(cut) {
    const towards = this.picture.towardsEye().toArray();
    this.change({ cut, flip: Object.hasOwn(AXES, cut) && towards["xyz".indexOf(cut)] < 0 });
  }

  /** Changes what is asked for and shows it, once a frame however often it changes. */
  change(changes) {
    Object.assign(this.state, changes);
    if (changes.cut === "view") this.state.viewNormal = this.picture.towardsEye().toArray();
    this.panel.showState();
    if (this.pending) return;
    this.pending = true;
    requestAnimationFrame(() => this.update());
  }

  update() {
    this.pending = false;
    selectCells(this.mesh, { ...this.state, ...this.plane() }, this.shown);
    this.seen.update(this.mesh, this.shown, this.colourOf());
    this.picture.setFaces(this.seen);
    this.picture.clipLines(this.plane());
    this.panel.showCounts(countShown(this.mesh, this.shown), this.seen.nFaces);
  }

  colourOf() {
    const { mesh, labels } = this, { colour } = this.state, scale = this.scales[colour];
    if (scale) {
      const factor = scale.high > scale.low ? 1 / (scale.high - scale.low) : 0;
      return (cell, out) => scaleColour((scale.values[cell] - scale.low) * factor, out);
    }
    if (colour === "region") {
      const rank = new Map(labels.map((label, i) => [label, i]));
      return (cell, out) => set(out, categoryColour(rank.get(mesh.regions[cell])));
    }
    return (cell, out) => set(out, KIND_COLOURS[mesh.kinds[cell]]);
  }

  /** Brings the camera to a cell, with everything between it and the eye cut away. */
  visit(cell) {
    const centre = Array.from(this.mesh.centres.subarray(3 * cell, 3 * cell + 3));
    const normal = this.picture.towardsEye().toArray(), [low, high] = this.extent(normal);
    const depth = normal[0] * centre[0] + normal[1] * centre[1] + normal[2] * centre[2];
    this.change({ cut: "view", flip: false, at: (depth + 1e-6 - low) / (high - low) });
    this.picture.pointOut(this.mesh, cell);
    this.picture.flyTo(centre, Math.cbrt(Math.abs(this.mesh.volumes[cell])) || 0.01);
  }

  reset() {
    const { low, high } = this.panel.qualityEnds;
    this.picture.pointOut(this.mesh, null);
    this.picture.look(-55, 25, 1);
    this.change({ cut: "none", at: 0.5, flip: false, peel: 0, colour: "kind", kinds: [true, true, true, true], low, high,
                  hiddenRegions: new Set() });
  }

  /**
   * What the address asks for after `#`: view=AZIMUTH,ELEVATION[,ZOOM] cut=x,0.5[,flip] peel= colour= range=LOW,HIGH lines=
   * curves= theme= panel=. What cannot be done is left out, with a remark.
   */
  readAddress() {
    const asked = new Map();
    for (const [name, text] of new URLSearchParams(location.hash.slice(1))) {
      if (!ADDRESS_NAMES.includes(name)) this.remark(name, text, "nothing is called so");
      else if (asked.has(name)) this.remark(name, text, "only the first of its name is followed");
      else asked.set(name, text);
    }
    for (const name of ADDRESS_NAMES) {  // in this order: a range is that of the colour
      const why = asked.has(name) && this.follow(name, asked.get(name));
      if (why) this.remark(name, asked.get(name), why);
    }
  }

  remark(name, text, why) {
    this.remarks.push(`${name}=${text}: ${why}`);
  }

  /** Does what one name of the address asks for; else says why it cannot be done. */
  follow(name, text) {
    const words = text.split(","), numbers = words.map((word) => (word.trim() ? Number(word) : NaN));
    switch (name) {
      case "view": return this.followView(numbers);
      case "cut": return this.followCut(words, numbers);
      case "peel": return this.followPeel(numbers);
      case "colour": return this.followColour(text);
      case "range": return this.followRange(numbers);
      case "theme": return this.panel.setTheme(text) ? null : "themes are light, dark and auto";
      case "panel": return this.followSwitch(text, (on) => on || this.panel.toggle());
      default: return this.followLines(name, text);
    }
  }

  followView([azimuth, elevation, zoom = 1, ...more]) {
    if (more.length || ![azimuth, elevation, zoom].every(Number.isFinite) || !(zoom > 0))
      return "two angles in degrees and, if wanted, a zoom above 0 should stand here";
    this.picture.look(azimuth, elevation, zoom);
  }

  followCut([cut, , flip, ...more], [, at = 0.5]) {
    if (cut !== "view" && !Object.hasOwn(AXES, cut)) return "cuts are across x, y, z or view";
    if (!(at >= 0 && at <= 1)) return "a place from 0 to 1 should follow the axis";
    if (more.length || (flip !== undefined && flip !== "flip")) return "only flip can follow the place";
    Object.assign(this.state, { cut, at, flip: flip === "flip", viewNormal: this.picture.towardsEye().toArray() });
  }

  followPeel([peel, ...more]) {
    const most = this.panel.mostLayers;
    if (more.length || !Number.isInteger(peel) || peel < 0) return "a number of layers should stand here";
    this.state.peel = Math.min(peel, most);
    if (peel > most) return `there are only ${most} layers to peel`;
  }

  followColour(wanted) {
    const known = this.panel.colours(), own = OWN_COLOURS.includes(wanted) && known.includes(wanted);
    const colour = own ? wanted : Object.keys(this.scales).find((key) => this.scales[key].name === wanted);
    if (!colour) return "there is no such array";
    this.state.colour = colour;
  }

  followRange([low, high, ...more]) {
    const scale = this.scales[this.state.colour];
    if (!scale) return "what is coloured by has no range";
    if (more.length || !(low < high && Number.isFinite(high - low))) return "two numbers should stand here, the lower first";
    Object.assign(scale, { low, high });
  }

  followLines(which, text) {
    if (text === "1" && !this.mesh[which].length) return "there are none on this page";
    return this.followSwitch(text, (on) => this.panel.setLines(which, on));
  }

  followSwitch(text, turn) {
    if (text !== "0" && text !== "1") return "0 or 1 should stand here";
    turn(text === "1");
  }
}

function extremes(values) {
  let low = Infinity, high = -Infinity;
  for (const x of values) {
    if (x < low && x > -Infinity) low = x;
    if (x > high && x < Infinity) high = x;
  }
  return low <= high ? [low, high] : [0, 0];
}

/** An error on the page rather than an empty picture. */
try {
  new Viewer();
} catch (error) {
  document.getElementById("failure").hidden = false;
  document.getElementById("failure").textContent = `This mesh cannot be shown: ${error.message}`;
  throw error;
}
