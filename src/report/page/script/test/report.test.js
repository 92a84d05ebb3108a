// Pages that springcheck wrote, in a real browser: `PAGES` is the folder that `run` was given as its output.

import assert from "node:assert/strict";
import { mkdirSync, readdirSync, readFileSync } from "node:fs";
import { basename, dirname, join, resolve } from "node:path";
import { after, before, test } from "node:test";
import { pathToFileURL } from "node:url";
import { serious } from "./axe.js";
import { launch, missing } from "../tools/chromium.js";

const folder = process.env.PAGES ? resolve(process.env.PAGES) : null;
const files = folder ? readdirSync(folder, { recursive: true }).map(String) : [];
const found = files.filter((file) => basename(file) === "report.html").map(dirname);
if (folder && !found.length) throw new Error(`no pages in ${folder}`);
const options = { skip: missing || (folder ? false : "PAGES names no folder of reports") };
const shots = join(folder ?? ".", "screenshots");

let browser;
before(async () => {
  if (options.skip) return;
  mkdirSync(shots, { recursive: true });
  browser = await launch();
});
after(() => browser?.close());

/** Opens a page from disk; it must ask for nothing and complain of nothing. */
async function open(name, context = {}) {
  const page = await browser.newPage({ viewport: { width: 1280, height: 900 }, reducedMotion: "reduce", ...context });
  const bad = [];
  page.on("console", (message) => ["error", "warning"].includes(message.type()) && bad.push(message.text()));
  page.on("pageerror", (error) => bad.push(String(error)));
  page.on("request", (request) => /^(file|data|blob):/.test(request.url()) || bad.push(request.url()));
  await page.goto(pathToFileURL(join(folder, name, "report.html")).href);
  if (context.javaScriptEnabled !== false) await page.waitForSelector("html[data-ready]");
  return { page, close: async () => (assert.deepEqual(bad, []), page.close()) };
}

const json = (name) => JSON.parse(readFileSync(join(folder, name, "report.json"), "utf8")).reports[0];

