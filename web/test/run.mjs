// node test/run.mjs [--wasm DIR/NAME]... [--only PART] [--page WORK REBOUNCE COMPARE DAMAGE] [--package WORK REBOUNCE TARBALL]
// [--site FOLDER]: tests that need a browser.
// --only: before --page: of its parts those with this name (`PARTS` in page.mjs).
// --wasm: a test program, where wasm-bindgen wrote NAME.js and NAME_bg.wasm.
// --page: the tests of the page, with a folder to work in and three programs.
// --package: those of the npm package, with a folder to work in, the program rebounce, and the tarball.
// --site: those of the site that lies in a folder.
// The last line printed is "N passed, N failed"; fails if any test does.

import path from "node:path";
import { Harness } from "./harness.mjs";
import { runPackageTests } from "./package.mjs";
import { runPageTests } from "./page.mjs";
import { runSiteTests } from "./site.mjs";
import { runWasmTests } from "./wasm.mjs";

const harness = new Harness();
const args = process.argv.slice(2);
let only;
/** What the arguments ask for: a name, and work. */
const asked = { page: [], others: [] };
while (args.length > 0) {
  const kind = args.shift();
  if (kind === "--wasm") {
    const program = args.shift();
    const name = path.basename(program);
    asked.others.push([`wasm tests: ${name}`, async () => harness.add(await runWasmTests(path.dirname(program), name))]);
  } else if (kind === "--only") {
    only = args.shift();
  } else if (kind === "--page") {
    const [work, rebounce, compare, damage] = args.splice(0, 4);
    asked.page.push(["page", () => runPageTests(harness, { work, rebounce, compare, damage }, only)]);
  } else if (kind === "--package") {
    const [work, rebounce, tarball] = args.splice(0, 3);
    asked.others.push(["package", () => runPackageTests(harness, { work, rebounce, tarball })]);
  } else if (kind === "--site") {
    const folder = args.shift();
    asked.others.push(["site", () => runSiteTests(harness, folder)]);
  } else {
    throw new Error(`unknown argument ${kind}`);
  }
}

/** One after the other; what throws outside its tests is a failed test. */
async function inTurn(list) {
  for (const [name, work] of list) {
    try {
      await harness.file(name, work);
    } catch (error) {
      await harness.test(name, () => Promise.reject(error));
    }
  }
}
// The page's own lanes leave processors idle where they wait: the others run beside them.
await Promise.all([inTurn(asked.page), inTurn(asked.others)]);

console.log(`\n${harness.summary()}`);
console.log(`\n${harness.passed} passed, ${harness.failed} failed`);
process.exitCode = harness.failed > 0 || harness.passed === 0 ? 1 : 0;
