// What nobody sees is neither loaded nor drawn.

import { within } from "../browser.mjs";
import { check, equal } from "../harness.mjs";
import { open, outcome } from "./open.mjs";

export async function onScreen(harness, context) {
  // The element far below what can be seen, and lazy.
  const prepare = () => {
    new MutationObserver((_, observer) => {
      const viewer = document.querySelector("rebounce-viewer");
      if (!viewer) return;
      observer.disconnect();
      viewer.setAttribute("loading", "lazy");
      viewer.style.display = "block";
      viewer.style.height = "180px";
      document.documentElement.style.overflow = document.body.style.overflow = "auto";
      document.documentElement.style.height = document.body.style.height = "auto";
      document.body.style.display = "block";
      const far = document.createElement("div");
      far.style.height = "4000px";
      viewer.before(far);
    }).observe(document, { childList: true, subtree: true });
  };
  const { page, faults } = await open(context, { prepare });
  const frames = () => page.evaluate(() => document.querySelector("rebounce-viewer").stats()?.frames);
  const pause = (ms) => new Promise((later) => setTimeout(later, ms));
  const scroll = (y) => page.evaluate((to) => scrollTo(0, to), y);

  await harness.test("page::a_lazy_element_loads_when_it_comes_into_view", async () => {
    await pause(1500);
    equal(await page.evaluate(() => events.length), 0, "events while it is far away");
    await scroll(4000);
    equal((await outcome(page)).type, "load", "the event");
  }, "attribute loading");

  await harness.test("page::out_of_view_nothing_is_drawn", async () => {
    await scroll(0);
    // What was under way comes to its end, however slow the machine is.
    const before = await page.evaluate(() => seen(viewer, false).then(still));
    await page.evaluate(() => {
      const viewer = document.querySelector("rebounce-viewer");
      const [light] = viewer.lights;
      viewer.lights = [{ ...light, intensity: light.intensity * 0.5 }];
    });
    await pause(1500);
    equal(await frames(), before, "frames drawn out of view");
    await scroll(4000);
    await within("a frame", page.waitForFunction((n) => document.querySelector("rebounce-viewer").stats().frames > n, before));
    equal(faults.length, 0, faults.join("\n"));
  });
  await page.close();
}