for (const name of found) {
  test(`${name}: asks for nothing, and fits`, options, async () => {
    const { page, close } = await open(name);
    const size = readFileSync(join(folder, name, "report.html")).length;
    assert.ok(size < 8e6, `${size} bytes`);
    const wide = await page.evaluate(() => document.documentElement.scrollWidth - innerWidth);
    assert.ok(wide <= 0, `${wide} pixels wider than the window`);
    await close();
  });

  test(`${name}: the table says what the JSON says`, options, async () => {
    const { page, close } = await open(name);
    const { outcomes } = json(name);
    const heads = await page.locator("table:has(tr[data-engine])").first().locator("thead th").allInnerTexts();
    const column = heads.findIndex((head) => /^error \(m\)/.test(head.trim()));
    for (const outcome of outcomes) {
      const row = page.locator(`tr[data-engine^="${outcome.engine}"]`).first();
      const cells = await row.locator("td").allInnerTexts();
      assert.ok(cells[0].includes(outcome.engine), `${cells[0]} is not ${outcome.engine}`);
      const said = cells[column];
      if (column < 0 || !outcome.position_error_m || !/^[\d.]/.test(said)) continue;
      const error = outcome.position_error_m.max;
      assert.ok(Math.abs(Number(said.replaceAll(",", "")) - error) <= 0.05 * error, `${outcome.engine}: ${said} is not ${error}`);
    }
    await close();
  });

  test(`${name}: plays, and stands where the slider says`, options, async () => {
    const { page, close } = await open(name);
    const frames = await page.evaluate(() => JSON.parse(document.getElementById("playback").textContent).t);
    const slider = page.getByLabel("Time", { exact: true });
    const middle = Math.floor(frames.length / 2);
    const before = await page.evaluate(() => Array.from(window.springcheckPlayer.picture.raster.bytes.slice()).reduce((a, b) => (31 * a + b) | 0, 0));
    await slider.fill(String(middle));
    assert.equal(await page.evaluate(() => window.springcheckPlayer.clock.time), frames[middle]);
    await page.waitForFunction((time) => Number(document.querySelector("canvas").dataset.time) === time, frames[middle]);
    const now = await page.evaluate(() => Array.from(window.springcheckPlayer.picture.raster.bytes.slice()).reduce((a, b) => (31 * a + b) | 0, 0));
    assert.notEqual(now, before, "the picture did not change");
    await page.locator("canvas").focus();
    await page.keyboard.press(" ");
    await page.waitForFunction((was) => window.springcheckPlayer.clock.time > was, frames[middle]);
    await page.keyboard.press(" ");
    await close();
  });

  test(`${name}: the motion is that of the saved rows`, options, async (context) => {
    const { page, close } = await open(name);
    const saved = readdirSync(join(folder, name)).filter((file) => /^[^.]*@[^@]*[0-9]\.csv$/.test(file));
    if (!saved.length) return context.skip("no rows were saved: run with --save csv");
    const { t, engines } = await page.evaluate(() => JSON.parse(document.getElementById("playback").textContent));
    for (const file of saved) {
      const id = file.slice(0, file.indexOf("@"));
      const engine = engines.find((one) => one.id === id);
      if (!engine) continue;
      const rows = readFileSync(join(folder, name, file), "utf8").trim().split("\n").slice(1).map((row) => row.split(",").map(Number));
      const frame = Math.floor((engine.last - 1) / 2);
      const now = rows.filter(([time]) => Math.abs(time - t[frame]) < 1e-9 * (1 + t[frame]));
      assert.ok(now.length, `no row at ${t[frame]} s`);
      await page.evaluate((time) => window.springcheckPlayer.clock.seek(time), t[frame]);
      for (const [, particle, ...place] of now) {
        const shown = await page.evaluate(([one, k]) => window.springcheckPlayer.place(one, k), [id, particle]);
        place.slice(0, 3).forEach((x, axis) =>
          assert.ok(Math.abs(x - shown[axis]) <= 0.51 * engine.unit + 1e-12 * Math.abs(x), `${id} ${particle}: ${shown[axis]} is not ${x}`));
      }
    }
    await close();
  });

  test(`${name}: an engine goes off and on by mouse and by keyboard`, options, async () => {
    const { page, close } = await open(name);
    const box = page.locator("#player fieldset input[type=checkbox]").first();
    await box.uncheck();
    const on = () => page.evaluate(() => window.springcheckPlayer.picture.choice.on.size);
    const less = await on();
    await box.focus();
    await page.keyboard.press(" ");
    assert.equal(await on(), less + 1);
    await close();
  });

  test(`${name}: figures read out their values and move the clock`, options, async () => {
    const { page, close } = await open(name);
    const figure = page.locator("svg[data-time]").first();
    await figure.scrollIntoViewIfNeeded();
    const place = await figure.boundingBox();
    await page.mouse.move(place.x + place.width * 0.3, place.y + place.height * 0.5);
    await page.mouse.move(place.x + place.width * 0.4, place.y + place.height * 0.5);
    assert.ok((await page.evaluate(() => window.springcheckPlayer.clock.time)) > 0);
    assert.match(await page.locator("#tip").innerText(), /: [-\d.e]+ at [-\d.e]+ s/);
    await close();
  });

  test(`${name}: can be read without the script`, options, async () => {
    const { page, close } = await open(name, { javaScriptEnabled: false });
    assert.ok(await page.locator(".verdict").isVisible());
    assert.ok((await page.locator("figure > svg").count()) > 0);
    await close();
  });

  for (const [width, scheme] of [[1280, "light"], [390, "dark"]]) {
    test(`${name}: no serious fault of access at ${width} px, ${scheme}`, options, async () => {
      const { page, close } = await open(name, { viewport: { width, height: 844 }, colorScheme: scheme });
      const faults = await serious(page);
      await page.screenshot({ path: join(shots, `${name.replaceAll("/", "-")}-${width}-${scheme}.png`), fullPage: true });
      assert.deepEqual(faults, []);
      await close();
    });
  }
}
