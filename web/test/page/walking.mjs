// The camera inside and outside: look and walk, or orbit; walls; the on-screen stick; the first view.

import { check, equal, same } from "../harness.mjs";
import { loaded } from "./open.mjs";

/** In the box, above its blocks, seen to the back wall. */
const INSIDE = { position: [0, 4.2, -2.6], target: [0, 4.2, -5], up: [0, 1, 0], yfov_deg: 60 };

const distance = (a, b) => Math.hypot(...a.map((x, i) => x - b[i]));

/** Sets a camera and waits until the element has drawn with it. */
const stand = (page, camera) =>
  page.evaluate(async (value) => {
    viewer.camera = value;
    await still();
  }, camera);

/** Drags over a place without handles. */
async function drag(page, [x, y], button = "left") {
  await page.mouse.move(60, 40);
  await page.mouse.down({ button });
  await page.mouse.move(60 + x, 40 + y, { steps: 3 });
  await page.mouse.up({ button });
  await page.evaluate(() => still());
}

/** A finger on the middle of the stick, moved by so many CSS pixels; `meanwhile` runs before it is lifted. */
async function push(page, [x, y], meanwhile) {
  const box = await page.evaluate(() => {
    const { left, top, width, height } = viewer.shadowRoot.querySelector(".stick").getBoundingClientRect();
    return { x: left + width / 2, y: top + height / 2 };
  });
  const session = await page.context().newCDPSession(page);
  const touch = (type, points) => session.send("Input.dispatchTouchEvent", { type, touchPoints: points });
  await touch("touchStart", [{ x: box.x, y: box.y }]);
  await touch("touchMove", [{ x: box.x + x, y: box.y + y }]);
  await meanwhile();
  await touch("touchEnd", []);
  await page.evaluate(() => still());
}

