// A headless Chromium without a GPU, and its place: CHROMIUM, or where Debian puts it.

import { existsSync } from "node:fs";
import { chromium } from "playwright-core";

export const executablePath = process.env.CHROMIUM ?? "/usr/bin/chromium";
export const missing = existsSync(executablePath) ? false : `no browser at ${executablePath}: set CHROMIUM`;

/** A fresh profile each time, given up at the end. */
export const launch = () => chromium.launch({
  executablePath, headless: true,
  args: ["--no-sandbox", "--disable-gpu", "--no-first-run", "--disable-background-networking", "--disable-component-update", "--disable-sync", "--disable-quic"],
});

/** @param {string} name of a fixture page */
export const fixture = (name) => new URL(`../fixture/${name}.html`, import.meta.url).href;
