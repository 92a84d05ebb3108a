// One picture of the motion: obstacles, then the truth as a pale ghost, then each engine.

import { pixel, strainScale, strainStep } from "./colours.js";
import { frameAt, placeOf, placesAt, sample, strain, usualStrain } from "./motion.js";
import { wires } from "./obstacles.js";
import { mix, Raster } from "./raster.js";

/** @typedef {import("./types").Motion} Motion */
/** @typedef {import("./types").Engine} Engine */
/** @typedef {import("./types").Panel} Panel */
/** @typedef {import("./types").Vec3} Vec3 */
/** @typedef {import("./camera.js").Camera} Camera */

/**
 * What the reader chose to see.
 * @typedef {object} Choice
 * @property {Set<string>} on ids of engines
 * @property {boolean} apart side by side
 * @property {boolean} strain springs coloured by it
 * @property {boolean} trails
 * @property {boolean} obstacles
 * @property {string | null} chosen the highlighted engine
 * @property {boolean} dark
 * @property {string} paper `#rrggbb`, the ground
 */

/** Up to so many lines are drawn smooth and wide, more of them thin. */
const FEW = 3000;
/** Particles are drawn as balls when there are few, or where they are large. */
const FEW_BALLS = 600;
const TRAILS = 12;
const SHADES = 24;
const WHITE = 0xffffffff;
/** Where the light comes from, of length 1. */
const LAMP = [0.48, -0.36, 0.8];

export class Picture {
  /** @param {Motion} motion @param {Camera} camera */
  constructor(motion, camera) {
    this.motion = motion;
    this.camera = camera;
    this.most = usualStrain(motion);
    this.places = new Float32Array(3 * motion.count);
    this.screen = new Float32Array(3 * motion.count);
    /** What the view has to hold. */
    this.points = sample(motion);
    const [low, high] = box(this.points);
    const middle = /** @type {Vec3} */ (low.map((x, axis) => (x + high[axis]) / 2));
    const reach = 0.75 * Math.hypot(...low.map((x, axis) => high[axis] - x)) || 1;
    this.wires = motion.obstacles.map((shape) => wires(shape, middle, reach));
    // Obstacles not much larger than the motion belong into the view.
    this.wires.forEach((points, k) => {
      const [from, to] = box(points);
      const small = from.every((x, axis) => to[axis] - x < 3 * reach);
      if (small && motion.obstacles[k].shape !== "plane") this.points.push(...points);
    });
    const moving = Array.from({ length: motion.count }, (_, i) => i).filter((i) => !motion.fixed.includes(i));
    const every = Math.max(1, Math.ceil(moving.length / TRAILS));
    this.traced = moving.filter((_, k) => k % every === (every >> 1));
    this.raster = new Raster(1, 1);
    /** @type {Choice} */
    this.choice = {
      on: new Set(motion.engines.map((engine) => engine.id)),
      apart: this.crowded(), strain: false, trails: motion.count <= 20, obstacles: true,
      chosen: null, dark: false, paper: "#ffffff",
    };
  }

  /** The engines to be drawn, the highlighted one last, on top. */
  shown() {
    const { on, chosen } = this.choice;
    const engines = this.motion.engines.filter((engine) => on.has(engine.id));
    return engines.sort((a, b) => Number(b.truth) - Number(a.truth) || Number(a.id === chosen) - Number(b.id === chosen));
  }

  /** One panel for all, or one for each engine; the truth lies behind every one. @returns {{panel: Panel, engines: Engine[]}[]} */
  panels() {
    const { width, height } = this.raster;
    const shown = this.shown();
    const ghosts = shown.filter((engine) => engine.truth);
    const order = this.motion.engines.filter((engine) => shown.includes(engine) && !engine.truth);
    if (!this.choice.apart || order.length < 2) return [{ panel: { left: 0, top: 0, right: width, bottom: height }, engines: shown }];
    const { low, high } = this.camera.reach(this.points);
    const [columns, rows] = split(order.length, width / height, (high[0] - low[0]) / (high[1] - low[1]));
    return order.map((engine, k) => {
      const [column, row] = [k % columns, Math.floor(k / columns)];
      const panel = {
        left: Math.floor((column * width) / columns), right: Math.floor(((column + 1) * width) / columns),
        top: Math.floor((row * height) / rows), bottom: Math.floor(((row + 1) * height) / rows),
      };
      return { panel, engines: [...ghosts, engine] };
    });
  }

