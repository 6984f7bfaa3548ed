// What a file, a shot or a link says is text in the page, whatever it says.

import { within } from "../browser.mjs";
import { check, equal, same } from "../harness.mjs";
import { document, serveStrictly } from "../strict.mjs";
import { expectFailure, open, outcome, shown } from "./open.mjs";

const MARKUP = "<img src=x onerror=\"globalThis.markup='run'\">";

/** Runs the tests. `damaged`: the folder that the program `damage` has filled. */
export async function text(harness, context) {
  const server = await serveStrictly({
    folders: [context.damaged],
    pages: { "": document('<rebounce-viewer controls alt="A room"></rebounce-viewer>') },
  });
  const opened = (options = {}) => open({ ...context, address: server.address }, { viewport: { width: 640, height: 480 }, ...options });
  const run = (page) => page.evaluate(() => globalThis.markup);
  try {
    await harness.test("page::text::names_in_a_file_are_text", async () => {
      const { page, faults } = await opened();
      await page.evaluate(() => (viewer.src = "names.rbn"));
      equal((await outcome(page)).type, "load", "the event");
      const found = await within("the panel", page.evaluate(async () => {
        const { shadowRoot } = viewer;
        await until(() => shadowRoot.querySelector("details"));
        for (const details of shadowRoot.querySelectorAll("details")) details.open = true;
        await until(() => shadowRoot.querySelectorAll("option").length > 1);
        await pause(1000);
        return {
          options: [...shadowRoot.querySelectorAll("[aria-label=Animation] option")].map(({ textContent }) => textContent),
          images: shadowRoot.querySelectorAll("img:not(.poster)").length,
          scene: viewer.stats().scene,
        };
      }));
      same(found, { options: [`${MARKUP}dim`, `${MARKUP}bright`], images: 0, scene: MARKUP }, "names in the panel");
      // In the link, too.
      await page.evaluate((name) => (viewer.animationName = name), `${MARKUP}bright`);
      check(!(await page.evaluate(() => viewer.stateLink())).includes("<img"), "markup in a link");
      equal(await run(page), undefined, "what markup did");
      equal(faults.join("\n"), "", "faults");
      await page.close();
    });

    await harness.test("page::text::a_name_in_an_error_is_text", async () => {
      const { page } = await opened();
      await page.evaluate(() => (viewer.src = "broken-texture.rbn"));
      await expectFailure(page, "texture");
      const { alert } = await shown(page);
      // As Rust quotes it.
      check(alert.includes("<img src=x onerror="), alert);
      equal(await run(page), undefined, "what markup did");
      await page.close();
    });

    await harness.test("page::text::shots_and_links_are_text", async () => {
      const { page } = await opened();
      await page.evaluate(() => (viewer.src = "whole.rbn"));
      equal((await outcome(page)).type, "load", "the event");
      const codes = await page.evaluate((markup) => {
        const tries = [
          () => (viewer.shot = { camera: viewer.camera, lights: [{ type: markup, name: markup, intensity: 1 }] }),
          () => (viewer.lights = [{ type: "point", position: markup, intensity: 1 }]),
          () => viewer.restoreState(`#light=${encodeURIComponent(markup)}`),
          () => (viewer.animations = [{ name: markup, duration: 1, tracks: [{ light: 0, property: markup, times: [0], values: [1] }] }]),
        ];
        return tries.map((attempt) => {
          try {
            attempt();
            return "taken";
          } catch (error) {
            return error.code;
          }
        });
      }, MARKUP);
      same(codes, ["bad-json", "bad-json", "bad-json", "bad-json"], "codes");
      // A light's name is text, in the panel's list, too.
      const kept = await page.evaluate((markup) => {
        viewer.controls = true;
        viewer.lights = viewer.lights.map((light) => ({ ...light, name: markup }));
        return viewer.lights[0].name;
      }, MARKUP);
      equal(kept, MARKUP, "the name");
      await page.getByText("Lights and settings").click();
      await page.getByText(MARKUP).first().waitFor();
      equal(await page.evaluate(() => viewer.shadowRoot.querySelectorAll("img:not(.poster)").length), 0, "images");
      equal(await run(page), undefined, "what markup did");
      await page.close();
    });
  } finally {
    server.end();
  }
}
