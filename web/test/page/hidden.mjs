// The tab goes into the background and comes back.

import { spread, within } from "../browser.mjs";
import { check, equal, same } from "../harness.mjs";
import { PLAIN, outcome } from "./open.mjs";
import { alike, counted } from "./sharing.mjs";

/**
 * In the page, before its scripts: `hide()` and `show()` do what a browser does to a tab (headless ones have no tabs): the
 * page is told, and what it asked to be called for before the next frame waits until it is seen again. `frame()` resolves
 * with the next frame in any case.
 */
function background() {
  let hidden = false;
  let waiting = new Map();
  const { requestAnimationFrame: request, cancelAnimationFrame: cancel } = window;
  window.requestAnimationFrame = (work) => {
    if (!hidden) return request.call(window, work);
    const id = -1 - Math.floor(Math.random() * 1e9);
    waiting.set(id, work);
    return id;
  };
  window.cancelAnimationFrame = (id) => waiting.delete(id) || cancel.call(window, id);
  Object.defineProperty(Document.prototype, "visibilityState", { get: () => (hidden ? "hidden" : "visible") });
  Object.defineProperty(Document.prototype, "hidden", { get: () => hidden });
  const change = (to) => {
    hidden = to;
    document.dispatchEvent(new Event("visibilitychange"));
  };
  globalThis.frame = () => new Promise((done) => request.call(window, done));
  globalThis.hide = () => change(true);
  globalThis.show = () => {
    change(false);
    for (const work of waiting.values()) request.call(window, work);
    waiting = new Map();
  };
}

/** Runs the tests. */
export async function hidden(harness, context) {
  const opened = async (html) => {
    const it = await counted(context, html);
    await it.page.evaluate(`(${background})()`);
    return it;
  };

  await harness.test("page::hidden::nothing_is_drawn_in_the_background_and_then_what_has_changed", async () => {
    const { page, faults } = await opened(PLAIN);
    await outcome(page);
    const found = await within("the picture", page.evaluate(async () => {
      await still();
      const lights = viewer.lights.map((light) => ({ ...light, color: [0.1, 0.2, 1] }));
      hide();
      // A frame that was asked for before may be under way.
      for (let i = 0; i < 2; i += 1) await frame();
      const { frames } = viewer.stats();
      viewer.lights = lights;
      viewer.exposure = 1;
      await pause(1500);
      const background = viewer.stats().frames - frames;
      show();
      await until(() => viewer.stats().frames > frames);
      await still();
      return { background, same: JSON.stringify(viewer.lights) === JSON.stringify(lights), loaded: viewer.loaded };
    }));
    same(found, { background: 0, same: true, loaded: true }, "frames in the background, the lights");
    const blue = await page.evaluate(() => look(viewer));
    const sum = (channel) => blue.reduce((all, value, i) => all + (i % 4 === channel ? value : 0), 0);
    check(sum(2) > 1.5 * sum(0), "the picture has not changed");
    equal(faults.join("\n"), "", "faults");
    await page.close();
  });

  await harness.test("page::hidden::a_scene_loads_and_a_lost_device_comes_back_in_the_background", async () => {
    const { page, faults } = await opened("<p></p>");
    const found = await within("the scene", page.evaluate(async () => {
      hide();
      add();
      await until(() => loads() === 1);
      gpu.devices[0].destroy();
      await until(() => gpu.devices.length === 2 && viewer.loaded);
      show();
      const { frames } = viewer.stats();
      viewer.exposure = 0.5;
      await until(() => viewer.stats().frames > frames);
      return { errors: events.filter(({ type }) => type === "error").length, picture: await look(viewer) };
    }));
    equal(found.errors, 0, "errors");
    check(spread(found.picture).deviation > 4, "the picture is blank");
    const fresh = await counted(context, PLAIN);
    await outcome(fresh.page);
    alike(found.picture, await fresh.page.evaluate(() => Object.assign(viewer, { exposure: 0.5 }) && look(viewer)), "this picture and one of a tab that was never hidden");
    await fresh.page.close();
    equal(faults.join("\n"), "", "faults");
    await page.close();
  });

  await harness.test("page::hidden::a_frozen_page_goes_on_where_it_was", async () => {
    const { page, faults } = await counted(context, PLAIN);
    await outcome(page);
    const session = await page.context().newCDPSession(page);
    await page.evaluate(() => {
      const values = [...viewer.lights[0].position, 0.2, 1, 0.1];
      viewer.animations = [{ name: "drift", duration: 30, tracks: [{ light: 0, property: "position", times: [0, 30], values }] }];
      viewer.play();
    });
    await page.waitForTimeout(1000);
    await session.send("Page.setWebLifecycleState", { state: "frozen" });
    await page.waitForTimeout(2000);
    await session.send("Page.setWebLifecycleState", { state: "active" });
    const at = await page.evaluate(() => viewer.currentTime);
    await within("the animation", page.waitForFunction((before) => viewer.currentTime > before + 0.3, at));
    equal(await page.evaluate(() => events.filter(({ type }) => type === "error").length), 0, "errors");
    equal(faults.join("\n"), "", "faults");
    await page.close();
  });
}
