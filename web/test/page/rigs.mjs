// Skins and morph targets in the page: silhouettes are those of three.js, pictures those of files that the command has posed.

import { readFile, writeFile } from "node:fs/promises";
import path from "node:path";
import { serve } from "../../bench/pages.mjs";
import { exec } from "../agreement.mjs";
import { HANGS, within } from "../browser.mjs";
import { binary } from "../gltf.mjs";
import { check, equal, same } from "../harness.mjs";
import { loaded } from "./open.mjs";

const SIZE = [64, 48];
/** Pixels of three.js a side for each pixel compared: as many samples as the page takes. */
const FINER = 8;
/** The most that silhouettes may differ, RMS of the share that is covered: other samples at edges. */
const EDGES = 0.04;
/** Moments of the file's two animations, seconds. */
const MOMENTS = [["bend", 0.4], ["bend", 1], ["bend", 1.6], ["sway", 0.3], ["sway", 0.8]];
const ROWS = 9;

/** A strip that two joints bend, and a triangle with two morph targets, before a camera and a lamp: a .gltf of its own. */
export function figure() {
  const { add, members } = binary();
  const floats = (list, type, more) => add(new Float32Array(list), type, more);
  const rows = Array.from({ length: ROWS }, (_, row) => (2 * row) / (ROWS - 1));
  const both = (of) => rows.flatMap((y) => [...of(y, -0.2), ...of(y, 0.2)]);
  const share = (y) => Math.min(Math.max(2 * (y - 0.75), 0), 1);
  const strip = {
    attributes: {
      POSITION: floats(both((y, x) => [x, y, 0]), "VEC3", { min: [-0.2, 0, 0], max: [0.2, 2, 0] }),
      NORMAL: floats(both(() => [0, 0, 1]), "VEC3"),
      JOINTS_0: add(new Uint16Array(both(() => [0, 1, 0, 0])), "VEC4"),
      WEIGHTS_0: floats(both((y) => [1 - share(y), share(y), 0, 0]), "VEC4"),
    },
    indices: add(new Uint32Array(rows.slice(1).flatMap((_, row) => [0, 1, 3, 0, 3, 2].map((i) => i + 2 * row))), "SCALAR"),
    material: 0,
  };
  const triangle = {
    attributes: {
      POSITION: floats([-1.3, 0.2, 0, -0.5, 0.2, 0, -0.9, 1, 0], "VEC3", { min: [-1.3, 0.2, 0], max: [-0.5, 1, 0] }),
      NORMAL: floats([0, 0, 1, 0, 0, 1, 0, 0, 1], "VEC3"),
    },
    targets: [[0, 0, 0, 0, 0, 0, 0.3, 0.8, 0], [-0.2, 0.3, 0, 0.1, -0.4, 0, 0, 0, 0]].map((moves) => ({
      POSITION: floats(moves, "VEC3", { min: [-0.2, -0.4, 0], max: [0.3, 0.8, 0] }),
    })),
    indices: add(new Uint32Array([0, 1, 2]), "SCALAR"),
    material: 0,
  };
  const identity = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];
  const below = identity.with(13, -1);
  const turn = (degrees) => [0, 0, Math.sin((degrees * Math.PI) / 360), Math.cos((degrees * Math.PI) / 360)];
  const keys = floats([0, 1, 2], "SCALAR", { min: [0], max: [2] });
  const pair = floats([0, 1], "SCALAR", { min: [0], max: [1] });
  const animation = (name, channels) => ({
    name,
    samplers: channels.map(([, , input, output, interpolation = "LINEAR"]) => ({ input, output, interpolation })),
    channels: channels.map(([node, path], sampler) => ({ sampler, target: { node, path } })),
  });
  const still = [0, 0, 0];
  const animations = [
    animation("bend", [
      [2, "rotation", keys, floats([...turn(0), ...turn(100), ...turn(-60)], "VEC4")],
      [3, "weights", keys, floats([0, 0, 1, 0, 0.25, 1], "SCALAR")],
    ]),
    animation("sway", [
      // In-tangents, values and out-tangents of two keys.
      [1, "translation", pair, floats([...still, 0, 0, 0, 1, 0.5, 0, -1, 0.5, 0, 0.4, 0.2, 0, ...still], "VEC3"), "CUBICSPLINE"],
      [1, "scale", pair, floats([1, 1, 1, 1.5, 0.7, 1], "VEC3"), "STEP"],
    ]),
  ];
  return JSON.stringify({
    asset: { version: "2.0" },
    scenes: [{ nodes: [0, 1, 3, 4, 5] }],
    nodes: [
      { mesh: 0, skin: 0, name: "strip" },
      { name: "hip", children: [2] },
      { name: "chest", translation: [0, 1, 0] },
      { mesh: 1, name: "flag" },
      { camera: 0, translation: [0, 1, 4], name: "camera" },
      { translation: [1.5, 2, 3], name: "lamp", extensions: { KHR_lights_punctual: { light: 0 } } },
    ],
    meshes: [{ primitives: [strip] }, { primitives: [triangle], weights: [0, 0] }],
    skins: [{ joints: [1, 2], inverseBindMatrices: floats([...identity, ...below], "MAT4") }],
    materials: [{ doubleSided: true, pbrMetallicRoughness: { baseColorFactor: [0.8, 0.6, 0.4, 1], metallicFactor: 0 } }],
    cameras: [{ type: "perspective", perspective: { yfov: 0.8, aspectRatio: SIZE[0] / SIZE[1], znear: 0.1, zfar: 100 } }],
    animations,
    extensionsUsed: ["KHR_lights_punctual"],
    extensions: { KHR_lights_punctual: { lights: [{ type: "point", intensity: 100, color: [1, 1, 1] }] } },
    ...members(),
  });
}

