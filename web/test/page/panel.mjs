// The panel: loaded when wanted, used by pointer and by keys alone.

import { readFile } from "node:fs/promises";
import { within } from "../browser.mjs";
import { check, equal, same } from "../harness.mjs";
import { loaded, PLAIN } from "./open.mjs";

const CONTROLS = '<rebounce-viewer src="scene.rbn" controls></rebounce-viewer>';
const VIEWPORT = { viewport: { width: 640, height: 360 } };

/** Runs the tests. */
export async function panel(harness, context) {
  await harness.test(
    "panel::its_code_is_loaded_only_when_it_is_wanted",
    async () => {
      const { page } = await loaded(context, PLAIN);
      const asked = () => page.evaluate(() => performance.getEntriesByType("resource").filter(({ name }) => /panel\./.test(name)).length);
      await page.evaluate(() => pause(300));
      equal(await asked(), 0, "requests without controls");
      equal(await page.locator("rebounce-viewer summary").count(), 0, "headings");
      await page.evaluate(() => (viewer.controls = true));
      await page.getByText("Lights and settings").waitFor();
      equal(await asked(), 1, "requests with controls");
      await page.evaluate(() => (viewer.controls = false));
      equal(await page.getByText("Lights and settings").isVisible(), false, "shown without controls");
      await page.close();
    },
    "attribute controls",
  );

  const { page, faults } = await loaded(context, CONTROLS, VIEWPORT);
  await page.getByText("Lights and settings").click();
  for (const title of ["Picture", "Save"]) await page.getByText(title, { exact: true }).click();
  const entry = (i) => page.getByRole("button", { name: new RegExp(`^(Lamp|Spot|Sun) ${i} (point|spot|sun)`) });
  const state = () => page.evaluate(() => viewer.lights);

  await harness.test("panel::lights_are_added_changed_switched_and_removed", async () => {
    equal((await state()).length, 1, "lights at first");
    for (const kind of ["lamp", "spot", "sun"]) await page.getByRole("button", { name: `Add ${kind}` }).click();
    same((await state()).map(({ type }) => type), ["spot", "point", "spot", "directional"], "kinds");
    await entry(2).click();
    await page.getByLabel("Intensity, in the unit").fill("7.5");
    await page.getByLabel("Colour", { exact: true }).fill("#ff0000");
    await page.getByRole("group", { name: "Position" }).getByLabel("y").fill("1.25");
    const light = (await state())[1];
    same([light.intensity, light.color, light.position[1]], [7.5, [1, 0, 0], 1.25], "intensity, colour, height");
    const lamp = page.getByRole("switch", { name: "Lamp 2 on" });
    await lamp.click();
    const channel = () => page.evaluate(() => viewer.mix[1]);
    same([await channel(), (await state())[1].intensity], [{ mute: true }, 7.5], "the channel and the intensity when it is off");
    check(!(await lamp.isChecked()), "the switch is on");
    await lamp.click();
    same(await channel(), {}, "the channel when it is on again");
    await page.getByRole("button", { name: "Remove" }).click();
    same((await state()).map(({ type }) => type), ["spot", "spot", "directional"], "kinds after removing one");
    // A script's lights are listed, too.
    await page.evaluate(() => void (viewer.lights = viewer.lights.slice(0, 1)));
    await within("one entry", page.waitForFunction(() => viewer.shadowRoot.querySelectorAll(".entry").length === 1));
  });

  await harness.test("panel::keys_alone_reach_and_move_a_light", async () => {
    await page.evaluate(() => {
      viewer.lights = [{ type: "point", position: [0, 3, -2], intensity: 5, color: [1, 1, 1] }];
      viewer.camera = { position: [0, 3, 8], target: [0, 3, -3] };
      viewer.shadowRoot.querySelector("canvas").focus();
    });
    await page.waitForFunction(() => viewer.shadowRoot.querySelector(".entry")?.textContent === "Lamp 1 point");
    const focused = () => page.evaluate(() => viewer.shadowRoot.activeElement?.textContent ?? "");
    for (let i = 0; i < 10 && (await focused()) !== "Lamp 1 point"; i += 1) await page.keyboard.press("Tab");
    equal(await focused(), "Lamp 1 point", "what Tab comes to");
    const status = page.getByRole("status");
    const press = async (key) => {
      const before = (await state())[0].position;
      await page.keyboard.press(key);
      const after = (await state())[0].position;
      check((await status.textContent()).includes(after.map((x) => x.toFixed(2)).join(", ")), `said: ${await status.textContent()}`);
      return after.map((x, i) => Math.sign(Number((x - before[i]).toFixed(9))));
    };
    same(await press("ArrowRight"), [1, 0, 0], "ArrowRight");
    same(await press("ArrowLeft"), [-1, 0, 0], "ArrowLeft");
    same(await press("ArrowUp"), [0, 0, -1], "ArrowUp");
    same(await press("ArrowDown"), [0, 0, 1], "ArrowDown");
    same(await press("PageUp"), [0, 1, 0], "PageUp");
    same(await press("Shift+PageDown"), [0, -1, 0], "PageDown");
    equal(await status.getAttribute("role"), "status", "the role of what is said");
    await page.keyboard.press("Enter");
    await page.getByLabel("Intensity, in the unit").waitFor();
    await page.keyboard.press("Delete");
    equal((await state()).length, 0, "lights after Delete");
    equal(await focused(), "Add lamp", "the focus after the last one is gone");
  });

  await harness.long("panel::sixteen_lights_are_listed", async () => {
    for (let i = 0; i < 16; i += 1) await page.getByRole("button", { name: "Add lamp" }).click();
    equal((await state()).length, 16, "lights");
    equal(await entry(16).getAttribute("aria-expanded"), "true", "whether the last one is chosen");
    await page.getByRole("group", { name: "Position" }).getByLabel("x").fill("-0.5");
    equal((await state())[15].position[0], -0.5, "the last one's place");
    equal(await page.getByRole("listitem").count(), 16, "entries");
    await page.evaluate(() => void (viewer.lights = viewer.lights.slice(0, 1)));
  });

  await harness.test("panel::what_the_viewer_refuses_is_said", async () => {
    await page.evaluate(() => void (viewer.lights = Array.from({ length: 42 }, () => ({ type: "point", position: [0, 1, 0], intensity: 1 }))));
    await page.getByRole("button", { name: "Add lamp" }).click();
    check(/shadow maps/.test(await page.getByRole("status").textContent()), await page.getByRole("status").textContent());
    equal((await state()).length, 42, "lights");
    await page.evaluate(() => void (viewer.lights = viewer.lights.slice(0, 1)));
  });

  await harness.test("panel::the_picture_follows_it_and_it_follows_the_element", async () => {
    const exposure = page.getByLabel("Exposure", { exact: true });
    await exposure.fill("2");
    await page.getByLabel("Direct", { exact: true }).check();
    await page.getByLabel("Points").check();
    await page.getByLabel("Neutral").check();
    await page.getByLabel("Automatic exposure").uncheck();
    const found = await page.evaluate(() => [viewer.exposure, viewer.mode, viewer.overlay, viewer.toneMapping, viewer.autoExposure]);
    same(found, [2, "direct", "points", "neutral", false], "exposure, mode, overlay, tone mapping, automatic");
    await page.evaluate(() => {
      for (const name of ["exposure", "mode", "overlay", "tone-mapping", "auto-exposure"]) viewer.removeAttribute(name);
    });
    equal(await exposure.inputValue(), "0", "the exposure shown");
    check(await page.getByLabel("Both").isChecked(), "the mode shown");
  });

  await harness.test("panel::animations_are_played_from_it", async () => {
    equal(await page.getByRole("button", { name: "Play" }).isVisible(), false, "offered without an animation");
    await page.evaluate(() => {
      const track = { light: 0, property: "intensity", times: [0, 8], values: [1, 9] };
      viewer.animations = [{ name: "one", duration: 8, tracks: [track] }, { name: "two", duration: 4, tracks: [track] }];
      viewer.exposure = 0.1;
    });
    await page.getByRole("button", { name: "Play" }).click();
    await page.getByRole("button", { name: "Pause" }).click();
    await page.getByLabel("Time").fill("2");
    same(await page.evaluate(() => [viewer.currentTime, viewer.lights[0].intensity, viewer.paused]), [2, 3, true], "time, intensity");
    await page.getByLabel("Animation").selectOption("two");
    equal(await page.evaluate(() => viewer.duration), 4, "the duration of the other one");
    await page.evaluate(() => void (viewer.animations = []));
  });

  await harness.test("panel::the_state_is_saved_loaded_and_copied", async () => {
    const [download] = await Promise.all([page.waitForEvent("download"), page.getByRole("button", { name: "Save lights" }).click()]);
    equal(download.suggestedFilename(), "shot.json", "the file's name");
    const saved = JSON.parse(await readFile(await download.path(), "utf8"));
    same(saved, await page.evaluate(() => viewer.shot), "what was saved");
    const lights = [{ type: "point", position: [0, 1, 0], intensity: 3, color: [1, 1, 1] }];
    const choose = (name, text) => page.getByLabel("Load lights", { exact: true }).setInputFiles({ name, mimeType: "application/json", buffer: Buffer.from(text) });
    const said = (text) => within(text, page.getByRole("status").filter({ hasText: text }).waitFor());
    await choose("good.json", JSON.stringify({ ...saved, lights }));
    await said("Lights and camera of good.json are set.");
    same(await state(), lights, "the lights");
    for (const bad of ["{", "7", '{"camera": 3}']) {
      await choose("bad.json", bad);
      await said("bad.json cannot be used.");
      same(await state(), lights, `the lights after ${bad}`);
      await page.evaluate(() => (viewer.shadowRoot.querySelector("[role=status]").textContent = ""));
    }
    // What nothing would follow is not offered.
    equal(await page.getByRole("button", { name: "Copy link" }).isVisible(), false, "a link without state-in-link");
    await page.evaluate(() => {
      viewer.stateInLink = true;
      viewer.exposure = 0.5;
    });
    await page.context().grantPermissions(["clipboard-read", "clipboard-write"]);
    await page.getByRole("button", { name: "Copy link" }).click();
    await said("The link is copied.");
    equal(await page.evaluate(() => navigator.clipboard.readText()), await page.evaluate(() => viewer.stateLink()), "the link");
    // Where there is no clipboard, the link is there to be copied by hand.
    await page.evaluate(() => (navigator.clipboard.writeText = () => Promise.reject(new Error("no"))));
    await page.getByRole("button", { name: "Copy link" }).click();
    await said("Copy the link from the field.");
    equal(await page.getByLabel("Link", { exact: true }).inputValue(), await page.evaluate(() => viewer.stateLink()), "the link in the field");
  });

  await harness.test("panel::figures_are_those_of_stats", async () => {
    await page.getByText("Statistics").click();
    const scene = page.getByRole("table", { name: "In this scene" });
    const cell = (name) => scene.getByRole("row", { name }).getByRole("cell").first();
    const number = async (name) => Number((await cell(name).textContent()).replace(/\D/g, ""));
    const stats = await page.evaluate(() => viewer.stats());
    equal(await number("links applied"), stats.links, "links");
    equal(await number("functions"), stats.functions.reduce((a, b) => a + b), "functions");
    equal(await number("lights"), stats.lights, "lights");
    check((await page.getByRole("table", { name: "On the GPU" }).getByRole("row").count()) === Object.keys(stats.bytes).length + 1, "bytes");
    const passes = Object.values(stats.milliseconds);
    check(passes.every((ms) => ms >= 0 && ms < 600_000), `milliseconds: ${JSON.stringify(stats.milliseconds)}`);
    const times = page.getByRole("table", { name: "GPU time per pass" });
    // Where the device can time passes, those that the first picture needs have run, and the sum stands below them.
    if (passes.length > 0) check((await times.getByRole("row").count()) >= 6 && passes.length >= 5, `passes: ${passes.length}`);
    const picture = page.getByRole("table", { name: "In this picture" });
    await within("what the GPU counted", picture.getByRole("row").first().waitFor());
    const counts = await page.evaluate(() => viewer.counts());
    const row = picture.getByRole("row", { name: "kernel evaluations per pixel" });
    const told = Number(await row.getByRole("cell").first().textContent());
    check(Math.abs(told - counts.kernelEvaluationsPerPixel) < 0.006, `${told}, not ${counts.kernelEvaluationsPerPixel}`);
    equal(faults.join("\n"), "", "faults");
  });
  await page.close();

  await harness.test("panel::without_its_code_the_scene_stays", async () => {
    const routes = { "**/panel.js": (route) => route.abort() };
    const { page } = await loaded(context, PLAIN, { routes });
    await page.evaluate(async () => {
      viewer.controls = true;
      await until(() => events.some(({ type }) => type === "error"));
    });
    same(await page.evaluate(() => [events.find(({ type }) => type === "error").code, viewer.loaded]), ["network", true], "code, loaded");
    await page.close();
  });
}
