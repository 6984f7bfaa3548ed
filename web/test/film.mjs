// node test/film.mjs ADDRESS FOLDER: takes the frames of a film, in which one lamp moves along a closed path, into
// FOLDER as 000.png, 001.png, …. Fails if the scene does not load, or a frame is blank.

import { writeFile } from "node:fs/promises";
import path from "node:path";
import { HANGS, decode, launch, spread, within } from "./browser.mjs";
import { check } from "./harness.mjs";
import { PLAIN, loaded } from "./page/open.mjs";

/** Size of a frame, pixels. */
const SIZE = { width: 800, height: 450 };
/** Frames of the film, once around the path. */
const FRAMES = 60;
/** Share of the way from the camera to its target: radius of the circle on which a scene's own lamp moves. */
const RADIUS = 0.15;

/**
 * Views of scenes, by name. `lamp`: the only light, a spot; `keys`: where it is and which point it shines at, at even
 * times; `exposure`: EV relative to radiance 1.
 */
const TAKES = {
  apartment: {
    camera: { position: [5.3, 1.65, 3.1], target: [1.7, 0.85, 5.9], up: [0, 1, 0], yfov_deg: 60 },
    lamp: { type: "spot", outer_cone_deg: 76, inner_cone_deg: 20, intensity: 13, color: [1, 0.92, 0.8], radius: 0.05 },
    exposure: 1.75,
    keys: [
      { position: [2.75, 0.9, 5.0], aim: [2.6, 0, 4.9] }, // red rug
      { position: [2.45, 1.4, 4.9], aim: [2.0, 0.1, 4.8] },
      { position: [2.0, 1.75, 4.75], aim: [1.2, 0.3, 4.75] }, // high above the coffee table
      { position: [1.45, 1.25, 4.75], aim: [0.4, 0.75, 4.75] }, // blue sofa, white wall
      { position: [1.75, 1.5, 5.8], aim: [1.4, 0, 5.9] }, // brown floor at the window
      { position: [2.9, 1.2, 5.7], aim: [2.8, 0, 5.5] },
    ],
  },
};

/** Value of a closed Catmull-Rom spline through points; `t` from 0 to 1 is once around. */
function spline(points, t) {
  const whole = Math.floor(t * points.length);
  const u = t * points.length - whole;
  const [a, b, c, d] = [-1, 0, 1, 2].map((k) => points[(whole + k + points.length) % points.length]);
  const along = (i) =>
    b[i] + 0.5 * u * (c[i] - a[i] + u * (2 * a[i] - 5 * b[i] + 4 * c[i] - d[i] + u * (3 * (b[i] - c[i]) + d[i] - a[i])));
  return [0, 1, 2].map(along);
}

/** The lamp of a take at a time. */
function lampAt({ lamp, keys }, t) {
  const position = spline(keys.map((key) => key.position), t);
  const aim = spline(keys.map((key) => key.aim), t);
  return { ...lamp, position, direction: aim.map((x, i) => x - position[i]) };
}

/** The lights of a take, frame by frame, and which of them moves. */
function taken(take, frames) {
  return { selected: 0, lights: frames.map((t) => [lampAt(take, t)]) };
}

/** The scene's own lights, frame by frame, and the first lamp among them, which moves on a circle. */
function own({ lights, camera }, frames) {
  const selected = lights.findIndex(({ type }) => type !== "directional");
  check(selected >= 0, "the scene has no lamp to move");
  const radius = RADIUS * Math.hypot(...camera.target.map((x, i) => x - camera.position[i]));
  const [x, y, z] = lights[selected].position;
  const at = (t) => [x + radius * (Math.cos(2 * Math.PI * t) - 1), y, z + radius * Math.sin(2 * Math.PI * t)];
  const moved = (t) => lights.map((light, i) => (i === selected ? { ...light, position: at(t) } : light));
  return { selected, lights: frames.map(moved) };
}

/** Sets up the view; gives what moves, and the lights of all frames. */
async function prepare(page) {
  const scene = await page.evaluate(() => ({ name: viewer.stats().scene, lights: viewer.lights, camera: viewer.camera }));
  const frames = Array.from({ length: FRAMES }, (_, k) => k / FRAMES);
  const take = TAKES[scene.name];
  if (!take) return own(scene, frames);
  await page.evaluate(({ camera, exposure }) => Object.assign(viewer, { camera, exposure, autoExposure: false }), take);
  return taken(take, frames);
}

/** One frame, when no more is drawn of it: a PNG file. */
async function shoot(page, lights, selected) {
  const draw = page.evaluate(
    async ([lights, selected]) => {
      Object.assign(viewer, { lights, selectedLight: selected });
      await still();
    },
    [lights, selected],
  );
  await within("drawing a frame", draw);
  return page.screenshot({ timeout: 1000 * HANGS });
}

const [address, folder] = process.argv.slice(2);
if (!address || !folder) throw new Error("usage: node film.mjs ADDRESS FOLDER");

const browser = await launch();
try {
  const { page, faults } = await loaded({ browser, address }, PLAIN, { viewport: SIZE, media: { deviceScaleFactor: 1 } });
  const { selected, lights } = await prepare(page);
  for (const [k, list] of lights.entries()) {
    const png = await shoot(page, list, selected);
    const { mean, deviation } = spread(await decode(browser, png));
    check(deviation >= 4, `frame ${k} is blank (mean ${mean.toFixed(1)} of 255)`);
    await writeFile(path.join(folder, `${String(k).padStart(3, "0")}.png`), png);
    console.log(`frame ${k + 1} of ${lights.length}, mean brightness ${mean.toFixed(1)}`);
  }
  check(faults.length === 0, faults.join("\n"));
} finally {
  await browser.close();
}
