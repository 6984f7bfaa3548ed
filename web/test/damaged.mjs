// node test/damaged.mjs FOLDER [FILES A PAGE]: opens damaged files in the element, one after another, and says what
// became of each. FOLDER is what the program `damage` has written: list.json, the files, and whole.rbn, which is none.

import { readFile } from "node:fs/promises";
import path from "node:path";
import { pathToFileURL } from "node:url";
import { Late, launch, within } from "./browser.mjs";
import { check } from "./harness.mjs";
import { document, serveStrictly } from "./strict.mjs";

/** What a file may be refused with. Others, such as internal or device-lost, are faults of ours. */
const REFUSALS = ["not-rbn", "truncated", "corrupt", "newer-version", "older-version", "too-large", "texture", "bad-json", "bad-argument"];
/** A file that takes longer is a hang, seconds: software WebGPU shows a whole one in about one, and a busy machine in twenty. */
const LONG = 120;

/** In the page: opens a file in the element, and waits until it is refused or has been drawn and read. */
async function attempt({ name, fresh }) {
  if (fresh || !globalThis.element) {
    globalThis.element?.remove();
    globalThis.element = document.createElement("rebounce-viewer");
    element.width = 64;
    element.height = 36;
    document.body.append(element);
  }
  const start = performance.now();
  const told = [];
  const note = ({ type, detail: { code, message } }) => told.push({ type, code, message });
  const next = new Promise((done) => {
    element.onload = element.onerror = null;
    for (const type of ["load", "error"]) element.addEventListener(type, done, { once: true });
  });
  for (const type of ["load", "error"]) element.addEventListener(type, note);
  element.src = name;
  await next;
  let spread = 0;
  if (told[0].type === "load") {
    try {
      // What the GPU refuses of it is told by the time that something was read.
      const pixels = await element.readPixels(16, 9);
      const light = await element.readIndirect(16, 9);
      spread = light.length === 16 * 9 * 4 ? Math.max(...pixels) : -1;
    } catch (error) {
      told.push({ type: "rejected", code: error.code, message: error.message });
    }
    await new Promise((later) => setTimeout(later, 20));
  }
  for (const type of ["load", "error"]) element.removeEventListener(type, note);
  const shown = element.shadowRoot.querySelector("[role=alert]");
  return { told, spread, ms: performance.now() - start, alert: shown.hidden ? "" : shown.textContent };
}

/** In the page, before its scripts: counts devices, and those that were lost. */
function watchDevices() {
  globalThis.devices = { opened: 0, lost: 0 };
  const original = GPUAdapter.prototype.requestDevice;
  GPUAdapter.prototype.requestDevice = async function (...args) {
    const device = await original.apply(this, args);
    devices.opened += 1;
    void device.lost.then(({ reason }) => (devices.lost += reason === "destroyed" ? 0 : 1));
    return device;
  };
}

/**
 * Opens the files of a folder, `each` a page; every twentieth in a new element. Gives counts and what was wrong, a sentence
 * a file. The picture of the whole file is looked at before and after every page's share.
 */
export async function openDamaged(browser, folder, { each = 250, say = () => undefined } = {}) {
  const list = JSON.parse(await readFile(path.join(folder, "list.json"), "utf8"));
  const server = await serveStrictly({ folders: [folder], pages: { "": document("") } });
  const result = { files: list.length, errors: 0, pictures: 0, codes: {}, slowest: { ms: 0, name: "" }, late: 0, faults: [] };
  try {
    for (let done = 0; done < list.length; ) {
      const before = result.faults.length;
      // A page that is of no further use makes room for another one, which goes on behind what broke it. What a hang did,
      // and not a busy machine, it does again.
      const opened = await share(browser, server.address, list.slice(done, done + each), result, false);
      done += opened.count;
      if (opened.late) done += (await share(browser, server.address, list.slice(done, done + 1), result, true)).count;
      for (const fault of result.faults.slice(before)) say(`  ${fault}`);
      say(`${done} of ${list.length}: ${summary(result)}`);
    }
  } finally {
    server.end();
  }
  return result;
}

