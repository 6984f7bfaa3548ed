// The light mixer: channels by script, by hand and by keys; in links and shots; and that the command mixes as the page does.

import { readFile, writeFile } from "node:fs/promises";
import path from "node:path";
import { exec } from "../agreement.mjs";
import { check, equal, near, same } from "../harness.mjs";
import { loaded } from "./open.mjs";

const CONTROLS = '<rebounce-viewer src="scene.rbn" controls></rebounce-viewer>';

const LIGHTS = [
  { type: "point", name: "Key", position: [0.9, 1.5, 0.6], intensity: 3, color: [1, 1, 1] },
  { type: "point", name: "Fill", position: [-0.6, 1.2, -0.4], intensity: 1, color: [1, 0.8, 0.5] },
  { type: "point", name: "Rim", position: [0.2, 0.4, 0.8], intensity: 0.5, color: [0.5, 0.7, 1] },
];
const SIZE = [96, 64];

/** In the page: the picture's light at the present exposure, and how much two pictures differ. */
function helpers() {
  globalThis.light = async () => Array.from(await viewer.readIndirect(48, 27)).filter((_, i) => i % 4 < 3);
  globalThis.apart = (a, b) => {
    const sum = (list) => list.reduce((total, x) => total + x, 0);
    return sum(a.map((x, i) => Math.abs(x - b[i]))) / sum(b.map(Math.abs));
  };
}

