// A lost device is replaced, and everything is as it was.

import { HANGS, decode, spread, within } from "../browser.mjs";
import { check, equal, same } from "../harness.mjs";
import { expectFailure, outcome, PLAIN, shown } from "./open.mjs";
import { alike, counted, distance } from "./sharing.mjs";

export async function recovery(harness, context) {
  await harness.test("page::recovery::every_element_shows_again_what_it_showed", async () => {
    const { page, faults } = await counted(context, PLAIN.repeat(3));
    const states = () => page.evaluate(() => elements().map(({ camera, lights }) => JSON.stringify({ camera, lights })));
    const looks = () => page.evaluate(async () => [await look(elements()[0]), await look(elements()[1]), await look(elements()[2])]);
    await within("three scenes", page.evaluate(() => until(() => loads() === 3)));
    // The exposure was measured before the change, and stays what it was.
    await page.evaluate(async () => {
      const [first, second] = elements();
      first.lights = first.lights.map((light) => ({ ...light, intensity: 3 * light.intensity, color: [1, 0.3, 0.1] }));
      second.camera = { ...second.camera, position: [0.3, 0.6, 1.5] };
      second.exposure = 0.5;
      await still();
      events.length = 0;
    });
    const before = { states: await states(), pictures: await looks() };
    await page.evaluate(() => gpu.devices[0].destroy());
    await within("three scenes again", page.evaluate(() => until(() => gpu.devices.length === 2 && elements().every((it) => it.loaded))));
    same(await states(), before.states, "cameras and lights");
    const pictures = await looks();
    check(distance(pictures[0], pictures[1]) > 3 && distance(pictures[0], pictures[2]) > 3, "the elements show the same");
    pictures.forEach((picture, i) => alike(picture, before.pictures[i], `picture ${i} before and after`));
    equal(await page.evaluate(() => gpu.devices.length), 2, "devices");
    same(await page.evaluate(() => events), [], "what was told");
    // On the screen too.
    const shot = await decode(context.browser, await page.locator("rebounce-viewer").first().screenshot({ timeout: 1000 * HANGS }));
    check(spread(shot).deviation > 4, "the canvas is blank");
    check((await shown(page)).canvas, "the canvas is hidden");
    equal(faults.join("\n"), "", "faults");
    await page.close();
  });

  await harness.test("page::recovery::a_sky_is_there_again_with_its_sun", async () => {
    // The automatic exposure of a smaller picture is another one after the loss.
    const { page } = await counted(context, PLAIN, { media: { deviceScaleFactor: 1 } });
    await outcome(page);
    const found = await within("the sky", page.evaluate(async () => {
      viewer.sky = "48,172,11";
      await until(() => viewer.lights.some(({ name }) => name === "Sun"));
      await still();
      const seen = async () => ({ lights: JSON.stringify(viewer.lights), picture: await look(viewer) });
      const before = await seen();
      viewer.removeAttribute("sky");
      await until(() => !viewer.lights.some(({ name }) => name === "Sun"));
      const without = await seen();
      viewer.sky = "48,172,11";
      await until(() => viewer.lights.some(({ name }) => name === "Sun"));
      gpu.devices[0].destroy();
      await until(() => gpu.devices.length === 2 && viewer.loaded);
      await still();
      return { before, without, after: await seen() };
    }));
    equal(found.after.lights, found.before.lights, "the lights");
    check(distance(found.without.picture, found.before.picture) > 3, "the sky is not seen");
    alike(found.after.picture, found.before.picture, "before and after");
    await page.close();
  });

  await harness.test("page::recovery::an_animation_goes_on", async () => {
    const { page } = await counted(context, PLAIN);
    await outcome(page);
    const found = await within("the animation", page.evaluate(async () => {
      const values = [...viewer.lights[0].position, 0.2, 1, 0.1];
      viewer.animations = [{ name: "drift", duration: 40, tracks: [{ light: 0, property: "position", times: [0, 40], values }] }];
      viewer.play();
      await until(() => viewer.currentTime > 0.5);
      const at = viewer.currentTime;
      events.length = 0;
      gpu.devices[0].destroy();
      await until(() => gpu.devices.length === 2 && viewer.loaded && viewer.currentTime > at + 0.5);
      const told = events.map(({ type }) => type).filter((type) => type !== "light-change");
      return { paused: viewer.paused, name: viewer.animations[0].name, told };
    }));
    same(found, { paused: false, name: "drift", told: [] }, "the animation");
    await page.close();
  });

  await harness.test("page::recovery::out_of_view_it_waits_until_it_is_seen", async () => {
    const { page } = await counted(context, PLAIN);
    await outcome(page);
    const found = await within("the scene", page.evaluate(async () => {
      // Far below; the page's own rules would keep it in view.
      document.documentElement.style.cssText = document.body.style.cssText = "display: block; height: auto; overflow: auto";
      const far = document.createElement("div");
      far.style.height = "4000px";
      Object.assign(viewer.style, { display: "block", height: "180px" });
      const { lights } = viewer;
      viewer.before(far);
      await seen(viewer, false);
      gpu.devices[0].destroy();
      await until(() => !viewer.loaded);
      const waiting = { ...(await settled()), devices: gpu.devices.length, lights: viewer.lights };
      scrollTo(0, 4000);
      await until(() => viewer.loaded);
      return { ...waiting, lights: JSON.stringify(waiting.lights) === JSON.stringify(lights), then: gpu.devices.length };
    }));
    same(found, { alive: 0, bytes: 0, devices: 1, lights: true, then: 2 }, "what there is while it waits");
    await page.close();
  });

  for (const [moment, wait] of [
    ["before_anything_is_on_it", "ondevice"],
    ["while_a_scene_is_loaded", "onbuffer"],
  ]) {
    await harness.test(`page::recovery::a_device_lost_${moment}_is_replaced`, async () => {
      const { page, faults } = await counted(context, "<p></p>");
      const found = await within("the scenes", page.evaluate(async (hook) => {
        gpu[hook] = (device) => {
          gpu[hook] = undefined;
          (device ?? gpu.devices[0]).destroy();
        };
        const both = [add(), add()];
        await until(() => gpu.devices.length === 2);
        await until(() => both.every((it) => it.loaded));
        return { devices: gpu.devices.length, told: events.map(({ type }) => type).filter((type) => type !== "progress") };
      }, wait));
      same(found, { devices: 2, told: ["load", "load"] }, "devices, and what was told");
      const pictures = await page.evaluate(async () => [await look(elements()[0]), await look(elements()[1])]);
      check(spread(pictures[0]).deviation > 4, "the picture is blank");
      alike(pictures[0], pictures[1], "the two pictures");
      equal(faults.join("\n"), "", "faults");
      await page.close();
    });
  }

  await harness.test("page::recovery::without_another_device_that_is_said_and_trying_again_brings_all_back", async () => {
    const { page, faults } = await counted(context, PLAIN);
    await outcome(page);
    const before = await page.evaluate(() => {
      viewer.lights = viewer.lights.map((light) => ({ ...light, color: [0.1, 0.2, 1] }));
      globalThis.request = GPUAdapter.prototype.requestDevice;
      GPUAdapter.prototype.requestDevice = () => Promise.reject(new Error("none left"));
      gpu.devices[0].destroy();
      return viewer.lights;
    });
    await expectFailure(page, "no-device", 1);
    await page.evaluate(() => (GPUAdapter.prototype.requestDevice = request));
    await page.getByRole("button", { name: "Try again" }).click();
    equal((await outcome(page, 2)).type, "load", "the event after trying again");
    same(await page.evaluate(() => viewer.lights), before, "the lights");
    equal(faults.join("\n"), "", "faults");
    await page.close();
  });

  await harness.test("page::recovery::devices_that_are_lost_again_and_again_are_given_up", async () => {
    const { page } = await counted(context, "<p></p>");
    await page.evaluate(() => {
      gpu.ondevice = (device) => device.destroy();
      // All of them within a minute, however long they take.
      const now = performance.now();
      performance.now = () => now;
      add();
    });
    // A page may be told of a loss only after a first picture on what is lost already.
    await page.evaluate(() => until(() => events.some(({ type }) => type === "error")));
    const before = await page.evaluate(() => events.filter(({ type }) => type === "load").length);
    await expectFailure(page, "device-lost", before);
    check(before < 2, `${before} load events`);
    await page.evaluate(() => pause(1500));
    equal(await page.evaluate(() => gpu.devices.length), 4, "devices asked for");
    await page.close();
  });
}
