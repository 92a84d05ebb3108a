// Where things are at a moment: between two stored instants each particle goes straight.

/** @typedef {import("./types").Motion} Motion */
/** @typedef {import("./types").Engine} Engine */
/** @typedef {import("./types").Vec3} Vec3 */

/**
 * The place of a moment among growing instants: 2.25 is a quarter of the way from frame 2 to frame 3.
 * @param {number[]} t @param {number} time
 */
export function frameAt(t, time) {
  if (t.length < 2 || time <= t[0]) return 0;
  let low = 0;
  let high = t.length - 1;
  if (time >= t[high]) return high;
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (t[middle] <= time) low = middle;
    else high = middle;
  }
  return low + (time - t[low]) / (t[high] - t[low]);
}

/**
 * Writes x, y, z of all particles, each coordinate in a row of its own; false if the engine has no such frame.
 * @param {Engine} engine @param {number} count @param {number} frame may lie between two @param {Float32Array} out
 */
export function placesAt(engine, count, frame, out) {
  const whole = Math.floor(frame);
  const part = frame - whole;
  if (whole + (part > 0 ? 1 : 0) >= engine.last) return false;
  const { q, unit, origin } = engine;
  const from = whole * 3 * count;
  const to = part > 0 ? from + 3 * count : from;
  for (let axis = 0; axis < 3; axis++) {
    const start = origin[axis];
    for (let i = axis * count, end = i + count; i < end; i++) {
      const a = q[from + i];
      out[i] = start + unit * (a + part * (q[to + i] - a));
    }
  }
  return true;
}

/**
 * The place of one particle.
 * @param {Engine} engine @param {number} count @param {number} frame @param {number} particle @returns {Vec3}
 */
export function placeOf(engine, count, frame, particle) {
  const whole = Math.min(Math.floor(frame), engine.last - 1);
  const next = Math.min(whole + 1, engine.last - 1);
  const part = frame - whole;
  const place = [0, 1, 2].map((axis) => {
    const a = engine.q[(whole * 3 + axis) * count + particle];
    const b = engine.q[(next * 3 + axis) * count + particle];
    return engine.origin[axis] + engine.unit * (a + part * (b - a));
  });
  return /** @type {Vec3} */ (place);
}

/**
 * Some points of what stays near, a few thousand: of engines that did not diverge, or of the first frames of all.
 * @param {Motion} motion @returns {Vec3[]}
 */
export function sample(motion) {
  const { engines, count } = motion;
  const calm = engines.filter((engine) => engine.diverged === null && engine.last > 0);
  const points = [];
  for (const engine of calm.length ? calm : engines) {
    const frames = calm.length ? engine.last : Math.min(1, engine.last);
    const each = Math.max(1, Math.floor(Math.sqrt((count * frames * engines.length) / 4000)));
    for (let frame = 0; frame < frames; frame += count < each ? each * each : each) {
      for (let i = frame % Math.min(each, count); i < count; i += each) points.push(placeOf(engine, count, frame, i));
    }
  }
  return points.length ? points : [[-1, -1, -1], [1, 1, 1]];
}

/**
 * The strain that the colours reach to: only one spring in fifty of a few frames is beyond it.
 * @param {Motion} motion
 */
export function usualStrain(motion) {
  const { springs, rest, count, t } = motion;
  const found = [];
  const places = new Float32Array(3 * count);
  const each = Math.max(1, Math.floor(rest.length / 500));
  for (const engine of motion.engines) {
    if (engine.diverged !== null) continue;
    for (let k = 0; k <= 8; k++) {
      if (!placesAt(engine, count, Math.round((k / 8) * (t.length - 1)), places)) continue;
      for (let s = 0; s < rest.length; s += each) {
        const value = Math.abs(strain(places, count, springs[2 * s], springs[2 * s + 1], rest[s]));
        if (value < Infinity) found.push(value);
      }
    }
  }
  found.sort((a, b) => a - b);
  return found[Math.floor(0.98 * (found.length - 1))] || 0.01;
}

/**
 * (length - rest) / rest; of a spring without a length at rest there is none: 0.
 * @param {Float32Array} places @param {number} count @param {number} i @param {number} j @param {number} rest
 */
export function strain(places, count, i, j, rest) {
  const x = places[i] - places[j];
  const y = places[count + i] - places[count + j];
  const z = places[2 * count + i] - places[2 * count + j];
  return rest > 0 ? Math.sqrt(x * x + y * y + z * z) / rest - 1 : 0;
}
