// Lines and discs into the pixels of a canvas. Without a GPU this is several times faster than strokes or WebGL.

/** @typedef {import("./types").Panel} Panel */

export class Raster {
  /** @param {number} width @param {number} height */
  constructor(width, height) {
    this.width = width;
    this.height = height;
    this.bytes = new Uint8ClampedArray(4 * width * height);
    /** A pixel is a number 0xAABBGGRR: browsers run on little-endian machines. */
    this.pixels = new Uint32Array(this.bytes.buffer);
    /** The pixels that are drawn: a hair less than the panel, so that rounding in a line's steps stays inside. */
    this.left = 0;
    this.top = 0;
    this.right = width - 0.01;
    this.bottom = height - 0.01;
  }

  /** @param {number} colour */
  clear(colour) {
    this.pixels.fill(colour);
  }

  /** Draws only within the panel from now on. @param {Panel} panel */
  clip(panel) {
    this.left = panel.left;
    this.top = panel.top;
    this.right = panel.right - 0.01;
    this.bottom = panel.bottom - 0.01;
  }

  /**
   * A line of one pixel's width, unsmoothed: for the many springs of a cloth.
   * @param {number} x0 @param {number} y0 @param {number} x1 @param {number} y1 @param {number} colour
   */
  thin(x0, y0, x1, y1, colour) {
    const { left, right, top, bottom } = this;
    const across = x0 >= left && x0 < right && x1 >= left && x1 < right;
    const inside = across && y0 >= top && y0 < bottom && y1 >= top && y1 < bottom;
    if (!inside) {
      const cut = this.cut(x0, y0, x1, y1, 0);
      if (!cut) return;
      // Rounding may leave an end a hair outside.
      x0 = Math.max(left, Math.min(right, cut[0]));
      y0 = Math.max(top, Math.min(bottom, cut[1]));
      x1 = Math.max(left, Math.min(right, cut[2]));
      y1 = Math.max(top, Math.min(bottom, cut[3]));
    }
    const { pixels, width } = this;
    const dx = x1 - x0;
    const dy = y1 - y0;
    const steps = Math.ceil(Math.max(Math.abs(dx), Math.abs(dy)));
    // 16 bits before and 16 after the point.
    let x = (x0 * 65536) | 0;
    let y = (y0 * 65536) | 0;
    const sx = steps ? ((dx / steps) * 65536) | 0 : 0;
    const sy = steps ? ((dy / steps) * 65536) | 0 : 0;
    for (let i = 0; i <= steps; i++) {
      pixels[(y >> 16) * width + (x >> 16)] = colour;
      x += sx;
      y += sy;
    }
  }

  /**
   * A smoothed line of any width.
   * @param {number} x0 @param {number} y0 @param {number} x1 @param {number} y1 @param {number} wide pixels @param {number} colour
   */
  thick(x0, y0, x1, y1, wide, colour) {
    const cut = this.cut(x0, y0, x1, y1, wide);
    if (!cut) return;
    [x0, y0, x1, y1] = cut;
    const steep = Math.abs(y1 - y0) > Math.abs(x1 - x0);
    let [a0, b0, a1, b1] = steep ? [y0, x0, y1, x1] : [x0, y0, x1, y1];
    if (a0 > a1) [a0, b0, a1, b1] = [a1, b1, a0, b0];
    const along = a1 - a0;
    const slope = along > 0 ? (b1 - b0) / along : 0;
    const half = (wide / 2) * Math.sqrt(1 + slope * slope);
    for (let a = Math.floor(a0); a <= Math.floor(a1); a++) {
      // The first and last columns are covered only in part; a dot has no columns between.
      const share = Math.max(Math.min(a + 1, a1) - Math.max(a, a0), along < 1 ? 0.5 : 0);
      const middle = b0 + slope * (Math.min(Math.max(a + 0.5, a0), a1) - a0);
      for (let b = Math.floor(middle - half); b <= Math.floor(middle + half); b++) {
        const cover = share * (Math.min(middle + half, b + 1) - Math.max(middle - half, b));
        if (steep) this.blend(b, a, colour, cover);
        else this.blend(a, b, colour, cover);
      }
    }
  }

  /** @param {number} x @param {number} y @param {number} radius pixels @param {number} colour */
  disc(x, y, radius, colour) {
    const reach = radius + 1;
    const { left, right, top, bottom } = this;
    if (!(x + reach > left && x - reach < right && y + reach > top && y - reach < bottom)) return;
    for (let row = Math.max(top, Math.floor(y - reach)); row <= Math.min(bottom, y + reach); row++) {
      for (let column = Math.max(left, Math.floor(x - reach)); column <= Math.min(right, x + reach); column++) {
        const off = Math.hypot(column + 0.5 - x, row + 0.5 - y);
        this.blend(column, row, colour, radius + 0.5 - off);
      }
    }
  }

  /** @param {number} x @param {number} y @param {number} colour @param {number} cover 0 to 1 */
  blend(x, y, colour, cover) {
    if (!(cover > 0) || x < this.left || x >= this.right || y < this.top || y >= this.bottom) return;
    const at = y * this.width + x;
    this.pixels[at] = cover >= 1 ? colour : mix(this.pixels[at], colour, cover);
  }

  /**
   * The part of a line within the panel, widened by a margin (Liang and Barsky), or null.
   * @param {number} x0 @param {number} y0 @param {number} x1 @param {number} y1 @param {number} margin
   * @returns {[number, number, number, number] | null}
   */
  cut(x0, y0, x1, y1, margin) {
    const dx = x1 - x0;
    const dy = y1 - y0;
    let from = 0;
    let to = 1;
    const edges = [
      [-dx, x0 - this.left + margin],
      [dx, this.right + margin - x0],
      [-dy, y0 - this.top + margin],
      [dy, this.bottom + margin - y0],
    ];
    for (const [way, room] of edges) {
      if (!(way === way && room === room)) return null; // a point behind the eye
      if (way === 0) {
        if (room < 0) return null;
      } else if (way < 0) from = Math.max(from, room / way);
      else to = Math.min(to, room / way);
    }
    return from > to ? null : [x0 + from * dx, y0 + from * dy, x0 + to * dx, y0 + to * dy];
  }
}

/** @param {number} a pixel @param {number} b pixel @param {number} part of b */
export function mix(a, b, part) {
  let mixed = 255;
  for (const shift of [16, 8, 0]) {
    const [low, high] = [(a >>> shift) & 255, (b >>> shift) & 255];
    mixed = (mixed << 8) | Math.round(low + part * (high - low));
  }
  return mixed >>> 0;
}
