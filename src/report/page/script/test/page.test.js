import assert from "node:assert/strict";
import { test } from "node:test";
import { Clock, firstSpeed, seconds } from "../src/clock.js";
import { timeAxis, valueAt } from "../src/figures.js";
import { compare, order, quantity } from "../src/tables.js";

test("a moment and its pixel belong together", () => {
  const axis = timeAxis("0,10,50,250");
  assert.equal(axis.x(5), 150);
  assert.equal(axis.time(150), 5);
  assert.ok(axis.holds(10) && !axis.holds(10.1) && !axis.holds(-1));
  for (const text of [undefined, "", "1,2,3", "0,0,1,2", "0,1,x,2"]) assert.equal(timeAxis(text), null);
});

test("numbers sort as numbers, texts as readers expect, nothing comes last in both directions", () => {
  assert.deepEqual(["10", "9", "1e-7", "-3"].sort(compare), ["-3", "1e-7", "9", "10"]);
  assert.deepEqual(["step 10", "step 9"].sort(compare), ["step 9", "step 10"]);
  assert.deepEqual(order(["2", "", "1", "none"], false), [2, 0, 3, 1]);
  assert.deepEqual(order(["2", "", "1", "none"], true), [3, 0, 2, 1]);
  assert.deepEqual(order(["a", "a", "a"], true), [0, 1, 2]);
});

test("any motion lasts 2 to 60 seconds at its first speed", () => {
  for (let duration = 0.01; duration < 1000; duration *= 1.3) {
    const lasts = duration / firstSpeed(duration);
    assert.ok(lasts > 2 && lasts < 60, `${duration} s lasts ${lasts} s`);
  }
  assert.equal(firstSpeed(10), 1);
  assert.equal(firstSpeed(0), 1);
});

test("the clock stays within the motion and tells of each change", () => {
  const clock = new Clock([1, 2, 4]);
  const heard = [];
  clock.listen(() => heard.push(clock.time));
  for (const time of [3, -5, 9]) clock.seek(time);
  assert.deepEqual(heard, [1, 3, 1, 4]);
  assert.equal(new Clock([]).time, 0);
});

test("a thousandth of the motion shows in its time", () => {
  assert.equal(seconds(1.23456, 10), "1.23 s");
  assert.equal(seconds(0.00123456, 0.01), "0.00123 s");
  assert.equal(seconds(7, 0), "7 s");
});

test("a quantity with a unit of time is in seconds, a word stays a word", () => {
  for (const [text, value] of [["12.3 ms ±14%", 0.0123], ["178 µs", 1.78e-4], ["1.2e-3", 1.2e-3], ["-0.92", -0.92], ["+11", 11], ["±2.5e-3", 2.5e-3], ["1,000", 1000], ["2 min", 120]]) {
    assert.ok(Math.abs(Number(quantity(text)) - value) <= 1e-15 + 1e-12 * Math.abs(value), `${text}: ${quantity(text)}`);
  }
  for (const text of ["floor", "-", "", "growing"]) assert.equal(quantity(text), text);
});

test("a figure reads out the stored value that is nearest in time", () => {
  const values = "0 1,0.1 2,0.3 4";
  assert.deepEqual(valueAt(values, 0.09), [0.1, 2]);
  assert.deepEqual(valueAt(values, 9), [0.3, 4]);
  assert.deepEqual(valueAt(values, -1), [0, 1]);
  assert.equal(valueAt("", 0), null);
});
