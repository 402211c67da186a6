// SPDX-License-Identifier: BSL-1.0
// The picture: cells with their edges, lines, the cell that is pointed out, and the camera.
import {
  BufferAttribute, BufferGeometry, Color, DoubleSide, GLSL3, LineSegments, LineBasicMaterial, Mesh, MeshBasicMaterial,
  PerspectiveCamera, Plane, Scene, ShaderMaterial, Vector3, WebGLRenderer,
} from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import { LineMaterial } from "three/addons/lines/LineMaterial.js";
import { LineSegments2 } from "three/addons/lines/LineSegments2.js";
import { LineSegmentsGeometry } from "three/addons/lines/LineSegmentsGeometry.js";
import { FACES } from "./mesh.js";

// Flat light from the eye and from above. Edges are where a barycentric coordinate is small; the diagonal of a
// quadrilateral is none.
const VERTEX = `
in vec4 colour;
out vec3 vColour, vBarycentric, vView;
void main() {
  vColour = colour.rgb;
  int corner = gl_VertexID % 3, undrawn = int(colour.a * 255.0 + 0.5);
  vBarycentric = vec3(corner == 0, corner == 1, corner == 2);
  if (undrawn > 0) vBarycentric[undrawn - 1] = 1.0;
  vec4 view = modelViewMatrix * vec4(position, 1.0);
  vView = view.xyz;
  gl_Position = projectionMatrix * view;
}`;
const FRAGMENT = `
in vec3 vColour, vBarycentric, vView;
out vec4 fragment;
uniform float edges;
uniform vec3 edgeColour;
void main() {
  vec3 normal = normalize(cross(dFdx(vView), dFdy(vView)));
  float light = 0.62 + 0.25 * abs(dot(normal, normalize(vView))) + 0.15 * abs(dot(normal, vec3(0.2, 0.95, 0.25)));
  vec3 width = max(fwidth(vBarycentric), 1e-5);  // constant along a diagonal
  vec3 near = smoothstep(vec3(0.0), 1.2 * width, vBarycentric);
  // Where cells are smaller than a few pixels their edges would cover everything.
  float fine = smoothstep(0.15, 0.5, max(max(width.x, width.y), width.z));
  float edge = edges * (1.0 - min(min(near.x, near.y), near.z)) * (1.0 - 0.8 * fine);
  fragment = vec4(mix(vColour * light, edgeColour, 0.85 * edge), 1.0);
}`;

const REACH = 3.4;  // distance of the camera at the start in a picture at least as wide as high; the mesh is 2 wide
const MOST_REACH = 20;
const ANGLE = 35;  // of view from below to above, in degrees
const HALF_ANGLE = ANGLE / 2 * Math.PI / 180;

/** How much further off the camera must be where the picture is narrower than high, so that a ball is seen whole. */
const narrowness = (aspect) =>
  aspect >= 1 ? 1 : Math.sin(HALF_ANGLE) / Math.sin(Math.atan(aspect * Math.tan(HALF_ANGLE)));

