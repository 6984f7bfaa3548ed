// node bench/ways.mjs SCENE.rbn SHOT.json OUT: what lookup and splatting cost, in turns, at two sizes, and how far apart
// their pictures of the bounced light are. Writes what was measured to OUT as JSON.

import { writeFile } from "node:fs/promises";
import { launch, within } from "../test/browser.mjs";
import { median, openPage, serve } from "./pages.mjs";

const SIZES = [
  [320, 180],
  [1280, 720],
];
const WAYS = ["lookup", "splat"];
const ROUNDS = 3;

const [rbn, shot, out] = process.argv.slice(2);

/** Root of the mean square of the difference, relative to the first picture. */
function apart(first, second) {
  let error = 0;
  let power = 0;
  for (let i = 0; i < first.length; i += 1) {
    if (i % 4 === 3) continue;
    error += (first[i] - second[i]) ** 2;
    power += first[i] ** 2;
  }
  return Math.sqrt(error / power);
}

const server = await serve({ "/scene.rbn": rbn, "/shot.json": shot });
const browser = await launch();
const results = { sizes: [] };
try {
  for (const [width, height] of SIZES) {
    const page = await openPage(browser, `${server.address}ours.html`, { width, height });
    const measured = Object.fromEntries(WAYS.map((way) => [way, { find: [], gather: [], light: [] }]));
    // The first round is for pipelines and buffers.
    for (let round = 0; round <= ROUNDS; round += 1) {
      for (const way of WAYS) {
        const call = ([name, shift]) => globalThis.bench.way(name, shift);
        const times = await within(way, page.evaluate(call, [way, 0.05 * (1 + round)]));
        if (times.display !== way) throw new Error(`${times.display} instead of ${way}`);
        results.adapter = times.adapter;
        for (const [pass, list] of Object.entries(measured[way])) if (round > 0) list.push(times[pass]);
      }
    }
    const medians = (times) => Object.fromEntries(Object.entries(times).map(([pass, list]) => [pass, median(list)]));
    results.sizes.push({ width, height, ...Object.fromEntries(WAYS.map((way) => [way, medians(measured[way])])) });
    console.log(JSON.stringify(results.sizes.at(-1)));
    if (results.apart === undefined) {
      const pictures = [];
      for (const way of WAYS) {
        const read = ([name, w, h]) => globalThis.bench.indirect(w, h, name);
        pictures.push(await within("a picture", page.evaluate(read, [way, width, height])));
      }
      results.apart = apart(...pictures);
      console.log(`${results.apart} apart`);
    }
    await page.close();
  }
} finally {
  await browser.close();
  server.close();
}
await writeFile(out, JSON.stringify(results, null, 1));
