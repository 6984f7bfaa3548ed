// node bench/figure.mjs WALK.rbn SHOT OFFICE.rbn OUT: antiradiance in the page. Frames of the walking figure at 1280 x 720 by the
// operator alone and with antiradiance, in turns; steps in the office. Writes medians and sizes to OUT as JSON.

import { mkdtemp, rm, writeFile } from "node:fs/promises";
import { tmpdir } from "node:os";
import path from "node:path";
import { launch, within } from "../test/browser.mjs";
import { median, openPage, serve } from "./pages.mjs";

const SIZES = { walk: { width: 1280, height: 720 }, office: { width: 160, height: 90 } };
const ROUNDS = 3;
/** The office from within. */
const INSIDE = {
  camera: { position: [0.5, 1.75, 4.35], target: [3.6, 0.85, 1.5], up: [0, 1, 0], yfov_deg: 62 },
  lights: [{ type: "point", position: [2.5, 2.3, 2.2], intensity: 40, color: [1, 0.95, 0.9] }],
};

const [walk, shot, office, out] = process.argv.slice(2);
const work = await mkdtemp(path.join(tmpdir(), "rebounce-bench-"));
const inside = path.join(work, "shot.json");
await writeFile(inside, JSON.stringify(INSIDE));

/** What a page measures of a scene. */
async function measured(rbn, shot, size, work) {
  const server = await serve({ "/scene.rbn": rbn, "/shot.json": shot });
  const browser = await launch();
  try {
    const page = await openPage(browser, `${server.address}ours.html`, size);
    return await within("figures of antiradiance", page.evaluate(work, ROUNDS), 1200);
  } finally {
    await browser.close();
    server.close();
  }
}

const results = {};
try {
  const walked = await measured(walk, shot, SIZES.walk, (n) => globalThis.bench.walk(n));
  const { operator, antiradiance } = walked.times;
  results.walk = { operator: median(operator), antiradiance: median(antiradiance), stats: walked.stats };
  console.log("walk", results.walk.operator, results.walk.antiradiance);
  const { linked, frames, stats } = await measured(office, inside, SIZES.office, (n) => globalThis.bench.solve(n));
  const step = median(frames.map(({ steps, milliseconds }) => milliseconds / steps));
  results.office = { linked, step, stats };
  console.log("office", linked, step);
} finally {
  await rm(work, { recursive: true, force: true });
}
await writeFile(out, JSON.stringify(results, null, 1));
