// The scene comes, is drawn, and nothing more than needed.

import { spread, within } from "../browser.mjs";
import { check, equal } from "../harness.mjs";
import { open, outcome, shown } from "./open.mjs";

export async function loading(harness, context) {
  const { page, faults } = await open(context);

  await harness.test("page::loads_the_baked_cornell_box", async () => {
    const event = await outcome(page);
    equal(event.type, "load", event.message ?? "the event");
    equal(event.url, `${context.address}scene.rbn`, "its url");
    const { alert, canvas } = await shown(page);
    equal(alert, "", "the message");
    check(canvas, "the canvas is hidden");
  });

  await harness.test("page::progress_rises_to_the_whole_file", async () => {
    const steps = await page.evaluate(() => events.filter((event) => event.type === "progress"));
    check(steps.length >= 2, `${steps.length} progress events`);
    const last = steps[steps.length - 1];
    equal(last.loaded, context.bytes.length, "bytes loaded in the end");
    equal(last.ratio, 1, "the ratio in the end");
    steps.reduce((before, step) => {
      check(step.loaded >= before.loaded, `${step.loaded} bytes after ${before.loaded}`);
      return step;
    });
  });

  await harness.test("page::picture_is_not_blank", async () => {
    const pixels = await page.evaluate(async () =>
      Array.from(await document.querySelector("rebounce-viewer").readPixels(128, 72)),
    );
    equal(pixels.length, 128 * 72 * 4, "bytes");
    const { mean, deviation } = spread(pixels);
    check(deviation > 4, `brightness ${mean.toFixed(1)} +- ${deviation.toFixed(1)} of 255`);
  });

  await harness.test("page::a_still_scene_costs_no_frames", async () => {
    const drawn = await page.evaluate(async () => {
      const original = requestAnimationFrame;
      let asked = 0;
      window.requestAnimationFrame = (callback) => {
        asked += 1;
        return original.call(window, callback);
      };
      // What loading began may still be under way.
      await still();
      asked = 0;
      const { frames } = viewer.stats();
      await pause(10_000);
      const drawn = asked + viewer.stats().frames - frames;
      asked = 0;
      document.querySelector("rebounce-viewer").exposure = 1;
      await until(() => asked > 0);
      window.requestAnimationFrame = original;
      return { still: drawn, changed: asked };
    });
    equal(drawn.still, 0, "frames of a still scene in ten seconds");
    check(drawn.changed > 0, "a change of exposure drew no frame");
  });

  await harness.test("page::dragging_turns_the_camera", async () => {
    const before = await page.evaluate(() => document.querySelector("rebounce-viewer").camera);
    await page.mouse.move(30, 150);
    await page.mouse.down();
    await page.mouse.move(90, 140, { steps: 4 });
    await page.mouse.up();
    const camera = await within("camera-change",
      page.evaluate(async () => {
        while (!events.some((event) => event.type === "camera-change")) await new Promise((t) => setTimeout(t, 50));
        return document.querySelector("rebounce-viewer").camera;
      }),
    );
    const moved = Math.hypot(...camera.position.map((value, axis) => value - before.position[axis]));
    const turned = Math.hypot(...camera.target.map((value, axis) => value - before.target[axis]));
    check(moved + turned > 0.01, `the camera stayed at ${camera.position}`);
  });

  await harness.test("page::no_fault_on_the_way", async () => {
    equal(faults.join("\n"), "", "faults");
  });
  await page.close();
}
