import assert from "node:assert/strict";
import { test } from "node:test";
import { decode, eachNumber, ends, fromBase64, inflate, positions } from "../src/codec.js";
import { leb128, pack, packEnds, packPositions } from "../fixture/encode.js";

const unpack = (text) => inflate(fromBase64(text));

/** A generator of its own, so that a failure comes again. */
function* random(seed) {
  for (let state = seed; ; ) {
    state = (Math.imul(state, 1664525) + 1013904223) >>> 0;
    yield state / 2 ** 32;
  }
}

test("bytes written by hand are the numbers of the standard", () => {
  // DWARF's example of LEB128: 624485 = e5 8e 26; zigzag: 0, -1, 1, -2 are 0, 1, 2, 3.
  const found = [];
  eachNumber(Uint8Array.of(0, 1, 2, 3, 0xe5, 0x8e, 0x26), 5, (value) => found.push(value));
  assert.deepEqual(found, [0, -1, 1, -2, -(624485 + 1) / 2]);
});

test("two particles over two frames, packed by hand", () => {
  // x: 5 7 then 6 9; y and z stay at 0. d = 5 7, 1 2; e = 5 2, 1 1; zigzag 10 4, 2 2.
  const bytes = Uint8Array.of(10, 4, 0, 0, 0, 0, 2, 2, 0, 0, 0, 0);
  assert.deepEqual([...positions(bytes, 2, 2)], [5, 7, 0, 0, 0, 0, 6, 9, 0, 0, 0, 0]);
});

test("positions come back to half a unit, over 32 bits of differences too", async () => {
  const draw = random(7);
  const [count, unit, origin] = [13, 1 / 512, [1, -2, 3]];
  // Up to 2^30 units to both sides: differences of differences pass 2^32.
  for (const size of [1, 1e3, 2 ** 21]) {
    const frames = Array.from({ length: 9 }, () => Float64Array.from({ length: 3 * count }, () => size * (2 * draw.next().value - 1)));
    const q = positions(await unpack(packPositions(frames, count, origin, unit)), 9, count);
    frames.forEach((frame, f) => frame.forEach((x, i) => {
      const found = origin[Math.floor(i / count)] + unit * q[f * 3 * count + i];
      assert.ok(Math.abs(found - x) <= unit / 2 + 1e-9 * size, `${found} is not ${x}`);
    }));
  }
});

test("ends come back, and a particle that is not there is refused", async () => {
  const list = [0, 1, 1, 2, 9, 0, 3, 3];
  const bytes = await unpack(packEnds(list));
  assert.deepEqual([...ends(bytes, 4, 10)], list);
  assert.throws(() => ends(bytes, 4, 9), /no particle 9/);
});

test("too few or too many bytes, and numbers past 32 bits, are refused", () => {
  assert.throws(() => positions(leb128([1, 2, 3]), 1, 2), /expected 6 numbers/);
  assert.throws(() => positions(leb128([1, 2, 3, 4]), 1, 1), /expected 3 numbers/);
  assert.throws(() => positions(leb128([2 ** 31, 0, 0]), 1, 1), /32 bits/);
});

test("a playback without springs and rods is read; another version is not", async () => {
  const engine = { id: "a", last: 1, origin: [0, 0, 0], unit: 1, positions: pack(leb128([4, 5, 6])) };
  const none = { count: 0, ends: "", rest: "" };
  const playback = { version: 1, particles: { count: 1, fixed: [], radius: 0 }, springs: none, rods: none, obstacles: [], t: [0], engines: [engine] };
  const motion = await decode(playback);
  assert.deepEqual([...motion.engines[0].q], [4, 5, 6]);
  await assert.rejects(decode({ ...playback, version: 2 }), /version 2/);
});
