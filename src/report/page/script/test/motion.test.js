import assert from "node:assert/strict";
import { test } from "node:test";
import { frameAt, placeOf, placesAt, sample, strain } from "../src/motion.js";

// One particle, three frames: x is 0, 2, 6 units of half a metre from x = 1.
const engine = { last: 3, diverged: null, origin: [1, 0, 0], unit: 0.5, q: Int32Array.of(0, 0, 0, 2, 0, 0, 6, 0, 0) };

test("a moment lies between the frames around it, of uneven distance too", () => {
  const t = [0, 1, 3, 3.5];
  assert.deepEqual([-1, 0, 0.5, 1, 2, 3.25, 9].map((time) => frameAt(t, time)), [0, 0, 0.5, 1, 1.5, 2.5, 3]);
  t.forEach((time, frame) => assert.equal(frameAt(t, time), frame));
  assert.equal(frameAt([], 1), 0);
});

test("stored instants are exact, between them lies a straight line, after the last nothing", () => {
  const out = new Float32Array(3);
  for (const [frame, x] of [[0, 1], [1, 2], [1.5, 3], [2, 4]]) {
    assert.ok(placesAt(engine, 1, frame, out));
    assert.equal(out[0], x);
    assert.equal(placeOf(engine, 1, frame, 0)[0], x);
  }
  assert.equal(placesAt(engine, 1, 2.1, out), false);
  assert.equal(placesAt({ ...engine, last: 0 }, 1, 0, out), false);
});

test("the view holds what did not diverge, or the start of what did", () => {
  const x = (points) => points.map((point) => point[0]);
  assert.deepEqual(x(sample({ count: 1, engines: [engine] })), [1, 2, 4]);
  const lost = { ...engine, diverged: 1, unit: 1e9 };
  assert.deepEqual(x(sample({ count: 1, engines: [engine, lost] })), [1, 2, 4]);
  assert.deepEqual(x(sample({ count: 1, engines: [lost] })), [1]);
  assert.equal(sample({ count: 0, engines: [] }).length, 2);
});

test("a spring of 3, 4, 12 is 13 long: at rest at 10 its strain is 0.3", () => {
  const places = Float32Array.of(0, 3, 0, 4, 0, 12);
  assert.ok(Math.abs(strain(places, 2, 0, 1, 10) - 0.3) < 1e-15);
  assert.equal(strain(places, 2, 0, 1, 0), 0);
});