export class Picture {
  constructor(canvas) {
    this.canvas = canvas;
    this.renderer = new WebGLRenderer({ canvas, antialias: true });
    this.renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2));
    this.renderer.localClippingEnabled = true;
    this.scene = new Scene();
    this.camera = new PerspectiveCamera(ANGLE, 1, 1e-4, 100);
    this.camera.up.set(0, 0, 1);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.zoomToCursor = true;
    this.controls.minDistance = 1e-3;
    this.controls.maxDistance = MOST_REACH;
    this.controls.addEventListener("change", () => this.redraw());

    const uniforms = { edges: { value: 1 }, edgeColour: { value: new Color(0x16181c) } };
    this.material = new ShaderMaterial({
      vertexShader: VERTEX, fragmentShader: FRAGMENT, glslVersion: GLSL3, side: DoubleSide, uniforms });
    this.cells = new Mesh(new BufferGeometry(), this.material);
    this.cells.frustumCulled = false;
    this.scene.add(this.cells);
    this.pointed = null;
    this.pending = false;
    this.look(-55, 25, 1);
    new ResizeObserver(() => this.resize()).observe(canvas);
    this.resize();
  }

  resize() {
    const { clientWidth, clientHeight } = this.canvas;
    if (!clientWidth || !clientHeight) return;
    this.renderer.setSize(clientWidth, clientHeight, false);
    this.setAspect(clientWidth / clientHeight);
    for (const lines of [this.curves, this.lines]) lines?.material.resolution.set(clientWidth, clientHeight);
    this.draw();  // at once: the new size has cleared the picture, which would be blank until the next frame
  }

  /** What is seen stays whole when the picture becomes narrower than high. */
  setAspect(aspect) {
    const { camera, controls } = this, farther = narrowness(aspect) / narrowness(camera.aspect);
    camera.aspect = aspect;
    camera.updateProjectionMatrix();
    if (farther === 1) return;
    controls.maxDistance = Math.min(MOST_REACH * narrowness(aspect), 0.9 * camera.far);
    this.zoom(1 / farther);
  }

  draw() {
    this.renderer.render(this.scene, this.camera);
  }

  redraw() {
    if (this.pending) return;
    this.pending = true;
    requestAnimationFrame(() => {
      this.pending = false;
      this.draw();
    });
  }

  setBackground(colour) {
    this.renderer.setClearColor(new Color(colour));
    this.redraw();
  }

  setEdges(on) {
    this.material.uniforms.edges.value = on ? 1 : 0;
    this.redraw();
  }

  /** Takes over the arrays of seen faces: to the card goes what is used of them. */
  setFaces(seen) {
    let geometry = this.cells.geometry;
    if (geometry.attributes.position?.array !== seen.positions) {
      geometry.dispose();
      geometry = new BufferGeometry();
      geometry.setAttribute("position", new BufferAttribute(seen.positions, 3));
      geometry.setAttribute("colour", new BufferAttribute(seen.colours, 4, true));
      this.cells.geometry = geometry;
    }
    geometry.setDrawRange(0, seen.nVertices);
    for (const attribute of Object.values(geometry.attributes)) {
      attribute.clearUpdateRanges();
      attribute.addUpdateRange(0, seen.nVertices * attribute.itemSize);
      attribute.needsUpdate = true;
    }
    this.redraw();
  }

  /** @param segments  six coordinates each. @param through  seen through the cells. */
  makeLines(segments, colour, width, through) {
    const material = new LineMaterial({ color: colour, linewidth: width, depthTest: !through });
    const lines = new LineSegments2(new LineSegmentsGeometry().setPositions(segments), material);
    lines.renderOrder = through ? 1 : 0;
    lines.frustumCulled = false;
    material.resolution.set(this.canvas.clientWidth, this.canvas.clientHeight);
    this.scene.add(lines);
    return lines;
  }

  addCurves({ points, curves }) {
    if (!curves.length) return;
    const segments = new Float32Array(3 * curves.length);
    curves.forEach((v, i) => segments.set(points.subarray(3 * v, 3 * v + 3), 3 * i));
    this.curves = this.makeLines(segments, 0x1565c0, 2.5, false);
  }

  addLines({ lines }) {
    if (!lines.length) return;
    this.lines = this.makeLines(lines, 0xd81b8c, 2.5, true);
    this.lines.visible = false;  // they lie inside: shown when asked for
  }

  /** Lines end where the cells are cut. */
  clipLines({ normal, offset }) {
    const planes = normal ? [new Plane(new Vector3(...normal).negate(), offset)] : [];
    for (const lines of [this.curves, this.lines])
      if (lines) lines.material.clippingPlanes = planes;
  }

  showLines(which, on) {
    if (this[which]) this[which].visible = on;
    this.redraw();
  }

  /** Camera at angles in degrees, so near that `zoom` times as much is seen of the size at the start. */
  look(azimuth, elevation, zoom, target = [0, 0, 0]) {
    const a = azimuth * Math.PI / 180, e = elevation * Math.PI / 180;
    const reach = REACH * narrowness(this.camera.aspect) / zoom;
    this.controls.target.set(...target);
    this.camera.position.set(Math.cos(e) * Math.cos(a), Math.cos(e) * Math.sin(a), Math.sin(e))
      .multiplyScalar(reach).add(this.controls.target);
    this.controls.update();
    this.redraw();
  }

  /** Unit vector from what is looked at to the eye. */
  towardsEye() {
    return this.camera.position.clone().sub(this.controls.target).normalize();
  }

  /** Turns the camera about what is looked at, by degrees. */
  turn(azimuth, elevation) {
    const { x, y, z } = this.towardsEye(), degree = Math.PI / 180;
    const up = Math.min(Math.max(Math.asin(z) / degree + elevation, -89), 89);
    const distance = this.camera.position.distanceTo(this.controls.target);
    const zoom = REACH * narrowness(this.camera.aspect) / distance;
    this.look(Math.atan2(y, x) / degree + azimuth, up, zoom, this.controls.target.toArray());
  }

  shift(right, up) {
    const { camera, controls } = this, step = camera.position.distanceTo(controls.target);
    const move = new Vector3().setFromMatrixColumn(camera.matrix, 0).multiplyScalar(right * step)
      .add(new Vector3().setFromMatrixColumn(camera.matrix, 1).multiplyScalar(up * step));
    camera.position.add(move);
    controls.target.add(move);
    controls.update();
  }

  zoom(factor) {
    const { camera, controls } = this;
    camera.position.sub(controls.target).divideScalar(factor).add(controls.target);
    controls.update();
  }

  /** Pixels by which a point moves on the screen when it moves by `direction` at what is looked at. */
  pixelsAlong(direction) {
    const at = this.controls.target.clone(), to = at.clone().addScaledVector(new Vector3(...direction), 0.01);
    const [a, b] = [at.project(this.camera), to.project(this.camera)];
    const { clientWidth, clientHeight } = this.canvas;
    return [(b.x - a.x) * 50 * clientWidth, (a.y - b.y) * 50 * clientHeight];
  }

  /** Outlines a cell, seen through all others; null: none. */
  pointOut(mesh, cell) {
    if (this.pointed) this.scene.remove(...this.pointed);
    this.pointed = null;
    if (cell !== null) {
      const first = mesh.firstCorner[cell], sides = [], triangles = [];
      const point = (i) => mesh.points.subarray(3 * mesh.corners[first + i], 3 * mesh.corners[first + i] + 3);
      for (const face of FACES[mesh.kinds[cell]]) {
        face.forEach((v, i) => sides.push(...point(v), ...point(face[(i + 1) % face.length])));
        for (let i = 2; i < face.length; ++i) triangles.push(...point(face[0]), ...point(face[i - 1]), ...point(face[i]));
      }
      const geometry = (numbers) =>
        new BufferGeometry().setAttribute("position", new BufferAttribute(new Float32Array(numbers), 3));
      const see = { depthTest: false, transparent: true };
      this.pointed = [
        new Mesh(geometry(triangles), new MeshBasicMaterial({ color: 0x3d6bff, opacity: 0.25, side: DoubleSide, ...see })),
        new LineSegments(geometry(sides), new LineBasicMaterial({ color: 0x1d3fd0, ...see })),
      ];
      for (const object of this.pointed) object.renderOrder = 2;
      this.scene.add(...this.pointed);
    }
    this.redraw();
  }

  /** Moves smoothly until `target` is in the middle and `radius` fills a fair part of the picture. */
  flyTo(target, radius) {
    const from = this.controls.target.clone(), to = new Vector3(...target), towards = this.towardsEye();
    const near = this.camera.position.distanceTo(from), start = performance.now();
    const far = Math.max(9 * radius, 2e-3) * narrowness(this.camera.aspect);
    const duration = window.matchMedia("(prefers-reduced-motion: reduce)").matches ? 1 : 500;
    const step = () => {
      const t = Math.min((performance.now() - start) / duration, 1), s = t * t * (3 - 2 * t);
      this.controls.target.lerpVectors(from, to, s);
      this.camera.position.copy(this.controls.target).addScaledVector(towards, near * (far / near) ** s);
      this.controls.update();
      this.redraw();
      if (t < 1) requestAnimationFrame(step);
    };
    step();
  }
}
