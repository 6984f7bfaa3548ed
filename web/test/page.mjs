// The page as a user has it: `rebounce view` serves it, headless Chromium shows it.

import { readFile } from "node:fs/promises";
import path from "node:path";
import { agreement, difference, exec, serve } from "./agreement.mjs";
import { launch, spread, within } from "./browser.mjs";
import { check, equal } from "./harness.mjs";

/** Pictures are compared at this size; the browser's is averaged from FINER times as many pixels a
 * side, since the CPU takes 64 samples a pixel. */
const SIZE = [256, 144];
const FINER = 4;
/** The most that the browser's indirect light may differ from the CPU's, relative RMS. */
const TOLERANCE = 0.03;

const CAMERA = { position: [0.4, 2.9, 3.2], target: [-0.2, 2.3, -3], up: [0, 1, 0], yfov_deg: 65 };
const SPOT = {
  type: "spot",
  position: [-1.2, 4.6, -2.2],
  direction: [-0.8, -1, 0.1],
  outer_cone_deg: 40,
  inner_cone_deg: 30,
  intensity: 150,
  color: [1, 0.9, 0.8],
};
const SHOTS = {
  "a spot on the red wall": { camera: CAMERA, lights: [SPOT] },
  "the spot moved to the green wall": {
    camera: CAMERA,
    lights: [{ ...SPOT, position: [1.0, 3.6, -1.6], direction: [1, -0.5, -0.3] }],
  },
};

/** Runs the tests of the page. `paths`: the programs rebounce and compare, and a folder to work in. */
export async function runPageTests(harness, paths) {
  const baked = path.join(paths.work, "cornell-box.rbn");
  await exec(paths.rebounce, ["bake", "builtin:cornell-box", "--preset", "draft", "-o", baked]);
  const server = await serve(paths.rebounce, baked);
  const browser = await launch();
  const context = { ...paths, baked, browser, address: server.address, bytes: await readFile(baked) };
  try {
    await loading(harness, context);
    await light(harness, context);
    await onScreen(harness, context);
    await failures(harness, context);
  } finally {
    await browser.close();
    server.process.kill();
  }
}

/** Opens the page; `prepare` may change it before any of its scripts run. Faults are gathered. */
async function open(context, { query = "", prepare, argument, routes = {} } = {}) {
  const page = await context.browser.newPage({ viewport: { width: 320, height: 180 } });
  page.setDefaultTimeout(180_000);
  const faults = [];
  page.on("pageerror", (error) => faults.push(String(error)));
  page.on("console", (message) => message.type() === "error" && faults.push(message.text()));
  await page.addInitScript(() => {
    globalThis.events = [];
    for (const type of ["load", "error", "progress", "camera-change", "light-change"]) {
      const note = (event) => event.target.localName === "rebounce-viewer" && events.push({ type, ...event.detail });
      document.addEventListener(type, note, true);
    }
    // Resolves with the next outcome after the first `seen` ones.
    globalThis.outcome = async (seen = 0) => {
      for (;;) {
        const outcomes = events.filter((event) => event.type === "load" || event.type === "error");
        if (outcomes.length > seen) return outcomes[seen];
        await new Promise((later) => setTimeout(later, 50));
      }
    };
  });
  if (prepare) await page.addInitScript(prepare, argument);
  for (const [pattern, route] of Object.entries(routes)) await page.route(pattern, route);
  await page.goto(context.address + query);
  return { page, faults };
}

const outcome = (page, seen = 0) =>
  within(180, "the scene", page.evaluate((count) => globalThis.outcome(count), seen));

/** What the element shows of a failure. */
const shown = (page) =>
  page.evaluate(() => {
    const { shadowRoot } = document.querySelector("rebounce-viewer");
    const alert = shadowRoot.querySelector("[role=alert]");
    const canvas = shadowRoot.querySelector("canvas");
    return {
      alert: alert.hidden ? "" : alert.querySelector("p").textContent,
      markup: alert.querySelectorAll("p *").length,
      canvas: getComputedStyle(canvas).visibility === "visible",
    };
  });

