// SPDX-License-Identifier: BSL-1.0
// The panel beside the picture: controls, counts, histogram, worst cells.
import { KINDS, KIND_NAMES, worstCells } from "./mesh.js";
import { KIND_COLOURS, categoryColour, css, scaleCss } from "./colours.js";

const N_WORST = 20;
const THEMES = ["auto", "light", "dark"];
const ORDER = [3, 2, 1, 0];  // kinds from the hexahedra down, as everyone lists them

const $ = (id) => document.getElementById(id);
const number = (n) => n.toLocaleString("en-US");
const counted = (n, noun) => `${number(n)} ${noun}${n === 1 ? "" : "s"}`;
const percent = (part, whole) => (whole > 0 ? `${(100 * part / whole).toFixed(1)} %` : "–");

function element(tag, attributes = {}, ...children) {
  const node = Object.assign(document.createElement(tag), attributes);
  node.append(...children);
  return node;
}

const swatch = (colour) => {
  const node = element("span", { className: "swatch" });
  node.style.background = css(colour);
  return node;
};

const bar = (share, colour) => {
  const node = element("span", { className: "bar" });
  node.style.width = `${100 * (share > 0 ? Math.min(share, 1) : 0)}%`;  // none where there is nothing to share
  if (colour) node.style.background = css(colour);
  return node;
};

export class Panel {
  constructor(viewer) {
    this.viewer = viewer;
    const { mesh } = viewer;
    this.qualityEnds = { low: viewer.state.low, high: viewer.state.high };
    this.mostLayers = mesh.layers.reduce((most, layer) => Math.max(most, layer), 0);
    document.title = `${mesh.title} – framehex`;
    $("title").textContent = mesh.title;
    this.makeColours();
    this.makeKinds();
    this.makeRegions();
    this.makeHistogram();
    this.makeWorst();
    $("peel").max = this.mostLayers;
    this.listen();
    this.setTheme("auto");
  }

  makeColours() {
    const { viewer } = this, options = [["kind", "Kind"]];
    if (viewer.labels.length > 1) options.push(["region", "Region"]);
    for (const [key, { name }] of Object.entries(viewer.scales)) options.push([key, capital(name)]);
    $("colour").append(...options.map(([value, text]) => element("option", { value }, text)));
  }

  makeKinds() {
    for (const kind of ORDER) {
      const box = element("input", { type: "checkbox", id: `kind-${KINDS[kind]}` });
      box.onchange = () => {
        const kinds = [...this.viewer.state.kinds];
        kinds[kind] = box.checked;
        this.viewer.change({ kinds });
      };
      $("counts").append(element("tr", {},
        element("th", { scope: "row" }, element("label", {}, box, " ", swatch(KIND_COLOURS[kind]), " ", capital(KIND_NAMES[kind]))),
        ...["shown", "total", "number", "volume"].map((what) => element("td", { id: `${what}-${KINDS[kind]}` }))));
    }
    const { mesh } = this.viewer, n = [0, 0, 0, 0], volume = [0, 0, 0, 0];
    for (let c = 0; c < mesh.nCells; ++c) {
      ++n[mesh.kinds[c]];
      volume[mesh.kinds[c]] += mesh.volumes[c];
    }
    const sum = (values) => values.reduce((a, b) => a + b, 0);
    for (const kind of ORDER) {
      $(`total-${KINDS[kind]}`).textContent = number(n[kind]);
      for (const [what, values] of [["number", n], ["volume", volume]])
        $(`${what}-${KINDS[kind]}`).append(percent(values[kind], sum(values)), bar(values[kind] / sum(values), KIND_COLOURS[kind]));
    }
    $("total-cells").textContent = number(mesh.nCells);
  }

