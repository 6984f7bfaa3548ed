// Nodes that move: listed, moved by script, hand and keyframes; what computes bounced light then, and what is told.

import { readFile, writeFile } from "node:fs/promises";
import path from "node:path";
import { agreement, exec } from "../agreement.mjs";
import { within } from "../browser.mjs";
import { binary } from "../gltf.mjs";
import { check, equal, near, same } from "../harness.mjs";
import { loaded } from "./open.mjs";

const SIZE = [64, 36];
/** Relative RMS and bias against the command: draft points, and shadow maps in place of rays. */
const TOLERANCE = { error: 0.05, bias: 0.015 };
const CAMERA = { position: [0, 1.4, 1.9], target: [0, 0.8, -1], up: [0, 1, 0], yfov_deg: 60 };
const LIGHTS = [{ type: "point", position: [0.9, 1.7, 0.6], intensity: 6, color: [1, 0.9, 0.8] }];
/** Where the block is, and its half size. */
const BLOCK = { at: [-0.5, 0.4, -0.6], half: [0.25, 0.4, 0.25] };

/** The corners and faces of a box; `inward` faces look to its middle. */
function box([x, y, z], inward) {
  const corner = (i) => [i & 1 ? x : -x, i & 2 ? y : -y, i & 4 ? z : -z];
  const faces = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
  const positions = faces.flatMap((face) => face.flatMap(corner));
  const indices = faces.flatMap((_, f) => (inward ? [0, 2, 1, 0, 3, 2] : [0, 1, 2, 0, 2, 3]).map((i) => 4 * f + i));
  return { positions, indices };
}

/** A closed room with a block on its floor, whose keyframes shift and turn it: a .gltf of its own. */
export function roomWithBlock() {
  const { add, members } = binary();
  const meshes = [[[2, 1, 2], true], [BLOCK.half, false]].map(([half, inward], material) => {
    const { positions, indices } = box(half, inward);
    const range = { min: half.map((x) => -x), max: half };
    return { primitives: [{ attributes: { POSITION: add(new Float32Array(positions), "VEC3", range) }, indices: add(new Uint32Array(indices), "SCALAR"), material }] };
  });
  const times = add(new Float32Array([0, 2]), "SCALAR", { min: [0], max: [2] });
  const [shift, turn] = [add(new Float32Array([...BLOCK.at, BLOCK.at[0] + 1, ...BLOCK.at.slice(1)]), "VEC3"), add(new Float32Array([0, 0, 0, 1, 0, 1, 0, 0]), "VEC4")];
  const material = (color) => ({ pbrMetallicRoughness: { baseColorFactor: [...color, 1], metallicFactor: 0 } });
  return JSON.stringify({
    asset: { version: "2.0" },
    scenes: [{ nodes: [0, 1] }],
    nodes: [{ mesh: 0, name: "room", translation: [0, 1, 0] }, { mesh: 1, name: "block", translation: BLOCK.at }],
    meshes,
    materials: [material([0.7, 0.7, 0.7]), material([0.8, 0.2, 0.1])],
    animations: [{ name: "slide", channels: [{ sampler: 0, target: { node: 1, path: "translation" } }, { sampler: 1, target: { node: 1, path: "rotation" } }], samplers: [{ input: times, output: shift }, { input: times, output: turn }] }],
    ...members(),
  });
}

/** In the page: what is told of nodes, and pictures. */
function helpers() {
  for (const type of ["node-change", "solver-change"]) document.addEventListener(type, (event) => events.push({ type, ...event.detail }), true);
  globalThis.told = (type) => events.filter((event) => event.type === type);
  globalThis.light = async () => Array.from(await viewer.readIndirect(48, 27)).filter((_, i) => i % 4 < 3);
  globalThis.apart = (a, b) => {
    const squares = (list) => list.reduce((total, x) => total + x * x, 0);
    return Math.sqrt(squares(a.map((x, i) => x - b[i])) / squares(b));
  };
  globalThis.settled = () => until(() => !viewer.stats().solving);
}

/** A place of world space in the picture, CSS pixels. */
function seen([x, y, z], [width, height]) {
  const { position, target, yfov_deg } = CAMERA;
  const sub = (a, b) => a.map((v, i) => v - b[i]);
  const dot = (a, b) => a.reduce((sum, v, i) => sum + v * b[i], 0);
  const cross = ([a, b, c], [d, e, f]) => [b * f - c * e, c * d - a * f, a * e - b * d];
  const unit = (v) => v.map((w) => w / Math.hypot(...v));
  const forward = unit(sub(target, position));
  const right = unit(cross(forward, [0, 1, 0]));
  const up = cross(right, forward);
  const away = sub([x, y, z], position);
  const scale = height / 2 / Math.tan((yfov_deg * Math.PI) / 360) / dot(away, forward);
  return [width / 2 + dot(away, right) * scale, height / 2 - dot(away, up) * scale];
}

