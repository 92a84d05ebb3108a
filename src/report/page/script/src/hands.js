// Mouse, fingers and keys move the camera.

/** @typedef {import("./camera.js").Camera} Camera */

/**
 * @param {HTMLCanvasElement} canvas @param {Camera} camera
 * @param {(moved: boolean) => void} act after each change; false asks for all in view again
 */
export function linkCamera(canvas, camera, act) {
  /** @type {Map<number, [number, number]>} places of fingers or of the mouse */
  const down = new Map();
  const side = () => Math.min(canvas.clientWidth, canvas.clientHeight) || 1;

  canvas.addEventListener("pointerdown", (event) => {
    down.set(event.pointerId, [event.clientX, event.clientY]);
    canvas.setPointerCapture(event.pointerId);
  });
  for (const end of /** @type {const} */ (["pointerup", "pointercancel"])) {
    canvas.addEventListener(end, (event) => down.delete(event.pointerId));
  }
  canvas.addEventListener("pointermove", (event) => {
    const before = down.get(event.pointerId);
    if (!before) return;
    const [dx, dy] = [event.clientX - before[0], event.clientY - before[1]];
    if (down.size > 1) {
      // Two fingers: their middle pans, their distance zooms.
      const other = [...down].find(([id]) => id !== event.pointerId)?.[1] ?? before;
      const apart = (/** @type {number} */ x, /** @type {number} */ y) => Math.hypot(x - other[0], y - other[1]) || 1;
      camera.zoom(apart(event.clientX, event.clientY) / apart(before[0], before[1]));
      camera.pan(dx / 2 / side(), dy / 2 / side());
    } else if (event.shiftKey || event.buttons === 2 || event.buttons === 4) camera.pan(dx / side(), dy / side());
    else {
      // Up and down, a finger scrolls the page until the picture has the focus.
      const scrolls = event.pointerType === "touch" && document.activeElement !== canvas;
      camera.orbit((-dx * 3) / side(), scrolls ? 0 : (dy * 3) / side());
    }
    down.set(event.pointerId, [event.clientX, event.clientY]);
    act(true);
  });
  canvas.addEventListener("contextmenu", (event) => event.preventDefault());
  canvas.addEventListener("dblclick", () => act(false));
  canvas.addEventListener("wheel", (event) => {
    // The wheel scrolls the page unless the picture has the focus.
    if (document.activeElement !== canvas && !event.ctrlKey) return;
    event.preventDefault();
    camera.zoom(Math.exp(-Math.max(-100, Math.min(100, event.deltaY)) / 400));
    act(true);
  }, { passive: false });

  canvas.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.altKey || event.metaKey) return;
    const [x, y] = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[event.key] ?? [0, 0];
    if (x || y) {
      if (event.shiftKey) camera.pan(0.05 * x, 0.05 * y);
      else camera.orbit(-0.1 * x, 0.1 * y);
    } else if (event.key === "+" || event.key === "=") camera.zoom(1.15);
    else if (event.key === "-") camera.zoom(1 / 1.15);
    else if (event.key === "f" || event.key === "0") return act(false);
    else return;
    event.preventDefault();
    act(true);
  });
}
