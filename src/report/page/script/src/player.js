// The 3D player: a canvas and its controls, built into `<div id="player">`.

import { Camera } from "./camera.js";
import { Clock, seconds, SPEEDS } from "./clock.js";
import { STRAIN } from "./colours.js";
import { button, choice, element, swatch, tick } from "./dom.js";
import { linkCamera } from "./hands.js";
import { frameAt, placeOf } from "./motion.js";
import { box, Picture } from "./picture.js";
import { Raster } from "./raster.js";
import { events, timeline } from "./timeline.js";

/** @typedef {import("./types").Motion} Motion */

/** The strain's scale with the root in it, as a gradient. */
const SCALE = [STRAIN[0], `color-mix(in srgb, ${STRAIN[0]}, ${STRAIN[1]}) 37.5%`, STRAIN[1], `color-mix(in srgb, ${STRAIN[2]}, ${STRAIN[1]}) 62.5%`, STRAIN[2]].join();

/** More lines than this are drawn at one pixel of the raster for one of the page, however dense the screen. */
const MANY = 20000;

/** @param {HTMLElement} place @param {Motion} motion @param {Clock} clock */
export function buildPlayer(place, motion, clock) {
  const camera = new Camera();
  const picture = new Picture(motion, camera);
  const show = picture.choice;
  const duration = clock.end - clock.start;
  const canvas = element("canvas", {
    tabindex: 0, role: "application", "aria-label": `The motion in 3D of ${motion.engines.map((engine) => engine.name).join(", ")}`,
    "aria-describedby": "player-keys",
  });
  const pen = /** @type {CanvasRenderingContext2D} */ (canvas.getContext("2d", { alpha: false }));
  let image = new ImageData(1, 1);
  let asked = false;
  let untouched = true;
  let drawn = 0;

  const draw = () => {
    asked = false;
    picture.draw(clock.time);
    pen.putImageData(image, 0, 0);
    const panels = picture.panels();
    const size = Math.round((13 * canvas.width) / Math.max(1, canvas.clientWidth));
    pen.font = `${size}px system-ui, sans-serif`;
    pen.fillStyle = show.dark ? "#ddd" : "#222";
    const frame = frameAt(motion.t, clock.time);
    for (const { panel, engines } of panels.length > 1 ? panels : []) {
      const engine = engines[engines.length - 1];
      pen.fillText(engine.name + (frame > engine.last - 1 ? " (stopped)" : ""), panel.left + size * 0.6, panel.top + size * 1.4);
    }
    canvas.dataset.time = String(clock.time);
    canvas.dataset.drawn = String(++drawn);
  };
  const redraw = () => {
    if (!asked) requestAnimationFrame(draw);
    asked = true;
  };
  const refit = () => {
    if (untouched) picture.fit();
    redraw();
  };
  const resize = () => {
    const lines = (motion.springs.length / 2) * motion.engines.length;
    const ratio = lines > MANY ? 1 : Math.min(2, devicePixelRatio || 1);
    canvas.width = Math.max(1, Math.round(canvas.clientWidth * ratio));
    canvas.height = Math.max(1, Math.round(canvas.clientHeight * ratio));
    picture.raster = new Raster(canvas.width, canvas.height);
    image = new ImageData(picture.raster.bytes, canvas.width, canvas.height);
    refit();
  };
  const home = () => {
    camera.face(box(picture.points));
    untouched = true;
    refit();
  };
  /** @template {keyof typeof show} K @param {K} key @returns {(value: typeof show[K]) => void} */
  const set = (key) => (value) => {
    show[key] = value;
    refit();
  };

  const play = button("Play", () => (clock.playing ? clock.pause() : clock.play()), { class: "play" });
  const now = element("output", { "aria-live": "off" });
  clock.listen(() => {
    play.textContent = clock.playing ? "Pause" : "Play";
    now.textContent = seconds(clock.time, duration);
    redraw();
  });
  const speed = choice("Speed", SPEEDS.map((x) => [String(x), `×${x}`]), String(clock.speed), (value) => (clock.speed = Number(value)));

  const boxes = motion.engines.map((engine) => {
    const turn = (/** @type {boolean} */ on) => {
      if (on) show.on.add(engine.id);
      else show.on.delete(engine.id);
      refit();
    };
    const notes = events(motion).filter((event) => event.engine === engine)
      .map(({ time, what }) => element("small", {}, ` ${what} at ${seconds(time, duration)}`));
    const label = tick(true, turn, swatch(engine.colour, engine.dash), engine.name, ...notes);
    label.dataset.engine = engine.id;
    return label;
  });
  const scale = element("span", { class: "strain", hidden: true }, `−${percent(picture.most)} `,
    element("i", { style: `background: linear-gradient(90deg, ${SCALE})` }), ` +${percent(picture.most)} strain`);
  const colours = choice("Springs", [["engine", "by engine"], ["strain", "by strain"]], "engine", (value) => {
    scale.hidden = value !== "strain";
    set("strain")(value === "strain");
  });
  const layout = choice("Engines", [["over", "overlaid"], ["apart", "side by side"]], show.apart ? "apart" : "over", (value) => set("apart")(value === "apart"));
    const moved = (/** @type {boolean} */ own) => {
    if (!own) return home();
    untouched = false;
    redraw();
  };
  const zoom = (/** @type {number} */ by) => () => {
    camera.zoom(by);
    moved(true);
  };
  const keys = "Drag to turn, Shift-drag or two fingers to move, wheel or pinch to zoom once the picture has the focus. "
    + "Keys: arrows turn, Shift-arrows move, + and - zoom, F fits, Space plays, comma and full stop step. "
    + "Between stored instants the motion is drawn straight.";
  place.replaceChildren(
    canvas,
    element("div", { class: "bar" }, play, timeline(motion, clock), now),
    element("fieldset", { class: "bar" }, element("legend", {}, "Engines"), ...boxes),
    element("div", { class: "bar" }, speed,
      ...(motion.engines.length > 1 ? [layout] : []),
      ...(motion.springs.length ? [colours, scale] : []),
      tick(show.trails, set("trails"), "Trails"),
      ...(motion.obstacles.length ? [tick(true, set("obstacles"), "Obstacles")] : []),
      tick(clock.again, (on) => (clock.again = on), "Repeat"),
      button("Fit", home), button("+", zoom(1.25), { "aria-label": "Zoom in" }), button("−", zoom(0.8), { "aria-label": "Zoom out" })),
    element("p", { id: "player-keys" }, keys));

  linkCamera(canvas, camera, moved);
  canvas.addEventListener("keydown", (event) => {
    const frame = frameAt(motion.t, clock.time);
    if (event.key === " ") play.click();
    else if (event.key === ",") clock.seek(motion.t[Math.max(0, Math.ceil(frame) - 1)] ?? clock.start);
    else if (event.key === ".") clock.seek(motion.t[Math.min(motion.t.length - 1, Math.floor(frame) + 1)] ?? clock.start);
    else return;
    event.preventDefault();
  });
  const dark = matchMedia("screen and (prefers-color-scheme: dark)");
  const dress = () => {
    show.dark = dark.matches;
    show.paper = getComputedStyle(place).getPropertyValue("--paper").trim() || show.paper;
    redraw();
  };
  dark.addEventListener("change", dress);
  dress();
  camera.face(box(picture.points));
  new ResizeObserver(resize).observe(canvas);
  startInSight(canvas, clock);

  return {
    highlight: set("chosen"),
    /** Where the picture has a particle now, metres. @param {string} id @param {number} particle */
    place(id, particle) {
      const engine = motion.engines.find((one) => one.id === id);
      return engine && engine.last ? placeOf(engine, motion.count, frameAt(motion.t, clock.time), particle) : null;
    },
    camera, clock, picture,
  };
}

/** Plays when first seen, unless the reader wants less motion. @param {Element} canvas @param {Clock} clock */
function startInSight(canvas, clock) {
  if (matchMedia("(prefers-reduced-motion: reduce)").matches) return;
  const watch = new IntersectionObserver((entries) => {
    if (!entries.some((entry) => entry.isIntersecting)) return;
    watch.disconnect();
    if (clock.time === clock.start) clock.play();
  }, { threshold: 0.5 });
  watch.observe(canvas);
}

/** @param {number} part */
const percent = (part) => `${Number((100 * part).toPrecision(2))} %`;
