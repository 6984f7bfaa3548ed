// Runs the wasm-bindgen tests of one program in the browser, as wasm-bindgen's own runner does.

import { createServer } from "node:http";
import { readFile } from "node:fs/promises";
import path from "node:path";
import { launch, within } from "./browser.mjs";

const PAGE = `<!doctype html><meta charset="utf-8"><title>tests</title><pre id="output"></pre>
<script>
  // What a test prints belongs to that test; the rest goes to the browser's console.
  for (const method of ["debug", "log", "info", "warn", "error"]) {
    const original = console[method];
    console[method] = (...args) => {
      const capture = window["on_console_" + method];
      if (capture) capture(args);
      else original.apply(console, args);
    };
  }
  window.__wbg_test_invoke = (f) => f();
</script>`;

const TYPES = { ".js": "text/javascript", ".wasm": "application/wasm" };

/** Runs `DIR/NAME.js` and `DIR/NAME_bg.wasm`; how many passed and failed. */
export async function runWasmTests(dir, name) {
  const server = createServer(async (request, response) => {
    const file = new URL(request.url, "http://127.0.0.1").pathname.slice(1);
    if (file === "") return response.setHeader("content-type", "text/html; charset=utf-8").end(PAGE);
    const bytes = await readFile(path.join(dir, path.basename(file))).catch(() => undefined);
    if (!bytes) return response.writeHead(404).end();
    response.setHeader("content-type", TYPES[path.extname(file)] ?? "application/octet-stream").end(bytes);
  });
  await new Promise((ready) => server.listen(0, "127.0.0.1", ready));
  const browser = await launch();
  try {
    const page = await browser.newPage();
    page.on("pageerror", (error) => console.error(`page: ${error}`));
    await page.goto(`http://127.0.0.1:${server.address().port}/`);
    const run = page.evaluate(async (name) => {
      const module = await import(`/${name}.js`);
      const wasm = await module.default({ module_or_path: `/${name}_bg.wasm` });
      const tests = Object.keys(wasm).filter((key) => key.startsWith("__wbgt_"));
      if (tests.length === 0) return "no tests";
      const context = new module.WasmBindgenTestContext(false);
      for (const method of ["debug", "log", "info", "warn", "error"]) {
        window[`on_console_${method}`] = module[`__wbgtest_console_${method}`];
      }
      await context.run(tests.map((test) => wasm[test]));
      return document.getElementById("output").textContent;
    }, name);
    const text = await within(`the tests of ${name}`, run);
    // The counts come in the last line of all; a line of cargo's form here would be counted twice.
    console.log(text.trim().replace(/^test result/gm, "result"));
    const result = /test result: .*?(\d+) passed; (\d+) failed/.exec(text);
    if (!result) throw new Error(`${name} printed no result`);
    return { passed: Number(result[1]), failed: Number(result[2]) };
  } finally {
    await browser.close();
    server.close();
  }
}
