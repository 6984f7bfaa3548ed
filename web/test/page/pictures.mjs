// A scene's picture looks the same whichever format it came in; transparent surfaces.

import { readFile, writeFile } from "node:fs/promises";
import path from "node:path";
import { fileURLToPath } from "node:url";
import { exec } from "../agreement.mjs";
import { launch, spread } from "../browser.mjs";
import { check, equal, same } from "../harness.mjs";
import { loaded } from "./open.mjs";

const SCENES = fileURLToPath(new URL("../../../baker/tests/gltf", import.meta.url));

/** Only direct light is looked at: little is baked. */
export const QUICK = "--preset draft --functions 1000 --levels 2 --sender-levels 2 --direct-levels 2".split(" ");

/** The pixels of a scene whose floor has a picture of this kind. */
async function pixels(context, name) {
  const baked = path.join(context.work, `${name}.rbn`);
  await exec(context.rebounce, ["bake", path.join(SCENES, `${name}.glb`), ...QUICK, "-o", baked]);
  const body = await readFile(baked);
  const html = `<rebounce-viewer src="${name}.rbn" mode="direct"></rebounce-viewer>`;
  const routes = { [`**/${name}.rbn`]: (route) => route.fulfill({ body }) };
  const { page, faults } = await loaded(context, html, { routes });
  const found = await page.evaluate(async () => {
    viewer.lights = [{ type: "point", position: [0, 4, 0], intensity: 60, color: [1, 1, 1] }];
    viewer.camera = { position: [0, 6, 5], target: [0, 0, 0], up: [0, 1, 0], yfov_deg: 60 };
    return Array.from(await viewer.readPixels(128, 72));
  });
  equal(faults.join("\n"), "", "faults");
  await page.close();
  return found;
}

/** A glTF file of horizontal squares that shine: height, half a side, colour, alpha (1: opaque). */
export function squares(list) {
  const positions = list.flatMap(([y, half]) => [-half, y, -half, -half, y, half, half, y, half, half, y, -half]);
  const bytes = Buffer.concat([Buffer.from(new Float32Array(positions).buffer), Buffer.from(new Uint16Array([0, 1, 2, 0, 2, 3]).buffer)]);
  const indices = list.length;
  return JSON.stringify({
    asset: { version: "2.0" },
    scene: 0,
    scenes: [{ nodes: list.map((_, i) => i) }],
    nodes: list.map((_, mesh) => ({ mesh })),
    meshes: list.map((_, i) => ({ primitives: [{ attributes: { POSITION: i }, indices, material: i }] })),
    materials: list.map(([, , emissiveFactor, alpha]) => ({
      emissiveFactor,
      doubleSided: true,
      pbrMetallicRoughness: { baseColorFactor: [0, 0, 0, alpha] },
      alphaMode: alpha < 1 ? "BLEND" : "OPAQUE",
    })),
    accessors: [
      ...list.map(([y, half], i) => {
        const [min, max] = [[-half, y, -half], [half, y, half]];
        return { bufferView: 0, byteOffset: 48 * i, componentType: 5126, count: 4, type: "VEC3", min, max };
      }),
      { bufferView: 1, componentType: 5123, count: 6, type: "SCALAR" },
    ],
    bufferViews: [
      { buffer: 0, byteLength: 4 * positions.length },
      { buffer: 0, byteOffset: 4 * positions.length, byteLength: 12 },
    ],
    buffers: [{ byteLength: bytes.length, uri: `data:application/octet-stream;base64,${bytes.toString("base64")}` }],
  });
}

/** Squares of so many triangles along a side that copies of them are kept once. */
const FINE = 24;

