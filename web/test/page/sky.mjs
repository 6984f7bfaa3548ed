// A daylight sky by attribute: that it is the command's, follows the hour live, is turned, dimmed, unset, refused.

import { readFile, writeFile } from "node:fs/promises";
import path from "node:path";
import { agreement, exec } from "../agreement.mjs";
import { check, equal, near, same } from "../harness.mjs";
import { open, outcome } from "./open.mjs";

const SIZE = [48, 32];
/** Where the sky is seen behind the yard; and where nothing but the yard is, as the command's exposure is of surfaces alone. */
const FAR = { position: [3.5, 2.2, 3.5], target: [-0.6, 0.5, -0.6], up: [0, 1, 0], yfov_deg: 50 };
const CAMERA = { position: [1.6, 2.6, 1.6], target: [-0.4, 0, -0.4], up: [0, 1, 0], yfov_deg: 40 };
/** Two skies of which files are baked. */
const [NOON, EVENING] = ["48,172,11", "48,80,16.75"];

/** A yard: a floor, a red wall to the north and a white one to the west, open to the sky; as glTF. */
function yard() {
  const floor = [-2, 0, -2, -2, 0, 2, 2, 0, 2, 2, 0, -2];
  const north = [-2, 0, -2, 2, 0, -2, 2, 1.5, -2, -2, 1.5, -2];
  const west = [-2, 0, 2, -2, 0, -2, -2, 1.5, -2, -2, 1.5, 2];
  const positions = Buffer.from(new Float32Array([...floor, ...north, ...west]).buffer);
  const indices = Buffer.from(new Uint16Array([0, 1, 2, 0, 2, 3]).buffer);
  const uri = `data:application/octet-stream;base64,${Buffer.concat([positions, indices]).toString("base64")}`;
  const bounds = [[[-2, 0, -2], [2, 0, 2]], [[-2, 0, -2], [2, 1.5, -2]], [[-2, 0, -2], [-2, 1.5, 2]]];
  const accessor = ([min, max], i) => ({ bufferView: 0, byteOffset: 48 * i, componentType: 5126, count: 4, type: "VEC3", min, max });
  const material = (baseColorFactor) => ({ doubleSided: true, pbrMetallicRoughness: { baseColorFactor, metallicFactor: 0 } });
  return JSON.stringify({
    asset: { version: "2.0" },
    scene: 0,
    scenes: [{ nodes: [0] }],
    nodes: [{ mesh: 0 }],
    meshes: [{ primitives: [0, 1, 2].map((i) => ({ attributes: { POSITION: i }, indices: 3, material: i })) }],
    materials: [[0.5, 0.5, 0.5, 1], [0.7, 0.2, 0.1, 1], [0.8, 0.8, 0.8, 1]].map(material),
    accessors: [...bounds.map(accessor), { bufferView: 1, componentType: 5123, count: 6, type: "SCALAR" }],
    bufferViews: [{ buffer: 0, byteLength: 144 }, { buffer: 0, byteOffset: 144, byteLength: 12 }],
    buffers: [{ byteLength: 156, uri }],
  });
}

/** In the page: what it looks like, the sun, and how much two pictures differ. */
function helpers() {
  globalThis.pixels = async () => Array.from(await viewer.readPixels(48, 32));
  globalThis.total = async () => (await viewer.readPixels(24, 16)).reduce((a, b) => a + b, 0);
  globalThis.suns = () => viewer.lights.filter(({ type }) => type === "directional");
  globalThis.lit = (claim) => until(() => suns().some(claim));
  globalThis.mean = (a, b) => a.reduce((sum, x, i) => sum + Math.abs(x - b[i]), 0) / a.length;
}

/** Lights to five digits, without the sun's size: a file has none. */
const rounded = (lights) => lights.map(({ radius_deg, ...light }) => JSON.parse(JSON.stringify(light, (_, x) => (typeof x === "number" ? Number(x.toPrecision(5)) : x))));