/** Runs the tests. */
export async function mixer(harness, context) {
  const { page, faults } = await loaded(context, CONTROLS, { prepare: helpers });
  await page.evaluate((lights) => {
    viewer.autoExposure = false;
    viewer.lights = lights;
  }, LIGHTS);

  await harness.test(
    "mixer::channels_are_lights_made_stronger_silent_or_alone",
    async () => {
      const found = await page.evaluate(async (lights) => {
        const as = async (mix, own = lights) => {
          viewer.lights = own;
          viewer.mix = mix;
          return await light();
        };
        const without = (gone) => lights.map((light, i) => (gone.includes(i) ? { ...light, intensity: 0 } : light));
        const pairs = {
          stops: [await as([{ stops: 1 }]), await as([], lights.map((light, i) => (i ? light : { ...light, intensity: 6 })))],
          mute: [await as([{}, { mute: true }]), await as([], without([1]))],
          solo: [await as([{}, {}, { solo: true }]), await as([], without([0, 1]))],
          color: [await as([{ color: [0, 1, 0] }]), await as([], lights.map((light, i) => (i ? light : { ...light, color: [0, 1, 0] })))],
        };
        const all = await as([]);
        return Object.entries(pairs).map(([name, [a, b]]) => [name, apart(a, b), apart(a, all)]);
      }, LIGHTS);
      console.log(`    ${JSON.stringify(found)}`);
      for (const [name, wrong, change] of found) check(wrong < 1e-4 && change > 0.05, `${name}: ${wrong} off, ${change} of change`);
    },
    "property mix",
  );

  await harness.test(
    "mixer::channels_stay_with_their_lights_and_come_back",
    async () => {
      const found = await page.evaluate(async (lights) => {
        const seen = [];
        viewer.addEventListener("mix-change", ({ detail }) => seen.push(detail.mix));
        viewer.lights = lights;
        const mix = [{}, { stops: -1.5, mute: true }, { solo: true, color: [0, 0.5, 1] }];
        viewer.mix = mix;
        await still();
        const steps = { set: viewer.mix, shot: viewer.shot.mix, link: viewer.stateLink() };
        viewer.addLight({ type: "point", position: [0, 1, 0], intensity: 1 }, 1);
        steps.added = viewer.mix;
        viewer.removeLight(0);
        steps.removed = viewer.mix;
        viewer.restoreState(steps.link);
        steps.restored = viewer.mix;
        const { shot } = viewer;
        viewer.shot = { camera: shot.camera, lights };
        steps.plain = viewer.mix;
        viewer.shot = shot;
        steps.again = viewer.mix;
        viewer.lights = lights.slice(0, 2);
        viewer.lights = lights;
        steps.fewer = viewer.mix;
        viewer.mix = shot.mix;
        const refused = [];
        for (const wrong of [7, [7], [{ stops: "loud" }], [{ stops: 99 }], [{ mute: 1 }], [{ color: [0, 1] }], [{ color: [0, 2, 0] }]]) {
          try {
            viewer.mix = wrong;
          } catch (error) {
            refused.push(error.code);
          }
        }
        await still();
        return { steps, refused, after: viewer.mix, seen: seen.length };
      }, LIGHTS);
      const mix = [{}, { stops: -1.5, mute: true }, { solo: true, color: [0, 0.5, 1] }];
      const { steps } = found;
      for (const name of ["set", "shot", "restored", "again"]) same(steps[name], mix, name);
      check(steps.link.includes("mix=0,-1.5m,0s*0*0.5*1") || steps.link.includes(encodeURIComponent("-1.5m")), steps.link);
      same([steps.added, steps.removed, steps.plain], [[{}, {}, ...mix.slice(1)], [{}, ...mix.slice(1)], []], "with another light, without the first");
      same(steps.fewer, mix.slice(0, 2), "fewer lights and then more");
      same([found.refused.length, found.after], [7, mix], `what is no mix: ${found.refused}`);
      check(found.seen >= 1, "no event");
    },
    "event mix-change",
  );

  await harness.test("mixer::hands_and_keys_move_faders", async () => {
    await page.evaluate((lights) => Object.assign(viewer, { lights, mix: [] }), LIGHTS);
    await page.getByText("Lights and settings").click();
    const fader = page.getByRole("slider", { name: "Fill strength" });
    const mix = () => page.evaluate(() => viewer.mix);
    await fader.fill("2");
    same(await mix(), [{}, { stops: 2 }], "two stops more");
    await fader.press("ArrowLeft");
    near((await mix())[1].stops, 1.9, 1e-9, "a key");
    equal(await fader.getAttribute("aria-valuetext"), "+1.9 EV", "what is read out");
    await fader.press("0");
    same((await mix())[1], {}, "as it was, by a key");
    const solo = page.getByRole("button", { name: "Rim solo" });
    await solo.focus();
    await page.keyboard.press("Space");
    same([(await mix())[2], await solo.getAttribute("aria-pressed")], [{ solo: true }, "true"], "solo by a key");
    const silent = () => page.evaluate(() => [...viewer.shadowRoot.querySelectorAll(".lights li")].map((item) => item.classList.contains("silent")));
    await page.waitForFunction(() => viewer.shadowRoot.querySelector(".silent"));
    same(await silent(), [true, true, false], "the list shows who is silent");
    await page.getByRole("button", { name: "Undo" }).click();
    same((await mix())[2] ?? {}, {}, "undone");
    await page.getByRole("switch", { name: "Key on" }).click();
    same([(await mix())[0], (await page.evaluate(() => viewer.lights[0])).intensity], [{ mute: true }, 3], "off, and the light is as it was");
  });
  equal(faults.join("\n"), "", "faults");

  await harness.test("mixer::the_command_mixes_as_the_page_does", async () => {
    const mix = [{ stops: -1 }, { stops: 1.5, solo: true }, { solo: true, color: [0.1, 0.2, 1] }];
    const shot = await page.evaluate(({ lights, mix }) => {
      Object.assign(viewer, { lights, mix });
      return viewer.shot;
    }, { lights: LIGHTS, mix });
    same(shot.mix, mix, "the shot");
    const [json, exr] = ["json", "exr"].map((ending) => path.join(context.work, `mixer.${ending}`));
    await writeFile(json, JSON.stringify({ ...shot, size: SIZE }));
    const picture = path.join(context.work, "mixer.png");
    await exec(context.rebounce, ["render", context.baked, "--shot", json, "-o", picture, "--spp", "64"]);
    const base64 = (await readFile(picture)).toString("base64");
    const [ours, theirs] = await page.evaluate(async ({ size, base64 }) => {
      viewer.autoExposure = true;
      viewer.shot = viewer.shot;
      await still();
      const bytes = Uint8Array.from(atob(base64), (c) => c.charCodeAt(0));
      const bitmap = await createImageBitmap(new Blob([bytes], { type: "image/png" }), { colorSpaceConversion: "none" });
      const context = new OffscreenCanvas(...size).getContext("2d");
      context.drawImage(bitmap, 0, 0);
      return [Array.from(await viewer.readPixels(...size)), Array.from(context.getImageData(0, 0, ...size).data)];
    }, { size: SIZE, base64 });
    const mean = (pixels) => pixels.reduce((sum, x) => sum + x, 0) / pixels.length;
    const difference = mean(ours.map((x, i) => Math.abs(x - theirs[i])));
    console.log(`    mean difference ${difference.toFixed(2)} of 255`);
    check(mean(theirs) > 10 && difference < 4, `${difference}`);
  });
  await page.close();
}
