// The clock as a line in every figure over time; the pointer over a figure moves the clock.

/** @typedef {import("./clock.js").Clock} Clock */

/** `t0,t1,x0,x1`: x in the view box at two instants. @param {string | undefined} text */
export function timeAxis(text) {
  const [t0, t1, x0, x1] = (text ?? "").split(",").map(Number);
  if (![t0, t1, x0, x1].every(Number.isFinite) || t0 === t1 || x0 === x1) return null;
  return {
    /** @param {number} time */
    x: (time) => x0 + ((time - t0) / (t1 - t0)) * (x1 - x0),
    /** @param {number} x */
    time: (x) => t0 + ((x - x0) / (x1 - x0)) * (t1 - t0),
    /** @param {number} time */
    holds: (time) => time >= Math.min(t0, t1) && time <= Math.max(t0, t1),
  };
}

/** @param {Clock} clock */
export function linkFigures(clock) {
  for (const svg of /** @type {NodeListOf<SVGSVGElement>} */ (document.querySelectorAll("svg[data-time]"))) {
    const axis = timeAxis(svg.dataset.time);
    if (!axis) continue;
    const line = document.createElementNS("http://www.w3.org/2000/svg", "line");
    line.setAttribute("class", "clock");
    line.setAttribute("y1", svg.dataset.top ?? "0");
    line.setAttribute("y2", svg.dataset.bottom ?? "0");
    svg.append(line);
    clock.listen(() => {
      const x = axis.x(clock.time).toFixed(2);
      line.setAttribute("x1", x);
      line.setAttribute("x2", x);
      line.style.display = axis.holds(clock.time) ? "" : "none";
    });
    const follow = (/** @type {PointerEvent} */ event) => {
      const matrix = svg.getScreenCTM();
      // Scrolling the page under a still pointer is no wish to move the clock.
      if (!matrix || (event.type === "pointermove" && !event.movementX && !event.movementY)) return;
      const time = axis.time(new DOMPoint(event.clientX, event.clientY).matrixTransform(matrix.inverse()).x);
      if (axis.holds(time)) clock.seek(time);
    };
    svg.addEventListener("pointermove", follow);
    svg.addEventListener("pointerdown", follow);
  }
}
