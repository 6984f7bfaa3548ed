// Several elements on a page: one device, and everything that an element takes of it comes back.

import { HANGS, decode, spread, within } from "../browser.mjs";
import { check, equal, same } from "../harness.mjs";
import { ledger } from "./ledger.mjs";
import { open, outcome, PLAIN } from "./open.mjs";

const CYCLES = 50;
/** After so many, memory no longer grows. */
const SETTLED = 20;

/** Opens a page with these elements, whose WebGPU is counted, and helpers to make and read elements. */
export async function counted(context, html, options = {}) {
  const opened = await open(context, { html, prepare: ledger, ...options });
  await opened.page.evaluate(() => {
    globalThis.elements = () => [...document.querySelectorAll("rebounce-viewer")];
    globalThis.loads = () => events.filter((event) => event.type === "load").length;
    // The tone-mapped picture, small.
    globalThis.look = (element) => element.readPixels(32, 18).then((pixels) => Array.from(pixels));
    // A further element, small.
    globalThis.add = (src = "scene.rbn") => {
      const element = document.createElement("rebounce-viewer");
      Object.assign(element, { src, width: 32, height: 18 });
      document.body.append(element);
      return element;
    };
    // What is alive, when all that was submitted is done and then for a while nothing has come, gone or been drawn.
    globalThis.settled = async () => {
      const state = () => [gpu.alive, gpu.bytes, ...elements().map((it) => it.stats()?.frames)].join();
      for (let before; before !== state(); await pause(1500)) {
        before = state();
        await idle();
      }
      return { alive: gpu.alive, bytes: gpu.bytes };
    };
  });
  return opened;
}

const NOTHING = { alive: 0, bytes: 0 };