/**
 * Opens files in a page of their own; how many it came to. `late`: the next one took too long, which is a fault the
 * second time, when it is tried `again`.
 */
async function share(browser, address, files, result, again) {
  let [begun, done] = [0, 0];
  const page = await browser.newPage({ viewport: { width: 320, height: 180 } });
  page.setDefaultTimeout(1000 * LONG);
  const stray = [];
  page.on("crash", () => stray.push("the tab crashed"));
  page.on("pageerror", (error) => stray.push(String(error)));
  // Refusals are no faults of the page: it tells of them by events alone.
  page.on("console", (message) => message.type() === "error" && stray.push(message.text()));
  await page.addInitScript(watchDevices);
  await page.goto(address);
  const open = (name, fresh) => within(name, page.evaluate(attempt, { name, fresh }), LONG);
  const whole = async (when) => {
    const { told, spread, alert } = await open("whole.rbn", false);
    const good = told.length === 1 && told[0].type === "load" && spread > 0 && alert === "";
    if (!good) result.faults.push(`${when}: the whole file: ${JSON.stringify(told)}, brightest ${spread}`);
  };
  try {
    await whole("at first");
    for (const [i, { name, what, refused }] of files.entries()) {
      begun += 1;
      const fault = (text) => result.faults.push(`${name} (${what}): ${text}`);
      const { told, spread, ms, alert } = await open(name, i % 20 === 0);
      if (ms > result.slowest.ms) result.slowest = { ms, name };
      const [{ type, code, message }] = told;
      result.codes[code ?? type] = (result.codes[code ?? type] ?? 0) + 1;
      if (type === "error") {
        result.errors += 1;
        if (!alert.startsWith(message)) fault(`the page shows ${JSON.stringify(alert)}, not ${message}`);
      } else {
        result.pictures += 1;
        if (refused) fault("it was shown");
        if (spread < 0) fault("the picture has another size");
      }
      for (const { type, code, message } of told) {
        if (type !== "load" && !REFUSALS.includes(code)) fault(`${type} ${code}: ${message}`);
      }
      if (told.length > 1) fault(`told twice: ${JSON.stringify(told)}`);
      if (stray.length > 0) fault(stray.splice(0).join("; "));
      const devices = await page.evaluate(() => globalThis.devices);
      if (devices.lost > 0) {
        await page.evaluate(() => (globalThis.devices.lost = 0));
        fault("the device was lost");
      }
      done = begun;
    }
    await whole("at last");
  } catch (error) {
    const late = error instanceof Late && !again && stray.length === 0;
    result.late += late;
    if (late) return { count: done, late };
    result.faults.push(`the page is of no further use: ${error.message}; ${stray.join("; ")}`);
  } finally {
    await page.close().catch(() => undefined);
  }
  // Even the whole file was too much for it: none of its share is tried.
  return { count: begun || files.length, late: false };
}

/** The figures, in a line. */
export function summary({ errors, pictures, slowest, late, faults, codes }) {
  const each = Object.entries(codes).sort(([, a], [, b]) => b - a).map(([code, count]) => `${code} ${count}`);
  return `${errors} errors, ${pictures} pictures, ${faults.length} faults, ${late} tried again; slowest ${slowest.name} ${(slowest.ms / 1000).toFixed(1)} s; ${each.join(", ")}`;
}

if (process.argv[1] && import.meta.url === pathToFileURL(process.argv[1]).href) {
  const [folder, each = "250"] = process.argv.slice(2);
  check(folder, "usage: node test/damaged.mjs FOLDER [FILES A PAGE]");
  const browser = await launch();
  const start = performance.now();
  try {
    const result = await openDamaged(browser, folder, { each: Number(each), say: console.log });
    console.log(`${result.files} files in ${((performance.now() - start) / 1000).toFixed(0)} s: ${summary(result)}`);
    const all = result.errors + result.pictures === result.files;
    process.exitCode = all && result.files > 0 && result.faults.length === 0 ? 0 : 1;
  } finally {
    await browser.close();
  }
}