  /** Whether engines on top of each other would hide each other: on a line, or a dense cloth. */
  crowded() {
    const [low, high] = box(this.points);
    const sizes = low.map((x, axis) => high[axis] - x).sort((a, b) => b - a);
    return this.motion.springs.length / 2 > FEW || !(sizes[1] > 0.02 * sizes[0]);
  }

  fit() {
    const { panel } = this.panels()[0];
    this.camera.fit(this.points, panel.right - panel.left, panel.bottom - panel.top);
  }

  /** @param {number} time seconds */
  draw(time) {
    const { choice, raster, motion } = this;
    this.paper = pixel(choice.paper);
    this.scale = strainScale(choice.dark);
    raster.clear(this.paper);
    const frame = frameAt(motion.t, time);
    const panels = this.panels();
    const lines = (motion.springs.length / 2) * this.shown().length;
    for (const { panel, engines } of panels) {
      raster.clip(panel);
      if (choice.obstacles) this.drawObstacles(panel, frame);
      // What is drawn earlier is wider, so that it is seen where engines agree.
      engines.forEach((engine, k) => {
        const wider = 1 + 0.4 * (engines.length - 1 - k);
        this.drawEngine(engine, panel, frame, lines <= FEW, this.wide() * (engine.truth ? Math.max(3, wider) : wider));
      });
    }
    raster.clip({ left: 0, top: 0, right: raster.width, bottom: raster.height });
    if (panels.length > 1) this.drawBorders(panels.map(({ panel }) => panel));
  }

  /** @param {Engine} engine */
  colour(engine) {
    const { chosen, dark } = this.choice;
    const own = pixel(engine.colour, dark);
    const pale = engine.truth ? 0.75 : 1;
    return mix(this.paper ?? 0, own, chosen !== null && chosen !== engine.id ? 0.25 : pale);
  }

  /** @param {Engine} engine @param {Panel} panel @param {number} frame @param {boolean} few @param {number} wide pixels of a line */
  drawEngine(engine, panel, frame, few, wide) {
    const { motion, camera, places, screen, raster, choice } = this;
    const { count, springs, rest, rods } = motion;
    const colour = this.colour(engine);
    if (choice.trails && !engine.truth) this.drawTrails(engine, panel, frame, mix(this.paper ?? 0, colour, 0.6));
    if (!placesAt(engine, count, frame, places)) return;
    camera.project(places, count, panel, screen);
    const byStrain = choice.strain && !engine.truth && (choice.chosen ?? engine.id) === engine.id;
    const scale = /** @type {Uint32Array} */ (this.scale);
    const shades = this.shades(colour);
    for (let s = 0; s < springs.length; s += 2) {
      const i = springs[s];
      const j = springs[s + 1];
      let ink = colour;
      if (byStrain) ink = scale[strainStep(strain(places, count, i, j, rest[s >> 1]), this.most)];
      else if (!few) ink = shades[this.shade(i, j)];
      if (few) raster.thick(screen[i], screen[count + i], screen[j], screen[count + j], wide, ink);
      else raster.thin(screen[i], screen[count + i], screen[j], screen[count + j], ink);
    }
    for (let s = 0; s < rods.length; s += 2) {
      const [i, j] = [rods[s], rods[s + 1]];
      raster.thick(screen[i], screen[count + i], screen[j], screen[count + j], 2 * wide, colour);
    }
    this.drawBalls(engine, colour, wide);
  }

  /** From pale to full. @param {number} colour */
  shades(colour) {
    return Uint32Array.from({ length: SHADES }, (_, k) => mix(this.paper ?? 0, colour, 0.3 + (0.7 * k) / (SHADES - 1)));
  }

  /**
   * How dark a spring of a dense cloth is: as a hair under a lamp, by its angle to the light. It makes folds visible.
   * @param {number} i @param {number} j
   */
  shade(i, j) {
    const { places, motion: { count } } = this;
    const x = places[i] - places[j];
    const y = places[count + i] - places[count + j];
    const z = places[2 * count + i] - places[2 * count + j];
    const along = LAMP[0] * x + LAMP[1] * y + LAMP[2] * z;
    const part = (along * along) / (x * x + y * y + z * z);
    return (Math.sqrt(part) * (SHADES - 0.01)) | 0;
  }