export async function sharing(harness, context) {
  await harness.long("page::sharing::ten_elements_draw_the_same_picture_with_one_device", async () => {
    const { page, faults } = await counted(context, "<rebounce-viewer></rebounce-viewer>".repeat(10), {
      viewport: { width: 400, height: 640 },
      // Every element begins on a whole device pixel.
      media: { deviceScaleFactor: 0.5 },
    });
    await page.evaluate(() => {
      document.documentElement.style.height = document.body.style.height = "auto";
      Object.assign(document.body.style, { display: "grid", gridTemplateColumns: "1fr 1fr", overflow: "visible" });
      for (const element of elements()) Object.assign(element.style, { width: "192px", height: "108px" });
      // Now that all have their size.
      for (const element of elements()) element.src = "scene.rbn";
    });
    await within("ten scenes", page.evaluate(() => until(() => loads() === 10)));
    equal(await page.evaluate(() => gpu.devices.length), 1, "devices");
    const pictures = await page.evaluate(async () => {
      const all = [];
      for (const element of elements()) all.push(await look(element));
      return all;
    });
    check(spread(pictures[0]).deviation > 4, "the picture is blank");
    for (const picture of pictures) alike(picture, pictures[0], "one picture and the first");
    // And so it is on the screen.
    await within("still pictures", page.evaluate(async () => {
      for (let before = -1, now = 0; before !== now; await pause(1500)) {
        before = now;
        now = elements().reduce((sum, element) => sum + element.stats().frames, 0);
      }
    }));
    const shots = [];
    for (let i = 0; i < 10; i += 1) {
      const png = await page.locator("rebounce-viewer").nth(i).screenshot({ timeout: 1000 * HANGS });
      shots.push(await decode(context.browser, png));
    }
    for (const shot of shots) {
      check(spread(shot).deviation > 4, "a canvas is blank");
      alike(shot, shots[0], "one canvas and the first");
    }
    equal(faults.join("\n"), "", "faults");
    await page.close();
  });

  await harness.test("page::sharing::a_second_element_compiles_nothing", async () => {
    const { page } = await counted(context, PLAIN);
    await outcome(page);
    const compiled = await page.evaluate(async () => {
      const { pipelines } = gpu;
      add();
      await until(() => loads() === 2);
      return { first: pipelines, second: gpu.pipelines - pipelines };
    });
    check(compiled.first > 0, "the first compiles none either");
    equal(compiled.second, 0, "pipelines that the second one compiles");
    await page.close();
  });

  await harness.test("page::sharing::what_one_element_does_wrong_is_not_the_others_failure", async () => {
    const { page } = await counted(context, PLAIN);
    await outcome(page);
    const codes = await within("both to tell", page.evaluate(async () => {
      const [first] = elements();
      // The second one's buffers are refused, as where memory is short.
      const original = GPUDevice.prototype.createBuffer;
      GPUDevice.prototype.createBuffer = function (descriptor) {
        return original.call(this, { ...descriptor, usage: descriptor.label === "VERT" ? 0 : descriptor.usage });
      };
      const second = add();
      const code = new Promise((told) => second.addEventListener("error", (event) => told(event.detail.code)));
      const own = [];
      first.addEventListener("error", (event) => own.push(event.detail.code));
      const found = await code;
      GPUDevice.prototype.createBuffer = original;
      first.exposure = 1;
      await pause(1000);
      return { found, own: own.length, loaded: first.loaded };
    }));
    same(codes, { found: "internal", own: 0, loaded: true }, "what both have told");
    await page.close();
  });

  await harness.test("page::sharing::dispose_frees_everything_and_the_last_one_the_device", async () => {
    const { page } = await counted(context, PLAIN + PLAIN);
    const found = await within("both", page.evaluate(async () => {
      await until(() => loads() === 2);
      const [first, second] = elements();
      const both = await settled();
      first.dispose();
      const one = await settled();
      const drawn = await look(second);
      // What is made while one uses it: other sizes, an overlay, more lights, pictures read.
      Object.assign(second, { width: 200, height: 100, overlay: "levels", mode: "indirect" });
      for (let i = 0; i < 3; i += 1) {
        second.addLight({ type: "spot", position: [0, 1, 0], direction: [0, -1, 0], outer_cone_deg: 30, intensity: 1 });
        await pause(300);
      }
      await second.readIndirect(40, 30);
      await second.counts();
      const ended = second.stats() && gpu.devices[0].lost.then(({ reason }) => reason);
      second.dispose();
      return { both, one, none: await settled(), ended: await ended, drawn, devices: gpu.devices.length };
    }));
    check(found.both.bytes > 1e6, JSON.stringify(found.both));
    // Half of it, but for a few bytes on their way to be read.
    check(Math.abs(2 * found.one.bytes - found.both.bytes) < 1000, `${found.one.bytes} of ${found.both.bytes} bytes are left with one`);
    check(spread(found.drawn).deviation > 4, "the other one's picture is blank");
    same(found.none, NOTHING, "what is alive after all");
    equal(found.ended, "destroyed", "the device");
    equal(found.devices, 1, "devices");
    await page.close();
  });

  for (const [moment, wait] of [
    ["the_viewer_is_opened", "gpu.ondevice"],
    ["the_scene_is_uploaded", "gpu.onbuffer"],
  ]) {
    await harness.test(`page::sharing::an_element_removed_while_${moment}_leaves_nothing`, async () => {
      const { page, faults } = await counted(context, "<p></p>");
      const left = await within("the end", page.evaluate(async (hook) => {
        let element;
        const happened = new Promise((done) => {
          gpu[hook.slice(4)] = () => {
            element?.remove();
            done();
          };
        });
        element = add();
        await happened;
        await until(() => gpu.devices.length === 1);
        await gpu.devices[0].lost;
        return { ...(await settled()), events: events.filter(({ type }) => type !== "progress").length };
      }, wait));
      same(left, { ...NOTHING, events: 0 }, "what is left, and told");
      equal(faults.join("\n"), "", "faults");
      await page.close();
    });
  }

  await harness.long("page::sharing::elements_come_and_go_without_a_trace", async () => {
    const { page, faults } = await counted(context, PLAIN);
    await outcome(page);
    const session = await page.context().newCDPSession(page);
    await session.send("Performance.enable");
    const measure = async () => {
      const ours = await page.evaluate(async () => {
        const { default: init } = await import("./rebounce_viewer.js");
        return { ...(await settled()), wasm: (await init()).memory.buffer.byteLength };
      });
      await session.send("HeapProfiler.collectGarbage");
      const { metrics } = await session.send("Performance.getMetrics");
      return { ...ours, heap: metrics.find(({ name }) => name === "JSHeapUsedSize").value };
    };
    const cycles = (count) =>
      within(`${count} elements`, page.evaluate(async (times) => {
        for (let i = 0; i < times; i += 1) {
          const element = add();
          await new Promise((told) => {
            for (const type of ["load", "error"]) element.addEventListener(type, told);
          });
          if (!element.loaded) throw new Error(events[events.length - 1].message);
          element.remove();
          await pause(0);
          events.length = 0;
        }
      }, count));
    // The first picture of all is a sketch where the device is slow.
    await page.evaluate(() => until(() => viewer.stats().frames > 1));
    const start = await measure();
    await cycles(SETTLED);
    const settled = await measure();
    await cycles(CYCLES - SETTLED);
    const end = await measure();
    console.log(`    start ${JSON.stringify(start)}\n    after ${SETTLED} ${JSON.stringify(settled)}\n    after ${CYCLES} ${JSON.stringify(end)}`);
    for (const { alive, bytes } of [settled, end]) {
      same({ alive, bytes }, { alive: start.alive, bytes: start.bytes }, "what is alive");
    }
    equal(end.wasm, settled.wasm, "bytes of the wasm's memory");
    const each = (end.heap - settled.heap) / (CYCLES - SETTLED);
    check(each < 2000, `${each.toFixed(0)} bytes of the script's memory stay for every element`);
    equal(await page.evaluate(() => gpu.devices.length), 1, "devices");
    equal(faults.join("\n"), "", "faults");
    await page.close();
  });
}

/** The mean difference between two pictures of one size, of 255. */
export function distance(a, b) {
  equal(a.length, b.length, "bytes of a picture");
  return a.reduce((sum, value, i) => sum + Math.abs(value - b[i]), 0) / a.length;
}

/** The same picture, up to what cannot be seen. */
export function alike(a, b, what) {
  const apart = distance(a, b);
  check(apart < 0.3, `${what}: ${apart.toFixed(3)} of 255 apart`);
}
