// The panel as one meets it: closed, beside the picture, on a phone; views, pictures to save, full screen.

import { readFile } from "node:fs/promises";
import { createRequire } from "node:module";
import { decode, within } from "../browser.mjs";
import { check, equal, same } from "../harness.mjs";
import { loaded } from "./open.mjs";

const AXE = createRequire(import.meta.url).resolve("axe-core/axe.min.js");
const RULES = ["wcag2a", "wcag2aa", "wcag21a", "wcag21aa", "wcag22aa", "best-practice"];
const CONTROLS = '<rebounce-viewer src="scene.rbn" controls alt="A room"></rebounce-viewer>';
const PHONE = { viewport: { width: 390, height: 844 }, media: { hasTouch: true, isMobile: true } };
const SIZES = [{ viewport: { width: 960, height: 540 } }, { viewport: { width: 1280, height: 720 } }, PHONE];
/** Lights of all kinds, with long numbers and a long name. */
const LIGHTS = [
  { type: "spot", name: "The lamp above the long table in the dining room", position: [-12.345678, 3.456789, -23.456789], direction: [-0.123456, -1, 0.654321], outer_cone_deg: 42.1234, inner_cone_deg: 31.4321, intensity: 12345.678, color: [1, 0.8, 0.6] },
  { type: "directional", direction: [-0.4, -1, -0.3], intensity: 2, color: [1, 1, 1] },
  { type: "point", position: [0, 3, -2], intensity: 5, color: [1, 1, 1] },
];

/** Opens the panel and all of its sections, with a spot chosen. */
async function spread(page) {
  await page.evaluate((lights) => void (viewer.lights = lights), LIGHTS);
  await page.getByText("Lights and settings").click();
  await page.getByRole("listitem").nth(2).waitFor();
  await page.getByRole("listitem").first().getByRole("button").first().click();
  for (const title of ["Camera", "Picture", "Save"]) await page.getByText(title, { exact: true }).click();
  await page.getByLabel("Name").waitFor();
}

