// Undo and redo: a hand's changes are steps, a script's and an animation's are none.

import { check, equal, same } from "../harness.mjs";
import { loaded } from "./open.mjs";

const CONTROLS = '<rebounce-viewer src="scene.rbn" controls></rebounce-viewer>';
const LAMP = { type: "point", position: [0, 3, -2], intensity: 5, color: [1, 1, 1] };

/** Runs the tests. */
export async function history(harness, context) {
  const { page, faults } = await loaded(context, CONTROLS, { viewport: { width: 640, height: 360 } });
  const state = () =>
    page.evaluate(() => {
      const { camera, lights, animations } = viewer;
      return { camera, lights, animations, mix: viewer.mix, settings: ["exposure", "mode", "overlay"].map((name) => viewer.getAttribute(name)) };
    });
  /** Does something with a hand, takes it back and does it again; `steps` is how many there are. */
  const law = async (what, work, steps = 1) => {
    const before = await state();
    await work();
    await page.evaluate(() => still());
    const after = await state();
    check(JSON.stringify(before) !== JSON.stringify(after), `${what} changes nothing`);
    const times = (way) => page.evaluate(([way, steps]) => Array.from({ length: steps }, () => viewer[way]()), [way, steps]);
    same(await times("undo"), Array(steps).fill(true), `${what}: steps to undo`);
    same(await state(), before, `${what}: the state after undo`);
    same(await times("redo"), Array(steps).fill(true), `${what}: steps to redo`);
    same(await state(), after, `${what}: the state after redo`);
  };
  await page.evaluate((lamp) => void (viewer.lights = [lamp]), LAMP);

  await harness.test(
    "history::undo_gives_the_state_before_a_gesture_and_redo_the_one_after",
    async () => {
      equal(await page.evaluate(() => viewer.undo() || viewer.redo()), false, "whether a script's change is a step");
      const drag = async (from, to, options) => {
        await page.mouse.move(...from);
        await page.mouse.down(options);
        await page.mouse.move(...to, { steps: 4 });
        await page.mouse.up(options);
      };
      await law("orbiting", () => drag([100, 250], [160, 240]));
      await law("looking around", () => drag([100, 250], [120, 250], { button: "right" }));
      await law("flying", async () => {
        await page.evaluate(() => viewer.shadowRoot.querySelector("canvas").focus());
        const before = await page.evaluate(() => viewer.camera.position);
        await page.keyboard.down("d");
        await page.evaluate((from) => until(() => viewer.camera.position.some((x, i) => x !== from[i])), before);
        await page.keyboard.up("d");
      });
      await law("the wheel", () =>
        page.evaluate(() => {
          const turn = () => new WheelEvent("wheel", { deltaY: 80, clientX: 100, clientY: 250, bubbles: true, cancelable: true });
          for (let i = 0; i < 3; i += 1) viewer.shadowRoot.querySelector("canvas").dispatchEvent(turn());
        }),
      );
      // A light in the middle of the picture, where its handle is.
      await page.evaluate(async () => {
        const { position, target } = viewer.camera;
        viewer.lights = [{ ...viewer.lights[0], position: target.map((x, i) => position[i] + 0.6 * (x - position[i])) }];
        await still();
      });
      const { camera } = await state();
      await law("dragging a light", () => drag([320, 180], [350, 190]));
      same((await state()).camera, camera, "the camera of who drags a light");
    },
    "method undo, method redo",
  );

  await page.getByText("Lights and settings").click();
  for (const title of ["Picture", "Camera"]) await page.getByText(title, { exact: true }).click();
  const button = (name) => page.getByRole("button", { name, exact: true });

  await harness.test("history::what_the_panel_changes_are_steps", async () => {
    await law("adding", () => button("Add spot").click());
    // Done again, it is chosen again with the next frame.
    await page.evaluate(() => still());
    equal(await page.getByRole("button", { name: "Spot 2 spot" }).getAttribute("aria-expanded"), "true", "whether it is chosen");
    await law("a number that is typed", async () => {
      await page.getByLabel("Intensity, in the unit").click();
      await page.keyboard.press("Control+a");
      await page.keyboard.type("123.5");
      await page.keyboard.press("Enter");
    });
    await law("a drag of a slider", async () => {
      const fader = page.getByRole("slider", { name: "Spot 2 strength" });
      await fader.scrollIntoViewIfNeeded();
      const box = await fader.boundingBox();
      await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
      await page.mouse.down();
      await page.mouse.move(box.x + 0.6 * box.width, box.y + box.height / 2, { steps: 5 });
      await page.mouse.move(box.x + 0.7 * box.width, box.y + box.height / 2, { steps: 5 });
      await page.mouse.up();
    });
    await law("two keys on a slider", async () => {
      await page.getByRole("slider", { name: "Colour temperature" }).focus();
      await page.keyboard.press("ArrowLeft");
      await page.keyboard.press("ArrowLeft");
    }, 2);
    await law("a switch", () => page.getByRole("switch").first().click());
    await law("keys on an entry", async () => {
      await page.getByRole("button", { name: "Spot 2 spot" }).focus();
      await page.keyboard.press("ArrowUp");
    });
    await law("aiming", () => button("Aim where the camera looks").click());
    await law("a setting", () => page.getByLabel("Indirect", { exact: true }).check());
    await law("exposure", () => page.getByRole("slider", { name: "Exposure" }).fill("1.5"));
    await page.evaluate(() => {
      for (const name of ["mode", "exposure"]) viewer.removeAttribute(name);
    });
  });

  await harness.test("history::a_light_that_is_removed_comes_back_with_its_animation", async () => {
    await page.evaluate(() => {
      const track = { light: 1, property: "intensity", times: [0, 1], values: [3, 4] };
      viewer.animations = [{ name: "a", duration: 1, tracks: [track] }];
    });
    await law("removing", async () => {
      await page.getByRole("button", { name: "Spot 2 spot" }).focus();
      await page.keyboard.press("Delete");
    });
    await page.evaluate(() => viewer.undo());
    equal(await page.evaluate(() => viewer.animations[0].tracks[0].light), 1, "the light of the track");
  });

  await harness.test("history::keys_and_buttons_undo_and_redo_but_not_while_text_is_typed", async () => {
    const count = () => page.evaluate(() => viewer.lights.length);
    await page.evaluate((lamp) => void (viewer.lights = [lamp]), LAMP);
    await button("Add lamp").click();
    await page.evaluate(() => viewer.shadowRoot.querySelector("canvas").focus());
    for (const [undo, redo] of [["Control+z", "Control+Shift+z"], ["Control+z", "Control+y"], ["Meta+z", "Meta+Shift+z"]]) {
      await page.keyboard.press(undo);
      equal(await count(), 1, `lights after ${undo}`);
      await page.keyboard.press(redo);
      equal(await count(), 2, `lights after ${redo}`);
    }
    await page.getByRole("button", { name: "Lamp 1 point" }).focus();
    await page.keyboard.press("Control+z");
    equal(await count(), 1, "lights after the key on the panel");
    check(!(await button("Redo").isDisabled()), "redo is offered");
    await button("Redo").click();
    equal(await count(), 2, "lights after the button");
    check(await button("Redo").isDisabled(), "nothing is left to redo");
    await button("Undo").click();
    equal(await count(), 1, "lights after the other button");
    equal(await page.getByRole("status").textContent(), "Undone: lights.", "what is said");
    await button("Redo").click();
    await page.getByRole("button", { name: "Lamp 1 point" }).click();
    await page.getByLabel("Name").focus();
    await page.keyboard.press("Control+z");
    equal(await count(), 2, "lights after the key in a field of text");
  });

  await harness.test("history::scripts_and_animations_are_no_steps_and_a_hundred_are_kept", async () => {
    const found = await page.evaluate(async () => {
      while (viewer.undo());
      viewer.lights = viewer.lights.map((light) => ({ ...light, intensity: 77 }));
      viewer.camera = { ...viewer.camera, yfov_deg: 44 };
      viewer.exposure = 2;
      const script = viewer.undo();
      viewer.exposure = 0;
      const track = { light: 0, property: "intensity", times: [0, 1], values: [3, 4] };
      viewer.animations = [{ name: "a", duration: 0.1, tracks: [track] }];
      viewer.play({ repetitions: 1 });
      await until(() => events.some(({ type }) => type === "finished"));
      const animation = viewer.undo();
      const [unit] = viewer.shadowRoot.querySelectorAll("[aria-label=Exposure]");
      for (let i = 1; i <= 120; i += 1) {
        unit.value = (i % 50) / 10;
        for (const type of ["input", "change"]) unit.dispatchEvent(new Event(type, { bubbles: true }));
      }
      let steps = 0;
      while (viewer.undo()) steps += 1;
      return { script, animation, steps, exposure: viewer.exposure };
    });
    same(found, { script: false, animation: false, steps: 100, exposure: 2 }, "undone");
    // What is done anew after undoing takes the place of what was undone.
    await page.evaluate(() => viewer.redo());
    await button("Add lamp").click();
    check(await button("Redo").isDisabled(), "the old way is offered still");
  });

  await harness.test("history::another_scene_has_none_of_it", async () => {
    await page.evaluate(async () => {
      const seen = events.filter(({ type }) => type === "load").length;
      viewer.reload();
      await until(() => events.filter(({ type }) => type === "load").length > seen);
    });
    equal(await page.evaluate(() => viewer.undo()), false, "whether there is a step");
    equal(faults.join("\n"), "", "faults");
  });
  await page.close();
}
