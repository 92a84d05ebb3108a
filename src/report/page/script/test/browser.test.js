// The built page in a real browser, opened from disk.

import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { readFileSync } from "node:fs";
import { after, before, test } from "node:test";
import { fixture, launch, missing } from "../tools/chromium.js";

const options = { skip: missing };
let browser;
before(async () => {
  if (missing) return;
  execFileSync(process.execPath, [new URL("../fixture/make.js", import.meta.url).pathname]);
  browser = await launch();
});
after(() => browser?.close());

/** Opens a fixture page; it must ask for nothing and complain of nothing. */
async function open(name, { json, ...context } = {}) {
  const page = await browser.newPage({ viewport: { width: 1280, height: 900 }, reducedMotion: "reduce", ...context });
  const bad = [];
  page.on("console", (message) => ["error", "warning"].includes(message.type()) && bad.push(message.text()));
  page.on("pageerror", (error) => bad.push(String(error)));
  page.on("request", (request) => /^(file|data):/.test(request.url()) || bad.push(request.url()));
  if (json) {
    // The page with another playback in it.
    const html = readFileSync(new URL(fixture(name)), "utf8");
    await page.setContent(html.replace(/(application\/json">).*?(<\/script>)/s, (_, head, tail) => head + json + tail));
  } else await page.goto(fixture(name));
  if (context.javaScriptEnabled !== false) await page.waitForSelector("html[data-ready]");
  return { page, close: async () => (assert.deepEqual(bad, []), page.close()) };
}
const time = (page) => page.evaluate(() => window.springcheckPlayer.clock.time);
/** Pixels of the picture near a colour. */
const inked = (page, rgb) => page.evaluate(async (wanted) => {
  await new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)));
  const data = window.springcheckPlayer.picture.raster.bytes;
  let count = 0;
  for (let i = 0; i < data.length; i += 4) if (wanted.every((part, k) => Math.abs(data[i + k] - part) < 3)) count++;
  return count;
}, rgb);

test("plays by mouse and keyboard, and waits where motion is unwelcome", options, async () => {
  const { page, close } = await open("spring");
  await page.waitForTimeout(300);
  assert.equal(await time(page), 0);
  await page.getByRole("button", { name: "Play" }).click();
  await page.waitForFunction(() => window.springcheckPlayer.clock.time > 0.3);
  await page.getByRole("button", { name: "Pause" }).click();
  const stopped = await time(page);
  await page.waitForTimeout(200);
  assert.equal(await time(page), stopped);
  await page.locator("canvas").focus();
  await page.keyboard.press(" ");
  await page.waitForFunction((was) => window.springcheckPlayer.clock.time > was, stopped);
  await close();
});

test("starts by itself where motion is welcome", options, async () => {
  const { page, close } = await open("spring", { reducedMotion: "no-preference" });
  await page.waitForFunction(() => window.springcheckPlayer.clock.time > 0.1);
  await close();
});

test("scrubbing lands on a stored instant, with the particle where it is then", options, async () => {
  const { page, close } = await open("spring");
  await page.getByLabel("Time", { exact: true }).fill("40");
  // 201 frames over 10 s; the truth is 1 + 0.4 cos 3t, stored to 1 / 1024 m.
  assert.equal(await time(page), 2);
  const [x] = await page.evaluate(() => window.springcheckPlayer.place("truth", 1));
  assert.ok(Math.abs(x - (1 + 0.4 * Math.cos(6))) <= 0.5 / 1024 + 1e-12, `${x}`);
  // The marks of divergence and fault jump there.
  await page.getByRole("button", { name: /Explicit Euler: diverges/ }).click();
  assert.equal(await time(page), 5.95);
  await close();
});

test("an engine is drawn while it is on and has frames", options, async () => {
  const { page, close } = await open("spring");
  const blue = [0, 0x72, 0xb2];
  assert.ok((await inked(page, blue)) > 30);
  await page.getByRole("checkbox", { name: /Explicit Euler/ }).focus();
  await page.keyboard.press(" ");
  assert.equal(await inked(page, blue), 0);
  await page.keyboard.press(" ");
  assert.ok((await inked(page, blue)) > 30);
  await page.getByLabel("Trails").uncheck();
  await page.evaluate(() => window.springcheckPlayer.clock.seek(8));
  assert.equal(await inked(page, blue), 0);
  await close();
});

test("turning, moving, zooming and fitting", options, async () => {
  const { page, close } = await open("course");
  const camera = () => page.evaluate(() => { const { turn, tilt, distance, target } = window.springcheckPlayer.camera; return { turn, tilt, distance, target }; });
  const first = await camera();
  const box = await page.locator("canvas").boundingBox();
  await page.mouse.move(box.x + 300, box.y + 200);
  await page.mouse.down();
  await page.mouse.move(box.x + 400, box.y + 200);
  await page.mouse.up();
  const turned = await camera();
  assert.ok(turned.turn < first.turn && turned.tilt === first.tilt);
  await page.mouse.wheel(0, -100);
  await page.keyboard.press("ArrowUp");
  await page.keyboard.press("Shift+ArrowLeft");
  const moved = await camera();
  assert.ok(moved.distance < turned.distance && moved.tilt < turned.tilt && moved.target[0] !== turned.target[0]);
  await page.keyboard.press("f");
  assert.deepEqual(await camera(), first);
  await close();
});