/** Runs the tests. */
export async function walking(harness, context) {
  const { page, faults } = await loaded(context);
  const camera = () => page.evaluate(() => viewer.camera);
  const first = await camera();

  await harness.test(
    "walking::inside_a_drag_looks_around_and_outside_it_orbits",
    async () => {
      const keeps = async (place, controls) => {
        await page.evaluate((value) => ((viewer.lights = []), (viewer.cameraControls = value)), controls);
        await stand(page, place);
        await drag(page, [20, 10]);
        const { position, target } = await camera();
        await page.evaluate(() => viewer.removeAttribute("camera-controls"));
        return { position: distance(position, place.position) < 1e-9, target: distance(target, place.target) < 1e-9 };
      };
      const [looks, orbits] = [{ position: true, target: false }, { position: false, target: true }];
      same(await keeps(first, "auto"), orbits, "before the open box");
      same(await keeps(INSIDE, "auto"), looks, "in the box");
      same(await keeps(first, "look"), looks, "before it, told to look");
      same(await keeps({ ...INSIDE, target: [0, 4.2, -3] }, "orbit"), orbits, "in it, told to orbit");
    },
    "attribute camera-controls, property cameraControls",
  );

  await harness.test("walking::keys_walk_at_one_height_until_a_wall", async () => {
    await stand(page, { ...INSIDE, target: [0, 3.7, -5] });
    await page.evaluate(() => viewer.focus());
    await page.keyboard.down("w");
    // It comes near the back wall, and stands there though the key is held.
    await page.evaluate(async () => {
      let before = NaN;
      await until(async () => {
        const z = viewer.camera.position[2];
        const stands = z < -5 && Math.abs(z - before) < 1e-4;
        before = z;
        await pause(300);
        return stands;
      });
    });
    await page.keyboard.up("w");
    const { position } = await camera();
    same([position[0], position[1]], [0, 4.2], "aside and height");
    check(position[2] > -5.6 && position[2] < -5, `it stands at ${position[2]}`);
  });

  await harness.test("walking::the_wheel_walks_inside", async () => {
    await stand(page, INSIDE);
    await page.mouse.move(160, 90);
    await page.mouse.wheel(0, -200);
    await page.evaluate(async () => (await until(() => viewer.camera.position[2] < -2.7), await still()));
    const { position, target } = await camera();
    same([position[0], position[1]], [0, 4.2], "aside and height");
    check(Math.abs(position[2] - target[2] - 2.4) < 1e-6, "what is looked at goes along");
  });

  await harness.test(
    "walking::the_first_view_comes_back_by_key_and_by_script",
    async () => {
      const cameras = await page.evaluate(() => viewer.cameras);
      same(cameras, [{ name: cameras[0].name, camera: first }], "the file's cameras");
      check(cameras[0].name.length > 0, "a camera without a name");
      await stand(page, INSIDE);
      await page.evaluate(() => viewer.resetView());
      same(await camera(), first, "after resetView()");
      await stand(page, INSIDE);
      await page.evaluate(() => viewer.focus());
      await page.keyboard.press("r");
      same(await camera(), first, "after R");
      const lights = await page.evaluate(() => viewer.lights);
      await page.evaluate(([view, lamps]) => (viewer.shot = { camera: view, lights: lamps }), [INSIDE, lights]);
      await drag(page, [20, 10]);
      await page.evaluate(() => viewer.resetView());
      same(await camera(), INSIDE, "a shot's view");
    },
    "method resetView, property cameras",
  );

  await harness.test("walking::escape_takes_a_drag_back", async () => {
    await stand(page, first);
    await page.mouse.move(60, 40);
    await page.mouse.down();
    await page.mouse.move(100, 60, { steps: 3 });
    check(distance((await camera()).position, first.position) > 0.01, "nothing was dragged");
    await page.keyboard.press("Escape");
    same(await camera(), first, "after Escape");
    await page.mouse.move(140, 80, { steps: 3 });
    await page.mouse.up();
    same(await camera(), first, "the pointer goes on, let go of");
    equal(faults.join("\n"), "", "faults");
  });

  await harness.test("walking::a_stick_walks_where_there_are_fingers", async () => {
    const shown = (on) =>
      on.evaluate(() => {
        const stick = viewer.shadowRoot.querySelector(".stick");
        return stick !== null && getComputedStyle(stick).display !== "none";
      });
    await stand(page, INSIDE);
    check(!(await shown(page)), "a stick without fingers");
    const { page: phone } = await loaded(context, undefined, { media: { hasTouch: true, isMobile: true } });
    await phone.evaluate(() => until(() => viewer.shadowRoot.querySelector(".stick")));
    check(!(await shown(phone)), "a stick outside");
    await stand(phone, INSIDE);
    check(!(await shown(phone)), "a stick in what is not yet tapped, where it would keep the page from scrolling");
    await phone.evaluate(() => viewer.focus());
    check(await shown(phone), "no stick inside");
    const { width, height, label } = await phone.evaluate(() => {
      const stick = viewer.shadowRoot.querySelector(".stick");
      return { ...stick.getBoundingClientRect().toJSON(), label: stick.getAttribute("aria-label") };
    });
    check(width >= 44 && height >= 44 && /walk/i.test(label), `${width} × ${height}, “${label}”`);
    await push(phone, [0, -60], () => phone.evaluate(() => until(() => viewer.camera.position[2] < -2.7)));
    const { position } = await phone.evaluate(() => viewer.camera);
    same([position[0], position[1]], [0, 4.2], "aside and height");
    await phone.evaluate(() => pause(300));
    same((await phone.evaluate(() => viewer.camera)).position, position, "where it stands, let go");
    // By keys alone, a step at a time.
    await phone.evaluate(() => viewer.shadowRoot.querySelector(".stick").focus());
    await phone.keyboard.press("Enter");
    check((await phone.evaluate(() => viewer.camera)).position[2] < position[2] - 0.01, "no step");
    await phone.evaluate(() => (viewer.interaction = "none"));
    check(!(await shown(phone)), "a stick on what is only a picture");
    await phone.close();
  }, "part stick");
  await page.close();
}