/** Runs the tests. */
export async function panelLook(harness, context) {
  const axe = await readFile(AXE, "utf8");
  const opened = (options) => loaded(context, CONTROLS, options);

  await harness.long("panel::look::in_a_low_picture_the_sheet_takes_all_of_its_height", async () => {
    const { page, faults } = await opened({ ...PHONE, viewport: { width: 390, height: 220 } });
    await page.getByText("Lights and settings").click();
    const [panel, add] = await page.evaluate(() =>
      [".panel", ".panel button[part], .panel .body button"].map((name) => {
        const { top, bottom } = viewer.shadowRoot.querySelector(name).getBoundingClientRect();
        const whole = viewer.getBoundingClientRect();
        return [top - whole.top, whole.bottom - bottom];
      }),
    );
    check(Math.abs(panel[0]) < 2 && Math.abs(panel[1]) < 2, `the sheet leaves ${panel}`);
    check(add[1] > 0, `the first button lies ${-add[1]} below the picture`);
    same(faults, []);
    await page.close();
  });

  for (const options of SIZES) {
    const { width, height } = options.viewport;
    // The widest and the narrowest always.
    const kind = width === 960 ? "long" : "test";
    await harness[kind](`panel::look::at_${width}_by_${height}_it_leaves_the_picture_and_clips_nothing`, async () => {
      const { page, faults } = await opened(options);
      const closed = await page.getByText("Lights and settings").boundingBox();
      check(closed.width < 230 && closed.height <= 44, `closed it is ${closed.width} by ${closed.height}`);
      await spread(page);
      const found = await page.evaluate(() => {
        const { shadowRoot } = viewer;
        const [box, whole] = [shadowRoot.querySelector(".panel"), viewer].map((element) => element.getBoundingClientRect());
        const form = shadowRoot.querySelector("form");
        const inputs = [...shadowRoot.querySelectorAll("input[type=number], select")];
        const controls = [...shadowRoot.querySelectorAll(".panel :is(button, .button, select, summary, .choices label, .check, input):not(.choices *, .check *, .button *)")];
        const shown = controls.filter((element) => element.checkVisibility() && element.type !== "checkbox");
        return {
          box: [box.left, box.top, box.width, box.height],
          whole: [whole.left, whole.top, whole.width, whole.height],
          sideways: form.scrollWidth - form.clientWidth,
          clipped: inputs.filter((input) => input.scrollWidth > input.clientWidth).map(({ value }) => value),
          numbers: inputs.length,
          low: shown.map((element) => [element.getBoundingClientRect().height, element.ariaLabel ?? element.textContent]).filter(([height]) => height < 44),
          shown: shown.length,
          scrolls: form.scrollHeight > form.clientHeight,
        };
      });
      same(found.clipped, [], "numbers that are cut off");
      equal(found.sideways, 0, "pixels that stick out sideways");
      check(found.numbers >= 9 && found.shown > 20, `${found.numbers} numbers, ${found.shown} controls`);
      const [left, top, w, h] = found.box;
      if (options === PHONE) {
        check(h <= found.whole[3] / 2 && found.scrolls, `a sheet of ${h} pixels of ${found.whole[3]}`);
        same([left, w, Math.round(top + h)], [0, found.whole[2], Math.round(found.whole[1] + found.whole[3])], "the sheet lies at the bottom");
        same(found.low, [], "targets of less than 44 pixels");
        await page.getByRole("switch").first().tap();
        equal(await page.evaluate(() => viewer.mix[0].mute), true, "off after a tap on the switch");
        await page.getByRole("button", { name: "Undo" }).tap();
        check(await page.evaluate(() => !viewer.mix[0]?.mute), "a tap on undo does nothing");
      } else {
        check(w <= 0.34 * found.whole[2] && h <= found.whole[3], `${w} by ${h} of ${found.whole}`);
      }
      await page.evaluate(axe);
      const violations = await page.evaluate(async (values) => {
        const { violations } = await globalThis.axe.run("rebounce-viewer", { runOnly: { type: "tag", values } });
        return violations.flatMap(({ id, nodes }) => nodes.map(({ target, failureSummary }) => `${id}: ${target.flat().join(" ")}: ${failureSummary}`));
      }, RULES);
      same(violations, [], "what axe finds");
      // Who has closed it by a key is where it is opened.
      await page.getByLabel("Name").focus();
      await page.keyboard.press("Escape");
      equal(await page.evaluate(() => viewer.shadowRoot.activeElement.textContent), "Lights and settings", "the focus after Escape");
      equal(await page.getByLabel("Name").isVisible(), false, "the fields after Escape");
      equal(faults.join("\n"), "", "faults");
      await page.close();
    });
  }

  const { page, faults } = await opened({ viewport: { width: 400, height: 300 } });
  await harness.test("panel::look::views_of_the_file_are_gone_to_by_name", async () => {
    await page.getByText("Lights and settings").click();
    await page.evaluate(() => {
      const { camera } = viewer;
      const cameras = [{ name: "Door", camera }, { name: "Camera 2", camera: { ...camera, position: [0, 3, 4] } }];
      Object.defineProperty(viewer, "cameras", { configurable: true, get: () => cameras });
    });
    await page.getByText("Camera", { exact: true }).click();
    await page.getByRole("button", { name: "Camera 2" }).click();
    same(await page.evaluate(() => viewer.camera.position), [0, 3, 4], "the second camera");
    await page.getByRole("button", { name: "First view (R)" }).click();
    same(await page.evaluate(() => viewer.camera.position), await page.evaluate(() => viewer.cameras[0].camera.position), "the first view");
    await page.evaluate(() => viewer.undo());
    same(await page.evaluate(() => viewer.camera.position), [0, 3, 4], "the view taken back");
  });

  await harness.long("panel::look::a_picture_is_saved_in_the_size_that_is_chosen", async () => {
    await page.getByText("Save", { exact: true }).click();
    const save = async () => {
      const [download] = await Promise.all([page.waitForEvent("download"), page.getByRole("button", { name: "Save picture" }).click()]);
      equal(download.suggestedFilename(), "picture.png", "the file's name");
      await within("what is said", page.getByRole("status").filter({ hasText: "The picture is saved in picture.png." }).waitFor());
      return readFile(await download.path());
    };
    const size = (png) => [png.readUInt32BE(16), png.readUInt32BE(20)];
    const shown = await page.evaluate(() => [viewer.shadowRoot.querySelector("canvas").width, viewer.shadowRoot.querySelector("canvas").height]);
    same(size(await save()), shown, "as shown");
    const choices = await page.getByLabel("Size").evaluate((select) => [...select.options].map(({ textContent }) => textContent));
    same(choices, [`As shown, ${shown.join(" × ")}`, `Twice, ${shown.map((n) => 2 * n).join(" × ")}`, "1920 × 1080", "3840 × 2160"], "sizes");
    await page.getByLabel("Size").selectOption(choices[1]);
    same(size(await save()), shown.map((n) => 2 * n), "twice");
    // What no device has room for is said, and the scene stays.
    await page.getByLabel("Size").evaluate((select) => (select.options[2].value = "99999x99999"));
    await page.getByLabel("Size").selectOption("1920 × 1080");
    await page.getByRole("button", { name: "Save picture" }).click();
    await within("what is said", page.getByRole("status").filter({ hasText: "There is no picture of this size." }).waitFor());
    check(await page.evaluate(() => viewer.loaded), "the scene is gone");
  });

  await harness.test(
    "panel::look::a_transparent_picture_has_the_scene_and_nothing_behind",
    async () => {
      // From far away: the box has much around it.
      const file = await page.evaluate(async () => {
        viewer.camera = { position: [0, 3, 30], target: [0, 3, 0], up: [0, 1, 0], yfov_deg: 40 };
        const read = async (options) => {
          const bytes = new Uint8Array(await (await viewer.toBlob("image/png", undefined, options)).arrayBuffer());
          return btoa(String.fromCharCode(...bytes));
        };
        const size = { width: 96, height: 64 };
        return [await read({ ...size, transparent: true }), await read(size)];
      });
      const [clear, opaque] = await Promise.all(file.map((text) => decode(context.browser, Buffer.from(text, "base64"))));
      equal(clear.length, 96 * 64 * 4, "bytes");
      const alpha = (pixels, x, y) => pixels[(y * 96 + x) * 4 + 3];
      same([alpha(clear, 2, 2), alpha(clear, 93, 61), alpha(clear, 48, 32)], [0, 0, 255], "alpha beside the box and in it");
      same([alpha(opaque, 2, 2), alpha(opaque, 48, 32)], [255, 255], "alpha of a picture that is not transparent");
      const at = (32 * 96 + 48) * 4;
      same([...clear.slice(at, at + 3)], [...opaque.slice(at, at + 3)], "the colour in the box");
    },
    "method toBlob",
  );

  await harness.test("panel::look::the_element_fills_the_screen_and_leaves_it", async () => {
    const full = () => page.evaluate(() => document.fullscreenElement === viewer);
    await page.keyboard.press("Escape");
    await page.evaluate(() => (viewer.shadowRoot.querySelector(".panel").open = false));
    await page.getByRole("button", { name: "Full screen" }).click();
    await page.getByRole("button", { name: "Leave full screen" }).waitFor();
    equal(await full(), true, "whether it fills the screen");
    await page.getByRole("button", { name: "Leave full screen" }).click();
    await page.getByRole("button", { name: "Full screen", exact: true }).waitFor();
    equal(await full(), false, "whether it fills it still");
    equal(faults.join("\n"), "", "faults");
    await page.close();
    // Where the browser has no such thing there is no button.
    const prepare = () => Object.defineProperty(Document.prototype, "fullscreenEnabled", { value: false });
    const other = await opened({ prepare });
    await other.page.getByText("Lights and settings").waitFor();
    equal(await other.page.getByRole("button", { name: "Full screen" }).count(), 0, "buttons");
    await other.page.close();
  });
}
