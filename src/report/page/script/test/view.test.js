import assert from "node:assert/strict";
import { test } from "node:test";
import { Camera } from "../src/camera.js";
import { pixel, STEPS, strainScale, strainStep } from "../src/colours.js";
import { wires } from "../src/obstacles.js";
import { split } from "../src/picture.js";
import { mix, Raster } from "../src/raster.js";

const panel = { left: 100, top: 0, right: 300, bottom: 100 };
const project = (camera, [x, y, z]) => {
  const out = new Float32Array(3);
  camera.project(Float32Array.of(x, y, z), 1, panel, out);
  return out;
};

test("the axes stay at right angles and of length 1, and are right-handed", () => {
  const camera = new Camera();
  for (const [turn, tilt] of [[0, 0], [1, 0.5], [-2, -1.2], [3, Math.PI / 2]]) {
    Object.assign(camera, { turn, tilt });
    const [r, u, b] = camera.axes();
    const dot = (a, c) => a[0] * c[0] + a[1] * c[1] + a[2] * c[2];
    for (const [a, c, value] of [[r, r, 1], [u, u, 1], [b, b, 1], [r, u, 0], [u, b, 0], [b, r, 0]]) assert.ok(Math.abs(dot(a, c) - value) < 1e-12);
    const cross = [r[1] * u[2] - r[2] * u[1], r[2] * u[0] - r[0] * u[2], r[0] * u[1] - r[1] * u[0]];
    assert.ok(cross.every((x, axis) => Math.abs(x - b[axis]) < 1e-12));
  }
});

test("z is up from the side, y is up from above, x is right in both", () => {
  for (const [box, up] of [[[[0, 0, 0], [1, 0, 1]], [0, 0, 1]], [[[0, 0, 0], [1, 1, 0]], [0, 1, 0]]]) {
    const camera = new Camera();
    camera.face(box);
    camera.distance = 10;
    const [x, y] = project(camera, up);
    assert.ok(Math.abs(x - 200) < 1e-3 && y < 49);
    assert.ok(project(camera, [1, 0, 0])[0] > 201);
  }
});

test("all points lie within the panel after a fit, and one of them near its edge", () => {
  const points = [[0, 0, 0], [5, 1, 0], [3, 2, 7], [-4, 1, 2]];
  const camera = new Camera();
  for (const turn of [0, 1, 2, 3]) {
    camera.turn = turn;
    camera.tilt = 0.3;
    camera.fit(points, 200, 100);
    const seen = points.map((point) => project(camera, point)).map(([x, y]) => Math.max(Math.abs(x - 200) / 100, Math.abs(y - 50) / 50));
    // The margin is 1 / 1.15.
    assert.ok(Math.max(...seen) < 0.88 && Math.max(...seen) > 0.86, `${seen}`);
  }
});

test("what lies behind the eye has no pixel and draws nothing", () => {
  const camera = new Camera();
  camera.distance = 1;
  const [x, y] = project(camera, [0, -5, 0]);
  assert.ok(Number.isNaN(x));
  const raster = new Raster(10, 10);
  raster.thin(x, y, 5, 5, 1);
  raster.thick(5, 5, x, y, 3, 1);
  raster.disc(x, y, 3, 1);
  assert.ok(raster.pixels.every((value) => value === 0));
});

const set = (raster) => [...raster.pixels].flatMap((value, i) => (value ? [[i % raster.width, Math.floor(i / raster.width)]] : []));

test("a thin line covers one pixel in each column", () => {
  const raster = new Raster(8, 8);
  raster.thin(0.5, 0.5, 7.5, 4.5, 0xff0000ff);
  const columns = set(raster).map(([x]) => x).sort();
  assert.deepEqual(columns, [0, 1, 2, 3, 4, 5, 6, 7]);
});

