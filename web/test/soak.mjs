// node test/soak.mjs MINUTES FOLDER FILE: moves lights and camera in headless Chromium for so long, and watches memory.
// FILE in FOLDER is shown. Prints a line a minute; fails where memory grows after the first one.

import { readFile } from "node:fs/promises";
import { pathToFileURL } from "node:url";
import { launch, within } from "./browser.mjs";
import { check } from "./harness.mjs";
import { ledger } from "./page/ledger.mjs";
import { document, serveStrictly } from "./strict.mjs";

/** Milliseconds between two changes. */
const STEP = 50;
/**
 * By how much a figure may be greater in the last third of the time than in the first one, whose first minute does not count:
 * of two values each, the greatest ones, or the middle ones where a figure goes up and down by itself. A leak of a few kilobytes
 * a frame goes beyond all of them.
 */
const MAY_GROW = {
  wasm: { of: greatest, by: () => 0 },
  gpu: { of: greatest, by: () => 0 },
  alive: { of: greatest, by: () => 0 },
  heap: { of: middle, by: () => 256e3 },
  processes: { of: middle, by: (before) => 0.05 * before },
};

function greatest(values) {
  return Math.max(...values);
}

function middle(values) {
  return [...values].sort((a, b) => a - b)[values.length >> 1];
}

/** In the page: one change after another, until it is told to stop. */
async function move({ step }) {
  const viewer = globalThis.document.querySelector("rebounce-viewer");
  const [home, lamp] = [viewer.camera, viewer.lights[0]];
  const around = (centre, radius, t) => centre.map((x, i) => x + radius * Math.sin(t * (1 + 0.3 * i) + i));
  const modes = ["all", "direct", "indirect"];
  globalThis.changes = 0;
  for (let n = 0; !globalThis.stop; n += 1) {
    const t = n * 0.1;
    const lights = [{ ...lamp, position: around(lamp.position, 0.3, t), color: [1, 0.5 + 0.5 * Math.sin(t), 0.5] }];
    // Now and then a second one, another way to show it, another size, a picture read.
    if (n % 40 >= 20) lights.push({ type: "spot", position: around([0, 2, 0], 0.5, t), direction: [0, -1, 0], outer_cone_deg: 40, intensity: 5 });
    viewer.lights = lights;
    viewer.camera = { ...home, position: around(home.position, 0.2, 0.7 * t) };
    if (n % 50 === 49) viewer.mode = modes[((n + 1) / 50) % 3];
    if (n % 60 === 59) viewer.style.width = `${280 + 40 * (((n + 1) / 60) & 1)}px`;
    if (n % 80 === 79) await viewer.readPixels(32, 18);
    globalThis.changes += 1;
    await new Promise((later) => setTimeout(later, step));
  }
}

/**
 * Bytes of memory that the browser's processes hold, by kind of process, without the files that they share with other
 * programs; nothing where the system does not say.
 */
async function held(browser) {
  const session = await browser.newBrowserCDPSession();
  try {
    const { processInfo } = await session.send("SystemInfo.getProcessInfo");
    const kinds = {};
    for (const { id, type } of processInfo) {
      const text = await readFile(`/proc/${id}/smaps_rollup`, "utf8").catch(() => "");
      const kilobytes = [...text.matchAll(/^Pss_(?:Anon|Shmem):\s+(\d+)/gm)].reduce((sum, [, n]) => sum + Number(n), 0);
      if (kilobytes > 0) kinds[type] = (kinds[type] ?? 0) + 1024 * kilobytes;
    }
    return kinds;
  } finally {
    await session.detach();
  }
}

/** What is held just now, after the garbage is collected. */
async function measure(browser, page, session) {
  // Between two steps, at the size and with the lights of the first one: like is compared with like.
  await page.evaluate(async () => {
    globalThis.stop = true;
    await globalThis.moving;
    const viewer = document.querySelector("rebounce-viewer");
    Object.assign(viewer, globalThis.home);
    viewer.style.width = "320px";
    for (let before = -1; before !== viewer.stats().frames; await new Promise((later) => setTimeout(later, 1500))) {
      before = viewer.stats().frames;
    }
  });
  await session.send("HeapProfiler.collectGarbage");
  await session.send("HeapProfiler.collectGarbage");
  const { metrics } = await session.send("Performance.getMetrics");
  const ours = await page.evaluate(async () => {
    const { default: init } = await import("./rebounce_viewer.js");
    const { bytes, frames } = document.querySelector("rebounce-viewer").stats();
    const told = Object.values(bytes).reduce((sum, n) => sum + n, 0);
    const { changes } = globalThis;
    return { wasm: (await init()).memory.buffer.byteLength, stats: told, gpu: gpu.bytes, alive: gpu.alive, frames, changes };
  });
  const kinds = await held(browser);
  // The browser's services come and go by themselves.
  const processes = ["browser", "renderer", "GPU"].reduce((sum, kind) => sum + (kinds[kind] ?? 0), 0) || undefined;
  return { ...ours, heap: metrics.find(({ name }) => name === "JSHeapUsedSize").value, kinds, processes };
}

