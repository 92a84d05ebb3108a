// The slider over the stored instants, with marks where an engine diverges or first faults.

import { seconds } from "./clock.js";
import { button, element } from "./dom.js";
import { frameAt } from "./motion.js";

/** @typedef {import("./types").Motion} Motion */
/** @typedef {import("./clock.js").Clock} Clock */

/** What happened to whom, and when. @param {Motion} motion */
export function events(motion) {
  return motion.engines.flatMap((engine) => [
    ...(engine.diverged === null ? [] : [{ engine, time: engine.diverged, what: "diverges", sign: "×" }]),
    ...(engine.fault === null ? [] : [{ engine, time: engine.fault, what: "first fault", sign: "▾" }]),
  ]);
}

/** @param {Motion} motion @param {Clock} clock */
export function timeline(motion, clock) {
  const { t } = motion;
  const last = Math.max(1, t.length - 1);
  const duration = clock.end - clock.start;
  const slider = element("input", { type: "range", min: 0, max: Math.max(0, t.length - 1), step: 1, value: 0, "aria-label": "Time" });
  slider.addEventListener("input", () => clock.seek(t[Number(slider.value)] ?? clock.start));
  const marks = events(motion).map(({ engine, time, what, sign }) => {
    const text = `${engine.name}: ${what} at ${seconds(time, duration)}`;
    const mark = button(sign, () => clock.seek(time), { class: "mark", "aria-label": text, "data-tip": text, "data-engine": engine.id });
    mark.style.setProperty("--at", String(frameAt(t, time) / last));
    mark.style.setProperty("--engine", engine.colour);
    return mark;
  });
  clock.listen(() => {
    slider.value = String(Math.round(frameAt(t, clock.time)));
    slider.setAttribute("aria-valuetext", seconds(clock.time, duration));
  });
  return element("div", { class: "time" }, slider, element("div", { class: "marks" }, ...marks));
}
