// A camera that goes round a point, z up, and its projection onto a panel.

/** @typedef {import("./types").Vec3} Vec3 */
/** @typedef {import("./types").Panel} Panel */

/** Half the opening angle is 16 degrees: lines stay nearly parallel. */
const FOCUS = 1 / Math.tan((16 * Math.PI) / 180);

export class Camera {
  constructor() {
    /** @type {Vec3} what it looks at */
    this.target = [0, 0, 0];
    /** Radians round z; at 0 the x axis points right. */
    this.turn = 0;
    /** Radians above the horizon; at a right angle the y axis points up. */
    this.tilt = 0;
    this.distance = 1;
  }

  /** Right, up, and back (towards the eye), of length 1. @returns {[Vec3, Vec3, Vec3]} */
  axes() {
    const [s, c] = [Math.sin(this.turn), Math.cos(this.turn)];
    const [sp, cp] = [Math.sin(this.tilt), Math.cos(this.tilt)];
    return [
      [c, s, 0],
      [-sp * s, sp * c, cp],
      [cp * s, -cp * c, sp],
    ];
  }

  /** @param {number} turn radians @param {number} tilt radians */
  orbit(turn, tilt) {
    this.turn += turn;
    this.tilt = Math.max(-Math.PI / 2, Math.min(Math.PI / 2, this.tilt + tilt));
  }

  /** Moves the picture by parts of a panel's smaller side. @param {number} right @param {number} down */
  pan(right, down) {
    const [r, u] = this.axes();
    const metres = (2 * this.distance) / FOCUS;
    for (let axis = 0; axis < 3; axis++) this.target[axis] += metres * (down * u[axis] - right * r[axis]);
  }

  /** @param {number} factor above 1 comes nearer */
  zoom(factor) {
    this.distance /= factor;
  }

  /** Looks at the flat side of a flat box, at any other from above. @param {[Vec3, Vec3]} box */
  face([low, high]) {
    const size = low.map((x, axis) => high[axis] - x);
    const flat = 0.02 * Math.max(...size);
    if (size[1] <= flat) [this.turn, this.tilt] = [0, 0];
    else if (size[2] <= flat) [this.turn, this.tilt] = [0, Math.PI / 2];
    else if (size[0] <= flat) [this.turn, this.tilt] = [Math.PI / 2, 0];
    else [this.turn, this.tilt] = [0.5, 0.4];
  }

  /**
   * Goes as far away as the box needs to lie within a panel, with a margin.
   * @param {[Vec3, Vec3]} box @param {number} width @param {number} height
   */
  fit([low, high], width, height) {
    const side = Math.min(width, height);
    const [r, u, b] = this.axes();
    this.target = /** @type {Vec3} */ (low.map((x, axis) => (x + high[axis]) / 2));
    let far = 1e-6;
    for (let corner = 0; corner < 8; corner++) {
      const d = low.map((x, axis) => (corner & (1 << axis) ? high[axis] : x) - this.target[axis]);
      const [x, y, z] = [r, u, b].map((way) => Math.abs(way[0] * d[0] + way[1] * d[1] + way[2] * d[2]));
      far = Math.max(far, z + 1.15 * FOCUS * Math.max((x * side) / width, (y * side) / height));
    }
    this.distance = far;
  }

  /**
   * Writes the pixels of points, and pixels a metre at each; NaN for what lies behind the eye.
   * @param {Float32Array} places x, y, z, each in a row @param {number} count
   * @param {Panel} panel @param {Float32Array} out x, y, scale, each in a row
   */
  project(places, count, panel, out) {
    const [[rx, ry, rz], [ux, uy, uz], [bx, by, bz]] = this.axes();
    const [tx, ty, tz] = this.target;
    const focus = (FOCUS * Math.min(panel.right - panel.left, panel.bottom - panel.top)) / 2;
    const middle = (panel.left + panel.right) / 2;
    const centre = (panel.top + panel.bottom) / 2;
    const near = 0.01 * this.distance;
    for (let i = 0; i < count; i++) {
      const x = places[i] - tx;
      const y = places[count + i] - ty;
      const z = places[2 * count + i] - tz;
      const depth = this.distance - (bx * x + by * y + bz * z);
      const scale = depth > near ? focus / depth : NaN;
      out[i] = middle + scale * (rx * x + ry * y + rz * z);
      out[count + i] = centre - scale * (ux * x + uy * y + uz * z);
      out[2 * count + i] = scale;
    }
  }
}
