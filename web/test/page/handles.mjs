// The lights' handles: marked, chosen, dragged, let go; what the element tells of it.

import { check, equal, same } from "../harness.mjs";
import { loaded } from "./open.mjs";

/** A light in the middle of the picture, half-way to what is looked at, and one at its left; their places. */
const middle = (page) =>
  page.evaluate(async () => {
    const { target, position } = viewer.camera;
    const place = target.map((x, i) => position[i] + 0.5 * (x - position[i]));
    const light = { type: "point", intensity: 5, color: [1, 1, 1] };
    viewer.lights = [{ ...light, position: place }, { ...light, position: [place[0] - 1.5, place[1], place[2]] }];
    viewer.selectedLight = -1;
    await still();
    events.length = 0;
    return place;
  });

/** Waits until the element has told so many of an event; the lights that it told of. */
const told = (page, type, count) =>
  page.evaluate(
    async ([name, least]) => {
      const lights = () => events.filter((event) => event.type === name).map(({ light }) => light);
      await until(() => lights().length >= least);
      return lights();
    },
    [type, count],
  );

/** Runs the tests. */
export async function handles(harness, context) {
  const { page, faults } = await loaded(context);
  const light = () => page.evaluate(() => viewer.lights[0].position);
  const chosen = () => page.evaluate(() => viewer.selectedLight);

  await harness.test(
    "handles::a_pointer_marks_them_and_a_script_can",
    async () => {
      await middle(page);
      const cursor = () => page.evaluate(() => viewer.shadowRoot.querySelector("canvas").style.cursor);
      await page.mouse.move(30, 20);
      await page.mouse.move(160, 90);
      same(await told(page, "light-hover", 1), [0], "over it");
      equal(await cursor(), "pointer", "the cursor over it");
      await page.mouse.move(30, 20);
      same(await told(page, "light-hover", 2), [0, -1], "beside it");
      equal(await cursor(), "", "the cursor beside it");
      await page.evaluate(() => (viewer.hoveredLight = 1));
      same(await told(page, "light-hover", 3), [0, -1, 1], "by script");
      equal(await page.evaluate(() => viewer.hoveredLight), 1, "which one");
      await page.evaluate(() => (viewer.hoveredLight = -1));
    },
    "property hoveredLight, event light-hover",
  );

  await harness.test(
    "handles::a_click_chooses_and_one_beside_lets_go",
    async () => {
      await middle(page);
      await page.mouse.click(160, 90);
      same(await told(page, "light-select", 1), [0], "clicked");
      await page.mouse.move(40, 40);
      await page.mouse.down();
      await page.mouse.move(80, 40, { steps: 3 });
      await page.mouse.up();
      equal(await chosen(), 0, "after a drag of the view");
      await page.evaluate(() => viewer.addLight(viewer.lights[1], 0));
      equal(await chosen(), 1, "the same light, which is the second now");
      await page.evaluate(() => viewer.removeLight(0));
      equal(await chosen(), 0, "and the first again");
      await page.mouse.click(30, 20);
      equal(await chosen(), -1, "after a click beside");
      await page.evaluate(() => (viewer.selectedLight = 1));
      // With the next frame, whatever was told before.
      await page.evaluate(() => until(() => events.filter(({ type }) => type === "light-select").at(-1)?.light === 1));
      await page.evaluate(() => viewer.removeLight(1));
      equal(await chosen(), -1, "when it is gone");
    },
    "property selectedLight, event light-select",
  );

  await harness.test("handles::what_is_chosen_is_seen", async () => {
    await page.evaluate(() => viewer.resetView());
    await middle(page);
    await page.mouse.move(30, 20);
    const shot = async (which) => {
      await page.evaluate(async (set) => (Object.assign(viewer, set), await still()), which);
      return page.screenshot({ clip: { x: 130, y: 60, width: 60, height: 60 } });
    };
    const plain = await shot({});
    check(!plain.equals(await shot({ selectedLight: 0 })), "no ring");
    check(!plain.equals(await shot({ selectedLight: -1, hoveredLight: 0 })), "it does not grow");
    check(plain.equals(await shot({ hoveredLight: -1 })), "something stays");
  });

  await harness.test("handles::a_light_stays_before_what_is_seen_and_with_shift_goes_through", async () => {
    const away = async (shift) => {
      await middle(page);
      // Farther than the back wall; with Shift it can be put there.
      await page.mouse.move(160, 90);
      await page.mouse.down();
      if (shift) await page.keyboard.down("Shift");
      await page.mouse.move(164, 90, { steps: 2 });
      await page.mouse.wheel(0, -400);
      await page.mouse.wheel(0, -400);
      await page.mouse.wheel(0, -400);
      await page.evaluate(() => still());
      await page.mouse.move(166, 90, { steps: 2 });
      await page.mouse.up();
      if (shift) await page.keyboard.up("Shift");
      await page.evaluate(() => still());
      const { position } = await page.evaluate(() => viewer.camera);
      return Math.hypot(...(await light()).map((x, i) => x - position[i]));
    };
    const [before, through] = [await away(false), await away(true)];
    check(through > before + 1, `${before} away, with Shift ${through}`);
  });

  await harness.test("handles::escape_puts_a_light_back", async () => {
    const before = await middle(page);
    await page.mouse.move(160, 90);
    await page.mouse.down();
    await page.mouse.move(190, 90, { steps: 3 });
    check((await light())[0] > before[0] + 0.01, "it was not dragged");
    await page.keyboard.press("Escape");
    same(await light(), before, "after Escape");
    await page.mouse.move(200, 90);
    await page.mouse.up();
    same(await light(), before, "let go of");
    equal(faults.join("\n"), "", "faults");
  });
  await page.close();
}
