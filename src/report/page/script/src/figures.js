// The clock as a line in every figure over time; the pointer over a figure moves the clock, and reads the values there.

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

/**
 * The stored value that is nearest to a time, `[t, value]`; null where there is none.
 * @param {string | undefined} text `t value,t value,...` by growing t
 * @param {number} time @returns {[number, number] | null}
 */
export function valueAt(text, time) {
  if (!text) return null;
  /** @type {[number, number] | null} */
  let best = null;
  for (const pair of text.split(",")) {
    const [t, value] = pair.split(" ").map(Number);
    if (best && Math.abs(t - time) >= Math.abs(best[0] - time)) break;
    best = [t, value];
  }
  return best;
}

/** The clock as a line. @param {SVGSVGElement} svg @param {NonNullable<ReturnType<typeof timeAxis>>} axis @param {Clock} clock */
function mark(svg, axis, clock) {
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
}

/** @param {Clock | null} clock moved by the pointer; null where nothing plays @param {(text: string | null, event: PointerEvent) => void} say */
export function linkFigures(clock, say) {
  for (const svg of /** @type {NodeListOf<SVGSVGElement>} */ (document.querySelectorAll("svg[data-time]"))) {
    const axis = timeAxis(svg.dataset.time);
    if (!axis) continue;
    if (clock) mark(svg, axis, clock);
    const lines = /** @type {SVGGElement[]} */ ([...svg.querySelectorAll("[data-values]")]);
    const follow = (/** @type {PointerEvent} */ event) => {
      const matrix = svg.getScreenCTM();
      // Scrolling the page under a still pointer is no wish to move the clock.
      if (!matrix || (event.type === "pointermove" && !event.movementX && !event.movementY)) return;
      const time = axis.time(new DOMPoint(event.clientX, event.clientY).matrixTransform(matrix.inverse()).x);
      if (!axis.holds(time)) return say(null, event);
      clock?.seek(time);
      const values = lines.flatMap((group) => {
        const found = valueAt(group.dataset.values, time);
        return found ? [`${group.dataset.engine}: ${found[1]} at ${found[0]} s`] : [];
      });
      say(values.length ? [svg.dataset.value ?? "", ...values].join("\n") : null, event);
    };
    svg.addEventListener("pointermove", follow);
    svg.addEventListener("pointerdown", follow);
    svg.addEventListener("pointerleave", (event) => say(null, event));
  }
}
