// Size, poster, slots, parts and variables: the element as a thing of the page.

import { within } from "../browser.mjs";
import { check, equal, same } from "../harness.mjs";
import { loaded, open, outcome, PLAIN } from "./open.mjs";

const POSTER = "data:image/svg+xml,%3Csvg xmlns='http://www.w3.org/2000/svg' width='8' height='8'/%3E";

/** Runs the tests. */
export async function slots(harness, context) {
  await harness.test(
    "slots::poster_and_progress_are_there_until_the_scene_is",
    async () => {
      const html = `<rebounce-viewer poster="${POSTER}"><b slot="poster">soon</b><i slot="progress">coming</i></rebounce-viewer>`;
      // Half of the file comes, the rest when the page says so.
      const prepare = () => {
        const original = window.fetch;
        window.fetch = async (address, options) => {
          if (!String(address).endsWith("scene.rbn")) return original(address, options);
          const bytes = new Uint8Array(await (await original(address, options)).arrayBuffer());
          const half = bytes.length >> 1;
          const start = async (controller) => {
            controller.enqueue(bytes.subarray(0, half));
            await new Promise((go) => (globalThis.go = go));
            controller.enqueue(bytes.subarray(half));
            controller.close();
          };
          return new Response(new ReadableStream({ start }), { headers: { "content-length": String(bytes.length) } });
        };
      };
      const { page } = await open(context, { html, prepare });
      const look = () =>
        page.evaluate(() => {
          const progress = viewer.querySelector("i");
          return {
            poster: viewer.querySelector("b").checkVisibility(),
            image: viewer.shadowRoot.querySelector("[part=poster] img").hasAttribute("src"),
            progress: progress.checkVisibility(),
            ratio: Number(getComputedStyle(progress).getPropertyValue("--rebounce-progress")),
          };
        });
      same(await look(), { poster: true, image: true, progress: false, ratio: 0 }, "before loading");
      await page.evaluate(async () => {
        viewer.src = "scene.rbn";
        await until(() => events.some(({ ratio }) => ratio > 0.4 && ratio < 0.6));
      });
      const half = await look();
      check(half.ratio > 0.4 && half.ratio < 0.6, `--rebounce-progress is ${half.ratio} at half`);
      same([half.poster, half.progress], [true, true], "poster and progress at half");
      await page.evaluate(() => globalThis.go());
      equal((await outcome(page)).type, "load", "the event");
      const end = await look();
      same([end.poster, end.progress], [false, false], "poster and progress in the end");
      await page.close();
    },
    "slot poster, slot progress, attribute poster, part poster, variable --rebounce-progress, event progress, event load",
  );

  await harness.test(
    "slots::an_error_can_have_a_look_of_its_own",
    async () => {
      const html = '<rebounce-viewer src="missing.rbn"><b slot="error">Sorry</b></rebounce-viewer>';
      const { page } = await open(context, { html });
      equal((await outcome(page)).type, "error", "the event");
      const found = await page.evaluate(() => ({
        own: viewer.querySelector("b").checkVisibility(),
        ours: viewer.shadowRoot.querySelector("[part=message] p").checkVisibility(),
      }));
      same(found, { own: true, ours: false }, "visible");
      await page.evaluate(async () => {
        viewer.src = "scene.rbn";
        await until(() => viewer.loaded);
      });
      equal(await page.evaluate(() => viewer.querySelector("b").checkVisibility()), false, "after a good file");
      await page.close();
    },
    "slot error, part message, event error",
  );

  await harness.test(
    "slots::width_and_height_are_those_of_a_video",
    async () => {
      const { page } = await open(context, { html: "<rebounce-viewer></rebounce-viewer>", viewport: { width: 800, height: 600 } });
      const size = (change) =>
        page.evaluate((set) => {
          // Without the page's own rules, but for those given.
          document.querySelector("link[rel=stylesheet]")?.remove();
          document.body.style.margin = "0";
          for (const name of ["width", "height"]) {
            if (set[name]) viewer.setAttribute(name, set[name]);
            else viewer.removeAttribute(name);
          }
          viewer.style.cssText = set.style ?? "";
          const box = viewer.getBoundingClientRect();
          return [box.width, box.height];
        }, change);
      same(await size({}), [800, 450], "without attributes: 16:9 of what there is");
      same(await size({ width: "320", height: "240" }), [320, 240], "both");
      same(await size({ width: "320" }), [320, 180], "a width");
      same(await size({ height: "180" }), [320, 180], "a height");
      same(await size({ width: "320", height: "240", style: "width: 100%; height: auto" }), [800, 600], "the page's rules go first");
      same(await size({ width: "wide" }), [800, 450], "no number");
      await page.close();
    },
    "attribute width, attribute height",
  );

  await harness.test(
    "slots::parts_and_variables_can_be_styled",
    async () => {
      const html = '<rebounce-viewer src="scene.rbn" controls></rebounce-viewer>';
      const { page } = await loaded(context, html);
      const found = await page.evaluate(async () => {
        await until(() => viewer.shadowRoot.querySelector("[part=panel]"));
        const sheet = new CSSStyleSheet();
        const parts = ["canvas", "panel", "poster", "progress", "message"];
        sheet.replaceSync(
          `rebounce-viewer { --rebounce-background: rgb(1, 2, 3); --rebounce-accent: rgb(4, 5, 6) }` +
            parts.map((part, i) => `rebounce-viewer::part(${part}) { z-index: ${i + 40} }`).join(""),
        );
        document.adoptedStyleSheets.push(sheet);
        const look = (element) => getComputedStyle(element);
        return {
          parts: parts.map((part) => look(viewer.shadowRoot.querySelector(`[part=${part}]`)).zIndex),
          background: look(viewer).backgroundColor,
          accent: look(viewer.shadowRoot.querySelector("[part=progress] div")).backgroundColor,
        };
      });
      same(found.parts, ["40", "41", "42", "43", "44"], "parts");
      same([found.background, found.accent], ["rgb(1, 2, 3)", "rgb(4, 5, 6)"], "colours");
      await page.close();
    },
    "part canvas, part panel, part poster, part progress, part message, variable --rebounce-background, variable --rebounce-accent",
  );

  await harness.test("slots::the_canvas_follows_box_and_device_pixels", async () => {
    // Emulated screens tell of no change: the media queries here are the test's.
    const prepare = () => {
      const original = window.matchMedia;
      window.matchMedia = (query) => {
        if (!query.includes("resolution")) return original.call(window, query);
        globalThis.watched = Object.assign(new EventTarget(), { query });
        return globalThis.watched;
      };
    };
    const { page } = await loaded(context, PLAIN, { prepare, media: { deviceScaleFactor: 1 } });
    const size = (ratio) =>
      page.evaluate((value) => {
        if (value) {
          Object.defineProperty(window, "devicePixelRatio", { value, configurable: true });
          globalThis.watched.dispatchEvent(new Event("change"));
        }
        const { width, height } = viewer.shadowRoot.querySelector("canvas");
        return [width, height, globalThis.watched.query];
      }, ratio);
    same(await size(), [320, 180, "(resolution: 1dppx)"], "at first");
    same(await size(1.5), [480, 270, "(resolution: 1.5dppx)"], "at one and a half device pixels");
    same(await size(4), [640, 360, "(resolution: 4dppx)"], "at four, of which two are drawn");
    await page.evaluate(() => (viewer.style.width = "200px"));
    await within("400 pixels", page.waitForFunction(() => viewer.shadowRoot.querySelector("canvas").width === 400));
    await page.close();
  });
}