async function loading(harness, context) {
  const { page, faults } = await open(context);

  await harness.test("page::loads_the_baked_cornell_box", async () => {
    const event = await outcome(page);
    equal(event.type, "load", event.message ?? "the event");
    equal(event.url, `${context.address}scene.rbn`, "its url");
    const { alert, canvas } = await shown(page);
    equal(alert, "", "the message");
    check(canvas, "the canvas is hidden");
  });

  await harness.test("page::progress_rises_to_the_whole_file", async () => {
    const steps = await page.evaluate(() => events.filter((event) => event.type === "progress"));
    check(steps.length >= 2, `${steps.length} progress events`);
    const last = steps[steps.length - 1];
    equal(last.loaded, context.bytes.length, "bytes loaded in the end");
    equal(last.ratio, 1, "the ratio in the end");
    steps.reduce((before, step) => {
      check(step.loaded >= before.loaded, `${step.loaded} bytes after ${before.loaded}`);
      return step;
    });
  });

  await harness.test("page::picture_is_not_blank", async () => {
    const pixels = await page.evaluate(async () =>
      Array.from(await document.querySelector("rebounce-viewer").readPixels(128, 72)),
    );
    equal(pixels.length, 128 * 72 * 4, "bytes");
    const { mean, deviation } = spread(pixels);
    check(deviation > 4, `brightness ${mean.toFixed(1)} +- ${deviation.toFixed(1)} of 255`);
  });

  await harness.test("page::a_still_scene_costs_no_frames", async () => {
    const drawn = await page.evaluate(async () => {
      const original = requestAnimationFrame;
      let asked = 0;
      window.requestAnimationFrame = (callback) => {
        asked += 1;
        return original.call(window, callback);
      };
      const pause = (ms) => new Promise((later) => setTimeout(later, ms));
      // What loading began may still be under way.
      for (let before = -1; before !== asked; await pause(500)) before = asked;
      asked = 0;
      await pause(1000);
      const still = asked;
      document.querySelector("rebounce-viewer").exposure = 1;
      await pause(1000);
      window.requestAnimationFrame = original;
      return { still, changed: asked - still };
    });
    equal(drawn.still, 0, "frames of a still scene");
    check(drawn.changed > 0, "a change of exposure drew no frame");
  });

  await harness.test("page::dragging_turns_the_camera", async () => {
    const before = await page.evaluate(() => document.querySelector("rebounce-viewer").camera);
    await page.mouse.move(30, 150);
    await page.mouse.down();
    await page.mouse.move(90, 140, { steps: 4 });
    await page.mouse.up();
    const camera = await within(
      60,
      "camera-change",
      page.evaluate(async () => {
        while (!events.some((event) => event.type === "camera-change")) await new Promise((t) => setTimeout(t, 50));
        return document.querySelector("rebounce-viewer").camera;
      }),
    );
    const moved = Math.hypot(...camera.position.map((value, axis) => value - before.position[axis]));
    const turned = Math.hypot(...camera.target.map((value, axis) => value - before.target[axis]));
    check(moved + turned > 0.01, `the camera stayed at ${camera.position}`);
  });

  await harness.test("page::no_fault_on_the_way", async () => {
    equal(faults.join("\n"), "", "faults");
  });
  await page.close();
}

