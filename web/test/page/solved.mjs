// A file of `rebounce solve`: shown as the command renders it, mixed; lights stay in their places, and that is told.

import { readFile, writeFile } from "node:fs/promises";
import path from "node:path";
import { agreement, exec } from "../agreement.mjs";
import { check, equal, same } from "../harness.mjs";
import { loaded, open, outcome } from "./open.mjs";

/** As in light.mjs. */
const SIZE = [48, 27];
const FINER = 2;
const TOLERANCE = 0.01;

const CAMERA = { position: [0.4, 2.9, 3.2], target: [-0.2, 2.3, -3], up: [0, 1, 0], yfov_deg: 65 };
const LIGHTS = [
  { type: "point", name: "Key", position: [1.4, 3.8, -1.6], intensity: 20, color: [1, 0.9, 0.8] },
  { type: "point", name: "Fill", position: [-1.4, 4.2, -1.4], intensity: 12, color: [0.5, 0.7, 1] },
  { type: "environment", name: "Sky", intensity: 0.5, color: [0.8, 0.9, 1] },
];
/** Where the drag of a hand begins and ends, CSS pixels from the element's top left. */
const DRAG = [160, 90, 200, 60];

/** In the page: the bounced light, and how much two pictures differ. */
function helpers() {
  globalThis.light = async () => Array.from(await viewer.readIndirect(48, 27)).filter((_, i) => i % 4 < 3);
  globalThis.apart = (a, b) => {
    const sum = (list) => list.reduce((total, x) => total + Math.abs(x), 0);
    return sum(a.map((x, i) => x - b[i])) / sum(b);
  };
  globalThis.errors = () => events.filter(({ type }) => type === "error").map(({ code, message }) => ({ code, message }));
}

/** A sentence says which light, and what to do. */
function isTold({ code, message }, light) {
  equal(code, "bad-argument", "the code");
  for (const words of [`Light ${light}, `, "rebounce bake"]) check(message.includes(words), `no ${words}: ${message}`);
  check(/^[A-Z].*\.$/.test(message), `no sentence: ${message}`);
}

