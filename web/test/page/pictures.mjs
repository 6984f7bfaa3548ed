// A scene's picture looks the same whichever format it came in; transparent surfaces.

import { readFile, writeFile } from "node:fs/promises";
import path from "node:path";
import { fileURLToPath } from "node:url";
import { exec } from "../agreement.mjs";
import { launch, spread } from "../browser.mjs";
import { check, equal } from "../harness.mjs";
import { loaded } from "./open.mjs";

const SCENES = fileURLToPath(new URL("../../../baker/tests/gltf", import.meta.url));

/** Only direct light is looked at: little is baked. */
const QUICK = "--preset draft --functions 1000 --levels 2 --sender-levels 2 --direct-levels 2".split(" ");

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
function squares(list) {
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
    const html = '<rebounce-viewer src="glass.rbn" auto-exposure="off" mode="direct"></rebounce-viewer>';
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
  await browser.close();
}