  makeRegions() {
    const { labels, mesh } = this.viewer;
    if (labels.length < 2) return;
    $("regions-part").hidden = false;
    const count = new Map(labels.map((label) => [label, 0]));
    for (const label of mesh.regions) count.set(label, count.get(label) + 1);
    labels.forEach((label, i) => {
      const box = element("input", { type: "checkbox", checked: true });
      box.dataset.label = label;
      box.onchange = () => {
        const hiddenRegions = new Set(this.viewer.state.hiddenRegions);
        box.checked ? hiddenRegions.delete(label) : hiddenRegions.add(label);
        this.viewer.change({ hiddenRegions });
      };
      $("regions").append(element("li", {}, element("label", {}, box, " ", swatch(categoryColour(i)), " ",
        `${mesh.names[label] ?? `region ${label}`}: ${counted(count.get(label), "cell")}`)));
    });
  }

  makeHistogram() {
    const { quality } = this.viewer.mesh, bins = Array.from({ length: 11 }, () => 0);  // the first: below 0
    let least = 1, sum = 0;
    for (const q of quality) {
      ++bins[q < 0 ? 0 : 1 + Math.min(Math.floor(10 * q), 9)];
      least = Math.min(least, q);
      sum += q;
    }
    const most = Math.max(...bins);
    bins.forEach((n, i) => {
      if (i === 0 && n === 0) return;
      const range = i === 0 ? "below 0" : `${((i - 1) / 10).toFixed(1)} – ${(i / 10).toFixed(1)}`;
      $("histogram").append(element("tr", {}, element("th", { scope: "row" }, range),
        element("td", {}, bar(n / most)), element("td", {}, number(n))));
    });
    $("quality-summary").textContent = quality.length
      ? `least ${least.toFixed(3)}, mean ${(sum / quality.length).toFixed(3)}` : "no cells";
    this.showInvalid();
  }

  /** Cells whose Jacobian is zero or negative somewhere. */
  showInvalid() {
    const { invalid } = this.viewer.mesh, n = invalid.length;
    $("invalid-text").hidden = n === 0;
    $("invalid-text").textContent = `${counted(n, "cell")} ${n === 1 ? "is" : "are"} invalid (flat or inside out somewhere): ` +
      [...invalid.subarray(0, N_WORST)].join(", ") + (n > N_WORST ? " ..." : "");
  }

  colours() {
    return [...$("colour").options].map((option) => option.value);
  }

  /** What the address asks for and cannot be done. */
  showRemarks(remarks) {
    $("remarks").hidden = !remarks.length;
    $("remarks").textContent = remarks.join("\n");
  }

  makeWorst() {
    const { mesh } = this.viewer;
    for (const cell of worstCells(mesh, N_WORST)) {
      const button = element("button", { type: "button" }, `${mesh.quality[cell].toFixed(3)}  ${KINDS[mesh.kinds[cell]]} ${cell}`);
      button.onclick = () => this.viewer.visit(cell);
      $("worst").append(element("li", {}, button));
    }
  }

