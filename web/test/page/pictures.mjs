// A scene's picture looks the same whichever format it came in.

import { readFile } from "node:fs/promises";
import path from "node:path";
import { fileURLToPath } from "node:url";
import { exec } from "../agreement.mjs";
import { launch, spread } from "../browser.mjs";
import { check, equal } from "../harness.mjs";
import { loaded } from "./open.mjs";

const SCENES = fileURLToPath(new URL("../../../baker/tests/gltf", import.meta.url));

/** Only direct light is looked at: little is baked. */
const QUICK = "--preset draft --functions 1000 --levels 2 --sender-levels 2 --direct-levels 2".split(" ");

/** The pixels of a scene whose floor has a picture of this kind. */
async function pixels(context, name) {
  const baked = path.join(context.work, `${name}.rbn`);
  await exec(context.rebounce, ["bake", path.join(SCENES, `${name}.glb`), ...QUICK, "-o", baked]);
  const body = await readFile(baked);
  const html = `<rebounce-viewer src="${name}.rbn" mode="direct"></rebounce-viewer>`;
  const routes = { [`**/${name}.rbn`]: (route) => route.fulfill({ body }) };
  const { page, faults } = await loaded(context, html, { routes });
  const found = await page.evaluate(async () => {
    viewer.lights = [{ type: "point", position: [0, 4, 0], intensity: 60, color: [1, 1, 1] }];
    viewer.camera = { position: [0, 6, 5], target: [0, 0, 0], up: [0, 1, 0], yfov_deg: 60 };
    return Array.from(await viewer.readPixels(128, 72));
  });
  equal(faults.join("\n"), "", "faults");
  await page.close();
  return found;
}

/** In a browser of its own: with three more scenes the shared one came to its end before the last test. */
export async function pictures(harness, shared) {
  const browser = await launch();
  const context = { ...shared, browser, served: undefined };
  await harness.test("pictures::webp_and_basis_universal_look_like_png", async () => {
    const truth = await pixels(context, "plain");
    check(spread(truth).deviation > 4, "the picture is blank");
    for (const [name, most] of [["webp", 0.5], ["uastc", 2]]) {
      const found = await pixels(context, name);
      const mean = found.reduce((sum, value, i) => sum + Math.abs(value - truth[i]), 0) / truth.length;
      check(mean < most, `${name} differs by ${mean.toFixed(2)} of 255`);
    }
  });
  await browser.close();
}