/** RMS of differences. */
const apart = (a, b) => Math.sqrt(a.reduce((sum, x, i) => sum + (x - b[i]) ** 2, 0) / a.length);

/** Runs the tests. */
export async function rigs(harness, context) {
  const file = (name) => path.join(context.work, name);
  await writeFile(file("figure.gltf"), figure());
  const bake = async (name, ...options) => {
    await exec(context.rebounce, ["bake", file("figure.gltf"), "--preset", "draft", "--functions", "500", "-o", file(name), ...options]);
    return readFile(file(name));
  };
  const body = await bake("figure.rbn");
  const shown = async (body) => {
    const routes = { "**/figure.rbn": (route) => route.fulfill({ body, contentType: "application/octet-stream" }) };
    const prepare = () => {
      globalThis.at = (name, time) => {
        viewer.animationName = name;
        viewer.currentTime = time;
      };
      globalThis.covered = async (width, height) => Array.from(await viewer.readIndirect(width, height)).filter((_, i) => i % 4 === 3);
    };
    return loaded(context, '<rebounce-viewer src="figure.rbn" auto-exposure="off" backdrop="none"></rebounce-viewer>', { routes, prepare });
  };
  const { page, faults } = await shown(body);

  await harness.test("rigs::animations_of_skins_and_morph_targets_are_listed", async () => {
    const listed = await page.evaluate(() => viewer.animations.map(({ name, duration, tracks }) => [name, duration, tracks.map(({ node, property, times, values }) => [node, property, times, values])]));
    same(listed, [["bend", 2, [["bend", "pose", [0, 2], [0, 2]]]], ["sway", 1, [["sway", "pose", [0, 1], [0, 1]]]]], "the animations");
  });

  await harness.test("rigs::silhouettes_are_those_of_three_js", async () => {
    const server = await serve({ "/figure.gltf": file("figure.gltf") });
    const other = await context.browser.newPage({ viewport: { width: 320, height: 240 } });
    other.setDefaultTimeout(1000 * HANGS);
    try {
      await other.goto(new URL("/test/exported.html", server.address).href);
      await within("three.js", other.waitForFunction(() => globalThis.shown));
      const rest = await page.evaluate((size) => covered(...size), SIZE);
      for (const [name, time] of MOMENTS) {
        const ours = await page.evaluate(([name, time, size]) => (at(name, time), covered(...size)), [name, time, SIZE]);
        const draw = other.evaluate(([name, time, size, finer]) => shown.silhouette("/figure.gltf", name, time, size, finer), [name, time, SIZE, FINER]);
        const theirs = await within("a picture", draw);
        console.log(`    ${name} at ${time}: apart by ${apart(ours, theirs)}, from rest by ${apart(ours, rest)}`);
        check(apart(ours, theirs) < EDGES, `${name} at ${time} differs by ${apart(ours, theirs)}`);
        check(apart(ours, rest) > 3 * EDGES, `${name} at ${time} is as at rest`);
      }
    } finally {
      await other.close();
      server.close();
    }
  });

  await harness.test("rigs::a_pose_is_lit_as_a_file_baked_in_that_pose", async () => {
    const [name, time] = MOMENTS[0];
    const posed = await shown(await bake("posed.rbn", "--animation", name, "--time", String(time)));
    same(await posed.page.evaluate(() => viewer.animations), [], "a fixed pose has no animation");
    const read = ([size, camera]) => {
      Object.assign(viewer, { camera, mode: "direct" });
      return viewer.readPixels(...size).then((pixels) => Array.from(pixels));
    };
    await page.evaluate(([name, time]) => at(name, time), [name, time]);
    const camera = await page.evaluate(() => viewer.camera);
    const [ours, theirs] = [await page.evaluate(read, [SIZE, camera]), await posed.page.evaluate(read, [SIZE, camera])];
    const bright = theirs.filter((_, i) => i % 4 < 3).reduce((sum, x) => sum + x, 0);
    check(bright > 1000, "the picture is dark");
    check(apart(ours, theirs) < 4, `they differ by ${apart(ours, theirs)} of 255`);
    equal(posed.faults.join("\n"), "", "faults");
    await posed.page.close();
  });

  await harness.test("rigs::a_shot_is_of_a_moment_of_an_animation_or_at_rest", async () => {
    const found = await page.evaluate(async ([[name, time], size]) => {
      const { camera, lights } = viewer.shot;
      const of = (moment) => ((viewer.shot = { camera, lights, ...moment }), covered(...size));
      at(name, time);
      const played = await covered(...size);
      const told = viewer.shot;
      const rest = await of({});
      const refused = (moment) => {
        try {
          viewer.shot = { camera, lights, ...moment };
        } catch ({ code, message }) {
          return `${code}: ${message}`;
        }
        return "";
      };
      const named = await of({ animation: name, time });
      return {
        played,
        rest,
        named,
        told,
        numbered: await of({ animation: "1", time: 0.5 }),
        second: viewer.shot,
        first: (await of({ time }), viewer.shot),
        wrong: [{ animation: "fly" }, { animation: name, time: "late" }].map(refused),
        none: (await of({}), viewer.shot),
      };
    }, [MOMENTS[0], SIZE]);
    const [name, time] = MOMENTS[0];
    same([found.told.animation, found.told.time], [name, time], "the shot of what is played");
    check(apart(found.named, found.played) < 1e-3, "the shot is not the moment that was played");
    check(apart(found.rest, found.played) > EDGES, "without one it is not at rest");
    check(apart(found.numbered, found.rest) > EDGES, "the second animation does not move it");
    same([found.second.animation, found.second.time], ["sway", 0.5], "an animation by its number");
    same([found.first.animation, found.first.time], ["bend", time], "the first one");
    check(found.wrong[0].includes("bad-json") && found.wrong[0].includes("bend, sway"), found.wrong[0]);
    check(found.wrong[1].includes("bad-json") && found.wrong[1].includes("time"), found.wrong[1]);
    check(!("animation" in found.none) && !("time" in found.none), "at rest there is none");
    equal(faults.join("\n"), "", "faults");
  });

  await harness.test("rigs::it_plays_and_stands_again_where_it_was", async () => {
    const found = await page.evaluate(async (size) => {
      viewer.animationName = "bend";
      viewer.currentTime = 0;
      const before = await covered(...size);
      viewer.play({ repetitions: 1 });
      await until(() => viewer.paused);
      const end = await covered(...size);
      viewer.currentTime = 0;
      return { before, end, after: await covered(...size), told: events.filter(({ type }) => ["play", "finished"].includes(type)).map(({ type }) => type) };
    }, SIZE);
    same(found.told, ["play", "finished"], "what is told");
    check(apart(found.end, found.before) > EDGES, "at its end it stands elsewhere");
    check(apart(found.after, found.before) < 1e-3, "and at its beginning as before");
    equal(faults.join("\n"), "", "faults");
  });
  await page.close();
}
