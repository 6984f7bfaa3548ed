// node test/agree.mjs REBOUNCE COMPARE FILE.rbn SHOT.json...: how far the browser's indirect light is from
// the CPU's, for any baked file. Prints one line a shot.

import { mkdtemp } from "node:fs/promises";
import { tmpdir } from "node:os";
import path from "node:path";
import { agreement, readShot, serve } from "./agreement.mjs";
import { HANGS, launch, within } from "./browser.mjs";

const SIZE = [256, 144];
const FINER = 2;
const SAMPLES = 1024;

const [rebounce, compare, baked, ...shots] = process.argv.slice(2);
if (shots.length === 0) throw new Error("usage: node agree.mjs REBOUNCE COMPARE FILE.rbn SHOT.json...");
const tools = { rebounce, compare, baked, work: await mkdtemp(path.join(tmpdir(), "rebounce-")) };
const server = await serve(rebounce, baked);
const browser = await launch();
try {
  const page = await browser.newPage({ viewport: { width: 320, height: 180 } });
  page.setDefaultTimeout(1000 * HANGS);
  await page.goto(server.address);
  const loaded = page.evaluate(async () => {
    const viewer = document.querySelector("rebounce-viewer");
    const message = () => viewer.shadowRoot.querySelector("[role=alert]").textContent;
    while (!viewer.loaded && !message()) await new Promise((later) => setTimeout(later, 100));
    return message();
  });
  const message = await within("loading", loaded);
  if (message) throw new Error(message);
  for (const shot of shots) {
    const name = path.basename(shot, ".json");
    const { difference } = await agreement(page, tools, name, await readShot(shot), SIZE, FINER, SAMPLES);
    console.log(`${name}: ${JSON.stringify(difference)}`);
  }
} finally {
  await browser.close();
  server.process.kill();
}
