import { readFile } from "node:fs/promises";
import { exec, serve } from "./agreement.mjs";
import { launch } from "./browser.mjs";
import { Harness } from "./harness.mjs";
const work = "/tmp/wbx/work";
const harness = new Harness();
const baked = "/tmp/wbx/soak.rbn";
const server = await serve("/work/wb/target/debug/rebounce", baked);
const browser = await launch();
const context = { work, damaged: "/tmp/wbx/d60", baked, browser, address: server.address, bytes: await readFile(baked) };
for (const name of process.argv.slice(2)) { const m = await import(`./page/${name}.mjs`); await m[name === "onscreen" ? "onScreen" : name](harness, context); }
await browser.close(); server.process.kill();
console.log(harness.passed, harness.failed);