/** A glTF file of a dark floor and 8 x 8 tiles over it that shine, all of one mesh, every other one turned. */
function tiles() {
  const side = [...Array(FINE + 1).keys()].map((i) => (2 * i) / FINE - 1);
  const grid = new Float32Array([-6, 0, -6, -6, 0, 6, 6, 0, 6, 6, 0, -6, ...side.flatMap((x) => side.flatMap((z) => [x, 0, z]))]);
  const squares = [...Array(FINE * FINE).keys()].map((i) => Math.floor(i / FINE) * (FINE + 1) + (i % FINE));
  const indices = new Uint16Array([0, 1, 2, 0, 2, 3, ...squares.flatMap((a) => [a, a + 1, a + FINE + 2, a, a + FINE + 2, a + FINE + 1])]);
  const bytes = Buffer.concat([Buffer.from(grid.buffer), Buffer.from(indices.buffer)]);
  const mesh = (k, material) => ({ primitives: [{ attributes: { POSITION: 2 * k }, indices: 2 * k + 1, material }] });
  const accessors = [[0, 4, 6], [4, (FINE + 1) ** 2, 6 * FINE * FINE]].flatMap(([first, count, corners], k) => [
    { bufferView: 0, byteOffset: 12 * first, componentType: 5126, count, type: "VEC3", min: [k ? -1 : -6, 0, k ? -1 : -6], max: [k ? 1 : 6, 0, k ? 1 : 6] },
    { bufferView: 1, byteOffset: 12 * k, componentType: 5123, count: corners, type: "SCALAR" },
  ]);
  const nodes = [...Array(64).keys()].map((i) => ({
    mesh: 1,
    translation: [(i % 8) - 3.5, 0, Math.floor(i / 8) - 3.5],
    rotation: i % 2 ? [0, Math.SQRT1_2, 0, Math.SQRT1_2] : [0, 0, 0, 1],
    scale: [0.3, 1, 0.3],
  }));
  const color = (emissiveFactor) => ({ emissiveFactor, doubleSided: true, pbrMetallicRoughness: { baseColorFactor: [0, 0, 0, 1] } });
  return JSON.stringify({
    asset: { version: "2.0" },
    scene: 0,
    scenes: [{ nodes: [...Array(65).keys()] }],
    nodes: [{ mesh: 0, translation: [0, -0.5, 0] }, ...nodes],
    meshes: [mesh(0, 0), mesh(1, 1)],
    materials: [color([0, 0, 0]), color([0.3, 0.3, 0.3])],
    accessors,
    bufferViews: [
      { buffer: 0, byteLength: grid.byteLength },
      { buffer: 0, byteOffset: grid.byteLength, byteLength: indices.byteLength },
    ],
    buffers: [{ byteLength: bytes.length, uri: `data:application/octet-stream;base64,${bytes.toString("base64")}` }],
  });
}

/** A JPEG picture, left half red and right half blue, and the same with metadata that ask for a quarter turn: what the browser makes of their sizes, and their bytes. */
async function turned(browser) {
  const page = await browser.newPage();
  try {
    return await page.evaluate(async () => {
      const canvas = new OffscreenCanvas(64, 32);
      const context = canvas.getContext("2d");
      context.fillStyle = "#f00";
      context.fillRect(0, 0, 32, 32);
      context.fillStyle = "#00f";
      context.fillRect(32, 0, 32, 32);
      const plain = new Uint8Array(await (await canvas.convertToBlob({ type: "image/jpeg", quality: 1 })).arrayBuffer());
      // Exif: one entry, the orientation (0x0112), one number of 16 bits, 6.
      const exif = [0x45, 0x78, 0x69, 0x66, 0, 0, 0x4d, 0x4d, 0, 42, 0, 0, 0, 8, 0, 1, 1, 0x12, 0, 3, 0, 0, 0, 1, 0, 6, 0, 0, 0, 0, 0, 0];
      const tagged = Uint8Array.from([0xff, 0xd8, 0xff, 0xe1, 0, exif.length + 2, ...exif, ...plain.subarray(2)]);
      const told = async (bytes) => {
        const blob = new Blob([bytes], { type: "image/jpeg" });
        const { width, height } = await createImageBitmap(blob, { premultiplyAlpha: "none", colorSpaceConversion: "none" });
        return { size: [width, height], base64: btoa(String.fromCharCode(...bytes)) };
      };
      return { plain: await told(plain), tagged: await told(tagged) };
    });
  } finally {
    await page.close();
  }
}

