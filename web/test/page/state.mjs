// The state as SHOT.json and as a link.

import { readFile, writeFile } from "node:fs/promises";
import path from "node:path";
import { exec } from "../agreement.mjs";
import { DEVICE_PIXELS } from "../browser.mjs";
import { check, equal, same } from "../harness.mjs";
import { loaded, open, outcome } from "./open.mjs";

const SHOT = {
  camera: { position: [0.4, 2.9, 3.2], target: [-0.2, 2.3, -3], up: [0, 1, 0], yfov_deg: 65 },
  lights: [
    { type: "spot", position: [-1.2, 4.6, -2.2], direction: [-0.8, -1, 0.1], outer_cone_deg: 40, inner_cone_deg: 30, intensity: 150, color: [1, 0.9, 0.8] },
    { type: "point", position: [1, 2, -1], intensity: 12.5, color: [1, 1, 1] },
  ],
};
const IN_LINK = '<rebounce-viewer src="scene.rbn" state-in-link></rebounce-viewer>';

/** Runs the tests. */
export async function state(harness, context) {
  const { page, faults } = await loaded(context);
  let link = "";

  await harness.test(
    "state::a_shot_is_what_the_command_renders",
    async () => {
      const shot = await page.evaluate((given) => {
        viewer.shot = given;
        return viewer.shot;
      }, SHOT);
      same(shot.camera, SHOT.camera, "the camera");
      same(shot.lights, SHOT.lights, "the lights");
      same(shot.size, [320, 180].map((side) => side * DEVICE_PIXELS), "the size");
      const file = path.join(context.work, "state.json");
      await writeFile(file, JSON.stringify({ ...shot, size: [16, 9] }));
      await exec(context.rebounce, ["render", context.baked, "--shot", file, "-o", `${file}.png`, "--spp", "1"]);
      check((await readFile(`${file}.png`)).length > 100, "no picture");
    },
    "property shot",
  );

  await harness.test(
    "state::a_link_brings_the_state_to_another_page",
    async () => {
      link = await page.evaluate(() => {
        viewer.exposure = 0.5;
        viewer.mode = "indirect";
        return viewer.stateLink();
      });
      check(link.startsWith(`${context.address}#camera=0.4,2.9,3.2,`), link);
      check(link.endsWith("&light=point,1,2,-1,12.5,1,1,1&exposure=0.5&mode=indirect"), link);
      const { page: other } = await open(context, { html: IN_LINK, query: new URL(link).hash });
      equal((await outcome(other)).type, "load", "the event");
      const there = await other.evaluate(() => [viewer.camera, viewer.lights, viewer.exposure, viewer.mode]);
      same(there, [SHOT.camera, SHOT.lights, 0.5, "indirect"], "the state there");
      // Another hash in the same page, as a link in the page sets it.
      await other.evaluate(async () => {
        location.hash = "light=none&camera=0,1,4,0,1,0,0,1,0,50";
        await until(() => viewer.lights.length === 0);
      });
      same(await other.evaluate(() => [viewer.camera.position, viewer.exposure]), [[0, 1, 4], 0], "the state of the new hash");
      // A damaged one is told of, and the picture stays.
      await other.evaluate(async () => {
        location.hash = "camera=1,2,x";
        await until(() => events.some(({ type }) => type === "error"));
      });
      same(
        await other.evaluate(() => [viewer.loaded, viewer.camera.position, events.find(({ type }) => type === "error").code]),
        [true, [0, 1, 4], "bad-json"],
        "after a damaged hash",
      );
      await other.close();
    },
    "method stateLink, attribute state-in-link",
  );

  await harness.test(
    "state::a_link_is_taken_over_when_asked",
    async () => {
      const found = await page.evaluate((address) => {
        viewer.lights = [];
        viewer.removeAttribute("mode");
        const before = viewer.lights.length;
        return [viewer.restoreState(address), before, viewer.lights.length, viewer.mode, viewer.restoreState("#elsewhere")];
      }, link);
      same(found, [true, 0, 2, "indirect", false], "restored, lights before, after, the mode, another link");
    },
    "method restoreState",
  );

  await harness.test("state::without_the_attribute_the_address_says_nothing", async () => {
    const { page: other } = await open(context, { html: '<rebounce-viewer src="scene.rbn"></rebounce-viewer>', query: new URL(link).hash });
    equal((await outcome(other)).type, "load", "the event");
    equal(await other.evaluate(() => viewer.lights.length), 1, "lights");
    await other.close();
  });

  await harness.test("state::elements_with_an_id_keep_apart", async () => {
    const found = await page.evaluate(() => {
      viewer.id = "left & right";
      const own = viewer.stateLink();
      const taken = viewer.restoreState(own);
      viewer.id = "other";
      return { own, taken, other: viewer.restoreState(own) };
    });
    check(found.own.includes("#left%20%26%20right.camera="), found.own);
    same([found.taken, found.other], [true, false], "taken by itself, by another");
    equal(faults.join("\n"), "", "faults");
  });
  await page.close();
}
