// The page as a user has it: `rebounce view` serves it, headless Chromium shows it.

import { readFile, rm } from "node:fs/promises";
import path from "node:path";
import { exec, serve } from "./agreement.mjs";
import { launch } from "./browser.mjs";
import { animation } from "./page/animation.mjs";
import { attributes } from "./page/attributes.mjs";
import { bakeElement } from "./page/bake-element.mjs";
import { bakeGuide } from "./page/bake-guide.mjs";
import { bakeInPage } from "./page/bake-in-page.mjs";
import { damaged } from "./page/damaged.mjs";
import { downloads } from "./page/downloads.mjs";
import { environment } from "./page/environment.mjs";
import { exported } from "./page/exported.mjs";
import { failures } from "./page/failures.mjs";
import { gloss } from "./page/gloss.mjs";
import { handles } from "./page/handles.mjs";
import { hidden } from "./page/hidden.mjs";
import { history } from "./page/history.mjs";
import { input } from "./page/input.mjs";
import { light } from "./page/light.mjs";
import { lights } from "./page/lights.mjs";
import { loading } from "./page/loading.mjs";
import { memory } from "./page/memory.mjs";
import { mixer } from "./page/mixer.mjs";
import { modules } from "./page/modules.mjs";
import { nodes } from "./page/nodes.mjs";
import { onScreen } from "./page/onscreen.mjs";
import { panel } from "./page/panel.mjs";
import { panelLights } from "./page/panel-lights.mjs";
import { panelLook } from "./page/panel-look.mjs";
import { pictures } from "./page/pictures.mjs";
import { policy } from "./page/policy.mjs";
import { readme } from "./page/readme.mjs";
import { recovery } from "./page/recovery.mjs";
import { rigs } from "./page/rigs.mjs";
import { sharing } from "./page/sharing.mjs";
import { shown } from "./page/shown.mjs";
import { sky } from "./page/sky.mjs";
import { slots } from "./page/slots.mjs";
import { solved } from "./page/solved.mjs";
import { soak } from "./page/soak.mjs";
import { state } from "./page/state.mjs";
import { step } from "./page/step.mjs";
import { text } from "./page/text.mjs";
import { three } from "./page/three.mjs";
import { touch } from "./page/touch.mjs";
import { unsupported } from "./page/unsupported.mjs";
import { walking } from "./page/walking.mjs";
import { watch } from "./page/watch.mjs";

const PARTS = {
  loading, attributes, slots, onScreen, hidden, animation, lights, mixer, input, touch, walking, handles, history, panel, panelLights, panelLook, pictures, shown, solved, step, state, watch, light, environment, sky, gloss, nodes, rigs,
  failures, unsupported, downloads, exported, memory, text, policy, damaged, sharing, bakeInPage, bakeElement, bakeGuide, three,
};
/** Damaged files that are opened: a share of what `cargo xtask damage` opens, from another seed. */
const DAMAGED = ["24", "2"];

/** Parts that run at the same time, each in a browser of its own: much of a part's time is spent waiting. */
const LANES = 2;

/** Runs the tests of the page, or one of its parts. `paths`: the programs rebounce, compare and damage, and a folder to
 * work in. */
export async function runPageTests(harness, paths, only) {
  // By the names of their files.
  const file = (part) => part.toLowerCase().replaceAll("-", "");
  const named = Object.entries({ ...PARTS, recovery }).filter(([name]) => !only || file(name) === file(only));
  const left = named.map(([, part]) => part);
  if (left.length === 0 && only !== "modules") throw new Error(`there is no part ${only}; there are ${Object.keys(PARTS).join(", ")}, recovery`);
  if (!only || only === "modules") await modules(harness);
  if (only === "modules") return;
  if (!only) await soak(harness);
  const baked = path.join(paths.work, "cornell-box.rbn");
  await exec(paths.rebounce, ["bake", "builtin:cornell-box", "--preset", "draft", "-o", baked]);
  const folder = path.join(paths.work, "damaged");
  await rm(folder, { recursive: true, force: true });
  await exec(paths.damage, [folder, ...DAMAGED]);
  const server = await serve(paths.rebounce, baked);
  const shared = { ...paths, damaged: folder, baked, address: server.address, bytes: await readFile(baked) };
  const last = left.indexOf(recovery) < 0 ? [] : [left.pop()];
  try {
    const lanes = await Promise.allSettled(
      Array.from({ length: LANES }, async () => {
        // Where a browser crashes, later parts have a new one.
        while (left.length > 0) {
          await inBrowser(shared, async (context) => {
            for (let part = left.shift(); part; part = context.browser.isConnected() && left.shift()) await part(harness, context);
          });
        }
      }),
    );
    const lost = lanes.find((lane) => lane.status === "rejected");
    if (lost) throw lost.reason;
    // In a browser of its own: some lose patience with pages whose devices go.
    for (const part of last) await inBrowser(shared, (context) => part(harness, context));
  } finally {
    server.process.kill();
  }
  if (!only) await readme(harness);
}

/** Does some work with a browser, and closes that. */
async function inBrowser(shared, work) {
  const context = { ...shared, browser: await launch() };
  try {
    await work(context);
  } finally {
    await context.browser.close();
  }
}