/** A glTF file of a floor, four by two, that shines as this JPEG picture says. */
function screen(base64) {
  const floats = new Float32Array([-2, 0, -1, -2, 0, 1, 2, 0, 1, 2, 0, -1, 0, 0, 0, 1, 1, 1, 1, 0]);
  const bytes = Buffer.concat([Buffer.from(floats.buffer), Buffer.from(new Uint16Array([0, 1, 2, 0, 2, 3]).buffer)]);
  return JSON.stringify({
    asset: { version: "2.0" },
    scene: 0,
    scenes: [{ nodes: [0] }],
    nodes: [{ mesh: 0 }],
    meshes: [{ primitives: [{ attributes: { POSITION: 0, TEXCOORD_0: 1 }, indices: 2, material: 0 }] }],
    materials: [{ emissiveFactor: [1, 1, 1], emissiveTexture: { index: 0 }, doubleSided: true, pbrMetallicRoughness: { baseColorFactor: [0, 0, 0, 1] } }],
    textures: [{ source: 0 }],
    images: [{ uri: `data:image/jpeg;base64,${base64}` }],
    accessors: [
      { bufferView: 0, componentType: 5126, count: 4, type: "VEC3", min: [-2, 0, -1], max: [2, 0, 1] },
      { bufferView: 1, componentType: 5126, count: 4, type: "VEC2" },
      { bufferView: 2, componentType: 5123, count: 6, type: "SCALAR" },
    ],
    bufferViews: [
      { buffer: 0, byteLength: 48 },
      { buffer: 0, byteOffset: 48, byteLength: 32 },
      { buffer: 0, byteOffset: 80, byteLength: 12 },
    ],
    buffers: [{ byteLength: bytes.length, uri: `data:application/octet-stream;base64,${bytes.toString("base64")}` }],
  });
}

