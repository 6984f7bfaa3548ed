// Reflections in the page: a metal under a sky that turns, and a shot's gloss.

import { readFile } from "node:fs/promises";
import path from "node:path";
import { exec } from "../agreement.mjs";
import { check, equal } from "../harness.mjs";
import { loaded } from "./open.mjs";

const SIZE = [48, 32];
/** The ring and its balls fill the picture. */
const CAMERA = { position: [0.45, 1.35, 1.5], target: [0, 1.2, 0], up: [0, 1, 0], yfov_deg: 40 };

/** Relative difference of two pictures. */
function apart(a, b) {
  const sum = (list) => list.reduce((total, x) => total + Math.abs(x), 0);
  return sum(a.map((x, i) => x - b[i])) / sum(b);
}

/** Runs the tests. */
export async function gloss(harness, context) {
  const file = (name) => path.join(context.work, `gloss-${name}.rbn`);

  /** Bakes that are there already. */
  const baked = new Set();
  /** Opens a bake of the trophy; `args` are those of the bake, the same ones under one name. */
  async function shown(name, args) {
    if (!baked.has(name)) {
      await exec(context.rebounce, ["bake", "builtin:trophy", "--preset", "draft", "--functions", "2K", "-o", file(name), ...args]);
      baked.add(name);
    }
    const body = await readFile(file(name));
    const routes = { "**/trophy.rbn": (route) => route.fulfill({ body, contentType: "application/octet-stream" }) };
    const prepare = () => {
      globalThis.pixels = async (width, height) => Array.from(await viewer.readPixels(width, height)).filter((_, i) => i % 4 < 3);
    };
    const html = '<rebounce-viewer src="trophy.rbn" auto-exposure="off" exposure="-4" backdrop="none"></rebounce-viewer>';
    const { page, faults } = await loaded(context, html, { routes, prepare });
    /** The picture under the sky turned by so many degrees. */
    const turned = (degrees, more = {}) =>
      page.evaluate(
        async ([degrees, more, camera, [width, height]]) => {
          viewer.shot = { camera, lights: [{ type: "environment", intensity: 1, rotation_deg: degrees }], ...more };
          return pixels(width, height);
        },
        [degrees, more, CAMERA, SIZE],
      );
    return { page, faults, turned };
  }

  await harness.long("gloss::metals_reflect_a_sky_that_turns", async () => {
    const matt = await shown("matt", ["--gloss-roughness", "0"]);
    const dull = [await matt.turned(0), await matt.turned(120)];
    await matt.page.close();
    for (const transfer of ["links", "matrices"]) {
      const { page, faults, turned } = await shown(transfer, ["--gloss-transfer", transfer]);
      const bright = [await turned(0), await turned(120)];
      // What is matt is the same in both files.
      console.log(`    ${transfer}: unlike chalk by ${[0, 1].map((i) => apart(bright[i], dull[i]))}, turned by ${apart(bright[0], bright[1])}`);
      for (const i of [0, 1]) check(apart(bright[i], dull[i]) > 0.02, `${transfer}: the metal looks as chalk does, ${apart(bright[i], dull[i])}`);
      check(apart(bright[0], bright[1]) > 0.02, `${transfer}: a turn of the sky changes nothing`);
      equal(apart(await turned(0), bright[0]), 0, `${transfer}: the sky turned back`);
      check(faults.length === 0, faults.join());
      await page.close();
    }
  });

  await harness.test("gloss::a_shot_may_have_metals_as_conductors", async () => {
    const { page, faults, turned } = await shown("links", ["--gloss-transfer", "links"]);
    const before = await turned(0);
    const conductors = await turned(0, { gloss: true });
    console.log(`    conductors differ by ${apart(conductors, before)}`);
    check(apart(conductors, before) > 0.0003, "Fresnel's factor is there with and without gloss");
    equal(await page.evaluate(() => viewer.shot.gloss), true, "the shot's gloss");
    equal(apart(await turned(0), before), 0, "without gloss again");
    equal(await page.evaluate(() => viewer.shot.gloss), undefined, "no gloss");
    check(faults.length === 0, faults.join());
    await page.close();
  });

  await harness.long("gloss::an_object_for_an_environment_is_lit_as_by_its_operator", async () => {
    const object = await shown("object", ["--for", "environment"]);
    const linked = await shown("matrices", ["--gloss-transfer", "matrices"]);
    for (const degrees of [0, 120]) {
      const off = apart(await object.turned(degrees), await linked.turned(degrees));
      console.log(`    turned by ${degrees}: apart by ${off}`);
      check(off < 0.05, `the object differs by ${off} from the scene with links`);
    }
    const dark = await object.turned(0, { lights: [] });
    check(Math.max(...dark) === 0, "without light it is dark");
    check(apart(await object.turned(0), await object.turned(120)) > 0.02, "a turn of the sky changes nothing");
    const faults = [...object.faults, ...linked.faults];
    check(faults.length === 0, faults.join());
    await object.page.close();
    await linked.page.close();
  });
}
