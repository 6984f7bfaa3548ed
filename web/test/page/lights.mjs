// Lights that come and go, by script.

import { check, equal, same } from "../harness.mjs";
import { loaded } from "./open.mjs";

/** Runs the tests. */
export async function lights(harness, context) {
  const { page, faults } = await loaded(context);

  await harness.test(
    "lights::are_added_and_removed",
    async () => {
      const found = await page.evaluate(async () => {
        const lamp = (x) => ({ type: "point", position: [x, 3, -2], intensity: 1, color: [1, 1, 1] });
        viewer.lights = [lamp(0)];
        viewer.animations = [{ name: "a", duration: 1, tracks: [{ light: 0, property: "intensity", times: [0], values: [5] }] }];
        const places = [viewer.addLight(lamp(1)), viewer.addLight(lamp(2), 0), viewer.addLight(lamp(3), 1)];
        const order = viewer.lights.map(({ position }) => position[0]);
        const track = viewer.animations[0].tracks[0].light;
        const removed = viewer.removeLight(track);
        return { places, order, track, removed, left: viewer.lights.length, tracks: viewer.animations[0].tracks.length };
      });
      same(found.places, [1, 0, 1], "places");
      same(found.order, [2, 3, 0, 1], "the order");
      equal(found.track, 2, "the light that its track follows");
      same(found.removed.position, [0, 3, -2], "the one removed");
      same([found.left, found.tracks], [3, 0], "lights left, tracks left");
    },
    "method addLight, method removeLight, property lights",
  );

  await harness.test("lights::a_light_more_is_a_brighter_picture", async () => {
    const [before, after] = await page.evaluate(async () => {
      const sum = async () => (await viewer.readIndirect(32, 18)).reduce((a, b) => a + b, 0);
      const before = await sum();
      viewer.addLight({ type: "spot", position: [0, 4, -2], direction: [0, -1, 0], outer_cone_deg: 50, intensity: 50 });
      return [before, await sum()];
    });
    check(after > before * 1.1, `${before} before, ${after} after`);
  });

  await harness.test("lights::a_size_is_kept_and_softens_shadows", async () => {
    const found = await page.evaluate(async () => {
      const { mode, camera } = viewer;
      viewer.mode = "direct";
      // Down onto the floor, where the blocks' shadows end.
      viewer.camera = { position: [0, 4.6, -0.4], target: [0, 0.3, -3.2], yfov_deg: 60 };
      const lit = async (radius) => {
        const size = radius === undefined ? {} : { radius };
        viewer.lights = [{ type: "point", position: [-1.5, 4.5, -1.5], intensity: 20, color: [1, 1, 1], ...size }];
        return { pixels: await viewer.readPixels(96, 54), radius: viewer.lights[0].radius };
      };
      const [sharp, again, soft] = [await lit(), await lit(0), await lit(0.4)];
      const differing = (a, b) => a.pixels.filter((value, i) => Math.abs(value - b.pixels[i]) > 16).length;
      viewer.lights = [{ type: "directional", direction: [0, -1, 0], intensity: 1, color: [1, 1, 1], radius_deg: 0.27 }];
      const sun = viewer.lights;
      let refused = "";
      try {
        viewer.lights = [{ type: "point", position: [0, 3, -2], intensity: 1, radius: -1 }];
      } catch (error) {
        refused = error.code;
      }
      Object.assign(viewer, { mode, camera });
      const radii = [sharp, soft].map(({ radius }) => radius);
      return { radii, same: differing(sharp, again), softer: differing(sharp, soft), sun, refused };
    });
    same(found.radii, [undefined, 0.4], "radii");
    equal(found.sun[0].radius_deg, 0.27, "the sun's");
    equal(found.same, 0, "numbers that differ without a size");
    // Of 96 x 54 pixels, three a pixel.
    check(found.softer > 200, `${found.softer} numbers differ`);
    equal(found.refused, "bad-argument", "a negative one");
  });

  await harness.test("lights::sixteen_of_them_work", async () => {
    const found = await page.evaluate(async () => {
      viewer.lights = [];
      for (let i = 0; i < 16; i += 1) {
        const position = [((i % 4) - 1.5) * 1.1, 4.5, -1 - (i >> 2)];
        const color = [1, i % 2, i % 3 ? 1 : 0];
        const light = [
          { type: "point", position, intensity: 5, color },
          { type: "spot", position, direction: [0, -1, 0], outer_cone_deg: 30, intensity: 20, color },
          { type: "directional", direction: [0.2, -1, -0.5], intensity: 0.1, color },
        ][i % 3];
        viewer.addLight(light);
      }
      await still();
      const each = [];
      const sum = async () => (await viewer.readIndirect(16, 9)).reduce((a, b) => a + b, 0);
      const all = await sum();
      const { lights } = viewer;
      // Each of the inner ones does its part.
      for (const dark of [0, 7, 15]) {
        viewer.lights = lights.map((light, i) => (i === dark ? { ...light, intensity: 0 } : light));
        each.push(all - (await sum()));
      }
      return { count: viewer.lights.length, stats: viewer.stats().lights, each };
    });
    same([found.count, found.stats], [16, 16], "lights");
    check(found.each.every((part) => part > 0), `parts of three lights: ${found.each}`);
    equal(faults.join("\n"), "", "faults");
  });

  await harness.test(
    "lights::camera_and_lights_tell_of_changes",
    async () => {
      const found = await page.evaluate(async () => {
        await still();
        events.length = 0;
        viewer.camera = { ...viewer.camera, position: [0, 3, 4] };
        await until(() => events.length === 1);
        viewer.lights = viewer.lights.slice(0, 2);
        await until(() => events.length === 2);
        return events.map(({ type, camera, lights }) => [type, camera?.position, lights?.length]);
      });
      same(found, [["camera-change", [0, 3, 4], null], ["light-change", null, 2]], "events");
    },
    "event camera-change, event light-change, property camera",
  );
  await page.close();
}