async function onScreen(harness, context) {
  // The element far below what can be seen, and lazy.
  const prepare = () => {
    new MutationObserver((_, observer) => {
      const viewer = document.querySelector("rebounce-viewer");
      if (!viewer) return;
      observer.disconnect();
      viewer.setAttribute("loading", "lazy");
      viewer.style.display = "block";
      viewer.style.height = "180px";
      document.documentElement.style.overflow = document.body.style.overflow = "auto";
      document.documentElement.style.height = document.body.style.height = "auto";
      document.body.style.display = "block";
      const far = document.createElement("div");
      far.style.height = "4000px";
      viewer.before(far);
    }).observe(document, { childList: true, subtree: true });
  };
  const { page, faults } = await open(context, { prepare });
  const frames = () => page.evaluate(() => document.querySelector("rebounce-viewer").stats()?.frames);
  const pause = (ms) => new Promise((later) => setTimeout(later, ms));
  const scroll = (y) => page.evaluate((to) => scrollTo(0, to), y);

  await harness.test("page::a_lazy_element_loads_when_it_comes_into_view", async () => {
    await pause(1500);
    equal(await page.evaluate(() => events.length), 0, "events while it is far away");
    await scroll(4000);
    equal((await outcome(page)).type, "load", "the event");
  });

  await harness.test("page::out_of_view_nothing_is_drawn", async () => {
    await scroll(0);
    // What was under way comes to its end, however slow the machine is.
    let before = -1;
    for (let now = await frames(); now !== before; now = await frames()) {
      before = now;
      await pause(1500);
    }
    await page.evaluate(() => {
      const viewer = document.querySelector("rebounce-viewer");
      const [light] = viewer.lights;
      viewer.lights = [{ ...light, intensity: light.intensity * 0.5 }];
    });
    await pause(1500);
    equal(await frames(), before, "frames drawn out of view");
    await scroll(4000);
    await within(60, "a frame", page.waitForFunction((n) => document.querySelector("rebounce-viewer").stats().frames > n, before));
    equal(faults.length, 0, faults.join("\n"));
  });
  await page.close();
}

async function light(harness, context) {
  const { page } = await open(context);
  const files = [];
  for (const [name, shot] of Object.entries(SHOTS)) {
    await harness.test(`page::indirect_light_is_that_of_the_cpu: ${name}`, async () => {
      equal((await outcome(page)).type, "load", "the event");
      const { file, difference } = await agreement(page, context, name, shot, SIZE, FINER);
      console.log(`    ${name}: ${JSON.stringify(difference)}`);
      files.push(file);
      const rms = difference.error;
      check(rms <= TOLERANCE, `relative RMS difference ${rms}, at most ${TOLERANCE} is allowed`);
    });
  }
  await harness.test("page::moving_the_light_changes_the_picture", async () => {
    equal(files.length, 2, "pictures");
    const { error: rms } = await difference(context, files[0], files[1]);
    check(rms > 0.3, `the two shots differ by ${rms} only`);
    const told = await page.evaluate(() => events.filter((event) => event.type === "light-change").length);
    check(told > 0, "no light-change event");
  });
  await page.close();
}

/** A route that answers with these bytes. */
const answer = (body) => (route) => route.fulfill({ status: 200, contentType: "application/octet-stream", body });

