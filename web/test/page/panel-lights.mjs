// What the panel offers for a light: its name, intensity, colour, way; and the light under a pointer, in list and picture.

import path from "node:path";
import { readFile } from "node:fs/promises";
import { exec } from "../agreement.mjs";
import { DEVICE_PIXELS, within } from "../browser.mjs";
import { check, equal, near, same } from "../harness.mjs";
import { loaded } from "./open.mjs";

const CONTROLS = '<rebounce-viewer src="scene.rbn" controls></rebounce-viewer>';
const VIEWPORT = { viewport: { width: 640, height: 480 } };
const LAMP = { type: "point", position: [0, 3, -2], intensity: 8, color: [1, 1, 1] };
const SPOT = { type: "spot", position: [0, 4, -2], direction: [0, -1, 0], outer_cone_deg: 40, inner_cone_deg: 30, intensity: 8, color: [1, 1, 1] };
const SUN = { type: "directional", direction: [0, -1, 0], intensity: 2, color: [1, 1, 1] };

/** Runs the tests. */
export async function panelLights(harness, context) {
  const { page, faults } = await loaded(context, CONTROLS, VIEWPORT);
  await page.getByText("Lights and settings").click();
  const entry = (name) => page.getByRole("button", { name, exact: true });
  const light = (i = 0) => page.evaluate((i) => viewer.lights[i], i);
  const slider = (name) => page.getByRole("slider", { name, exact: true });
  const text = (name) => slider(name).getAttribute("aria-valuetext");
  const follows = (name, words) => within(words, page.waitForFunction(
    ([name, words]) => [...viewer.shadowRoot.querySelectorAll("input")].some((input) => input.ariaLabel === name && input.getAttribute("aria-valuetext") === words),
    [name, words],
  ));
  /** Sets one light and chooses it. */
  const choose = async (only, name) => {
    await page.evaluate((only) => void (viewer.lights = [only]), only);
    await entry(name).waitFor();
    if ((await entry(name).getAttribute("aria-expanded")) !== "true") await entry(name).click();
    await page.getByLabel("Name").waitFor();
  };

  await harness.test("panel::lights::have_names_and_can_have_others", async () => {
    await page.evaluate((lights) => void (viewer.lights = lights), [{ ...LAMP, name: "Reading lamp" }, SPOT, SUN]);
    for (const name of ["Reading lamp point", "Spot 2 spot", "Sun 3 sun"]) await entry(name).waitFor();
    await entry("Spot 2 spot").dblclick();
    equal(await page.evaluate(() => viewer.shadowRoot.activeElement.className), "name", "the focus after a double click");
    await page.keyboard.type("Stage");
    await entry("Stage spot").waitFor();
    equal((await light(1)).name, "Stage", "its name");
    await page.getByRole("switch", { name: "Stage on" }).waitFor();
    await page.getByLabel("Name").fill("");
    await entry("Spot 2 spot").waitFor();
    check(!(await light(1)).name, "a name that is empty");
    await entry("Reading lamp point").focus();
    await page.keyboard.press("F2");
    equal(await page.getByLabel("Name").inputValue(), "Reading lamp", "the name in the field after F2");
  });

  await harness.test("panel::lights::intensity_is_set_in_units", async () => {
    await choose(LAMP, "Lamp 1 point");
    const number = page.getByLabel("Intensity, in the unit");
    await page.getByLabel("Unit", { exact: true }).selectOption("lumen");
    near(Number(await number.inputValue()), 8 * 4 * Math.PI, 0.01, "lumens");
    await number.fill("200");
    near((await light()).intensity, 200 / (4 * Math.PI), 1e-6, "candela");
    await choose(SPOT, "Spot 1 spot");
    await page.getByLabel("Unit", { exact: true }).selectOption("lumen");
    const [inner, outer] = [30, 40].map((angle) => Math.cos((angle * Math.PI) / 180));
    near(Number(await number.inputValue()), 8 * 2 * Math.PI * (1 - inner + (inner - outer) / 3), 0.01, "lumens of a spot");
    await page.getByLabel("Unit", { exact: true }).selectOption("candela");
    await choose(SUN, "Sun 1 sun");
    equal(await page.getByLabel("Unit", { exact: true }).count(), 0, "choices of a sun's unit");
    await page.getByText("lux", { exact: true }).waitFor();
  });

  await harness.test("panel::lights::colour_and_colour_temperature_agree", async () => {
    await choose(LAMP, "Lamp 1 point");
    const color = page.getByLabel("Colour", { exact: true });
    await slider("Colour temperature").fill("2700");
    const [r, g, b] = (await light()).color;
    check(r === 1 && g < 0.6 && b < g, `no warm white: ${[r, g, b]}`);
    await follows("Colour temperature", "2700 K");
    const hex = await color.inputValue();
    // The same colour typed is the same temperature, as far as 256 steps tell.
    await color.fill("#ffffff");
    await color.fill(hex);
    await within("the temperature", page.waitForFunction(() => {
      const words = [...viewer.shadowRoot.querySelectorAll("input")].find(({ ariaLabel }) => ariaLabel === "Colour temperature").getAttribute("aria-valuetext");
      return Math.abs(parseFloat(words) - 2700) <= 50;
    }));
    await color.fill("#00ff00");
    await follows("Colour temperature", "not a white");
  });

  await harness.test("panel::lights::a_sun_is_set_by_azimuth_and_elevation", async () => {
    await choose(SUN, "Sun 1 sun");
    await slider("Elevation").fill("30");
    await slider("Azimuth").fill("90");
    const { direction } = await light();
    // From the east, +x.
    [-Math.cos(Math.PI / 6), -0.5, 0].forEach((x, i) => near(direction[i], x, 1e-6, `direction ${i}`));
    await follows("Azimuth", "90° E");
    await slider("Elevation").fill("90");
    await slider("Elevation").fill("10");
    await follows("Azimuth", "90° E");
    equal(await page.getByRole("group", { name: "Direction" }).count(), 0, "fields of its direction");
  });

  await harness.test("panel::lights::a_spot_is_aimed_where_the_camera_looks_or_one_clicks", async () => {
    await page.evaluate(() => {
      viewer.camera = { ...viewer.camera, target: [1, 2, -3] };
    });
    await choose(SPOT, "Spot 1 spot");
    await page.getByRole("button", { name: "Aim where the camera looks" }).click();
    same((await light()).direction, [1, -2, -1], "the direction");
    await page.evaluate(() => viewer.undo());
    same((await light()).direction, [0, -1, 0], "the direction taken back");
    // The place under a click is what the viewer's ray tells; here it tells the test's.
    const rays = await page.evaluate(async () => {
      const { Viewer } = await import("./rebounce_viewer.js");
      globalThis.asked = [];
      Viewer.prototype.surfaceAt = (x, y) => (asked.push([x, y]), asked.length > 1 ? [0, 0, -2] : undefined);
      return typeof Viewer;
    });
    equal(rays, "function", "the class of the viewer");
    for (let i = 0; i < 2; i += 1) await entry("Spot 1 spot").click();
    const { camera, lights } = await page.evaluate(() => viewer.shot);
    const aim = page.getByRole("button", { name: "Aim", exact: true });
    await aim.click();
    await page.keyboard.press("Escape");
    await aim.click();
    await page.mouse.click(100, 200);
    equal(await page.getByRole("status").textContent(), "Nothing is there to shine at.", "what is said of the sky");
    same(await page.evaluate(() => [viewer.camera, viewer.lights]), [camera, lights], "camera and lights");
    await page.evaluate(() => void (viewer.lights = viewer.lights.map((light) => ({ ...light, direction: [1, 0, 0] }))));
    await aim.click();
    await page.mouse.click(120, 210);
    same(await page.evaluate(() => asked), [[100, 200], [120, 210]].map((at) => at.map((x) => x * DEVICE_PIXELS)), "places asked for");
    same((await light()).direction, [0, -4, 0], "the direction after a click");
    same(await page.evaluate(() => viewer.camera), camera, "the camera");
    await page.evaluate(() => viewer.undo());
    same((await light()).direction, [1, 0, 0], "the direction taken back");
  });

  await harness.test("panel::lights::hover_and_choice_go_both_ways", async () => {
    await page.evaluate((lights) => void (viewer.lights = lights), [LAMP, SPOT]);
    await entry("Spot 2 spot").hover();
    equal(await page.evaluate(() => viewer.hoveredLight), 1, "the light under the pointer");
    await entry("Spot 2 spot").click();
    equal(await page.evaluate(() => viewer.selectedLight), 1, "the chosen light");
    await page.mouse.move(100, 300);
    await entry("Lamp 1 point").focus();
    equal(await page.evaluate(() => viewer.hoveredLight), 0, "the light with the focus");
    const tell = (type, light) => page.evaluate(([type, light]) => viewer.dispatchEvent(new CustomEvent(type, { detail: { light } })), [type, light]);
    await tell("light-select", 0);
    equal(await entry("Lamp 1 point").getAttribute("aria-expanded"), "true", "the entry of a light that is chosen in the picture");
    equal(await entry("Spot 2 spot").getAttribute("aria-expanded"), "false", "the other entry");
    await page.evaluate((lights) => void (viewer.lights = lights), Array(16).fill(LAMP));
    await entry("Lamp 16 point").waitFor();
    await tell("light-select", 15);
    const [list, last] = await Promise.all([page.locator("form"), entry("Lamp 16 point")].map((it) => it.boundingBox()));
    check(last.y > list.y - 1 && last.y + last.height < list.y + list.height / 2, `the entry lies at ${last.y} in a list at ${list.y}`);
    await page.evaluate((lights) => void (viewer.lights = lights), [LAMP, SPOT]);
    await entry("Spot 2 spot").waitFor();
    await tell("light-hover", 1);
    const marked = () => page.evaluate(() => [...viewer.shadowRoot.querySelectorAll(".lights li")].map((item) => item.classList.contains("hovered")));
    same(await marked(), [false, true], "entries that are marked");
    await tell("light-hover", -1);
    same(await marked(), [false, false], "entries that are marked when the pointer has left");
    await tell("light-select", -1);
    equal(await page.getByLabel("Name").count(), 0, "fields of no light");
    equal(faults.join("\n"), "", "faults");
  });
  await page.close();

  await harness.test("panel::lights::a_sun_outside_of_a_closed_room_is_told_of", async () => {
    const file = path.join(context.work, "closed.rbn");
    const quick = "--preset draft --functions 500 --levels 2 --sender-levels 2 --direct-levels 2".split(" ");
    await exec(context.rebounce, ["bake", "builtin:furnace", ...quick, "-o", file]);
    const body = await readFile(file);
    const html = '<rebounce-viewer src="closed.rbn" controls></rebounce-viewer>';
    const { page } = await loaded(context, html, { ...VIEWPORT, routes: { "**/closed.rbn": (route) => route.fulfill({ body }) } });
    await page.getByText("Lights and settings").click();
    const said = (words) => within(words, page.getByRole("status").filter({ hasText: words }).waitFor());
    await page.getByRole("button", { name: "Add sun" }).click();
    await said("Sun 2 is added, but it reaches nothing in view: the room is closed");
    await page.close();
    // In an open one it is only added.
    const open = await loaded(context, CONTROLS, VIEWPORT);
    await open.page.getByText("Lights and settings").click();
    await open.page.evaluate(() => {
      const { readPixels } = viewer;
      globalThis.pictures = 0;
      viewer.readPixels = async (...size) => {
        const picture = await readPixels.apply(viewer, size);
        pictures += 1;
        return picture;
      };
    });
    await open.page.getByRole("button", { name: "Add sun" }).click();
    await open.page.evaluate(() => until(() => pictures === 2));
    await open.page.evaluate(() => pause(0));
    equal(await open.page.getByRole("status").textContent(), "Sun 2 is added.", "what is said of an open room");
    await open.page.close();
  });
}