  listen() {
    const { viewer } = this, { picture } = viewer;
    $("cut").onchange = () => viewer.cutAcross($("cut").value);
    $("at").oninput = () => viewer.change({ at: Number($("at").value) });
    $("flip").onchange = () => viewer.change({ flip: $("flip").checked });
    $("drag").onchange = () => viewer.change({ dragCuts: $("drag").checked });
    $("peel").oninput = () => viewer.change({ peel: Number($("peel").value) });
    $("colour").onchange = () => viewer.change({ colour: $("colour").value });
    for (const end of ["low", "high"]) {
      // A slider at its end means the end itself, which rounding to its steps would miss.
      $(end).oninput = () => viewer.change({ [end]: this.fromSlider(end, Number($(end).value)) });
    }
    $("edges").onchange = () => picture.setEdges($("edges").checked);
    for (const which of ["curves", "lines"]) {
      $(`${which}-row`).hidden = !viewer.mesh[which].length;
      $(which).onchange = () => picture.showLines(which, $(which).checked);
    }
    $("reset").onclick = () => viewer.reset();
    $("theme").onclick = () => this.setTheme(THEMES[(THEMES.indexOf(this.theme) + 1) % THEMES.length]);
    $("hide").onclick = () => this.toggle();
    $("show").onclick = () => this.toggle();
    $("help-button").onclick = () => this.toggleHelp();
    window.matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.paintBackground());
  }

  fromSlider(end, value) {
    const { low, high } = this.qualityEnds;
    if (end === "low" && value <= 0) return low;
    if (end === "high" && value >= 1) return high;
    return low + value * (high - low);
  }

  toSlider(value) {
    const { low, high } = this.qualityEnds;
    return high > low ? (value - low) / (high - low) : 0;
  }

  /** Controls say what is asked for, whoever changed it. */
  showState() {
    const { state, labels, scales, mesh } = this.viewer;
    $("cut").value = state.cut;
    $("at").value = state.at;
    $("at").disabled = $("flip").disabled = state.cut === "none";
    $("flip").checked = state.flip;
    $("drag").checked = state.dragCuts;
    $("peel").value = state.peel;
    $("peel-value").textContent = counted(state.peel, "layer");
    $("colour").value = state.colour;
    for (const end of ["low", "high"]) {
      $(end).value = this.toSlider(state[end]);
      $(`${end}-value`).textContent = state[end].toFixed(3);
    }
    KINDS.forEach((kind, i) => ($(`kind-${kind}`).checked = state.kinds[i]));
    for (const box of $("regions").querySelectorAll("input"))
      box.checked = !state.hiddenRegions.has(Number(box.dataset.label));
    $("at-value").textContent = this.planeText();
    const scale = scales[state.colour];
    $("legend").hidden = !scale;
    if (scale) {
      $("scale-name").textContent = capital(scale.name);
      $("scale").style.background = scaleCss();
      for (const end of ["low", "high"]) $(`scale-${end}`).textContent = String(Number(scale[end].toPrecision(3)));
    }
    document.body.classList.toggle("drag-cuts", state.dragCuts);
  }

  planeText() {
    const { state, mesh } = this.viewer;
    if (state.cut === "none") return "";
    const { offset } = this.viewer.plane(), at = state.flip ? -offset : offset;
    if (state.cut === "view") return `at ${Number((at * mesh.scale).toPrecision(4))} from the middle`;
    const place = mesh.centre["xyz".indexOf(state.cut)] + at * mesh.scale;
    return `${state.cut} = ${Math.abs(place) < 1e-7 * mesh.scale ? 0 : Number(place.toPrecision(5))}`;  // single precision
  }

  showCounts({ cells, volumes }, nFaces) {
    KINDS.forEach((kind, i) => ($(`shown-${kind}`).textContent = number(cells[i])));
    const n = cells.reduce((a, b) => a + b, 0), volume = volumes.reduce((a, b) => a + b, 0);
    $("shown-cells").textContent = number(n);
    $("shown-text").textContent =
      `${counted(n, "cell")} shown, ${percent(cells[3], n)} of them hexahedra (${percent(volumes[3], volume)} by volume), ` +
      `${counted(nFaces, "face")} seen`;
  }

  setLines(which, on) {
    $(which).checked = on;
    this.viewer.picture.showLines(which, on);
  }

  /** @returns  whether there is such a theme; else nothing changes. */
  setTheme(theme) {
    if (!THEMES.includes(theme)) return false;
    this.theme = theme;
    document.documentElement.dataset.theme = this.theme;
    $("theme").textContent = `Theme: ${this.theme}`;
    this.paintBackground();
    return true;
  }

  paintBackground() {
    this.viewer.picture.setBackground(getComputedStyle(document.body).backgroundColor);
  }

  toggle() {
    const hidden = document.body.classList.toggle("panel-hidden");
    $("show").hidden = !hidden;
    (hidden ? $("show") : $("hide")).focus();
  }

  toggleHelp() {
    const help = $("help");
    help.open ? help.close() : help.showModal();
  }
}

const capital = (name) => (name ? name[0].toUpperCase() + name.slice(1).replaceAll("_", " ") : "(no name)");
