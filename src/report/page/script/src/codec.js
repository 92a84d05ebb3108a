// From the packed text of the page to numbers: base64, deflate-raw, LEB128, zigzag, differences.

/** @typedef {import("./types").Playback} Playback */
/** @typedef {import("./types").Motion} Motion */

/** @param {string} text base64 @returns {Uint8Array<ArrayBuffer>} */
export function fromBase64(text) {
  const raw = atob(text);
  const bytes = new Uint8Array(raw.length);
  for (let i = 0; i < raw.length; i++) bytes[i] = raw.charCodeAt(i);
  return bytes;
}

/** @param {Uint8Array<ArrayBuffer>} bytes deflate-raw */
export async function inflate(bytes) {
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate-raw"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

/**
 * Calls `take` with each number of a chain of zigzag LEB128 numbers.
 * @param {Uint8Array} bytes
 * @param {number} count how many numbers there must be
 * @param {(value: number, index: number) => void} take
 */
export function eachNumber(bytes, count, take) {
  let at = 0;
  for (let i = 0; i < count; i++) {
    let byte = bytes[at++];
    let value = byte & 127;
    // Products, not shifts: a difference of differences may pass 32 bits.
    for (let scale = 128; byte > 127; scale *= 128) {
      byte = bytes[at++];
      value += (byte & 127) * scale;
    }
    take(value % 2 ? -(value + 1) / 2 : value / 2, i);
  }
  if (at !== bytes.length) throw new RangeError(`expected ${count} numbers in ${bytes.length} bytes`);
}

/** @param {number} value */
function int32(value) {
  if (value !== (value | 0)) throw new RangeError(`${value} does not fit 32 bits`);
  return value;
}

/**
 * q of all frames: e is the difference along particles of the difference in time.
 * @param {Uint8Array} bytes @param {number} frames @param {number} count of particles
 */
export function positions(bytes, frames, count) {
  const q = new Int32Array(frames * 3 * count);
  const frame = 3 * count;
  let d = 0;
  eachNumber(bytes, q.length, (e, i) => {
    d = i % count ? d + e : e;
    q[i] = int32(i < frame ? d : q[i - frame] + d);
  });
  return q;
}

/** @param {Uint8Array} bytes @param {number} pairs @param {number} count of particles */
export function ends(bytes, pairs, count) {
  const list = new Int32Array(2 * pairs);
  let before = 0;
  eachNumber(bytes, list.length, (step, i) => {
    before += step;
    if (before < 0 || before >= count) throw new RangeError(`there is no particle ${before}`);
    list[i] = before;
  });
  return list;
}

/** @param {string} text */
const unpack = (text) => inflate(fromBase64(text));

/** @param {{count: number, ends: string}} pairs @param {number} count */
const unpackEnds = async (pairs, count) =>
  pairs.count ? ends(await unpack(pairs.ends), pairs.count, count) : new Int32Array(0);

/** @param {Playback} playback @returns {Promise<Motion>} */
export async function decode(playback) {
  if (playback.version !== 1) throw new RangeError(`playback of version ${playback.version} is not known here`);
  const { count, fixed, radius } = playback.particles;
  const engines = [];
  for (const { positions: text, ...facts } of playback.engines) {
    engines.push({ ...facts, q: positions(await unpack(text), facts.last, count) });
  }
  const springs = await unpackEnds(playback.springs, count);
  // The lengths at rest are plain little-endian floats, a few bytes a spring.
  const rest = new Float32Array(fromBase64(playback.springs.rest).buffer);
  if (rest.length !== playback.springs.count) throw new RangeError("one length at rest is expected for each spring");
  const rods = await unpackEnds(playback.rods, count);
  return { count, fixed, radius, springs, rest, rods, obstacles: playback.obstacles, t: playback.t, engines };
}
