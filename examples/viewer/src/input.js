// SPDX-License-Identifier: BSL-1.0
// Keys and dragging. Turning, moving and zooming by mouse and touch are OrbitControls' business.

/** What each key does; the page lists the same in its help. */
function keyActions(viewer) {
  const { picture, panel } = viewer, move = (step) => viewer.change({ at: clamp(viewer.state.at + step) });
  const cut = (axis) => () => viewer.cutAcross(axis);
  return {
    ArrowLeft: (shift) => (shift ? picture.shift(-0.05, 0) : picture.turn(-5, 0)),
    ArrowRight: (shift) => (shift ? picture.shift(0.05, 0) : picture.turn(5, 0)),
    ArrowUp: (shift) => (shift ? picture.shift(0, 0.05) : picture.turn(0, 5)),
    ArrowDown: (shift) => (shift ? picture.shift(0, -0.05) : picture.turn(0, -5)),
    "+": () => picture.zoom(1.15),
    "=": () => picture.zoom(1.15),
    "-": () => picture.zoom(1 / 1.15),
    x: cut("x"), y: cut("y"), z: cut("z"), v: cut("view"), n: cut("none"),
    "[": () => move(-0.01),
    "]": () => move(0.01),
    f: () => viewer.change({ flip: !viewer.state.flip }),
    c: () => viewer.change({ dragCuts: !viewer.state.dragCuts }),
    p: () => viewer.change({ peel: Math.min(viewer.state.peel + 1, panel.mostLayers) }),
    o: () => viewer.change({ peel: Math.max(viewer.state.peel - 1, 0) }),
    r: () => viewer.reset(),
    h: () => panel.toggle(),
    "?": () => panel.toggleHelp(),
  };
}

const clamp = (x) => Math.min(Math.max(x, 0), 1);

export function listenToKeys(viewer) {
  const actions = keyActions(viewer);
  document.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    // Sliders and lists have the arrows for themselves.
    if (/^Arrow/.test(event.key) && /^(INPUT|SELECT)$/.test(event.target.tagName)) return;
    const action = actions[event.key] ?? actions[event.key.toLowerCase()];
    if (!action) return;
    action(event.shiftKey);
    event.preventDefault();
  });
}

/** With Shift, or where dragging is set to cut, the plane follows the pointer. */
export function listenToDragging(viewer) {
  const { canvas, controls } = viewer.picture;
  let last = null;
  canvas.addEventListener("pointerdown", (event) => {
    if (!event.isPrimary || event.button !== 0 || !(viewer.state.dragCuts || event.shiftKey)) return;
    if (viewer.state.cut === "none") viewer.cutAcross("view");
    controls.enabled = false;
    last = [event.clientX, event.clientY];
    canvas.setPointerCapture(event.pointerId);
    event.stopImmediatePropagation();
  }, { capture: true });
  canvas.addEventListener("pointermove", (event) => {
    if (!last || !event.isPrimary) return;
    const [dx, dy] = [event.clientX - last[0], event.clientY - last[1]];
    last = [event.clientX, event.clientY];
    viewer.change({ at: clamp(viewer.state.at + draggedShare(viewer, dx, dy)) });
  });
  for (const end of ["pointerup", "pointercancel"])
    canvas.addEventListener(end, () => {
      last = null;
      controls.enabled = true;
    });
}

/** By how much of the mesh's extent the plane moves. One that is seen face on moves away when the pointer moves up. */
function draggedShare(viewer, dx, dy) {
  const { normal } = viewer.plane(), direction = viewer.state.flip ? normal.map((x) => -x) : normal;
  const [low, high] = viewer.extent(direction), [px, py] = viewer.picture.pixelsAlong(direction);
  const square = px * px + py * py, width = viewer.picture.canvas.clientHeight / 2;
  if (square < (0.2 * width) ** 2) {
    const towards = viewer.picture.towardsEye().toArray().reduce((sum, x, k) => sum + x * direction[k], 0);
    return dy * Math.sign(towards) / width / (high - low);
  }
  return (dx * px + dy * py) / square / (high - low);
}
