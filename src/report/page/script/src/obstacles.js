// The wires of an obstacle: pairs of points in metres.

/** @typedef {import("./types").Obstacle} Obstacle */
/** @typedef {import("./types").Vec3} Vec3 */

const ROUND = 32;

/** @param {Vec3} a @param {Vec3} b @param {number} [part] @returns {Vec3} a + part b */
const add = (a, b, part = 1) => [a[0] + part * b[0], a[1] + part * b[1], a[2] + part * b[2]];

/** @param {Vec3} a @param {Vec3} b @returns {Vec3} */
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];

/** @param {Vec3} a @returns {Vec3} */
const unit = (a) => add([0, 0, 0], a, 1 / (Math.hypot(...a) || 1));

/** Two ways at right angles to a third and to each other. @param {Vec3} way @returns {[Vec3, Vec3]} */
export function across(way) {
  const [x, y, z] = way.map(Math.abs);
  const helper = /** @type {Vec3} */ (x <= y && x <= z ? [1, 0, 0] : y <= z ? [0, 1, 0] : [0, 0, 1]);
  const first = unit(cross(way, helper));
  return [first, unit(cross(way, first))];
}

/** @param {Vec3} centre @param {Vec3} a @param {Vec3} b @param {number} radius @param {number} turns 1 is a circle @returns {Vec3[]} */
function arc(centre, a, b, radius, turns) {
  const steps = Math.round(ROUND * turns);
  const points = [];
  for (let k = 0; k < steps; k++) {
    for (const at of [k, k + 1]) {
      const angle = (2 * Math.PI * at) / ROUND;
      points.push(add(add(centre, a, radius * Math.cos(angle)), b, radius * Math.sin(angle)));
    }
  }
  return points;
}

/** A grid on the plane, round the point of it that is nearest to `middle`. @param {Vec3} normal @param {number} offset @param {Vec3} middle @param {number} reach @returns {Vec3[]} */
function grid(normal, offset, middle, reach) {
  const size = Math.hypot(...normal) || 1;
  const n = unit(normal);
  const height = offset / size - (n[0] * middle[0] + n[1] * middle[1] + n[2] * middle[2]);
  const centre = add(middle, n, height);
  const [a, b] = across(n);
  const lines = [];
  for (let k = -5; k <= 5; k++) {
    for (const [along, aside] of [[a, b], [b, a]]) {
      // In pieces, so that only what lies behind the eye is left out.
      for (let piece = -5; piece < 5; piece++) {
        const start = add(centre, aside, (k * reach) / 5);
        lines.push(add(start, along, (piece * reach) / 5), add(start, along, ((piece + 1) * reach) / 5));
      }
    }
  }
  return lines;
}

/**
 * @param {Obstacle} shape @param {Vec3} middle of the motion @param {number} reach how far a plane is drawn from there
 * @returns {Vec3[]} ends of lines, two by two
 */
export function wires(shape, middle, reach) {
  switch (shape.shape) {
    case "plane":
      return grid(shape.normal, shape.offset, middle, reach);
    case "ball": {
      const [x, y, z] = /** @type {Vec3[]} */ ([[1, 0, 0], [0, 1, 0], [0, 0, 1]]);
      const slant = [unit([1, 1, 0]), unit([1, -1, 0])];
      const rounds = [[x, y], [y, z], [x, z], ...slant.map((way) => [way, z])];
      const belts = [-0.5, 0.5].flatMap((h) =>
        arc(add(shape.center, z, h * shape.radius), x, y, shape.radius * Math.sqrt(1 - h * h), 1));
      return [...rounds.flatMap(([a, b]) => arc(shape.center, a, b, shape.radius, 1)), ...belts];
    }
    case "box": {
      const corner = (/** @type {number} */ k) => shape.axes.reduce(
        (at, axis, i) => add(at, axis, k & (1 << i) ? shape.half[i] : -shape.half[i]), shape.center);
      const lines = [];
      for (let k = 0; k < 8; k++) {
        for (const bit of [1, 2, 4]) if (!(k & bit)) lines.push(corner(k), corner(k | bit));
      }
      return lines;
    }
    case "capsule": {
      const [from, to] = shape.ends;
      const way = unit(add(to, from, -1));
      const back = /** @type {Vec3} */ (way.map((x) => -x));
      const lines = [];
      const [a, b] = across(way);
      for (const end of shape.ends) lines.push(...arc(end, a, b, shape.radius, 1));
      for (const side of [a, b]) {
        lines.push(...arc(to, side, way, shape.radius, 0.5), ...arc(from, side, back, shape.radius, 0.5));
        for (const sign of [-1, 1]) lines.push(add(from, side, sign * shape.radius), add(to, side, sign * shape.radius));
      }
      return lines;
    }
    case "mesh": {
      const seen = new Set();
      const lines = [];
      for (const [a, b, c] of shape.triangles) {
        for (const [i, j] of [[a, b], [b, c], [c, a]]) {
          const edge = `${Math.min(i, j)},${Math.max(i, j)}`;
          if (seen.has(edge)) continue;
          seen.add(edge);
          lines.push(shape.vertices[i], shape.vertices[j]);
        }
      }
      return lines;
    }
  }
}
