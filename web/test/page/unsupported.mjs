// Without WebGPU: the poster stays, visitors read what to do, and the reason is in the event and on the console.

import { readFile } from "node:fs/promises";
import { createRequire } from "node:module";
import { check, equal, same } from "../harness.mjs";
import { open, outcome } from "./open.mjs";

const AXE = createRequire(import.meta.url).resolve("axe-core/axe.min.js");
const POSTER = "data:image/svg+xml,%3Csvg xmlns='http://www.w3.org/2000/svg' width='8' height='8'/%3E";
/** The element with a poster of each kind, and without. */
const ELEMENTS = {
  attribute: `<rebounce-viewer alt="A red room" poster="${POSTER}"></rebounce-viewer>`,
  slot: '<rebounce-viewer alt="A red room"><b slot="poster">A red room</b></rebounce-viewer>',
  none: '<rebounce-viewer alt="A red room"></rebounce-viewer>',
};
/** What is missing: the code, a word of the reason, and how. */
const MISSING = {
  webgpu: ["no-webgpu", "navigator.gpu", () => delete Navigator.prototype.gpu],
  adapter: ["no-adapter", "adapter", () => (GPU.prototype.requestAdapter = () => Promise.resolve(null))],
};

/** Opens the element; what is told, on the console and in the picture's place. */
async function told(context, html, prepare) {
  const { page, faults } = await open(context, { html, prepare, viewport: { width: 390, height: 219 } });
  const warnings = [];
  page.on("console", (message) => message.type() === "warning" && message.text().startsWith("<rebounce-viewer>") && warnings.push(message.text()));
  await page.evaluate(() => (viewer.src = "scene.rbn"));
  const event = await outcome(page);
  const found = await page.evaluate(() => {
    const { shadowRoot } = viewer;
    const alert = shadowRoot.querySelector("[role=alert]");
    const box = alert.getBoundingClientRect();
    const image = shadowRoot.querySelector("[part=poster] img");
    return {
      words: alert.querySelector("p").textContent,
      buttons: alert.querySelectorAll("button").length,
      share: box.height / viewer.getBoundingClientRect().height,
      image: image.checkVisibility(),
      alt: image.alt,
      slotted: viewer.querySelector("[slot=poster]")?.checkVisibility() ?? false,
      canvas: getComputedStyle(shadowRoot.querySelector("canvas")).visibility,
    };
  });
  return { page, faults, warnings, event, found };
}

/** Runs the tests. */
export async function unsupported(harness, context) {
  const axe = await readFile(AXE, "utf8");
  for (const [kind, html] of Object.entries(ELEMENTS)) {
    for (const [what, [code, reason, prepare]] of Object.entries(MISSING)) {
      await harness.test(`unsupported::no_${what}_with_poster_${kind}`, async () => {
        const { page, faults, warnings, event, found } = await told(context, html, prepare);
        same([event.type, event.code], ["error", code], "the event");
        check(event.message.includes(reason), `the event's reason: ${event.message}`);
        equal(warnings.length, 1, `warnings: ${warnings.join("\n")}`);
        check(warnings[0].includes(event.message), warnings[0]);
        check(/^This 3D view needs WebGPU.*Chrome, Edge, Firefox or Safari/.test(found.words), found.words);
        check(!found.words.includes(reason), `visitors read the reason: ${found.words}`);
        same([found.buttons, found.canvas], [0, "hidden"], "buttons, and the canvas");
        same([found.image, found.slotted], [kind === "attribute", kind === "slot"], "posters");
        if (kind === "attribute") equal(found.alt, "A red room", "the poster's name");
        if (kind === "none") equal(found.share, 1, "the sentence's share of the height");
        else check(found.share < 0.5, `the sentence covers ${found.share} of the poster`);
        await page.evaluate(axe);
        const violations = await page.evaluate(async () => (await axe.run(viewer)).violations.map(({ id, help }) => `${id}: ${help}`));
        same(violations, [], "what axe finds");
        equal(faults.join("\n"), "", "faults");
        await page.close();
      });
    }
  }

  await harness.test("unsupported::a_page_without_https_is_told_so", async () => {
    const prepare = () => {
      delete Navigator.prototype.gpu;
      Object.defineProperty(window, "isSecureContext", { value: false });
    };
    const { page, event, found } = await told(context, ELEMENTS.none, prepare);
    equal(event.code, "no-webgpu", "the code");
    check(/needs WebGPU.*https/.test(found.words), found.words);
    await page.close();
  });
}