  /** @param {Engine} engine @param {number} colour @param {number} wide pixels of a line */
  drawBalls(engine, colour, wide) {
    const { motion: { count, radius, fixed }, screen, raster } = this;
    const size = (/** @type {number} */ i) => screen[2 * count + i] * (typeof radius === "number" ? radius : radius[i] ?? 0);
    const least = count <= FEW_BALLS ? (count <= 60 ? 3.5 : 1.5) * this.wide() + wide : 0;
    const [paper, rim] = [this.paper ?? 0, this.wide()];
    for (let i = 0; i < count; i++) {
      const pixels = Math.max(size(i), least);
      if (pixels < 1.5) continue;
      raster.disc(screen[i], screen[count + i], pixels, colour);
      // A light spot makes a large ball look round, unless it is a ghost.
      if (pixels > 6 && !engine.truth) raster.disc(screen[i] - pixels / 3, screen[count + i] - pixels / 3, pixels / 4, mix(colour, WHITE, 0.5));
    }
    if (engine.truth) return;
    for (const i of fixed) {
      // What is held: a ring.
      if (least) raster.disc(screen[i], screen[count + i], Math.max(size(i), least) - 1.5 * rim, paper);
      else raster.disc(screen[i], screen[count + i], 2.5, colour);
    }
  }

  /** @param {Engine} engine @param {Panel} panel @param {number} frame @param {number} colour */
  drawTrails(engine, panel, frame, colour) {
    const now = Math.min(frame, engine.last - 1);
    if (now < 0) return;
    const first = Math.max(0, Math.ceil(now) - 300);
    const steps = Math.ceil(now) - first + 1;
    const line = new Float32Array(3 * steps);
    const screen = new Float32Array(3 * steps);
    for (const particle of this.traced) {
      for (let k = 0; k < steps; k++) {
        const place = placeOf(engine, this.motion.count, Math.min(first + k, now), particle);
        for (let axis = 0; axis < 3; axis++) line[axis * steps + k] = place[axis];
      }
      this.camera.project(line, steps, panel, screen);
      for (let k = 1; k < steps; k++) {
        this.raster.thick(screen[k - 1], screen[steps + k - 1], screen[k], screen[steps + k], this.wide(), colour);
      }
    }
  }

  /** @param {Panel} panel @param {number} frame */
  drawObstacles(panel, frame) {
    const colour = mix(this.paper ?? 0, pixel("#6b6b6b", this.choice.dark), 0.45);
    this.wires.forEach((points, k) => {
      const path = this.motion.obstacles[k].path ?? [];
      const whole = Math.min(Math.floor(frame), path.length - 1);
      const [a, b] = [path[whole] ?? [0, 0, 0], path[Math.min(whole + 1, path.length - 1)] ?? [0, 0, 0]];
      const shift = a.map((x, axis) => x + (frame - whole) * (b[axis] - x));
      const count = points.length;
      const places = new Float32Array(3 * count);
      points.forEach((point, i) => point.forEach((x, axis) => (places[axis * count + i] = x + shift[axis])));
      const screen = new Float32Array(3 * count);
      this.camera.project(places, count, panel, screen);
      for (let i = 0; i < count; i += 2) {
        this.raster.thick(screen[i], screen[count + i], screen[i + 1], screen[count + i + 1], this.wide() / 1.5, colour);
      }
    });
  }

  /** @param {Panel[]} panels */
  drawBorders(panels) {
    const colour = mix(this.paper ?? 0, pixel("#6b6b6b", this.choice.dark), 0.4);
    for (const { left, top, right, bottom } of panels) {
      this.raster.thin(left, top, right, top, colour);
      this.raster.thin(left, top, left, bottom, colour);
    }
  }

  /** The width of a line, in pixels of the raster. */
  wide() {
    return this.raster.width > 1200 ? 2.5 : 1.5;
  }
}

/** @param {Vec3[]} points @returns {[Vec3, Vec3]} */
export function box(points) {
  const low = /** @type {Vec3} */ ([Infinity, Infinity, Infinity]);
  const high = /** @type {Vec3} */ ([-Infinity, -Infinity, -Infinity]);
  for (const point of points) {
    for (let axis = 0; axis < 3; axis++) {
      low[axis] = Math.min(low[axis], point[axis]);
      high[axis] = Math.max(high[axis], point[axis]);
    }
  }
  return [low, high];
}

/**
 * Columns and rows that show each of n panels largest.
 * @param {number} n @param {number} aspect width over height of all panels together @param {number} content the same of what is in one
 * @returns {[number, number]}
 */
export function split(n, aspect, content) {
  const wide = Math.max(0.2, Math.min(5, content)) || 1;
  let best = /** @type {[number, number]} */ ([1, n]);
  let largest = 0;
  for (let columns = 1; columns <= n; columns++) {
    const rows = Math.ceil(n / columns);
    const height = Math.min(aspect / columns / wide, 1 / rows);
    if (height > largest * 1.001) [best, largest] = [[columns, rows], height];
  }
  return best;
}
