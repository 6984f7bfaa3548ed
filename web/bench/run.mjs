// node bench/run.mjs COMPARE SCENE.glb SCENE.rbn SHOT.json REFERENCE OUT: frames with a moving light at 1280 x 720,
// in turns: rebounce-viewer, three.js without global illumination, with our bounced light, with VXGI, with
// LightProbeGrid. At the end rebounce-viewer's frames under a sky: with the sky turned, and with the light moved.
// Writes what was measured to OUT as JSON. REFERENCE.indirect.a.exr and .b.exr are path-traced pictures of the shot's
// bounced light, or "-".

import { execFile } from "node:child_process";
import { mkdtemp, readFile, writeFile } from "node:fs/promises";
import { tmpdir } from "node:os";
import path from "node:path";
import { promisify } from "node:util";
import { launch, within } from "../test/browser.mjs";
import { median, openPage, serve, skyPicture } from "./pages.mjs";

const SIZE = { width: 1280, height: 720 };
const PICTURE = [320, 180];
const ROUNDS = 5;
/** Frames under a sky, of each kind. */
const UNDER_SKY = 5;

const [compare, glb, rbn, shot, reference, out] = process.argv.slice(2);
const work = await mkdtemp(path.join(tmpdir(), "rebounce-bench-"));
const sky = path.join(work, "sky.hdr");
await writeFile(sky, skyPicture());
const server = await serve({ "/scene.glb": glb, "/scene.rbn": rbn, "/shot.json": shot, "/sky.hdr": sky });
const open = (browser, name) => openPage(browser, `${server.address}${name}`, SIZE);

/** The light goes back and forth; every frame has a place of its own. */
const frames = async (page, count, first) => {
  const times = [];
  for (let i = 0; i < count; i += 1) {
    const shift = 0.05 * (1 + ((first + i) % 10));
    times.push(await within("a frame", page.evaluate((s) => globalThis.bench.frame(s), shift)));
  }
  return times;
};

/** Relative error and bias of a picture against the reference, as `rebounce compare` measures them. */
async function error(page, work, name) {
  if (reference === "-") return undefined;
  const pixels = await within("the picture", page.evaluate(([w, h]) => globalThis.bench.indirect(w, h), PICTURE));
  const file = path.join(work, `${name}-${PICTURE.join("x")}.f32`);
  await writeFile(file, Buffer.from(new Float32Array(pixels).buffer));
  const { stdout } = await promisify(execFile)(compare, [file, `${reference}.indirect.a.exr`, `${reference}.indirect.b.exr`]);
  return JSON.parse(stdout);
}

const names = { ours: "ours.html", three: "three.html", rebounce: "three.html?rebounce", vxgi: "three.html?gi", probes: "three.html?probes" };
/** Slow ones: measured once, and a failure is written down. */
const SLOW = ["vxgi", "probes"];
const results = Object.fromEntries(Object.keys(names).map((which) => [which, { ms: [] }]));
try {
  // Each in a browser of its own, in turns: what else the machine does hits all alike.
  for (let round = 0; round < ROUNDS; round += 1) {
    for (const [which, name] of Object.entries(names)) {
      if (SLOW.includes(which) && round > 0) continue;
      const browser = await launch();
      try {
        const page = await open(browser, name);
        await frames(page, 1, 7);
        results[which].ms.push(...(await frames(page, SLOW.includes(which) ? 1 : 3, round)));
        if (which === "ours") {
          results.ours.turn = await within("a turn", page.evaluate(() => globalThis.bench.turn(0.1)));
          results.ours.loaded = await page.evaluate(() => globalThis.bench.loadedAt);
          results.ours.lit = await page.evaluate(() => globalThis.bench.litAt);
          results.ours.stats = await page.evaluate(() => globalThis.bench.stats());
          results.ours.still = await within("a still picture", page.evaluate(() => globalThis.bench.still()));
        }
        if (which === "ours" && round + 1 === ROUNDS) {
          results.ours.sky = await within("frames under a sky", page.evaluate((n) => globalThis.bench.sky(n), UNDER_SKY));
        }
        if (round === 0 && which !== "three") results[which].error = await error(page, work, which);
      } catch (failure) {
        if (!SLOW.includes(which)) throw failure;
        results[which].failure = String(failure);
      } finally {
        await browser.close();
      }
    }
    console.log(Object.entries(results).map(([which, { ms }]) => `${which} ${ms.map(Math.round).join(" ")}`).join(" | "));
  }
} finally {
  server.close();
}
for (const [which, times] of Object.entries(results.ours.sky)) results.ours.sky[which] = median(times);
for (const result of Object.values(results)) result.median = result.ms.length ? median(result.ms) : undefined;
await writeFile(out, JSON.stringify(results, null, 1));
