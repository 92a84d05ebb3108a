// The one clock of the page, and the one highlighted engine.

/** @typedef {import("./types").Motion} Motion */

/** Seconds of the scene in one second of the reader. */
export const SPEEDS = [0.001, 0.003, 0.01, 0.03, 0.1, 0.25, 0.5, 1, 2, 5, 10, 30, 100];

/** The speed nearest to real time at which a motion takes 4 to 20 seconds. @param {number} duration seconds */
export function firstSpeed(duration) {
  const lasts = SPEEDS.map((speed) => duration / speed);
  const wanted = Math.max(4, Math.min(20, duration));
  const off = lasts.map((time) => Math.abs(Math.log(time / wanted)));
  return duration > 0 ? SPEEDS[off.indexOf(Math.min(...off))] : 1;
}

export class Clock {
  /** @param {number[]} t seconds of the frames */
  constructor(t) {
    this.start = t[0] ?? 0;
    this.end = t[t.length - 1] ?? 0;
    this.time = this.start;
    this.speed = firstSpeed(this.end - this.start);
    this.again = true;
    this.playing = false;
    /** @type {(() => void)[]} */
    this.hearers = [];
    this.last = 0;
  }

  /** @param {() => void} hearer is called whenever the moment or the state changes */
  listen(hearer) {
    this.hearers.push(hearer);
    hearer();
  }

  tell() {
    for (const hearer of this.hearers) hearer();
  }

  /** @param {number} time seconds */
  seek(time) {
    this.playing = false;
    this.time = Math.max(this.start, Math.min(this.end, time));
    this.tell();
  }

  play() {
    if (this.playing || !(this.end > this.start)) return;
    if (this.time >= this.end) this.time = this.start;
    this.playing = true;
    this.last = performance.now();
    requestAnimationFrame((now) => this.tick(now));
    this.tell();
  }

  pause() {
    this.playing = false;
    this.tell();
  }

  /** @param {number} now milliseconds */
  tick(now) {
    if (!this.playing) return;
    // After a hidden tab the motion goes on where it was.
    this.time += (Math.max(0, Math.min(250, now - this.last)) / 1000) * this.speed;
    this.last = now;
    if (this.time >= this.end) {
      this.playing = this.again;
      this.time = this.again ? this.start : this.end;
    }
    this.tell();
    if (this.playing) requestAnimationFrame((next) => this.tick(next));
  }
}

/** @param {number} time @param {number} duration both seconds: digits show a thousandth of the duration */
export function seconds(time, duration) {
  const digits = duration > 0 ? Math.max(0, Math.min(9, 3 - Math.floor(Math.log10(duration)))) : 0;
  return `${time.toFixed(digits)} s`;
}