async function failures(harness, context) {
  const { bytes } = context;
  const damaged = Buffer.from(bytes);
  damaged[damaged.length >> 1] ^= 0x10;
  const cases = {
    a_wrong_file: { code: "not-rbn", body: Buffer.from("glTF, or something else that is no baked scene") },
    an_empty_file: { code: "not-rbn", body: Buffer.alloc(0) },
    a_truncated_file: { code: "truncated", body: bytes.subarray(0, Math.floor(bytes.length * 0.6)) },
    a_truncated_header: { code: "truncated", body: bytes.subarray(0, 20) },
    a_damaged_file: { code: "corrupt", body: damaged },
    a_missing_file: { code: "http" },
    a_broken_connection: { code: "network", abort: true },
  };
  for (const [name, { code, body, abort }] of Object.entries(cases)) {
    await harness.test(`page::failures::${name}`, async () => {
      const route = abort ? (r) => r.abort() : answer(body);
      const routes = body || abort ? { "**/bad.rbn": route } : {};
      const { page, faults } = await open(context, { query: "?src=bad.rbn", routes });
      await expectFailure(page, code);
      // The browser itself reports answers that are no success.
      const own = faults.filter((fault) => !fault.startsWith("Failed to load resource"));
      equal(own.join("\n"), "", "faults");
      // The same element shows a good file afterwards.
      await page.evaluate(() => (document.querySelector("rebounce-viewer").src = "scene.rbn"));
      const event = await outcome(page, 1);
      equal(event.type, "load", event.message ?? "the event after the failure");
      equal((await shown(page)).alert, "", "the message after loading");
      await page.close();
    });
  }

  const broken = {
    no_webgpu: { code: "no-webgpu", prepare: () => delete Navigator.prototype.gpu },
    no_adapter: {
      code: "no-adapter",
      prepare: () => (GPU.prototype.requestAdapter = () => Promise.resolve(null)),
    },
    no_device: {
      code: "no-device",
      prepare: () => (GPUAdapter.prototype.requestDevice = () => Promise.reject(new Error("none <b>left</b>"))),
    },
  };
  for (const [name, { code, prepare }] of Object.entries(broken)) {
    await harness.test(`page::failures::${name}`, async () => {
      const { page, faults } = await open(context, { prepare });
      await expectFailure(page, code);
      equal(faults.join("\n"), "", "faults");
      await page.close();
    });
  }

  await harness.test("page::failures::a_download_that_breaks_off", async () => {
    const prepare = () => {
      const original = window.fetch;
      window.fetch = async (address, options) => {
        if (!String(address).endsWith("scene.rbn")) return original(address, options);
        const pull = (controller) => controller.error(new TypeError("network error"));
        const start = (controller) => controller.enqueue(new Uint8Array(1000));
        return new Response(new ReadableStream({ start, pull }), { headers: { "content-length": "5000" } });
      };
    };
    const { page, faults } = await open(context, { prepare });
    await expectFailure(page, "truncated");
    equal(faults.join("\n"), "", "faults");
    await page.close();
  });

  await harness.test("page::failures::a_name_is_text_and_never_markup", async () => {
    const { page } = await open(context, { query: `?src=${encodeURIComponent("<img src=x onerror=alert(1)>.rbn")}` });
    await expectFailure(page, "http");
    await page.close();
  });

  await harness.test("page::failures::reading_before_loading_rejects_with_a_code", async () => {
    const { page, faults } = await open(context, { query: "?src=missing.rbn" });
    await outcome(page);
    const code = await page.evaluate(() =>
      document.querySelector("rebounce-viewer").readIndirect(8, 8).then(() => "none", (error) => error.code),
    );
    equal(code, "no-scene", "the code");
    check(!faults.some((fault) => fault.includes("Uncaught")), faults.join("\n"));
    await page.close();
  });

  await harness.test("page::failures::an_element_that_is_removed_says_nothing", async () => {
    const { page, faults } = await open(context);
    const events = await page.evaluate(async () => {
      const viewer = document.querySelector("rebounce-viewer");
      let told = 0;
      viewer.addEventListener("error", () => (told += 1));
      viewer.src = "scene.rbn?again";
      viewer.remove();
      await new Promise((later) => setTimeout(later, 1000));
      globalThis.events.length = 0;
      document.body.append(viewer);
      return { told, outcome: await globalThis.outcome() };
    });
    equal(events.told, 0, "errors");
    equal(events.outcome.type, "load", "the event when it is back");
    equal(faults.join("\n"), "", "faults");
    await page.close();
  });

  // Last: this browser's GPU process is not to be used afterwards.
  await harness.test("page::failures::a_lost_device", async () => {
    const prepare = () => {
      const original = GPUAdapter.prototype.requestDevice;
      GPUAdapter.prototype.requestDevice = async function (...args) {
        globalThis.device = await original.apply(this, args);
        return globalThis.device;
      };
    };
    const { page, faults } = await open(context, { prepare });
    equal((await outcome(page)).type, "load", "the event");
    await page.evaluate(() => globalThis.device.destroy());
    await expectFailure(page, "device-lost", 1);
    equal(faults.join("\n"), "", "faults");
    await page.close();
  });
}

/** The next outcome is this failure: an event with the code, and a sentence where the picture was. */
async function expectFailure(page, code, seen = 0) {
  const event = await outcome(page, seen);
  equal(event.type, "error", "the event");
  equal(event.code, code, `the code (${event.message})`);
  const { alert, markup, canvas } = await shown(page);
  equal(alert, event.message, "the message in the page");
  check(/^\S.{15,}[.!?]$/s.test(alert), `no sentence: ${alert}`);
  equal(markup, 0, "elements made from the message");
  check(!canvas, "a blank canvas is shown");
}
