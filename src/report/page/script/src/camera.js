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
   * Goes to where all points lie within a panel, with a margin.
   * @param {Vec3[]} points @param {number} width @param {number} height
   */
  fit(points, width, height) {
    const side = Math.min(width, height);
    const axes = this.axes();
    const { low, high } = this.reach(points);
    const middle = low.map((x, k) => (x + high[k]) / 2);
    this.target = /** @type {Vec3} */ ([0, 1, 2].map((axis) => axes.reduce((sum, way, k) => sum + middle[k] * way[axis], 0)));
    let far = 1e-9;
    for (const point of points) {
      const [x, y, z] = axes.map((way, k) => dot(way, point) - middle[k]);
      far = Math.max(far, z + 1.15 * FOCUS * Math.max((Math.abs(x) * side) / width, (Math.abs(y) * side) / height));
    }
    this.distance = far;
  }

  /** The least and the most of points to the right, up and back. @param {Vec3[]} points */
  reach(points) {
    const [low, high] = [[Infinity, Infinity, Infinity], [-Infinity, -Infinity, -Infinity]];
    const axes = this.axes();
    for (const point of points) {
      axes.forEach((way, k) => {
        const x = dot(way, point);
        if (x < low[k]) low[k] = x;
        if (x > high[k]) high[k] = x;
      });
    }
    return { low, high };
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

/** @param {number[]} a @param {number[]} b */
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
