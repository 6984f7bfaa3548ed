// The code of docs/guide/in-the-page.md, as a page has it that copies it.

import { cp, readFile, writeFile } from "node:fs/promises";
import path from "node:path";
import { within } from "../browser.mjs";
import { block } from "../guide.mjs";
import { check, equal } from "../harness.mjs";
import { document as pageWith } from "../strict.mjs";
import { commandBake, cornellBox } from "./bake-in-page.mjs";
import { serveFolder } from "../serve.mjs";

const PAGE = "in-the-page.md";
const ICON = '<link rel="icon" href="data:,">';
/** Where a page without a bundler has the package. */
const MAP = '<script type="importmap">{ "imports": { "rebounce-viewer": "./rebounce-viewer.js", "rebounce-viewer/bake": "./bake.js" } }</script>';

/** Runs the tests. */
export async function bakeGuide(harness, context) {
  const root = path.join(context.work, "bake-guide");
  await cp(path.resolve("dist"), root, { recursive: true });
  const box = path.join(root, "room.glb");
  await cp(await cornellBox(context), box);
  // A policy allows no script in a page, and no import map; whoever copies the code has other pages.
  const served = await serveFolder(root, 0, { policy: false });
  const opened = async (name, body, head) => {
    await writeFile(path.join(root, name), pageWith(body, head));
    const page = await context.browser.newPage({ viewport: { width: 320, height: 180 } });
    const faults = [];
    page.on("pageerror", (error) => faults.push(String(error)));
    await page.goto(`${served.address}${name}`);
    return { page, faults };
  };
  try {
    await harness.long("bake-guide::the_element_bakes_tells_how_far_it_is_and_saves", async () => {
      const script = `<script type="module">${await block(PAGE, "progress.js")}</script>`;
      const { page, faults } = await opened("element.html", `${await block(PAGE, "element.html")}${script}`, ICON);
      const said = [];
      page.on("console", (message) => said.push(message.text()));
      const saved = await within("the file", page.waitForEvent("download", { timeout: 0 }));
      equal(saved.suggestedFilename(), "room.rbn", "the name");
      const expected = await commandBake(context, box, { preset: "draft" });
      check(expected.equals(await readFile(await saved.path())), "other bytes");
      check(said.some((line) => /^gathering links: \d+%, \d+ s left$/.test(line)), said.join("\n"));
      equal(faults.join("\n"), "", "faults");
      await page.close();
    });

    await harness.test("bake-guide::the_script_bakes_a_chosen_file_and_shows_previews", async () => {
      const { page, faults } = await opened("script.html", await block(PAGE, "script.html"), `${ICON}${MAP}`);
      const shown = page.evaluate(() => new Promise((done) => document.querySelector("rebounce-viewer").addEventListener("load", done, { once: true })).then(() => "shown"));
      await page.locator("input").setInputFiles(box);
      equal(await within("a preview", shown), "shown", "the viewer");
      await within("progress", page.waitForFunction(() => document.querySelector("progress").value > 0, undefined, { timeout: 0 }));
      equal(faults.join("\n"), "", "faults");
      await page.close();
    });
  } finally {
    served.end();
  }
}