/** What has grown beyond its bound among samples, a minute each. */
export function grown(samples) {
  const faults = [];
  for (const [name, { of, by }] of Object.entries(MAY_GROW)) {
    const values = samples.slice(1).map((sample) => sample[name]).filter((value) => value !== undefined);
    const third = Math.ceil(values.length / 3);
    if (values.length < 2) continue;
    const [before, after] = [of(values.slice(0, third)), of(values.slice(-third))];
    if (after - before > by(before)) faults.push(`${name} has grown from ${before} to ${after}, by more than ${by(before).toFixed(0)}`);
  }
  return faults;
}

/** Runs it; the samples. */
export async function soak({ minutes, seconds = 60, folder, file, say = console.log }) {
  const html = `<rebounce-viewer src="${file}" controls></rebounce-viewer>`;
  const server = await serveStrictly({ folders: [folder], pages: { "": document(html) } });
  const browser = await launch();
  const samples = [];
  try {
    const page = await browser.newPage({ viewport: { width: 320, height: 180 } });
    page.setDefaultTimeout(300_000);
    const faults = [];
    page.on("pageerror", (error) => faults.push(String(error)));
    page.on("crash", () => faults.push("the tab crashed"));
    await page.addInitScript(ledger);
    await page.goto(server.address);
    await within("the scene", page.waitForFunction(() => document.querySelector("rebounce-viewer")?.loaded));
    await page.evaluate(() => {
      const viewer = document.querySelector("rebounce-viewer");
      viewer.addEventListener("error", ({ detail }) => (globalThis.fault ??= detail.message));
      globalThis.home = { camera: viewer.camera, lights: viewer.lights, mode: "all" };
    });
    const session = await page.context().newCDPSession(page);
    await session.send("Performance.enable");
    await page.evaluate(`globalThis.move = ${move}`);
    for (let minute = 0; minute <= minutes; minute += 1) {
      const sample = await within("measuring", measure(browser, page, session));
      samples.push(sample);
      const size = (bytes) => (bytes === undefined ? "unknown" : `${(bytes / 1e6).toFixed(2)} MB`);
      const { wasm, heap, gpu, alive, frames } = sample;
      const kinds = Object.entries(sample.kinds).map(([kind, bytes]) => `${kind} ${size(bytes)}`).join(", ");
      say(
        `${String(minute).padStart(3)} min: wasm ${size(wasm)}, script ${size(heap)}, GPU ${size(gpu)} in ${alive} buffers and textures ` +
          `(stats() says ${size(sample.stats)}), processes ${size(sample.processes)} (${kinds}), ${frames} frames`,
      );
      const fault = await page.evaluate(() => globalThis.fault);
      check(!fault && faults.length === 0, `${fault}; ${faults.join("; ")}`);
      if (minute === minutes) break;
      await page.evaluate((step) => {
        globalThis.stop = false;
        globalThis.moving = globalThis.move({ step });
      }, STEP);
      await page.waitForTimeout(seconds * 1000);
    }
    check(samples.at(-1).frames > samples[0].frames + 2 * minutes, "nothing was drawn");
  } finally {
    await browser.close();
    server.end();
  }
  return samples;
}

if (process.argv[1] && import.meta.url === pathToFileURL(process.argv[1]).href) {
  const [minutes, folder, file] = process.argv.slice(2);
  check(Number(minutes) >= 2 && file, "usage: node test/soak.mjs MINUTES FOLDER FILE, at least 2 minutes");
  const faults = grown(await soak({ minutes: Number(minutes), folder, file }));
  for (const fault of faults) console.log(fault);
  console.log(faults.length === 0 ? `${minutes} minutes: nothing has grown after the first` : "memory grows");
  process.exitCode = faults.length === 0 ? 0 : 1;
}
