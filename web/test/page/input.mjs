// Pointers, wheel and keys on the picture: what they do, and what they leave to the page.

import { check, equal, same } from "../harness.mjs";
import { loaded } from "./open.mjs";

/** A light in the middle of the picture, where its handle is. */
const middle = (page) =>
  page.evaluate(async () => {
    const { target, position } = viewer.camera;
    const place = target.map((x, i) => position[i] + 0.6 * (x - position[i]));
    viewer.lights = [{ type: "point", position: place, intensity: 5, color: [1, 1, 1] }];
    await still();
    return place;
  });

/** Drags from the middle of the picture. */
async function drag(page, [x, y], options) {
  await page.mouse.move(160, 90);
  await page.mouse.down(options);
  await page.mouse.move(160 + x, 90 + y, { steps: 3 });
  await page.mouse.up(options);
  await page.evaluate(() => still());
}

const distance = (a, b) => Math.hypot(...a.map((x, i) => x - b[i]));

/** Runs the tests. */
export async function input(harness, context) {
  const { page, faults } = await loaded(context);
  const camera = () => page.evaluate(() => viewer.camera);
  const light = () => page.evaluate(() => viewer.lights[0].position);
  const away = ({ position, target }) => distance(position, target);

  await harness.test(
    "input::a_handle_drags_its_light_along_the_picture",
    async () => {
      const before = await middle(page);
      const view = await camera();
      await page.evaluate(() => (events.length = 0));
      await drag(page, [40, 0]);
      const after = await light();
      same(await camera(), view, "the camera");
      const told = await page.evaluate(() => events.filter(({ type }) => type === "light-change").at(-1).lights[0].position);
      same(told, after, "the light that was told of");
      // To the right by as much as the pointer went, and no nearer.
      const forward = view.target.map((x, i) => x - view.position[i]);
      const length = Math.hypot(...forward);
      const moved = after.map((x, i) => x - before[i]);
      const along = moved.reduce((sum, x, i) => sum + (x * forward[i]) / length, 0);
      const perPixel = (2 * Math.tan((view.yfov_deg * Math.PI) / 360) * 0.6 * length) / 180;
      const pixels = Math.hypot(...moved) / perPixel;
      check(Math.abs(along) < 0.01 * length && Math.abs(pixels - 40) < 2, `${pixels} pixels aside, ${along} away`);
    },
  );

  await harness.test(
    "input::without_handles_the_same_drag_turns_the_view",
    async () => {
      await page.evaluate(() => (viewer.handles = false));
      const [before, view] = [await middle(page), await camera()];
      await drag(page, [40, 0]);
      same(await light(), before, "the light");
      const turned = await camera();
      check(distance(turned.position, view.position) > 0.01, "the view did not turn");
      check(Math.abs(away(turned) / away(view) - 1) < 1e-6, "it came closer");
      await page.evaluate(() => viewer.removeAttribute("handles"));
    },
    "attribute handles",
  );

  await harness.test("input::other_buttons_look_around_and_shift", async () => {
    await page.evaluate(() => (viewer.lights = []));
    const before = await camera();
    await drag(page, [30, 0], { button: "right" });
    const looked = await camera();
    same(looked.position, before.position, "where it stands");
    check(distance(looked.target, before.target) > 0.01, "it did not look around");
    await drag(page, [0, 30], { button: "middle" });
    const shifted = await camera();
    const [a, b] = [distance(shifted.position, looked.position), distance(shifted.target, looked.target)];
    check(a > 0.01 && Math.abs(a - b) < 1e-6, `shifted by ${a} and ${b}`);
  });

  await harness.test("input::keys_fly", async () => {
    const before = await camera();
    await page.evaluate(() => viewer.focus());
    await page.keyboard.down("w");
    await page.evaluate(async (from) => until(() => Math.hypot(...viewer.camera.position.map((x, i) => x - from[i])) > 0.05), before.position);
    await page.keyboard.up("w");
    await page.evaluate(() => still());
    const forward = before.target.map((x, i) => x - before.position[i]);
    const moved = (await camera()).position.map((x, i) => x - before.position[i]);
    const cosine = moved.reduce((sum, x, i) => sum + x * forward[i], 0) / (Math.hypot(...moved) * Math.hypot(...forward));
    check(cosine > 0.99, `it went ${moved}, not ${forward}`);
  });

  await harness.test("input::keys_act_wherever_the_focus_is_in_the_element", async () => {
    const html = '<rebounce-viewer src="scene.rbn" controls></rebounce-viewer>';
    const { page } = await loaded(context, html, { viewport: { width: 640, height: 360 } });
    const place = () => page.evaluate(() => JSON.stringify(viewer.camera.position));
    /** Holds a key until the view has moved; where none is to be seen, until frames that were asked for have been drawn. */
    const moves = async (key, expected) => {
      const before = await place();
      await page.keyboard.down(key);
      if (expected) await page.evaluate(async (from) => until(() => JSON.stringify(viewer.camera.position) !== from), before);
      else await page.evaluate(() => pause(400));
      await page.keyboard.up(key);
      await page.evaluate(() => still());
      return (await place()) !== before;
    };
    const first = await page.evaluate(() => viewer.camera.position);
    equal(await moves("w", false), false, "without the focus");
    await page.evaluate(() => (viewer.interaction = "all"));
    equal(await moves("w", true), true, "without the focus, in a viewer that fills its page");
    await page.mouse.click(20, 300);
    await page.keyboard.press("Escape");
    equal(await moves("s", true), true, "after Escape");
    await page.evaluate(() => (viewer.interaction = "auto"));
    await page.getByText("Lights and settings").click();
    equal(await moves("d", true), true, "with the focus on the panel");
    await page.keyboard.press("r");
    same(await page.evaluate(() => viewer.camera.position), first, "where R brings it back to");
    await page.getByRole("button", { name: /^(Lamp|Spot) 1 (point|spot)/ }).click();
    await page.getByLabel("Name").focus();
    equal(await moves("w", false), false, "in a name");
    // The ring is seen: an outline within the picture.
    await page.evaluate(() => viewer.shadowRoot.querySelector("canvas").focus());
    const [style, offset] = await page.evaluate(() => {
      const { outlineStyle, outlineOffset } = getComputedStyle(viewer.shadowRoot.querySelector("canvas"));
      return [outlineStyle, outlineOffset];
    });
    same([style, offset], ["solid", "-3px"], "the ring");
    await page.close();
  });

  await harness.test(
    "input::the_wheel_and_a_finger_are_the_pages_where_it_says_so",
    async () => {
      // Something to scroll.
      await page.evaluate(() => {
        for (const { style } of [document.documentElement, document.body]) [style.overflow, style.height] = ["auto", "auto"];
        Object.assign(viewer.style, { display: "block", height: "180px" });
        document.body.append(Object.assign(document.createElement("div"), { style: "height: 4000px" }));
        scrollTo(0, 0);
      });
      const wheel = async (interaction, key) => {
        await page.evaluate((value) => {
          viewer.interaction = value;
          scrollTo(0, 0);
        }, interaction);
        const before = away(await camera());
        await page.mouse.move(160, 90);
        if (key) await page.keyboard.down(key);
        await page.mouse.wheel(0, 60);
        if (key) await page.keyboard.up(key);
        // One of the two happens, and the other one would, too, by a moment later.
        await page.evaluate((from) => until(() => {
          const { position, target } = viewer.camera;
          return scrollY > 0 || Math.abs(Math.hypot(...position.map((x, i) => x - target[i])) - from) > 1e-3;
        }), before);
        await page.evaluate(() => pause(300));
        const scrolled = await page.evaluate(() => scrollY);
        return { scrolled: scrolled > 0, zoomed: Math.abs(away(await camera()) - before) > 1e-3 };
      };
      same(await wheel("all"), { scrolled: false, zoomed: true }, "all");
      same(await wheel("page"), { scrolled: true, zoomed: false }, "page");
      same(await wheel("page", "Control"), { scrolled: false, zoomed: true }, "page, with Ctrl");
      await page.evaluate(() => viewer.shadowRoot.activeElement?.blur());
      same(await wheel("auto"), { scrolled: true, zoomed: false }, "auto, before it has the focus");
      same(await wheel("auto", "Control"), { scrolled: false, zoomed: true }, "auto, with Ctrl");
      await page.mouse.click(160, 90);
      same(await wheel("auto"), { scrolled: false, zoomed: true }, "auto, after a click");
      await page.keyboard.press("Escape");
      same(await wheel("auto"), { scrolled: true, zoomed: false }, "auto, after Escape");
      same(await wheel("none"), { scrolled: true, zoomed: false }, "none");
      const touch = () => page.evaluate(() => getComputedStyle(viewer.shadowRoot.querySelector("canvas")).touchAction);
      equal(await touch(), "auto", "fingers with none");
      await page.evaluate(() => ((viewer.interaction = "page"), scrollTo(0, 0)));
      equal(await touch(), "pan-y", "fingers with page");
      await page.evaluate(() => (viewer.interaction = "all"));
      equal(await touch(), "none", "fingers with all");
    },
    "attribute interaction",
  );

  await harness.test("input::with_none_the_picture_is_only_a_picture", async () => {
    await page.evaluate(() => {
      viewer.interaction = "none";
      scrollTo(0, 0);
    });
    const before = await middle(page);
    const view = await camera();
    await drag(page, [40, 10]);
    await page.evaluate(() => viewer.focus());
    await page.keyboard.press("w");
    await page.evaluate(() => pause(300));
    same([await light(), await camera()], [before, view], "light and camera");
    const [tabindex, label] = await page.evaluate(() => {
      const canvas = viewer.shadowRoot.querySelector("canvas");
      return [canvas.getAttribute("tabindex"), canvas.getAttribute("aria-label")];
    });
    same([tabindex, label], [null, "3D scene"], "tabindex, label");
    equal(faults.join("\n"), "", "faults");
  });
  await page.close();
}