/** In a browser of its own: with three more scenes the shared one came to its end before the last test. */
export async function pictures(harness, shared) {
  const browser = await launch();
  const context = { ...shared, browser, served: undefined };
  await harness.test("pictures::webp_and_basis_universal_look_like_png", async () => {
    const truth = await pixels(context, "plain");
    check(spread(truth).deviation > 4, "the picture is blank");
    for (const [name, most] of [["webp", 0.5], ["uastc", 2]]) {
      const found = await pixels(context, name);
      const mean = found.reduce((sum, value, i) => sum + Math.abs(value - truth[i]), 0) / truth.length;
      check(mean < most, `${name} differs by ${mean.toFixed(2)} of 255`);
    }
  });
  await harness.test("pictures::transparent_surfaces_lie_over_each_other_in_order", async () => {
    const [gltf, baked] = ["glass.gltf", "glass.rbn"].map((name) => path.join(context.work, name));
    await writeFile(gltf, squares([[0, 3, [0, 0.4, 0], 1], [1, 1, [0.4, 0, 0], 0.5], [1.2, 1, [0, 0, 0.4], 0.25]]));
    await exec(context.rebounce, ["bake", gltf, ...QUICK, "-o", baked]);
    const body = await readFile(baked);
    const html = '<rebounce-viewer src="glass.rbn" auto-exposure="off" tone-mapping="neutral" mode="direct"></rebounce-viewer>';
    const { page, faults } = await loaded(context, html, { routes: { "**/glass.rbn": (route) => route.fulfill({ body }) } });
    const [above, below, layers] = await page.evaluate(async () => {
      const middle = async (y) => {
        viewer.camera = { position: [0.1, y, 0.1], target: [0.1, 1.1, 0.1], up: [0, 0, 1], yfov_deg: 40 };
        const pixels = await viewer.readPixels(32, 32);
        return Array.from(pixels.slice(4 * (16 * 32 + 16), 4 * (16 * 32 + 16) + 3));
      };
      return [await middle(3), await middle(0.5), viewer.stats().blendedLayers];
    });
    equal(faults.join("\n"), "", "faults");
    check(layers > 0, "no layer was drawn");
    const linear = (c) => (c / 255 <= 0.04045 ? c / 255 / 12.92 : ((c / 255 + 0.055) / 1.055) ** 2.4);
    // From above: a quarter of the blue one, half of the rest is the red one, and what is left the floor. From below: no floor.
    for (const [where, found, expected] of [["above", above, [0.15, 0.15, 0.1]], ["below", below, [0.2, 0, 0.05]]]) {
      // Khronos PBR Neutral takes this away.
      const least = Math.min(...expected);
      const offset = least < 0.08 ? least - 6.25 * least * least : 0.04;
      const off = Math.max(...found.map((c, i) => Math.abs(linear(c) + offset - expected[i])));
      check(off < 0.01, `${where}: ${found.map(linear)}, expected ${expected} less ${offset}`);
    }
    await page.close();
  });
  await harness.long("pictures::copies_of_a_mesh_stand_where_each_of_them_does", async () => {
    const [gltf, baked] = ["tiles.gltf", "tiles.rbn"].map((name) => path.join(context.work, name));
    await writeFile(gltf, tiles());
    await exec(context.rebounce, ["bake", gltf, ...QUICK, "-o", baked]);
    const body = await readFile(baked);
    equal(body.includes("INST"), true, "a section with the places of copies");
    const html = '<rebounce-viewer src="tiles.rbn" auto-exposure="off" mode="direct"></rebounce-viewer>';
    const { page, faults } = await loaded(context, html, { routes: { "**/tiles.rbn": (route) => route.fulfill({ body }) } });
    const [pixels, triangles] = await page.evaluate(async () => {
      viewer.camera = { position: [0, 10, 0], target: [0, 0, 0], up: [0, 0, 1], yfov_deg: (2 * Math.atan(0.4) * 180) / Math.PI };
      return [Array.from(await viewer.readPixels(128, 128)), viewer.stats().triangles];
    });
    equal(faults.join("\n"), "", "faults");
    equal(triangles, 2 + 64 * 2 * FINE * FINE, "triangles, those of each copy counted");
    // The picture is 8 wide: sixteen pixels for a tile and what is between it and the next.
    const wrong = [...Array(128 * 128).keys()].filter((i) => {
      const off = Math.max(...[i % 128, Math.floor(i / 128)].map((x) => Math.abs((x % 16) - 7.5)));
      const shines = pixels[4 * i] > 60;
      return off < 4 ? !shines : off > 6 && shines;
    });
    equal(wrong.length, 0, `pixels that shine where nothing stands, or do not; the first is ${wrong[0]}`);
    await page.close();
  });
  await harness.long("pictures::a_turn_that_metadata_ask_for_is_none_of_gltfs", async () => {
    const { plain, tagged } = await turned(browser);
    // Chromium turns what asks for it, or this would show nothing.
    same([plain.size, tagged.size], [[64, 32], [32, 64]], "sizes as the browser decodes them");
    const seen = [];
    for (const [name, { base64 }] of Object.entries({ plain, tagged })) {
      const [gltf, baked] = [`turn-${name}.gltf`, `turn-${name}.rbn`].map((file) => path.join(context.work, file));
      await writeFile(gltf, screen(base64));
      await exec(context.rebounce, ["bake", gltf, ...QUICK, "-o", baked]);
      const body = await readFile(baked);
      const html = `<rebounce-viewer src="turn-${name}.rbn" auto-exposure="off" mode="direct"></rebounce-viewer>`;
      const { page, faults } = await loaded(context, html, { routes: { [`**/turn-${name}.rbn`]: (route) => route.fulfill({ body }) } });
      seen.push(await page.evaluate(async () => {
        viewer.camera = { position: [0, 3, 0], target: [0, 0, 0], up: [0, 0, -1], yfov_deg: 30 };
        return Array.from(await viewer.readPixels(64, 32));
      }));
      equal(faults.join("\n"), "", "faults");
      await page.close();
    }
    const at = (pixels, x) => pixels.slice(4 * (16 * 64 + x), 4 * (16 * 64 + x) + 3);
    const [left, right] = [at(seen[0], 16), at(seen[0], 48)];
    check(left[0] > 2 * left[2] && right[2] > 2 * right[0], `left ${left}, right ${right}`);
    same(at(seen[1], 16), left, "the left half of the one that asks for a turn");
    same(at(seen[1], 48), right, "its right half");
  });
  await browser.close();
}
