// Bundles src/ into page.js, the one file that a page carries. `--check` only says whether that file is stale.

import { build } from "esbuild";
import { readFileSync, writeFileSync } from "node:fs";

const target = new URL("../page.js", import.meta.url);
const made = await build({
  entryPoints: [new URL("../src/main.js", import.meta.url).pathname],
  bundle: true, minify: true, write: false, format: "iife", target: "es2022", charset: "utf8", legalComments: "none",
});
const text = made.outputFiles[0].text;
// Within a page the first of these would end the script, the second would hide its end.
for (const end of ["</script", "<!--"]) if (text.includes(end)) throw new Error(`page.js must not contain ${end}`);
if (process.argv.includes("--check")) {
  if (readFileSync(target, "utf8") !== text) {
    console.error("page.js is stale: run `npm run build`");
    process.exit(1);
  }
} else {
  writeFileSync(target, text);
  console.log(`page.js: ${Buffer.byteLength(text)} bytes`);
}
