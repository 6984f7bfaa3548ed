// node test/screenshot.mjs ADDRESS OUT.png: a picture of the page when its scene is drawn.
// Fails if the scene does not load, or the picture is blank.

import { writeFile } from "node:fs/promises";
import { HANGS, decode, launch, spread, within } from "./browser.mjs";

const [address, out] = process.argv.slice(2);
if (!address || !out) throw new Error("usage: node screenshot.mjs ADDRESS OUT.png");

const browser = await launch();
try {
  const page = await browser.newPage({ viewport: { width: 1280, height: 720 } });
  page.on("pageerror", (error) => console.error(`page: ${error}`));
  page.on("console", (message) => message.type() === "error" && console.error(`page: ${message.text()}`));
  // Listens before the element exists, so that nothing is missed.
  await page.addInitScript(() => {
    globalThis.outcome = new Promise((resolve) => {
      document.addEventListener("load", (event) => event.detail && resolve({}), true);
      document.addEventListener("error", (event) => event.detail && resolve(event.detail), true);
    });
  });
  await page.goto(address);
  const failure = await within("loading the scene", page.evaluate(() => globalThis.outcome));
  if (failure.code) throw new Error(`${failure.code}: ${failure.message}`);
  // What the GPU holds, then what the page shows: either may fail alone.
  const read = page.evaluate(async () => {
    const viewer = document.querySelector("rebounce-viewer");
    return Array.from(await viewer.readPixels(256, 144));
  });
  const drawn = spread(await within("reading the picture", read));
  // Two more frames of the page: the canvas has been presented then.
  await page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
  const png = await page.screenshot({ timeout: 1000 * HANGS });
  const shown = spread(await decode(browser, png));
  if (drawn.deviation < 4) throw new Error(`the picture is blank (mean ${drawn.mean.toFixed(1)} of 255)`);
  if (shown.deviation < 4) throw new Error(`the page is blank (mean ${shown.mean.toFixed(1)} of 255)`);
  await writeFile(out, png);
  console.log(`wrote ${out}`);
} finally {
  await browser.close();
}