test("no line leaves its panel, wherever its ends are", () => {
  const raster = new Raster(40, 30);
  raster.clip({ left: 10, top: 5, right: 30, bottom: 20 });
  for (let k = 0; k < 4000; k++) {
    // A spiral of ends in all directions, near and far.
    const [a, b, reach] = [k * 2.4, k * 1.7, 2 ** (k % 22)];
    const ends = [20 + reach * Math.cos(a), 12 + reach * Math.sin(a), 20 + 7 * Math.cos(b), 12 - reach * Math.sin(b)];
    raster.thin(...ends, 0xff000001);
    raster.thin(ends[1] + 8, ends[0] - 8, ends[3] + 8, ends[2] - 8, 0xff000001);
    if (k % 10 === 0) raster.thick(...ends, 3, 0xff000001);
  }
  raster.disc(10, 5, 6, 0xff000001);
  for (const [x, y] of set(raster)) assert.ok(x >= 10 && x < 30 && y >= 5 && y < 20, `${x}, ${y}`);
  assert.ok(set(raster).length > 200);
});

test("a smooth line covers its length times its width", () => {
  for (const [x1, y1] of [[50, 10], [50, 40], [12, 50], [10.25, 10]]) {
    const raster = new Raster(60, 60);
    raster.clear(0xff000000);
    raster.thick(10, 10, x1, y1, 3, 0xff0000ff);
    const area = raster.pixels.reduce((sum, value) => sum + (value & 255) / 255, 0);
    const length = Math.hypot(x1 - 10, y1 - 10);
    // A dot of less than a pixel shows as half a column.
    if (length > 1) assert.ok(Math.abs(area - 3 * length) < 0.02 * area, `${area} for ${3 * length}`);
    else assert.ok(area > 1);
  }
});

test("strains of both signs are apart, and none is at the middle", () => {
  const scale = strainScale(false);
  assert.equal(strainStep(0, 0.1), (STEPS - 1) / 2);
  assert.deepEqual([-9, 9, NaN].map((x) => strainStep(x, 0.1)), [0, STEPS - 1, 0]);
  assert.equal(scale[0], pixel("#0072b2"));
  assert.equal(scale[STEPS - 1], pixel("#d55e00"));
  assert.equal(mix(0xff000000, 0xffffffff, 0.2), 0xff333333);
});

test("in the dark black is light, white is dark, and blue stays blue", () => {
  assert.equal(pixel("#ffffff", true), 0xff121212);
  assert.equal(pixel("#000000", true), 0xffededed);
  const [r, g, b] = [0, 8, 16].map((shift) => (pixel("#0072b2", true) >>> shift) & 255);
  assert.ok(b > g && g > r);
});

test("wires lie on their shapes", () => {
  const near = (a, b) => assert.ok(Math.abs(a - b) < 1e-12, `${a} is not ${b}`);
  const middle = [3, 1, 2];
  for (const [x, y, z] of wires({ shape: "plane", normal: [0, 3, 4], offset: 10 }, middle, 2)) near(3 * y + 4 * z, 10 + 0 * x);
  for (const [x, y, z] of wires({ shape: "ball", center: [1, 2, 3], radius: 2 }, middle, 2)) near(Math.hypot(x - 1, y - 2, z - 3), 2);
  const box = wires({ shape: "box", center: [1, 0, 0], half: [1, 2, 3], axes: [[1, 0, 0], [0, 1, 0], [0, 0, 1]] }, middle, 2);
  assert.equal(box.length, 24);
  for (const [x, y, z] of box) assert.deepEqual([Math.abs(x - 1), Math.abs(y), Math.abs(z)], [1, 2, 3]);
  for (const [x, y, z] of wires({ shape: "capsule", ends: [[0, 0, 0], [0, 0, 2]], radius: 0.5 }, middle, 2)) {
    near(Math.hypot(x, y, z - Math.max(0, Math.min(2, z))), 0.5);
  }
  const two = { shape: "mesh", vertices: [[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]], triangles: [[0, 1, 2], [2, 1, 3]] };
  assert.equal(wires(two, middle, 2).length, 2 * 5);
});

test("panels follow the shape of what they show", () => {
  assert.deepEqual(split(4, 2, 2), [2, 2]);
  assert.deepEqual(split(4, 2, 100), [1, 4]);
  assert.deepEqual(split(4, 2, 0.01), [4, 1]);
  assert.deepEqual(split(1, 2, NaN), [1, 1]);
});
