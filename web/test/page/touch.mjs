// A phone: one finger scrolls past an embedded viewer, until a tap wakes it; two are always the viewer's.

import { check, equal, same } from "../harness.mjs";
import { loaded } from "./open.mjs";

/** Width and height of the screen, and the viewer's height on it, CSS pixels. */
const SCREEN = { width: 390, height: 844 };
const HEIGHT = 220;

/** A page that goes on below and above a viewer; `touch` moves fingers, each a list of places, step by step. */
async function phone(context) {
  const html = '<rebounce-viewer src="scene.rbn" alt="A box"></rebounce-viewer>';
  const opened = await loaded(context, html, { viewport: SCREEN, media: { hasTouch: true, isMobile: true } });
  const { page } = opened;
  await page.evaluate((height) => {
    for (const { style } of [document.documentElement, document.body]) [style.overflow, style.height] = ["auto", "auto"];
    Object.assign(viewer.style, { display: "block", height: `${height}px`, width: "390px" });
    for (const place of ["beforebegin", "afterend"]) viewer.insertAdjacentElement(place, document.createElement("div")).style.height = "1200px";
  }, HEIGHT);
  const client = await page.context().newCDPSession(page);
  const send = (type, touchPoints) => client.send("Input.dispatchTouchEvent", { type, touchPoints });
  const touch = async (...steps) => {
    await send("touchStart", steps[0].slice(0, 1));
    if (steps[0].length > 1) await send("touchStart", steps[0]);
    for (const places of steps.slice(1)) await send("touchMove", places);
    await send("touchEnd", []);
    await page.evaluate(() => still());
  };
  return { ...opened, touch };
}

/** One finger from a place by so much, in steps. */
const swipe = (x, y, dx, dy) => [0, 1, 2, 3, 4, 5].map((i) => [{ x: x + (dx * i) / 5, y: y + (dy * i) / 5, id: 0 }]);

/** Runs the tests. */
export async function touch(harness, context) {
  const { page, faults, touch } = await phone(context);
  const MIDDLE = HEIGHT / 2;
  /** Brings the viewer to the top of the screen; where page and camera are. */
  const look = () => page.evaluate(() => ({ scrolled: scrollY, camera: JSON.stringify(viewer.camera) }));
  const above = async () => {
    await page.evaluate(async () => {
      await until(() => (scrollTo(0, viewer.offsetTop), Math.abs(viewer.getBoundingClientRect().top) < 1));
      await still();
    });
    return look();
  };
  const hint = () => page.evaluate(() => viewer.shadowRoot.querySelector(".tap").checkVisibility());

  await harness.test(
    "touch::one_finger_scrolls_past_the_viewer_in_both_directions",
    async () => {
      equal(await hint(), true, "the hint is shown");
      for (const dy of [-90, 90]) {
        const before = await above();
        await touch(...swipe(200, MIDDLE, 0, dy));
        const after = await look();
        check((after.scrolled - before.scrolled) * -Math.sign(dy) > 40, `it scrolled from ${before.scrolled} to ${after.scrolled}`);
        equal(after.camera, before.camera, "the camera");
      }
      equal(await hint(), true, "the hint is still shown");
    },
    "attribute interaction",
  );

  await harness.test("touch::two_fingers_are_the_viewers", async () => {
    const before = await above();
    const apart = [20, 30, 40, 60, 80].map((d) => [{ x: 200 - d, y: MIDDLE, id: 0 }, { x: 200 + d, y: MIDDLE, id: 1 }]);
    await touch(...apart);
    const after = await look();
    equal(after.scrolled, before.scrolled, "the page");
    check(after.camera !== before.camera, "the camera is where it was");
    equal(await hint(), true, "the hint is shown");
  });

  await harness.test("touch::after_a_tap_one_finger_looks_around", async () => {
    const before = await above();
    await touch([{ x: 100, y: MIDDLE, id: 0 }]);
    equal((await look()).camera, before.camera, "the camera after the tap");
    equal(await hint(), false, "the hint is shown");
    await touch(...swipe(200, MIDDLE, 60, 80));
    const after = await look();
    equal(after.scrolled, before.scrolled, "the page");
    check(after.camera !== before.camera, "the camera is where it was");
  });

  const sleeps = async (what, put) => {
    await above();
    await touch([{ x: 100, y: MIDDLE, id: 0 }]);
    equal(await hint(), false, "the hint is shown after a tap");
    await put();
    equal(await hint(), true, `the hint is shown after ${what}`);
    const before = await above();
    await touch(...swipe(200, MIDDLE, 0, -90));
    const after = await look();
    check(after.scrolled > before.scrolled + 40, `after ${what} it scrolled from ${before.scrolled} to ${after.scrolled}`);
    equal(after.camera, before.camera, "the camera");
  };
  await harness.test("touch::a_tap_beside_it_or_escape_gives_the_finger_back_to_the_page", async () => {
    await sleeps("a tap beside it", () => touch([{ x: 200, y: HEIGHT + 300, id: 0 }]));
    await sleeps("Escape", () => page.keyboard.press("Escape"));
  });

  await harness.test("touch::other_interactions_say_so_at_once", async () => {
    const style = (interaction) =>
      page.evaluate((value) => {
        viewer.setAttribute("interaction", value);
        return getComputedStyle(viewer.shadowRoot.querySelector("canvas")).touchAction;
      }, interaction);
    same([await style("all"), await hint()], ["none", false], "all");
    same([await style("page"), await hint()], ["pan-y", false], "page");
    same([await style("none"), await hint()], ["auto", false], "none");
    same([await style("auto"), await hint()], ["pan-x pan-y", true], "auto");
    equal(faults.join("\n"), "", "faults");
  });
  await page.close();
}