/** Runs the tests. */
export async function sky(harness, context) {
  const gltf = path.join(context.work, "yard.gltf");
  await writeFile(gltf, yard());
  const files = {};
  for (const [name, hour] of Object.entries({ noon: NOON, evening: EVENING })) {
    files[name] = path.join(context.work, `yard-${name}.rbn`);
    await exec(context.rebounce, ["bake", gltf, "--preset", "draft", "--sky", hour, "-o", files[name]]);
  }
  const routes = {};
  for (const [name, file] of Object.entries(files)) {
    const body = await readFile(file);
    routes[`**/${name}.rbn`] = (route) => route.fulfill({ body, contentType: "application/octet-stream" });
  }
  const html = '<rebounce-viewer src="noon.rbn"></rebounce-viewer>';
  const { page, faults } = await open(context, { html, routes, prepare: helpers });
  equal((await outcome(page)).type, "load", "the event");

  await harness.test("sky::is_what_the_command_baked_into_the_file", async () => {
    const found = await page.evaluate(async ([camera, hour]) => {
      viewer.camera = camera;
      const before = { lights: viewer.lights, pixels: await pixels() };
      viewer.sky = hour;
      // The sun is already where it is to be: the picture comes with the module.
      await until(() => performance.getEntriesByName(new URL("sky.js", location.href).href).length > 0);
      await pause(500);
      await still();
      const after = { lights: viewer.lights, pixels: await pixels() };
      viewer.sky = "48,172,3";
      await lit(({ intensity }) => intensity === 0);
      const night = await pixels();
      viewer.removeAttribute("sky");
      await lit(({ intensity }) => intensity > 0);
      return { before, after, apart: mean(before.pixels, after.pixels), night: mean(before.pixels, night), back: mean(before.pixels, await pixels()), lights: viewer.lights };
    }, [FAR, NOON]);
    console.log(`    with the file's own ${found.apart.toFixed(3)} of 255, at night ${found.night.toFixed(1)}, unset ${found.back}`);
    same(rounded(found.after.lights), rounded(found.before.lights), "the lights");
    check(found.apart < 0.5 && found.night > 10, "another sky than the file's");
    same([found.lights, found.back], [found.before.lights, 0], "unset, it is as it was");
  });

  await harness.test(
    "sky::another_hour_is_what_the_command_renders",
    async () => {
      const shot = await page.evaluate(async ([camera, hour]) => {
        viewer.sky = hour;
        await lit(({ direction }) => direction[1] > -0.3);
        await still();
        viewer.shot = { camera, lights: viewer.lights };
        await still();
        return viewer.shot;
      }, [CAMERA, EVENING]);
      const json = path.join(context.work, "sky.json");
      await writeFile(json, JSON.stringify({ ...shot, size: SIZE }));
      const picture = path.join(context.work, "sky.png");
      await exec(context.rebounce, ["render", files.evening, "--shot", json, "-o", picture, "--spp", "64"]);
      const base64 = (await readFile(picture)).toString("base64");
      const [ours, theirs] = await page.evaluate(async ({ size, base64 }) => {
        const bytes = Uint8Array.from(atob(base64), (c) => c.charCodeAt(0));
        const bitmap = await createImageBitmap(new Blob([bytes], { type: "image/png" }), { colorSpaceConversion: "none" });
        const context = new OffscreenCanvas(...size).getContext("2d");
        context.drawImage(bitmap, 0, 0);
        return [await pixels(), Array.from(context.getImageData(0, 0, ...size).data)];
      }, { size: SIZE, base64 });
      const mean = (list) => list.reduce((sum, x) => sum + x, 0) / list.length;
      const difference = mean(ours.map((x, i) => Math.abs(x - theirs[i])));
      const tools = { ...context, baked: files.evening };
      const { difference: indirect } = await agreement(page, tools, "sky, indirect", { camera: CAMERA, lights: shot.lights }, SIZE, 2, 256, false);
      console.log(`    mean difference ${difference.toFixed(2)} of 255; indirect light ${JSON.stringify(indirect)}`);
      check(mean(theirs) > 10 && difference < 4, `${difference}`);
      check(indirect.error <= 0.01, `indirect light differs by ${indirect.error}`);
    },
    "attribute sky, property sky",
  );

  await harness.test("sky::follows_the_hour_live", async () => {
    const found = await page.evaluate(async () => {
      const loads = () => events.filter(({ type }) => type === "load").length;
      const before = { loads: loads(), lights: viewer.lights.length };
      const hours = [];
      for (const hour of [5, 9, 13, 17, 21]) {
        const [last] = suns()[0].direction;
        viewer.sky = `48,172,${hour}`;
        await lit(({ direction }) => direction[0] !== last);
        hours.push({ ...suns()[0], count: viewer.lights.length, total: await total() });
      }
      // As a slider is moved: only the last counts.
      for (let hour = 8; hour <= 14; hour += 0.5) viewer.sky = `48,172,${hour}`;
      await lit(({ direction, intensity }) => direction[0] > 0.4 && intensity > 60);
      const slid = suns()[0].direction;
      viewer.sky = "48,172,14";
      await pause(300);
      return { before, hours, slid, last: suns()[0].direction, loads: loads() };
    });
    equal(found.loads, found.before.loads, "loads");
    same(found.hours.map(({ count }) => count), found.hours.map(() => found.before.lights), "as many lights as before");
    const eastward = found.hours.map(({ direction }) => direction[0]);
    check(eastward[0] < -0.8 && eastward.at(-1) > 0.4, `from the east to the west: ${eastward}`);
    check(found.hours[2].intensity > 80 && found.hours.at(-1).intensity === 0, "up at one, down at nine in the evening");
    check(new Set(found.hours.map(({ total }) => total)).size === found.hours.length, "each hour looks different");
    same(found.slid, found.last, "the last hour of a slider");
  });

  await harness.test("sky::turns_and_dims_with_its_sun_and_goes_before_an_environment", async () => {
    const found = await page.evaluate(async () => {
      viewer.sky = "0,80,9";
      await lit(({ direction }) => direction[0] < -0.6 && Math.abs(direction[2]) < 0.1);
      const [level] = suns();
      viewer.environmentRotation = 90;
      const [turned] = suns();
      viewer.environmentIntensity = 0.25;
      const [dim] = suns();
      const sky = viewer.lights.find(({ type }) => type === "environment");
      viewer.environmentIntensity = 1;
      viewer.environmentRotation = 0;
      viewer.environment = "missing.hdr";
      await pause(300);
      return { level, turned, dim, sky, still: suns()[0], errors: events.filter(({ type }) => type === "error") };
    });
    // From +x, counterclockwise seen from above: to -z.
    const [x, y, z] = found.level.direction;
    for (const [i, expected] of [z, y, -x].entries()) near(found.turned.direction[i], expected, 1e-6, "the turned direction");
    near(found.dim.intensity, found.level.intensity / 4, 1e-4, "the dimmed sun");
    same([found.sky.rotation_deg, found.sky.intensity], [90, 0.25], "the sky");
    same(found.still, found.level, "with an environment besides");
    same(found.errors, [], "errors");
  });

  await harness.test("sky::what_is_no_sky_leaves_the_light_as_it_is", async () => {
    const before = await page.evaluate(async () => {
      viewer.removeAttribute("environment");
      viewer.sky = "48,172,12";
      await lit(({ intensity }) => intensity > 80);
      await pause(300);
      return [await total(), viewer.lights];
    });
    for (const bad of ["48,172", "48,172,15.5,3", "noon", "48,172,", "91,172,12", "48,0,12", "48,172,24.1", "48,NaN,12"]) {
      const found = await page.evaluate(async (bad) => {
        const seen = events.filter(({ type }) => type === "error").length;
        viewer.sky = bad;
        await until(() => events.filter(({ type }) => type === "error").length > seen);
        return { error: events.filter(({ type }) => type === "error").at(-1), after: [await total(), viewer.lights], loaded: viewer.loaded };
      }, bad);
      equal(found.error.code, "bad-environment", bad);
      check(found.error.message.includes(`“${bad}”`) && found.error.message.includes("48,172,15.5"), found.error.message);
      same([found.after, found.loaded], [before, true], bad);
    }
  });

  await harness.test("sky::stays_when_another_scene_comes", async () => {
    const found = await page.evaluate(async () => {
      viewer.sky = "48,172,12";
      await lit(({ intensity, direction }) => intensity > 80 && direction[1] < -0.85);
      const before = suns();
      const seen = events.length;
      viewer.src = "evening.rbn";
      await until(() => events.slice(seen).some(({ type }) => type === "load"));
      const after = suns();
      viewer.removeAttribute("sky");
      await lit(({ intensity }) => intensity < 80);
      return { before, after, own: suns() };
    });
    same(found.after, found.before, "the sun");
    near(found.own[0].direction[1], -0.20985, 1e-4, "the new scene's own sun, without the attribute");
  });
  equal(faults.join("\n"), "", "faults");
  await page.close();

  await harness.test("sky::an_attribute_of_the_page_lights_a_scene_without_one", async () => {
    const html = `<rebounce-viewer src="scene.rbn" sky="${NOON}"></rebounce-viewer>`;
    const { page, faults } = await open(context, { html, prepare: helpers });
    equal((await outcome(page)).type, "load", "the event");
    const found = await page.evaluate(async () => {
      await lit(({ name }) => name === "Sun");
      const added = viewer.lights;
      viewer.removeAttribute("sky");
      await until(() => suns().length === 0);
      return { added, left: viewer.lights };
    });
    same(found.added.slice(-2).map(({ type }) => type), ["environment", "directional"], "the lights added");
    same(found.left, found.added.slice(0, -2), "the lights that stay");
    equal(faults.join("\n"), "", "faults");
    await page.close();
  });
}
