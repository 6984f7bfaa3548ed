// node bench/rooms.mjs REBOUNCE OUT: a ball that the bake does not know, in a room and behind a wall of 5 cm: its error
// against a path tracer, and its light as a share of the lit side's, with our probes, VXGI and LightProbeGrid. Writes
// what was measured to OUT as JSON.

import { mkdtemp, rm, writeFile } from "node:fs/promises";
import { tmpdir } from "node:os";
import path from "node:path";
import { launch, within } from "../test/browser.mjs";
import { baked, errorOf, meanOf, traced } from "../test/three/ball.mjs";
import { room, twoRooms, VIEWS } from "../test/three/rooms.mjs";
import { openPage, serve } from "./pages.mjs";

const [rebounce, out] = process.argv.slice(2);
const work = await mkdtemp(path.join(tmpdir(), "rebounce-bench-"));
const server = await serve({});
const results = {};
try {
  const files = { room: await baked({ work, rebounce }, "room", room), two: await baked({ work, rebounce }, "two", twoRooms) };
  const truth = await traced({ work, rebounce });
  for (const way of ["ours", "vxgi", "probes"]) {
    const browser = await launch();
    try {
      const picture = async (scene, view) => {
        const page = await openPage(browser, `${server.address}ball.html`, { width: 400, height: 300 });
        const pixels = page.evaluate(([way, files]) => globalThis.bench[way](files), [way, { ...files[scene], ...VIEWS[view] }]);
        const found = await within(`${way}, ${view}`, pixels);
        await page.close();
        return found;
      };
      const { error, bias } = errorOf(await picture("room", "room"), truth);
      const leak = meanOf(await picture("two", "dark")) / meanOf(await picture("two", "lit"));
      results[way] = { error, bias, leak };
      console.log(way, results[way]);
    } finally {
      await browser.close();
    }
  }
} finally {
  server.close();
  await rm(work, { recursive: true, force: true });
}
await writeFile(out, JSON.stringify(results, null, 1));