test("the clock is a line in each figure, and the pointer there moves it", options, async () => {
  const { page, close } = await open("spring");
  const figure = page.locator("figure svg").first();
  await figure.scrollIntoViewIfNeeded();
  const box = await figure.boundingBox();
  // Half-way from pixel 60 to pixel 620 of 760 is 5 s.
  await page.mouse.move(box.x + (box.width * 300) / 760, box.y + 20);
  await page.mouse.move(box.x + (box.width * 340) / 760, box.y + 20);
  assert.ok(Math.abs((await time(page)) - 5) < 0.02);
  for (const line of await page.locator("line.clock").all()) assert.ok(Math.abs(Number(await line.getAttribute("x1")) - 340) < 1);
  await close();
});

test("pointer and focus highlight an engine everywhere", options, async () => {
  const { page, close } = await open("spring");
  const row = page.locator("tr[data-engine=rk4] td[data-tip]").first();
  for (const act of [() => row.hover(), () => row.focus()]) {
    await page.mouse.move(5, 5);
    await act();
    assert.equal(await page.locator("[data-engine=rk4].dim").count(), 0);
    assert.equal(await page.locator("[data-engine]:not([data-engine=rk4]):not(.dim)").count(), 0);
    assert.equal(await page.evaluate(() => window.springcheckPlayer.picture.choice.chosen), "rk4");
  }
  await page.evaluate(() => document.activeElement.blur());
  assert.equal(await page.locator(".dim").count(), 0);
  await close();
});

test("a table is sorted by Enter on a header and filtered by a text", options, async () => {
  const { page, close } = await open("spring");
  const values = async () => (await page.locator("tbody tr:visible td:nth-child(2)").evaluateAll((cells) => cells.map((cell) => Number(cell.dataset.value))));
  const before = await values();
  const sorted = [...before].sort((a, b) => a - b);
  await page.getByRole("columnheader", { name: /error/ }).getByRole("button").focus();
  await page.keyboard.press("Enter");
  assert.deepEqual(await values(), sorted);
  assert.equal(await page.locator("th[aria-sort=ascending]").count(), 1);
  await page.keyboard.press("Enter");
  assert.deepEqual(await values(), sorted.reverse());
  await page.getByRole("searchbox").fill("runge h");
  assert.equal((await values()).length, 1);
  await close();
});

test("exact values on hover, on focus and along a figure by arrows", options, async () => {
  const { page, close } = await open("spring");
  const tip = page.locator("#tip");
  const points = page.locator("figure").first().locator("circle[data-tip]");
  await points.nth(3).scrollIntoViewIfNeeded();
  await page.waitForTimeout(100);
  await points.nth(3).hover();
  assert.ok(await tip.isVisible());
  assert.equal(await tip.textContent(), await points.nth(3).getAttribute("data-tip"));
  await points.first().focus();
  await page.keyboard.press("ArrowRight");
  assert.equal(await tip.textContent(), await points.nth(1).getAttribute("data-tip"));
  await page.keyboard.press("Escape");
  assert.ok(await tip.isHidden());
  await close();
});

test("nothing is wider than a narrow window, and all is named", options, async () => {
  for (const name of ["spring", "cloth", "course"]) {
    const { page, close } = await open(name, { viewport: { width: 390, height: 800 } });
    assert.ok((await page.evaluate(() => document.documentElement.scrollWidth)) <= 390, name);
    for (const control of await page.locator("button, input, select, canvas").all()) {
      const named = await control.evaluate((one) => one.getAttribute("aria-label") || one.labels?.[0]?.textContent || one.textContent);
      assert.ok(named?.trim(), await control.evaluate((one) => one.outerHTML));
    }
    await close();
  }
});

test("a motion of next to nothing, and one that cannot be read", options, async () => {
  const { page, close } = await open("spring");
  const html = await page.content();
  const start = html.indexOf('type="application/json">') + 'type="application/json">'.length;
  const playback = JSON.parse(html.slice(start, html.indexOf("</script>", start)));
  const none = { count: 0, ends: "", rest: "" };
  const [truth] = playback.engines;
  const bare = { ...playback, springs: none, particles: { count: 0, fixed: [], radius: 0 }, engines: [] };
  const variants = {
    still: { ...playback, t: [0], engines: [{ ...truth, last: 0, positions: "AwA=" }] },
    empty: { ...bare, t: [] },
    free: { ...bare, t: [0, 1], obstacles: [{ shape: "plane", normal: [0, 0, 1], offset: 0 }] },
    broken: { ...playback, engines: [{ ...truth, positions: "AwA=" }] },
  };
  for (const [name, variant] of Object.entries(variants)) {
    const { page: other, close: shut } = await open("spring", { json: JSON.stringify(variant) });
    if (name === "broken") assert.match(await other.locator("#player").textContent(), /cannot be played: expected/);
    else {
      await other.locator("canvas").focus();
      for (const key of [" ", ".", ",", "f"]) await other.keyboard.press(key);
      assert.equal(await time(other), 0, name);
    }
    assert.ok(await other.getByRole("searchbox").isVisible());
    await shut();
  }
  await close();
});

test("tables and figures are there without the script", options, async () => {
  const { page, close } = await open("spring", { javaScriptEnabled: false });
  assert.equal(await page.locator("tbody tr").count(), 8);
  assert.ok(await page.locator("figure svg").first().isVisible());
  await close();
});
