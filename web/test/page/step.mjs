// A STEP file in the page: its bake is relit as the command renders it, its wavelet solution is shown by the lightmap.

import { readFile, writeFile } from "node:fs/promises";
import path from "node:path";
import { agreement, exec } from "../agreement.mjs";
import { check } from "../harness.mjs";
import { loaded } from "./open.mjs";

/** A plate, a wall and a tube. */
const STEP = path.resolve("../baker/tests/step/tube.step");
/** As in light.mjs. */
const SIZE = [40, 27];
const FINER = 2;
const TOLERANCE = 0.02;

const CAMERA = { position: [0.35, 0.4, 0.7], target: [0, 0.05, -0.05], up: [0, 1, 0], yfov_deg: 35 };
const LAMP = { type: "spot", direction: [-0.25, -1, -0.75], intensity: 2, color: [1, 1, 1], outer_cone_deg: 30 };
const AT = { type: "point", intensity: 0.4, color: [1, 0.8, 0.6] };
/** Where the lamp of a bake may go: outside of the tube, and above its mouth. */
const PLACES = [[0.15, 0.6, 0.35], [-0.1, 0.5, 0.1]];

/** Opens a file in a page. */
async function shown(context, file) {
  const body = await readFile(file);
  const route = (route) => route.fulfill({ body, contentType: "application/octet-stream" });
  const prepare = () => {
    globalThis.light = async () => Array.from(await viewer.readIndirect(40, 27)).filter((_, i) => i % 4 < 3);
  };
  const { page, faults } = await loaded(context, '<rebounce-viewer src="tube.rbn"></rebounce-viewer>', { routes: { "**/tube.rbn": route }, prepare });
  return { page, faults };
}

/** The page's bounced light of a shot is that of the command; gives the page's. */
async function agrees(page, context, file, name, lights) {
  const { difference } = await agreement(page, { ...context, baked: file }, name, { camera: CAMERA, lights }, SIZE, FINER, 256, false);
  console.log(`    ${name}: ${JSON.stringify(difference)}`);
  check(difference.error <= TOLERANCE, `relative RMS difference ${difference.error}, at most ${TOLERANCE} is allowed`);
  return page.evaluate(() => light());
}

/** Relative difference of two pictures. */
function apart(a, b) {
  const sum = (list) => list.reduce((total, x) => total + Math.abs(x), 0);
  return sum(a.map((x, i) => x - b[i])) / sum(b);
}

/** Runs the tests. */
export async function step(harness, context) {
  const file = (name) => path.join(context.work, `step-${name}`);
  await harness.test("step::a_bake_of_exact_faces_is_relit_as_the_command_has_it", async () => {
    await exec(context.rebounce, ["bake", STEP, "--preset", "draft", "--functions", "3K", "-o", file("bake.rbn")]);
    const { page, faults } = await shown(context, file("bake.rbn"));
    const pictures = [];
    for (const [i, position] of PLACES.entries()) {
      pictures.push(await agrees(page, context, file("bake.rbn"), `step lamp ${i}`, [{ ...LAMP, position }, { ...AT, position }]));
    }
    const change = apart(pictures[0], pictures[1]);
    check(change > 0.1, `the lamp's place changes nothing: ${change}`);
    check(faults.length === 0, faults.join());
    await page.close();
  });

  await harness.long("step::the_lightmap_of_a_wavelet_solution_is_that_of_the_command", async () => {
    const lights = [{ ...LAMP, position: PLACES[0] }, { ...AT, position: PLACES[1] }];
    await writeFile(file("shot.json"), JSON.stringify({ size: SIZE, camera: CAMERA, lights }));
    const solve = ["solve", STEP, "--solver", "wavelet", "--shot", file("shot.json"), "--preset", "draft", "--functions", "3K"];
    const { stdout } = await exec(context.rebounce, [...solve, "-o", file("solved.rbn")]);
    check(/lightmap +\d+ x \d+ texels/.test(stdout), stdout);
    const { page, faults } = await shown(context, file("solved.rbn"));
    const whole = await agrees(page, context, file("solved.rbn"), "step lightmap", lights);
    const red = [{ ...lights[1], intensity: 2, color: [1, 0.1, 0] }];
    const one = await agrees(page, context, file("solved.rbn"), "step lightmap of one lamp", red);
    check(apart(whole, one) > 0.1, "the lights change nothing");
    check(faults.length === 0, faults.join());
    await page.close();
  });
}
