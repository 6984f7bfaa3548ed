// node bench/metal.mjs ROOM.rbn OBJECT.rbn OUT: frames of metals at 1280 x 720, in turns with the environment turned and with a
// lamp moved: of a bake for rooms and of one for an environment. Writes the medians in milliseconds to OUT as JSON.

import { mkdtemp, rm, writeFile } from "node:fs/promises";
import { tmpdir } from "node:os";
import path from "node:path";
import { launch, within } from "../test/browser.mjs";
import { median, openPage, serve, skyPicture } from "./pages.mjs";

const SIZE = { width: 1280, height: 720 };
const ROUNDS = 5;
/** The trophy between its board and its step, and a lamp beside them. */
const SHOT = {
  camera: { position: [0.6, 1.9, 4.2], target: [0, 0.9, 0], up: [0, 1, 0], yfov_deg: 35 },
  lights: [{ type: "point", position: [1.5, 2.5, 1.5], intensity: 20, color: [1, 0.9, 0.8] }],
};

const [room, object, out] = process.argv.slice(2);
const work = await mkdtemp(path.join(tmpdir(), "rebounce-bench-"));
const [sky, shot] = [path.join(work, "sky.hdr"), path.join(work, "shot.json")];
await writeFile(sky, skyPicture());
await writeFile(shot, JSON.stringify(SHOT));
const results = {};
try {
  for (const [name, rbn] of Object.entries({ room, object })) {
    const server = await serve({ "/scene.rbn": rbn, "/shot.json": shot, "/sky.hdr": sky });
    const browser = await launch();
    try {
      const page = await openPage(browser, `${server.address}ours.html`, SIZE);
      const times = await within("frames under a sky", page.evaluate((n) => globalThis.bench.sky(n), ROUNDS));
      results[name] = { sky: median(times.sky), lamp: median(times.lamp) };
      console.log("metals", name, results[name]);
    } finally {
      await browser.close();
      server.close();
    }
  }
} finally {
  await rm(work, { recursive: true, force: true });
}
await writeFile(out, JSON.stringify(results, null, 1));
