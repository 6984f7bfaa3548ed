// node test/run.mjs [--long] [--wasm DIR/NAME]... [--only PART] [--page WORK REBOUNCE COMPARE DAMAGE] [--package WORK REBOUNCE TARBALLS]
// [--site FOLDER]: tests that need a browser.
// --only: before --page: of its parts those with this name (`PARTS` in page.mjs).
// --long: tests that take long are run, too.
// --wasm: a test program, where wasm-bindgen wrote NAME.js and NAME_bg.wasm.
// --page: the tests of the page, with a folder to work in and three programs.
// --package: those of the npm packages, with a folder to work in, the program rebounce, and the tarballs: viewer, command, native program (or none).
// --site: those of the site that lies in a folder.
// The last line printed is "N passed, N failed"; fails if any test does.

import path from "node:path";
import { Harness } from "./harness.mjs";
import { runPackageTests } from "./package.mjs";
import { runPageTests } from "./page.mjs";
import { runSiteTests } from "./site.mjs";
import { runWasmTests } from "./wasm.mjs";

const args = process.argv.slice(2);
const harness = new Harness(args.includes("--long"));
/** Tests of packages and site, which run at the same time: much of their time is spent waiting. */
const last = [];
let only;
while (args.length > 0) {
  const kind = args.shift();
  if (kind === "--long") {
    continue;
  } else if (kind === "--wasm") {
    const program = args.shift();
    const name = path.basename(program);
    console.log(`\nwasm tests in headless Chromium: ${name}`);
    try {
      harness.add(await runWasmTests(path.dirname(program), name));
    } catch (error) {
      await harness.test(name, () => Promise.reject(error));
    }
  } else if (kind === "--only") {
    only = args.shift();
  } else if (kind === "--page") {
    const [work, rebounce, compare, damage] = args.splice(0, 4);
    console.log("\npage tests in headless Chromium");
    try {
      await runPageTests(harness, { work, rebounce, compare, damage }, only);
    } catch (error) {
      await harness.test("page", () => Promise.reject(error));
    }
  } else if (kind === "--package") {
    const [work, rebounce, viewer, command, native] = args.splice(0, 5);
    last.push(["package", () => runPackageTests(harness, { work, rebounce, viewer, command, native })]);
  } else if (kind === "--site") {
    const folder = args.shift();
    last.push(["site", () => runSiteTests(harness, folder)]);
  } else {
    throw new Error(`unknown argument ${kind}`);
  }
}
if (last.length > 0) console.log("\ntests of the npm packages and of the site");
await Promise.all(last.map(([name, tests]) => tests().catch((error) => harness.test(name, () => Promise.reject(error)))));
if (harness.left > 0) console.log(`\n${harness.left} that take long are left out: cargo xtask test --long runs them`);
console.log(`\n${harness.passed} passed, ${harness.failed} failed`);
process.exitCode = harness.failed > 0 || harness.passed === 0 ? 1 : 0;
