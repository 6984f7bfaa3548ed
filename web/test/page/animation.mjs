// Animations of lights: played, paused, sought, finished, and left alone by those who want less motion.

import { within } from "../browser.mjs";
import { check, equal, near, same } from "../harness.mjs";
import { loaded, open, outcome } from "./open.mjs";

const ANIMATIONS = [
  {
    name: "across",
    duration: 2,
    tracks: [
      { light: 0, property: "position", times: [0, 2], values: [-1, 4, -2, 1, 4, -2] },
      { light: 0, property: "intensity", times: [0, 1, 2], values: [10, 50, 10] },
    ],
  },
  { name: "short", duration: 0.4, tracks: [{ light: 0, property: "intensity", times: [0], values: [33], interpolation: "step" }] },
];

/** Puts the animations into the element of a page. */
const give = (page) => page.evaluate((list) => void (viewer.animations = list), ANIMATIONS);
const told = (page, type) => page.evaluate((wanted) => events.filter((event) => event.type === wanted).length, type);

/** Runs the tests. */
export async function animation(harness, context) {
  const { page, faults } = await loaded(context);

  await harness.test(
    "animation::seeking_sets_the_lights_of_a_moment",
    async () => {
      await give(page);
      const at = (time) =>
        page.evaluate((seconds) => {
          viewer.currentTime = seconds;
          return [viewer.currentTime, viewer.lights[0].position, viewer.lights[0].intensity, viewer.paused];
        }, time);
      same(await at(0.5), [0.5, [-0.5, 4, -2], 30, true], "at half a second");
      same(await at(9), [2, [1, 4, -2], 10, true], "past the end");
      same(await at(-1), [0, [-1, 4, -2], 10, true], "before the start");
      equal(await page.evaluate(() => viewer.duration), 2, "the duration");
      same(await page.evaluate(() => viewer.animations.map(({ name }) => name)), ["across", "short"], "animations");
      await within("light-change", page.evaluate(() => until(() => events.some(({ type }) => type === "light-change"))));
    },
    "property animations, property currentTime, property duration, property paused, event light-change",
  );

  await harness.test(
    "animation::playing_draws_frames_and_pausing_none",
    async () => {
      await page.evaluate(async () => {
        await still();
        viewer.play();
        const before = viewer.stats().frames;
        await until(() => viewer.stats().frames > before + 2 && viewer.currentTime > 0.2);
      });
      equal(await told(page, "play"), 1, "play events");
      const { time, after, frames, later } = await page.evaluate(async () => {
        viewer.pause();
        const time = viewer.currentTime;
        const frames = await still();
        await pause(1500);
        return { time, after: viewer.currentTime, frames, later: viewer.stats().frames };
      });
      equal(after, time, "the time while paused");
      equal(later, frames, "frames while paused");
      equal(await told(page, "pause"), 1, "pause events");
      // It goes on from there, and over the end to the start.
      await page.evaluate(async (time) => {
        viewer.play();
        let last = time;
        await until(() => {
          const back = viewer.currentTime < last;
          last = viewer.currentTime;
          return back;
        });
        viewer.pause();
      }, time);
      equal(await told(page, "finished"), 0, "finished events of an endless one");
    },
    "method play, method pause, event play, event pause",
  );

  await harness.test(
    "animation::the_last_repetition_finishes",
    async () => {
      const state = await page.evaluate(async () => {
        viewer.play({ name: "short", repetitions: 2 });
        const playing = !viewer.paused;
        await until(() => viewer.paused);
        return { playing, name: viewer.animationName, time: viewer.currentTime, light: viewer.lights[0].intensity };
      });
      same(state, { playing: true, name: "short", time: 0.4, light: 33 }, "in the end");
      equal(await told(page, "finished"), 1, "finished events");
      equal((await page.evaluate(() => events.find(({ type }) => type === "finished"))).name, "short", "its name");
      // Once more: from the start.
      const time = await page.evaluate(() => {
        viewer.play({ repetitions: 1 });
        return viewer.currentTime;
      });
      equal(time, 0, "the time after playing once more");
      await page.evaluate(() => until(() => viewer.paused));
    },
    "event finished, attribute animation-name",
  );

  await harness.test("animation::a_hand_on_an_animated_light_pauses_it", async () => {
    const found = await page.evaluate(async () => {
      viewer.animationName = "across";
      viewer.addLight({ type: "point", position: [0, 2, -1], intensity: 1 });
      const outcomes = [];
      const poke = async (index, change) => {
        viewer.play();
        const start = viewer.currentTime;
        await until(() => viewer.currentTime !== start);
        viewer.lights = viewer.lights.map((light, i) => (i === index ? { ...light, ...change } : light));
        const frames = viewer.stats().frames;
        await until(() => viewer.paused || viewer.stats().frames > frames + 2);
        outcomes.push(viewer.paused);
      };
      // What is not animated may be changed meanwhile.
      await poke(1, { intensity: 3 });
      await poke(0, { color: [1, 0, 0] });
      const kept = [viewer.lights[1].intensity, viewer.lights[0].color];
      await poke(0, { position: [0, 3, -1] });
      return { outcomes, kept, position: viewer.lights[0].position };
    });
    same(found.outcomes, [false, false, true], "paused");
    same(found.kept, [3, [1, 0, 0]], "what was changed meanwhile");
    same(found.position, [0, 3, -1], "where the hand left the light");
  });

  await harness.test("animation::a_moment_or_nothing_at_all_can_be_played", async () => {
    const found = await page.evaluate(async () => {
      const track = { light: 0, property: "intensity", times: [0], values: [4] };
      const play = async (duration, repetitions, ends) => {
        viewer.animations = [{ name: "short", duration, tracks: [track] }];
        viewer.play({ repetitions });
        for (let i = 0; i < 6; i += 1) await new Promise(requestAnimationFrame);
        if (ends) await until(() => viewer.paused);
        const { paused } = viewer;
        viewer.pause();
        return paused;
      };
      const outcomes = [await play(0, undefined, true), await play(1e-12), await play(1e-12, 3, true)];
      viewer.animations = [];
      viewer.play();
      return [...outcomes, viewer.paused, viewer.duration];
    });
    same(found, [true, false, true, true, 0], "paused after no time, ever again, three times, without one; the duration");
  });

  await harness.test("animation::dragging_a_handle_pauses_it", async () => {
    const paused = await page.evaluate(async () => {
      // The light stays in the middle of the picture, where its handle is.
      const { target, position } = viewer.camera;
      const place = target.map((x, i) => position[i] + 0.6 * (x - position[i]));
      viewer.animations = [{ name: "stay", duration: 60, tracks: [{ light: 0, property: "position", times: [0], values: place }] }];
      viewer.currentTime = 0;
      viewer.lights = viewer.lights.slice(0, 1);
      await still();
      viewer.play();
      await until(() => viewer.currentTime > 0);
      return viewer.paused;
    });
    equal(paused, false, "paused before");
    await page.mouse.move(160, 90);
    await page.mouse.down();
    await page.mouse.move(190, 100, { steps: 3 });
    await page.mouse.up();
    await within("a pause", page.evaluate(() => until(() => viewer.paused)));
    equal(faults.join("\n"), "", "faults");
  });
  await page.close();

  const auto = '<rebounce-viewer autoplay animation-name="across"></rebounce-viewer>';
  const start = async (media) => {
    const { page } = await open(context, { html: auto, media });
    await give(page);
    await page.evaluate(() => (viewer.src = "scene.rbn"));
    equal((await outcome(page)).type, "load", "the event");
    return page;
  };
  await harness.test(
    "animation::autoplay_begins_by_itself",
    async () => {
      const page = await start();
      await within("time", page.evaluate(() => until(() => viewer.currentTime > 0 && !viewer.paused)));
      await page.close();
    },
    "attribute autoplay, attribute animation-name",
  );
  await harness.test("animation::autoplay_does_not_begin_for_those_who_want_less_motion", async () => {
    const page = await start({ reducedMotion: "reduce" });
    await page.evaluate(() => pause(800));
    same(await page.evaluate(() => [viewer.paused, viewer.currentTime]), [true, 0], "paused, at");
    equal(await told(page, "play"), 0, "play events");
    // A play that is asked for begins.
    await page.evaluate(async () => {
      viewer.play();
      await until(() => viewer.currentTime > 0);
    });
    await page.close();
  });

  await harness.test("animation::the_files_own_animations_and_a_play_before_loading", async () => {
    const { page } = await open(context, { html: "<rebounce-viewer></rebounce-viewer>" });
    await page.evaluate(async (list) => {
      const { Viewer } = await import("./rebounce_viewer.js");
      Viewer.prototype.animations = () => list;
      viewer.play({ name: "short", repetitions: 1 });
      viewer.src = "scene.rbn";
      await until(() => events.some(({ type }) => type === "finished"));
    }, ANIMATIONS);
    const [count, intensity] = await page.evaluate(() => [viewer.animations.length, viewer.lights[0].intensity]);
    equal(count, 2, "animations");
    near(intensity, 33, 1e-9, "the light");
    check(await page.evaluate(() => viewer.paused), "it goes on after its end");
    await page.close();
  });

  await harness.test("animation::a_day_can_be_played", async () => {
    const { page } = await loaded(context);
    const found = await page.evaluate(async () => {
      const { dayCycle, sun } = await import("./daylight.js");
      const place = { latitude: 50, day: 172, scale: 1e-3 };
      viewer.lights = [];
      viewer.addLight(sun({ ...place, hour: 0 }));
      viewer.animations = [dayCycle({ ...place, duration: 24 })];
      const at = (hour) => {
        viewer.currentTime = hour;
        const [{ direction, intensity }] = viewer.lights;
        return { direction, intensity, duration: viewer.duration };
      };
      viewer.play();
      await until(() => viewer.currentTime > 0);
      viewer.pause();
      return [at(0), at(12)];
    });
    const [night, noon] = found;
    equal(night.intensity, 0, "the sun at midnight");
    check(noon.intensity > 50 && noon.direction[1] < -0.8, `the sun at noon: ${JSON.stringify(noon)}`);
    equal(noon.duration, 24, "the duration");
    await page.close();
  });
}