/** Runs the tests. */
export async function solved(harness, context) {
  const file = (ending) => path.join(context.work, `solved.${ending}`);
  await writeFile(file("json"), JSON.stringify({ size: SIZE, camera: CAMERA, lights: LIGHTS }));
  const solve = ["solve", "builtin:cornell-box", "--shot", file("json"), "--preset", "draft", "--functions", "4K"];
  await exec(context.rebounce, [...solve, "-o", file("rbn")]);
  const body = await readFile(file("rbn"));
  const routes = { "**/solved.rbn": (route) => route.fulfill({ body, contentType: "application/octet-stream" }) };
  const html = '<rebounce-viewer src="solved.rbn" controls></rebounce-viewer>';
  const { page, faults } = await loaded(context, html, { routes, prepare: helpers });

  const pictures = [];
  const dimmed = [{ ...LIGHTS[1], intensity: 30, color: [1, 0.2, 0.1] }, LIGHTS[2]];
  const shots = {
    "as solved": { lights: LIGHTS },
    "mixed": { lights: LIGHTS, mix: [{ stops: -2 }, { stops: 2, color: [0.1, 1, 0.2] }, { mute: true }] },
    "a light less": { lights: dimmed },
  };
  for (const [name, shot] of Object.entries(shots)) {
    const kind = name === "mixed" ? "long" : "test";
    await harness[kind](`solved::bounced_light_is_that_of_the_command: ${name}`, async () => {
      const tools = { ...context, baked: file("rbn") };
      const { difference } = await agreement(page, tools, `solved ${name}`, { camera: CAMERA, ...shot }, SIZE, FINER, 256, false);
      console.log(`    ${name}: ${JSON.stringify(difference)}`);
      check(difference.error <= TOLERANCE, `relative RMS difference ${difference.error}, at most ${TOLERANCE} is allowed`);
      pictures.push(await page.evaluate(() => light()));
      for (const [i, other] of pictures.slice(0, -1).entries()) {
        const change = await page.evaluate(([a, b]) => apart(a, b), [pictures.at(-1), other]);
        check(change > 0.1, `the picture is that of shot ${i}: ${change}`);
      }
    });
  }

  await harness.test("solved::channels_add_up_by_hand_and_by_script", async () => {
    const found = await page.evaluate(async (lights) => {
      Object.assign(viewer, { lights, mix: [] });
      const all = await light();
      const alone = [];
      for (let i = 0; i < lights.length; i += 1) {
        viewer.mix = lights.map((_, k) => (k === i ? { solo: true } : {}));
        alone.push(await light());
      }
      viewer.mix = lights.map(() => ({ mute: true }));
      const dark = await light();
      viewer.mix = [];
      const sum = all.map((_, at) => alone.reduce((total, picture) => total + picture[at], 0));
      return { sum: apart(sum, all), dark: dark.every((x) => x === 0), parts: alone.map((picture) => apart(picture, all)) };
    }, LIGHTS);
    console.log(`    ${JSON.stringify(found)}`);
    check(found.sum < 1e-3 && found.dark, "the lights add up to all, none of them is dark");
    check(found.parts.every((part) => part > 0.1 && part < 0.95), "each is a part of it");
    const fader = page.getByRole("slider", { name: "Fill strength" });
    await page.getByText("Lights and settings").click();
    const before = await page.evaluate(() => light());
    await fader.fill("3");
    const after = await page.evaluate(() => light());
    check(await page.evaluate(([a, b]) => apart(a, b), [after, before]) > 0.1, "a fader changes the picture");
    await page.getByRole("button", { name: "Undo" }).click();
    check(await page.evaluate(([b]) => light().then((a) => apart(a, b)), [before]) < 1e-6, "and undo brings it back");
  });

  await harness.test("solved::a_lamp_elsewhere_is_refused_with_a_sentence_and_the_picture_stays", async () => {
    const before = await page.evaluate(async () => ({ lights: viewer.lights, picture: await light() }));
    const stays = async (what) => {
      const [lights, change, ready] = await page.evaluate(async ({ picture }) => [viewer.lights, apart(await light(), picture), viewer.loaded], before);
      same([lights, ready], [before.lights, true], `${what}: lights`);
      check(change < 1e-6, `${what}: the picture is another by ${change}`);
      equal(await page.evaluate(() => viewer.shadowRoot.querySelector("[role=alert]").hidden), true, `${what}: a failure is shown`);
    };
    const status = () => page.evaluate(() => viewer.shadowRoot.querySelector("[role=status]").textContent);
    const byScript = await page.evaluate(() => {
      const [key, ...others] = viewer.lights;
      const lists = [[{ ...key, position: [1.4, 3.8, -1.5] }, ...others], [key, others[0], { ...others[1], rotation_deg: 40 }], [...viewer.lights, key]];
      return lists.map((lights) => {
        try {
          viewer.lights = lights;
        } catch ({ code, message }) {
          return { code, message: message[0].toUpperCase() + message.slice(1) + (message.endsWith(".") ? "" : ".") };
        }
      });
    });
    for (const [i, light] of [0, 2, 3].entries()) isTold(byScript[i], light);
    await stays("by script");
    // A list of its own, by keys: and nothing says that the lamp has moved.
    await page.getByRole("button", { name: "Key point" }).focus();
    await page.keyboard.press("ArrowLeft");
    check((await status()).startsWith("Light 0, point, is not where"), await status());
    await stays("by a key");
    await page.getByRole("button", { name: "Add lamp" }).click();
    check((await status()).startsWith("Light 3, point, is not where"), await status());
    await stays("added by hand");
    // There is no handle: the lamp is in the middle of the picture, and a drag turns the view.
    const view = await page.evaluate(async () => {
      viewer.camera = { position: [1.4, 3.8, 0], target: [1.4, 3.8, -1.6], up: [0, 1, 0], yfov_deg: 60 };
      viewer.controls = false;
      await still();
      return JSON.stringify(viewer.camera);
    });
    const { x, y } = await page.locator("rebounce-viewer").boundingBox();
    const [fromX, fromY, toX, toY] = DRAG;
    await page.mouse.move(x + fromX, y + fromY);
    equal(await page.evaluate(() => viewer.hoveredLight), -1, "the light under the pointer");
    await page.mouse.down();
    await page.mouse.move(x + toX, y + toY, { steps: 4 });
    await page.mouse.up();
    const after = await page.evaluate(async (view) => (await still(), [viewer.lights, JSON.stringify(viewer.camera) === view, errors()]), view);
    same(after, [before.lights, false, []], "after a drag");
  });

  await harness.test("solved::direct_light_is_there_and_mode_parts_it_from_bounced_light", async () => {
    const found = await page.evaluate(async (camera) => {
      viewer.camera = camera;
      viewer.autoExposure = false;
      const sum = async (mode, mix) => {
        Object.assign(viewer, { mode, mix });
        const pixels = await viewer.readPixels(64, 36);
        return pixels.reduce((total, byte, i) => total + (i % 4 < 3 ? byte : 0), 0);
      };
      const silent = [{ mute: true }, { mute: true }];
      const out = {};
      for (const mode of ["all", "direct", "indirect"]) out[mode] = [await sum(mode, []), await sum(mode, silent)];
      Object.assign(viewer, { mode: "all", mix: [], autoExposure: true });
      return out;
    }, CAMERA);
    console.log(`    ${JSON.stringify(found)}`);
    for (const [at, whose] of ["of all", "of the sky"].entries()) {
      const [all, direct, indirect] = ["all", "direct", "indirect"].map((mode) => found[mode][at]);
      check(direct > 1000 && indirect > 1000 && all > direct && all > indirect, `${whose}: ${all}, ${direct}, ${indirect}`);
    }
  });
  equal(faults.join("\n"), "", "faults");
  await page.close();

  await harness.test("solved::what_was_set_before_the_file_was_there_is_told_and_the_scene_is_shown", async () => {
    const prepare = (lights) => addEventListener("DOMContentLoaded", () => (document.querySelector("rebounce-viewer").lights = lights));
    const moved = LIGHTS.map((light, i) => (i ? light : { ...light, position: [0, 1, 0] }));
    const plain = '<rebounce-viewer src="solved.rbn" environment="sky.hdr"></rebounce-viewer>';
    // Four texels of light.
    const sky = Buffer.concat([Buffer.from("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 4\n"), Buffer.alloc(32, 128)]);
    const more = { ...routes, "**/sky.hdr": (route) => route.fulfill({ body: sky, contentType: "application/octet-stream" }) };
    const { page } = await open(context, { html: plain, routes: more, prepare, argument: moved });
    const first = await outcome(page);
    equal(first.type, "error", "the first event");
    isTold(first, 0);
    await page.evaluate(() => until(() => events.some(({ type }) => type === "load")));
    await page.evaluate(() => until(() => events.some(({ message }) => message?.includes("own sky"))));
    const found = await page.evaluate(async () => [viewer.loaded, viewer.lights.map(({ position }) => position ?? null), (await still()) > 0]);
    same(found, [true, LIGHTS.map(({ position }) => position ?? null), true], "the file's lights are shown");
    await page.close();
  });
}
