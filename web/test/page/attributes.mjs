// Attributes, their properties, and what each of them does.

import { DEVICE_PIXELS, HANGS, spread, within } from "../browser.mjs";
import { check, equal, same } from "../harness.mjs";
import { loaded, open, outcome } from "./open.mjs";

/** Runs the tests. */
export async function attributes(harness, context) {
  await harness.test(
    "attributes::are_properties_too",
    async () => {
      const { page, faults } = await open(context, { html: "<rebounce-viewer></rebounce-viewer>" });
      const found = await page.evaluate(() => {
        const defaults = {};
        const wrong = [];
        const values = {
          alt: "A room", poster: "room.png", width: 320, height: 200, exposure: 1.5, autoExposure: false,
          toneMapping: "neutral", mode: "direct", overlay: "levels", loading: "lazy", controls: true, autoplay: true,
          animationName: "night", stateInLink: true, handles: false, interaction: "page", display: "splat", backdrop: "none",
          detail: false, cameraControls: "orbit", environmentRotation: 45, environmentIntensity: 2, sky: "48,172,12", backgroundBlur: 0.5,
        };
        for (const [name, value] of Object.entries(values)) {
          const attribute = name.replace(/[A-Z]/g, (letter) => `-${letter.toLowerCase()}`);
          defaults[name] = viewer[name];
          viewer[name] = value;
          if (viewer[name] !== value) wrong.push(`${name} is ${viewer[name]} after ${value} was set`);
          if (!viewer.hasAttribute(attribute)) wrong.push(`no attribute ${attribute}`);
          const written = viewer.getAttribute(attribute);
          viewer.removeAttribute(attribute);
          if (viewer[name] !== defaults[name]) wrong.push(`${name} is ${viewer[name]} without its attribute`);
          viewer.setAttribute(attribute, written);
          if (viewer[name] !== value) wrong.push(`${name} is ${viewer[name]} for the attribute ${written}`);
        }
        viewer.src = "missing.rbn";
        const src = viewer.src;
        for (const [name, bad] of [["mode", "x"], ["overlay", "x"], ["toneMapping", "x"], ["interaction", "x"], ["display", "x"], ["backdrop", "x"], ["cameraControls", "x"], ["exposure", "much"], ["width", "-3"]]) {
          viewer[name] = bad;
          if (viewer[name] !== defaults[name]) wrong.push(`${name} is ${viewer[name]} for ${bad}`);
        }
        viewer.exposure = 1e9;
        return { defaults, wrong, src, exposure: viewer.exposure };
      });
      same(found.wrong, [], "what is wrong");
      const defaults = {
        alt: "", poster: "", width: 0, height: 0, exposure: 0, autoExposure: true, toneMapping: "agx", mode: "all",
        overlay: "none", loading: "eager", controls: false, autoplay: false, animationName: "", stateInLink: false,
        handles: true, interaction: "auto", display: "auto", backdrop: "auto", detail: true, cameraControls: "auto", environmentRotation: 0, environmentIntensity: 1, sky: "", backgroundBlur: 0,
      };
      same(found.defaults, defaults, "defaults");
      equal(found.src, `${context.address}missing.rbn`, "src, in full");
      equal(found.exposure, 20, "far too large an exposure");
      equal(faults.filter((fault) => !fault.startsWith("Failed to load")).join("\n"), "", "faults");
      await page.close();
    },
    `property src, property alt, property poster, property width, property height, property exposure
    property autoExposure, property toneMapping, property mode, property overlay, property loading, property controls
    property autoplay, property animationName, property stateInLink, property handles, property interaction
    property display, property backdrop, property detail`,
  );

  await harness.test("attributes::a_value_that_means_nothing_is_warned_of_once_with_those_that_do", async () => {
    const { page } = await open(context, { html: "<rebounce-viewer mode='foo'></rebounce-viewer>" });
    const warnings = [];
    page.on("console", (message) => message.type() === "warning" && message.text().includes("rebounce-viewer") && warnings.push(message.text()));
    const wrong = { mode: "sideways", overlay: "dots", display: "x", "tone-mapping": "aces", interaction: "yes", loading: "late", "auto-exposure": "no", handles: "false" };
    const right = { mode: "direct", overlay: "levels", display: "splat", "tone-mapping": "neutral", interaction: "page", loading: "lazy", "auto-exposure": "off", handles: "off", alt: "foo", exposure: "1" };
    await page.evaluate(([wrong, right]) => {
      for (const values of [wrong, right, wrong]) for (const [name, value] of Object.entries(values)) viewer.setAttribute(name, value);
      const second = document.createElement("rebounce-viewer");
      second.setAttribute("mode", "sideways");
      console.warn("rebounce-viewer: the end");
    }, [wrong, right]);
    for (const [name, value] of Object.entries(wrong)) {
      const own = warnings.filter((text) => text.includes(`${name}="${value}"`));
      equal(own.length, 1, `warnings of ${name}: ${warnings.join("\n")}`);
      check(own[0].includes(right[name]), `the allowed ones are not named: ${own[0]}`);
    }
    equal(warnings.length, Object.keys(wrong).length + 1, "warnings");
    await page.close();
  });

  const { page, faults } = await loaded(context, '<rebounce-viewer src="scene.rbn" alt="Two <b>blocks</b>"></rebounce-viewer>');

  await harness.test(
    "attributes::alt_names_the_picture",
    async () => {
      const label = () => page.evaluate(() => viewer.shadowRoot.querySelector("canvas[role=img]").getAttribute("aria-label"));
      check((await label()).startsWith("Two <b>blocks</b>."), await label());
      await page.evaluate(() => (viewer.alt = "A room"));
      check((await label()).startsWith("A room."), await label());
    },
    "attribute alt, attribute src",
  );

  const pixels = (set) =>
    page.evaluate(async (attributes) => {
      for (const [name, value] of Object.entries(attributes)) viewer.setAttribute(name, value);
      const bytes = Array.from(await viewer.readPixels(64, 36));
      for (const name of Object.keys(attributes)) viewer.removeAttribute(name);
      return bytes;
    }, set);

  await harness.test(
    "attributes::exposure_mode_and_overlay_change_the_picture",
    async () => {
      const plain = spread(await pixels({})).mean;
      const brighter = spread(await pixels({ exposure: "1" })).mean;
      const direct = spread(await pixels({ mode: "direct" })).mean;
      const indirect = spread(await pixels({ mode: "indirect" })).mean;
      check(brighter > plain * 1.1, `${brighter} with a stop more, ${plain} without`);
      check(direct < plain && indirect < plain, `direct ${direct}, indirect ${indirect}, both ${plain}`);
      // Overlays are drawn on the canvas only.
      const shot = async (overlay) => {
        await page.evaluate(async (value) => {
          viewer.overlay = value;
          await still();
        }, overlay);
        return page.screenshot({ timeout: 1000 * HANGS });
      };
      const without = await shot("none");
      check(!without.equals(await shot("levels")), "no levels are drawn");
      await shot("none");
    },
    "attribute exposure, attribute mode, attribute overlay, method readPixels",
  );

  await harness.test(
    "attributes::settings_reach_the_viewer",
    async () => {
      const look = () => page.evaluate(async () => Array.from(await viewer.readPixels(32, 18)));
      const agx = await look();
      await page.evaluate(() => (viewer.toneMapping = "neutral"));
      const neutral = await look();
      check(spread(agx).mean !== spread(neutral).mean, "AgX looks like the other");
      await page.evaluate(() => {
        viewer.autoExposure = false;
        viewer.exposure = 4;
      });
      const bright = await look();
      await page.evaluate(() => (viewer.exposure = -4));
      const dark = await look();
      check(spread(bright).mean > spread(dark).mean + 20, "stops of a fixed exposure");
      await page.evaluate(() => {
        viewer.exposure = 0;
        viewer.removeAttribute("auto-exposure");
      });
      check(Math.abs(spread(await look()).mean - spread(neutral).mean) < 1, "the measured exposure is not back");
      check(await page.evaluate(() => viewer.shadowRoot.querySelector("[role=alert]").hidden), "a message");
    },
    "attribute tone-mapping, attribute auto-exposure",
  );

  await harness.test(
    "attributes::figures_and_counts_are_told",
    async () => {
      const { stats, counts } = await page.evaluate(async () => ({ stats: viewer.stats(), counts: await viewer.counts() }));
      check(stats.frames > 0 && stats.links > 1000 && stats.triangles === 30, JSON.stringify(stats));
      check(Object.values(stats.bytes).every((n) => n >= 0) && stats.bytes.scene > 1e5, JSON.stringify(stats.bytes));
      check(stats.functions.length > 1 && stats.adapter !== "", JSON.stringify(stats));
      const { pixels, pixelsLookedUp, functionsLookedAtPerPixel, kernelEvaluationsPerPixel } = counts;
      check(pixels === 320 * 180 * DEVICE_PIXELS ** 2 && pixelsLookedUp > pixels / 5 && pixelsLookedUp < pixels, JSON.stringify(counts));
      check(functionsLookedAtPerPixel > kernelEvaluationsPerPixel && kernelEvaluationsPerPixel > 0.5, JSON.stringify(counts));
    },
    "method stats, method counts",
  );

  await harness.test(
    "attributes::pictures_can_be_read",
    async () => {
      const found = await page.evaluate(async () => {
        const blob = await viewer.toBlob("image/jpeg", 0.7);
        const png = await viewer.toBlob();
        const bitmap = await createImageBitmap(png);
        const { width, height } = viewer.shadowRoot.querySelector("canvas");
        const light = await viewer.readIndirect(16, 8);
        return {
          types: [blob.type, png.type], same: bitmap.width === width && bitmap.height === height, floats: light.length,
          some: light.some((x) => x > 0), finite: light.every(Number.isFinite),
        };
      });
      same(found, { types: ["image/jpeg", "image/png"], same: true, floats: 512, some: true, finite: true }, "pictures");
    },
    "method toBlob, method readIndirect",
  );

  await harness.test(
    "attributes::reload_and_dispose",
    async () => {
      const states = await page.evaluate(async () => {
        const states = [viewer.loaded];
        viewer.dispose();
        states.push(viewer.loaded, viewer.stats() === undefined);
        viewer.reload();
        await until(() => viewer.loaded);
        return states;
      });
      same(states, [true, false, true], "loaded, not any more, no figures");
    },
    "method dispose, method reload, property loaded",
  );

  await harness.test("attributes::no_fault_on_the_way", () => equal(faults.join("\n"), "", "faults"));
  await page.close();

  await harness.test(
    "attributes::a_refusal_carries_a_code_and_leaves_the_scene",
    async () => {
      const { page } = await loaded(context);
      const codes = await page.evaluate(async () => {
        const code = (work) => {
          try {
            work();
            return "none";
          } catch (error) {
            return error.code;
          }
        };
        return {
          codes: [
            code(() => (viewer.camera = { position: [0, 0, 0] })),
            code(() => (viewer.lights = "none")),
            code(() => (viewer.shot = 7)),
            code(() => (viewer.animations = [{}])),
            code(() => viewer.addLight({ type: "lamp" })),
            code(() => viewer.removeLight(9)),
            code(() => viewer.restoreState("#camera=1")),
          ],
          loaded: viewer.loaded,
          later: await viewer.toBlob("image/png").then(() => "none", (error) => error.code),
          gone: (viewer.dispose(), [code(() => viewer.addLight({})), await viewer.counts().catch((error) => error.code)]),
        };
      });
      same(codes.codes.slice(0, 5), Array(5).fill("bad-json"), "codes");
      same(codes.codes.slice(5), ["bad-argument", "bad-json"], "codes");
      same([codes.loaded, codes.later], [true, "none"], "loaded, and drawn");
      same(codes.gone, ["no-scene", "no-scene"], "codes once there is no scene");
      await page.close();
    },
    "property camera, property lights, property shot",
  );

  await harness.test("attributes::what_is_set_before_loading_takes_effect_then", async () => {
    const { page } = await open(context, { html: "<rebounce-viewer></rebounce-viewer>" });
    await page.evaluate(() => {
      viewer.lights = [{ type: "point", position: [0, 3, -2], intensity: 9 }];
      viewer.camera = { position: [0, 2, 3], target: [0, 2, -3] };
      viewer.src = "scene.rbn";
    });
    equal((await outcome(page)).type, "load", "the event");
    const found = await within("the state", page.evaluate(() => ({ camera: viewer.camera, lights: viewer.lights })));
    same(found.camera.position, [0, 2, 3], "the camera");
    same(found.lights, [{ type: "point", position: [0, 3, -2], intensity: 9, color: [1, 1, 1] }], "the lights");
    await page.close();
  });
}
