// Frames a second of the fixture cloth (4 engines x 10,000 particles x 39,402 springs), and pictures of all
// fixture pages: `node tools/measure.js [folder for pictures]`.

import { fixture, launch } from "./chromium.js";

const folder = process.argv[2];
const browser = await launch();

for (const [width, height] of [[1280, 900], [390, 800]]) {
  const page = await browser.newPage({ viewport: { width, height } });
  const start = Date.now();
  await page.goto(fixture("cloth"));
  await page.waitForSelector("html[data-ready]");
  console.log(`${width} px: ready after ${Date.now() - start} ms`);
  for (const [layout, colours] of [["over", "engine"], ["apart", "engine"], ["over", "strain"]]) {
    await page.getByLabel("Engines", { exact: false }).and(page.locator("select")).selectOption(layout);
    await page.getByLabel("Springs").selectOption(colours);
    await page.evaluate(() => window.springcheckPlayer.clock.play());
    const [frames, drawing] = await page.evaluate(async () => {
      const { picture, clock } = window.springcheckPlayer;
      const canvas = document.querySelector("canvas");
      const pause = (ms) => new Promise((done) => setTimeout(done, ms));
      await pause(1500);
      const before = Number(canvas.dataset.drawn);
      const from = performance.now();
      await pause(5000);
      const rate = (1000 * (Number(canvas.dataset.drawn) - before)) / (performance.now() - from);
      clock.pause();
      const alone = performance.now();
      for (let k = 0; k < 20; k++) picture.draw(k / 10);
      return [rate, (performance.now() - alone) / 20];
    });
    console.log(`  ${layout}, by ${colours}: ${frames.toFixed(1)} frames/s; ${drawing.toFixed(1)} ms a picture without showing it`);
  }
  await page.close();
}

if (folder) {
  for (const [width, height] of [[1280, 900], [390, 800]]) {
    for (const colorScheme of ["light", "dark"]) {
      for (const name of ["spring", "cloth", "course"]) {
        const page = await browser.newPage({ viewport: { width, height }, colorScheme, reducedMotion: "reduce" });
        await page.goto(fixture(name));
        await page.waitForSelector("html[data-ready]");
        await page.evaluate(() => window.springcheckPlayer.clock.seek(2.5));
        if (name === "course" && width > 400) await page.getByLabel("Engines").and(page.locator("select")).selectOption("apart");
        if (name === "cloth" && width < 400) await page.getByLabel("Springs").selectOption("strain");
        await page.waitForTimeout(400);
        await page.screenshot({ path: `${folder}/${name}-${width}-${colorScheme}.png`, fullPage: true });
        await page.close();
      }
    }
  }
}
await browser.close();
