// node test/figures.mjs SITE WIDTH HEIGHT VIEW:SCENE...: how long a frame takes in which a lamp has moved, of scenes/SCENE.rbn with
// shots/VIEW.json of the site in a folder. Prints JSON: `adapter`, and `frames` in milliseconds by view.

import { readFile } from "node:fs/promises";
import path from "node:path";
import { launch, within } from "./browser.mjs";
import { serveFolder } from "./serve.mjs";

const [folder, width, height, ...views] = process.argv.slice(2);
const PAGE = `<!doctype html><meta charset="utf-8" />
<script type="module" src="rebounce-viewer/rebounce-viewer.js"></script>
<rebounce-viewer width="${width}" height="${height}"></rebounce-viewer>`;

/** In the page: shows a scene; the time of a frame, which the GPU has timed, or which it took altogether. */
async function measure({ src, shot }) {
  const viewer = document.querySelector("rebounce-viewer");
  const loaded = new Promise((done, failed) => {
    viewer.addEventListener("load", done, { once: true });
    viewer.addEventListener("error", ({ detail }) => failed(new Error(detail.message)), { once: true });
  });
  viewer.src = src;
  await loaded;
  viewer.shot = shot;
  const times = [];
  for (let i = 0; i < 3; i += 1) {
    const start = performance.now();
    const [lamp, ...others] = viewer.lights;
    const [x, y, z] = lamp.position ?? lamp.direction;
    viewer.lights = [{ ...lamp, [lamp.position ? "position" : "direction"]: [x + 0.01, y, z] }, ...others];
    const { frames } = viewer.stats();
    while (viewer.stats().frames === frames) await new Promise(requestAnimationFrame);
    await viewer.counts();
    const all = performance.now() - start;
    const timed = Object.values(viewer.stats().milliseconds).reduce((sum, one) => sum + one, 0);
    times.push(timed || all);
  }
  return { time: times.sort((a, b) => a - b)[1], adapter: viewer.stats().adapter };
}

const server = await serveFolder(folder);
const browser = await launch();
try {
  const page = await browser.newPage({ viewport: { width: Number(width) + 16, height: Number(height) + 16 } });
  await page.route(`${server.address}figures`, (route) => route.fulfill({ contentType: "text/html", body: PAGE }));
  await page.goto(`${server.address}figures`);
  await page.evaluate(() => customElements.whenDefined("rebounce-viewer").then(() => undefined));
  const told = { adapter: "", frames: {} };
  for (const one of views) {
    const [view, scene] = one.split(":");
    const { camera, lights } = JSON.parse(await readFile(path.join(folder, "shots", `${view}.json`), "utf8"));
    const { time, adapter } = await within(one, page.evaluate(measure, { src: `scenes/${scene}.rbn`, shot: { camera, lights } }));
    told.adapter = adapter;
    told.frames[view] = time;
  }
  console.log(JSON.stringify(told));
} finally {
  await browser.close();
  server.end();
}
