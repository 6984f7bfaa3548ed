// `rebounce view --watch`: the page follows a bake, and the view stays as it is.

import { copyFile, rename, rm } from "node:fs/promises";
import path from "node:path";
import { exec, serve } from "../agreement.mjs";
import { equal, same } from "../harness.mjs";
import { open, outcome } from "./open.mjs";

const CAMERA = { position: [0.4, 2.9, 3.2], target: [-0.2, 2.3, -3], up: [0, 1, 0], yfov_deg: 65 };
const LIGHT = { type: "point", position: [1, 2, -1], intensity: 12.5, color: [1, 1, 1] };

/** Puts a file in its place at once, as a bake does. */
async function put(from, to) {
  await copyFile(from, `${to}.tmp`);
  await rename(`${to}.tmp`, to);
}

/** Runs the tests. */
export async function watch(harness, context) {
  await harness.test("watch::finer_files_take_the_place_of_coarser_ones_and_the_view_stays", async () => {
    const file = path.join(context.work, "watched.rbn");
    const preview = path.join(context.work, "watched.preview.rbn");
    const coarse = path.join(context.work, "coarse.rbn");
    for (const old of [file, preview]) await rm(old, { force: true });
    await exec(context.rebounce, ["bake", "builtin:cornell-box", "--preset", "draft", "--functions", "2000", "-o", coarse]);
    const server = await serve(context.rebounce, file, ["--watch"]);
    try {
      const { page, faults } = await open({ ...context, address: server.address }, { query: "?watch" });
      await page.waitForTimeout(1500);
      equal(await page.evaluate(() => events.length), 0, "events before there is a file");
      await put(coarse, preview);
      const first = await outcome(page);
      equal(first.type, "load", first.message ?? "the first event");
      await page.evaluate(([camera, light]) => Object.assign(viewer, { camera, lights: [light], exposure: 1 }), [CAMERA, LIGHT]);
      await put(context.baked, file);
      const second = await outcome(page, 1);
      equal(second.type, "load", second.message ?? "the second event");
      equal(first.url === second.url, false, "the same address");
      const { camera, lights, exposure } = await page.evaluate(() => ({ ...viewer.shot, exposure: viewer.exposure }));
      same(camera, CAMERA, "the camera");
      same(lights, [LIGHT], "the lights");
      equal(exposure, 1, "the exposure");
      // What the bake removes at its end is not missed, and nothing is loaded twice.
      await rm(preview);
      await page.waitForTimeout(1500);
      equal(await page.evaluate(() => events.filter(({ type }) => type === "load").length), 2, "loads");
      equal(faults.join("\n"), "", "faults");
      await page.close();
    } finally {
      server.process.kill();
    }
  });
}