/** Runs the tests. */
export async function nodes(harness, context) {
  const file = (name) => path.join(context.work, name);
  await writeFile(file("block.gltf"), roomWithBlock());
  const bake = async (name, ...options) => {
    await exec(context.rebounce, ["bake", file("block.gltf"), "--preset", "draft", "--functions", "700", ...options, "-o", file(name)]);
    return readFile(file(name));
  };
  const bodies = { "points.rbn": await bake("points.rbn", "--solver", "radiosity"), "links.rbn": await bake("links.rbn", "--group", "block") };
  const routes = Object.fromEntries(Object.entries(bodies).map(([name, body]) => [`**/${name}`, (route) => route.fulfill({ body, contentType: "application/octet-stream" })]));
  const opened = async (name, attributes = "") => {
    const { page, faults } = await loaded(context, `<rebounce-viewer src="${name}" ${attributes}></rebounce-viewer>`, { routes, prepare: helpers, media: { deviceScaleFactor: 1 } });
    await page.evaluate((shot) => (viewer.shot = shot), { camera: CAMERA, lights: LIGHTS });
    return { page, faults };
  };

  const { page, faults } = await opened("points.rbn");
  await harness.test(
    "nodes::a_node_is_listed_and_moved_and_its_light_is_that_of_the_command",
    async () => {
      same(await page.evaluate(() => Object.entries(viewer.nodes).map(([name, { translation, rotation }]) => [name, translation, rotation])), [["room", [0, 0, 0], [0, 0, 0, 1]], ["block", [0, 0, 0], [0, 0, 0, 1]]], "the nodes");
      const before = await page.evaluate(() => light());
      const move = { block: { translation: [0.8, 0.3, 0.2], rotation_y_deg: 40 } };
      const { difference } = await agreement(page, { ...context, baked: file("points.rbn") }, "nodes moved", { camera: CAMERA, lights: LIGHTS, move }, SIZE, 2);
      console.log(`    ${JSON.stringify(difference)}`);
      check(difference.error < TOLERANCE.error && Math.abs(difference.bias) < TOLERANCE.bias, "it is the command's");
      check((await page.evaluate(async (b) => apart(await light(), b), before)) > 0.1, "and another than before");
      await page.evaluate(() => until(() => told("node-change").length > 0));
      same(await page.evaluate(() => told("node-change").at(-1).nodes.block.translation), [0.8, 0.3, 0.2], "what is told");
      const shot = await page.evaluate(() => viewer.shot.move);
      same([Object.keys(shot), shot.block.translation], [["block"], [0.8, 0.3, 0.2]], "the shot");
      near(shot.block.rotation[1], Math.sin((20 * Math.PI) / 180), 1e-9, "its turn");
      await page.evaluate(() => (viewer.nodes.block.translation = [0, 0, 0]));
      await page.evaluate(() => (viewer.nodes = { block: { rotation: [0, 0, 0, 1] } }));
      check((await page.evaluate(async (b) => apart(await light(), b), before)) < 1e-6, "put back, the light is what it was");
      equal(await page.evaluate(() => viewer.shot.move), undefined, "a shot in which nothing has moved");
    },
    "property nodes, event node-change",
  );

  await harness.test("nodes::what_is_no_motion_is_refused_with_a_sentence", async () => {
    const failures = await page.evaluate(() => {
      const attempts = [
        () => (viewer.nodes.block.translation = [0, 1]),
        () => (viewer.nodes.block.rotation = [0, 0, 0, 0]),
        () => (viewer.nodes.block.translation = [0, NaN, 0]),
        () => (viewer.shot = { ...viewer.shot, move: { chair: {} } }),
        () => (viewer.shot = { ...viewer.shot, move: { block: { translation: "up" } } }),
      ];
      return attempts.map((attempt) => {
        try {
          attempt();
        } catch ({ code, message }) {
          return [code, message];
        }
      });
    });
    same(failures.map(([code]) => code), ["bad-json", "bad-argument", "bad-argument", "bad-json", "bad-json"], `the codes (${JSON.stringify(failures)})`);
    check(failures[3][1].includes("room, block"), failures[3][1]);
    same(await page.evaluate(() => viewer.nodes.block.translation), [0, 0, 0], "and nothing has moved");
  });

  await harness.test("nodes::a_hand_moves_and_turns_a_node_and_undo_puts_it_back", async () => {
    const [x, y] = seen(BLOCK.at, [320, 180]);
    await page.mouse.move(x, y);
    await page.mouse.down();
    await page.mouse.move(x + 60, y, { steps: 4 });
    await page.mouse.up();
    const place = await page.evaluate(() => viewer.nodes.block.translation);
    check(place[0] > 0.3 && place[1] === 0, `dragged over the floor: ${place}`);
    const [to] = seen(BLOCK.at.map((v, i) => v + place[i]), [320, 180]);
    near(to, x + 60, 1, "it is under the pointer");
    // The knob is at the right of its ring.
    const ring = (180 / 75 < 5 ? 5 : 180 / 75) * 3.2;
    await page.mouse.move(x + 60 + ring, y);
    await page.mouse.down();
    for (let step = 1; step <= 6; step += 1) {
      const angle = (step * Math.PI) / 12;
      await page.mouse.move(x + 60 + 2 * ring * Math.cos(angle), y - 2 * ring * Math.sin(angle));
    }
    await page.mouse.up();
    const turn = await page.evaluate(() => viewer.nodes.block.rotation);
    near(2 * Math.atan2(turn[1], turn[3]), Math.PI / 2, 0.15, "a quarter turn, counterclockwise from above");
    const about = await page.evaluate(() => viewer.nodes.block.translation);
    check(about.every((v, i) => Math.abs(v - place[i]) < 1e-6), "about its middle");
    same(await page.evaluate(() => [viewer.undo(), viewer.nodes.block.rotation]), [true, [0, 0, 0, 1]], "undo of the turn");
    same(await page.evaluate(() => [viewer.undo(), viewer.nodes.block.translation]), [true, [0, 0, 0]], "undo of the drag");
    await page.evaluate(() => viewer.redo());
    same(await page.evaluate(() => viewer.nodes.block.translation), place, "redo");
    await page.evaluate(() => viewer.undo());
  });

  await harness.test("nodes::a_link_brings_what_has_moved_and_puts_back_what_has_not", async () => {
    const found = await page.evaluate(() => {
      const rest = viewer.stateLink();
      Object.assign(viewer.nodes.block, { translation: [0.25, 0, -0.5], rotation: [0, 1, 0, 0] });
      const moved = viewer.stateLink();
      viewer.restoreState(rest);
      const { translation } = viewer.nodes.block;
      viewer.restoreState(moved);
      const block = [...viewer.nodes.block.translation, ...viewer.nodes.block.rotation];
      viewer.restoreState(rest);
      return { rest: rest.includes("node="), moved: moved.includes("&node=0.25,0,-0.5,0,1,0,0,block"), translation, block };
    });
    same(found, { rest: false, moved: true, translation: [0, 0, 0], block: [0.25, 0, -0.5, 0, 1, 0, 0] }, "links");
  });

  await harness.test("nodes::keyframes_of_nodes_play_and_a_hand_stops_them", async () => {
    same(await page.evaluate(() => viewer.animations.map(({ name, duration, tracks }) => [name, duration, tracks.map(({ node, property }) => [node, property])])), [["slide", 2, [["block", "translation"], ["block", "rotation"]]]], "the file's");
    const half = await page.evaluate(() => {
      viewer.currentTime = 1;
      return viewer.nodes.block;
    });
    check(Math.abs(half.translation[0] - 0.5) < 1e-5 && Math.abs(half.rotation[1] - Math.SQRT1_2) < 1e-5, JSON.stringify(half));
    await page.evaluate(async () => {
      viewer.play({ repetitions: 1 });
      await until(() => viewer.nodes.block.translation[0] > 0.6);
      viewer.nodes.block.translation = [0, 0, 0];
      await until(() => viewer.paused);
      viewer.nodes = { block: { translation: [0, 0, 0], rotation: [0, 0, 0, 1] } };
    });
    check(await page.evaluate(() => viewer.currentTime < 2), "it stood before its end");
  });

  await harness.long("nodes::a_thousand_moves_leave_memory_flat_and_light_settles_to_that_of_a_fresh_solve", async () => {
    await page.evaluate(() => settled());
    const found = await within("a drag", page.evaluate(async () => {
      // Pictures of different sizes come and go.
      const bytes = () => Object.entries(viewer.stats().bytes).reduce((sum, [of, n]) => sum + (of === "picture" ? 0 : n), 0);
      const [before, frames] = [bytes(), viewer.stats().frames];
      for (let step = 1; step <= 1000; step += 1) {
        viewer.nodes.block.translation = [0.8 * Math.sin(step / 50), 0, 0.3];
        if (step % 20 === 0) await new Promise((done) => requestAnimationFrame(done));
      }
      await settled();
      await still();
      const mine = await light();
      viewer.nodes.block.translation = [0, 0, 0];
      await light();
      viewer.nodes.block.translation = [0.8 * Math.sin(1000 / 50), 0, 0.3];
      return { grown: bytes() - before, frames: viewer.stats().frames - frames, apart: apart(mine, await light()) };
    }));
    console.log(`    ${JSON.stringify(found)}`);
    equal(found.grown, 0, "bytes on the GPU");
    check(found.frames > 10 && found.apart < 0.01, "it settles");
  });
  equal(faults.join("\n"), "", "faults");
  await page.close();

  await harness.test(
    "nodes::an_operator_gives_way_to_radiosity_while_something_is_moved_and_returns",
    async () => {
      const { page: linked, faults: seenFaults } = await opened("links.rbn");
      const solver = () => linked.evaluate(() => viewer.stats().solver);
      same([await solver(), await linked.evaluate(() => Object.keys(viewer.nodes))], ["operator", ["block"]], "as loaded");
      const before = await linked.evaluate(() => light());
      await linked.evaluate(() => (viewer.nodes.block.translation = [0.8, 0, 0.3]));
      equal(await solver(), "radiosity", "moved");
      check((await linked.evaluate(async (b) => apart(await light(), b), before)) > 0.1, "the light follows");
      await linked.evaluate(() => until(() => told("solver-change").length === 1));
      await linked.evaluate(() => viewer.setAttribute("solver", "operator"));
      equal(await solver(), "operator", "by force");
      await linked.evaluate(() => viewer.removeAttribute("solver"));
      await linked.evaluate(() => (viewer.nodes.block.translation = [0, 0, 0]));
      equal(await solver(), "operator", "put back");
      equal(await linked.evaluate(async (b) => apart(await light(), b), before), 0, "the same light");
      await linked.evaluate(() => (viewer.solver = "radiosity"));
      equal(await solver(), "radiosity", "as the attribute says");
      const other = await linked.evaluate(async (b) => apart(await light(), b), before);
      check(other > 0 && other < 0.2, `both ways come to about the same: ${other}`);
      await linked.evaluate(() => until(() => told("solver-change").at(-1)?.solver === "radiosity"));
      equal(seenFaults.join("\n"), "", "faults");
      await linked.close();
    },
    "attribute solver, property solver, event solver-change",
  );

  await harness.test("nodes::antiradiance_lights_what_moves_and_says_what_it_takes", async () => {
    const { page: linked, faults: seenFaults } = await opened("links.rbn");
    const of = (solver) =>
      linked.evaluate(async (solver) => {
        viewer.solver = solver;
        const found = await light();
        return { found, stats: viewer.stats() };
      }, solver);
    const apart = (a, b) => linked.evaluate(([a, b]) => globalThis.apart(a, b), [a, b]);
    const rest = await of("operator");
    equal(rest.stats.antiradiance, undefined, "what antiradiance takes where it is not at work");
    const still = await of("antiradiance");
    equal(still.stats.solver, "antiradiance", "as the attribute says");
    check((await apart(still.found, rest.found)) < 1e-6, "at rest it is not the operator's light");
    await linked.evaluate(() => (viewer.nodes.block.translation = [0.8, 0, 0.3]));
    const moved = await of("antiradiance");
    const traced = await of("radiosity");
    const { elements, links, bins, iterations } = moved.stats.antiradiance;
    console.log(`    ${elements} elements, ${links} links, ${bins} bins, ${iterations} steps`);
    check(elements > 50 && links > elements && bins === 256 && iterations >= 20, JSON.stringify(moved.stats.antiradiance));
    console.log(`    moved: apart by ${await apart(moved.found, traced.found)}, from rest by ${await apart(moved.found, still.found)}`);
    check((await apart(moved.found, traced.found)) < 0.25, "far from the light of rays");
    check((await apart(moved.found, still.found)) > 0.05, "the light does not follow");
    // And drawn frame by frame it comes to an end.
    await linked.evaluate(() => (viewer.solver = "antiradiance"));
    await linked.evaluate(() => (viewer.nodes.block.translation = [0.4, 0, 0.3]));
    check(await linked.evaluate(() => viewer.stats().solving), "nothing is on its way");
    await within("the light", linked.evaluate(() => settled()));
    // The panel has the choice.
    await linked.evaluate(() => (viewer.controls = true));
    await linked.getByText("Lights and settings").click();
    await linked.getByText("Picture", { exact: true }).click();
    await linked.getByRole("radio", { name: "Links" }).check();
    equal(await linked.evaluate(() => viewer.stats().solver), "operator", "what the panel has chosen");
    equal(seenFaults.join("\n"), "", "faults");
    await linked.close();
  });
}
