// An environment by attribute: set, turned, unset, refused; and surfaces that shine, dimmed.

import { readFile, writeFile } from "node:fs/promises";
import path from "node:path";
import { exec } from "../agreement.mjs";
import { check, equal, near, same } from "../harness.mjs";
import { plainExr } from "./exr-pictures.mjs";
import { open, outcome, PLAIN } from "./open.mjs";

/** A Radiance picture, run-length encoded in rows: bright in a quarter around +x, dark elsewhere. */
function hdr(width, height, { cut = 0, plain = false, exponent = 130 } = {}) {
  const header = `#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y ${height} +X ${width}\n`;
  const bytes = [...Buffer.from(header)];
  const value = (x, c) => (c === 3 ? (x >= width / 4 && x < width / 2 ? exponent : 120) : 200 - 40 * c);
  for (let y = 0; y < height; y += 1) {
    if (plain) {
      for (let x = 0; x < width; x += 1) for (let c = 0; c < 4; c += 1) bytes.push(value(x, c));
      continue;
    }
    bytes.push(2, 2, width >> 8, width & 255);
    for (let c = 0; c < 4; c += 1) {
      for (let x = 0; x < width; ) {
        let run = 1;
        while (run < 100 && x + run < width && value(x + run, c) === value(x, c)) run += 1;
        bytes.push(128 + run, value(x, c));
        x += run;
      }
    }
  }
  return Buffer.from(bytes.slice(0, bytes.length - cut));
}

/** The same picture as OpenEXR, where a pixel may be none. */
function exr(width, height, none = []) {
  /** Bits of a 16-bit float that is not tiny. */
  const half = (value) => {
    const exponent = Math.floor(Math.log2(value));
    return ((exponent + 15) << 10) + 1024 * (value / 2 ** exponent - 1);
  };
  const radiance = (x, c) => (200 - 40 * c) * 2 ** ((x >= width / 4 && x < width / 2 ? 130 : 120) - 136);
  return Buffer.from(plainExr(width, height, (x, y, c) => (x === none[0] && y === none[1] ? 0x7e00 : half(radiance(x, c)))));
}

/** A floor under a panel that shines down, as glTF. */
function panel() {
  const quad = (half, y) => [-half, y, -half, -half, y, half, half, y, half, half, y, -half];
  const positions = Buffer.from(new Float32Array([...quad(2, 0), ...quad(0.5, 2)]).buffer);
  const indices = Buffer.from(new Uint16Array([0, 1, 2, 0, 2, 3, 0, 2, 1, 0, 3, 2]).buffer);
  const uri = `data:application/octet-stream;base64,${Buffer.concat([positions, indices]).toString("base64")}`;
  const primitive = (i) => ({ attributes: { POSITION: i }, indices: 2 + i, material: i });
  const accessor = (i) => ({ bufferView: 0, byteOffset: 48 * i, componentType: 5126, count: 4, type: "VEC3", min: [i ? -0.5 : -2, 2 * i, i ? -0.5 : -2], max: [i ? 0.5 : 2, 2 * i, i ? 0.5 : 2] });
  const index = (i) => ({ bufferView: 1, byteOffset: 12 * i, componentType: 5123, count: 6, type: "SCALAR" });
  return JSON.stringify({
    asset: { version: "2.0" },
    scene: 0,
    scenes: [{ nodes: [0] }],
    nodes: [{ mesh: 0 }],
    meshes: [{ primitives: [primitive(0), primitive(1)] }],
    materials: [{ doubleSided: true }, { name: "panel", emissiveFactor: [1, 1, 1], doubleSided: true }],
    accessors: [accessor(0), accessor(1), index(0), index(1)],
    bufferViews: [{ buffer: 0, byteLength: 96 }, { buffer: 0, byteOffset: 96, byteLength: 24 }],
    buffers: [{ byteLength: 120, uri }],
  });
}

/** In the page: sums of the picture's bytes, by channel, at a fixed exposure. */
function helpers() {
  globalThis.sums = async () => {
    const pixels = await viewer.readPixels(64, 36);
    return [0, 1, 2].map((c) => pixels.filter((_, i) => i % 4 === c).reduce((a, b) => a + b, 0));
  };
  globalThis.total = async () => (await sums()).reduce((a, b) => a + b, 0);
  globalThis.skies = () => viewer.lights.filter(({ type }) => type === "environment");
}

/** Runs the tests. */
export async function environment(harness, context) {
  const fulfill = (body) => (route) => route.fulfill({ body, contentType: "application/octet-stream" });
  const routes = {
    "**/sky.hdr": fulfill(hdr(64, 32)),
    "**/plain.hdr": fulfill(hdr(64, 32, { plain: true })),
    "**/wide.hdr": fulfill(hdr(8192, 4096)),
    "**/cut.hdr": fulfill(hdr(64, 32, { cut: 9 })),
    "**/square.hdr": fulfill(hdr(32, 32)),
    "**/sky.exr": fulfill(exr(64, 32)),
    "**/cut.exr": fulfill(exr(64, 32).subarray(0, -99)),
    "**/nan.exr": fulfill(exr(64, 32, [12, 7])),
    "**/sky.png": fulfill(Buffer.from([0x89, 0x50, 0x4e, 0x47])),
    "**/broken.exr": (route) => route.abort("connectionreset"),
  };
  const { page, faults } = await open(context, { html: PLAIN, routes, prepare: helpers });
  equal((await outcome(page)).type, "load", "the event");

  await harness.test(
    "environment::is_set_turned_blurred_and_unset",
    async () => {
      const found = await page.evaluate(async () => {
        viewer.autoExposure = false;
        viewer.lights = [];
        const dark = await total();
        viewer.environment = "sky.hdr";
        await until(() => skies().length === 1);
        const [light] = skies();
        const lit = await total();
        const differing = (a, b) => a.filter((byte, i) => Math.abs(byte - b[i]) > 4).length;
        const level = await viewer.readPixels(64, 36);
        viewer.environmentRotation = 90;
        const turned = differing(await viewer.readPixels(64, 36), level);
        const rotation = skies()[0].rotation_deg;
        viewer.environmentIntensity = 0.25;
        const dim = await total();
        const intensity = skies()[0].intensity;
        viewer.environmentIntensity = 1;
        viewer.environmentRotation = 0;
        const before = await viewer.readPixels(64, 36);
        viewer.backgroundBlur = 1;
        const after = await viewer.readPixels(64, 36);
        const blurred = differing(before, after);
        viewer.backgroundBlur = 0;
        viewer.environment = "plain.hdr";
        await pause(500);
        const same = await total();
        viewer.removeAttribute("environment");
        await until(() => skies().length === 0);
        return { dark, light, lit, turned, rotation, dim, intensity, blurred, same, unset: await total() };
      });
      console.log(`    ${JSON.stringify(found)}`);
      same(found.light, { type: "environment", intensity: 1, color: [1, 1, 1] }, "the light");
      check(found.lit > found.dark + 1e5, "it is lit");
      check(found.turned > 1000, "turned, the picture is another");
      equal(found.rotation, 90, "the rotation");
      check(found.dim < 0.9 * found.lit, "dimmed, it is darker");
      equal(found.intensity, 0.25, "the intensity");
      check(found.blurred > 20, "the blur is seen");
      near(found.same, found.lit, 1, "the same picture in plain rows");
      equal(found.unset, found.dark, "unset, it is dark again");
    },
    `attribute environment, attribute environment-rotation, attribute environment-intensity, attribute background-blur
    property environment, property environmentRotation, property environmentIntensity, property backgroundBlur`,
  );

  await harness.test("environment::exr_is_read_as_hdr_is", async () => {
    const [hdr, exr] = await page.evaluate(async () => {
      const lit = async (name, done) => {
        viewer.environment = name;
        await until(done);
        await pause(500);
        return Array.from(await viewer.readPixels(64, 36));
      };
      const loaded = (name) => performance.getEntriesByType("resource").some((entry) => new URL(entry.name).pathname === `/${name}`);
      if (loaded("exr.js")) throw new Error("the reader of .exr was there before the first");
      const hdr = await lit("sky.hdr", () => skies().length === 1);
      const exr = await lit("sky.exr", () => loaded("exr.js"));
      viewer.environment = "plain.hdr";
      return [hdr, exr];
    });
    const apart = hdr.reduce((sum, byte, i) => sum + Math.abs(byte - exr[i]), 0) / hdr.length;
    console.log(`    mean difference ${apart.toFixed(3)} of 255`);
    check(apart < 0.1, `${apart}`);
  });

  await harness.test("environment::a_wide_picture_is_reduced", async () => {
    const warnings = [];
    page.on("console", (message) => message.type() === "warning" && warnings.push(message.text()));
    const [narrow, wide] = await page.evaluate(async () => {
      const lit = async (name) => {
        viewer.environment = name;
        await until(() => skies().length === 1);
        await pause(2000);
        return await total();
      };
      const found = [await lit("sky.hdr"), await lit("wide.hdr")];
      return found;
    });
    near(wide / narrow, 1, 0.03, "brightness");
    same(warnings, ["<rebounce-viewer>: the environment of 8192 x 4096 pixels is reduced to 4096 x 2048."], "what the console was told");
  });

  await harness.test("environment::what_cannot_be_used_leaves_the_light_as_it_is", async () => {
    const names = { "cut.hdr": "ends before", "square.hdr": "32 x 32", "cut.exr": "ends within its pixels", "nan.exr": "x = 12, y = 7", "broken.exr": "broke off", "sky.png": "neither Radiance (.hdr) nor OpenEXR (.exr)", "missing.hdr": "404" };
    for (const [name, words] of Object.entries(names)) {
      const found = await page.evaluate(async (name) => {
        viewer.environment = "sky.hdr";
        await pause(300);
        const before = await total();
        const seen = events.filter(({ type }) => type === "error").length;
        viewer.environment = name;
        await until(() => events.filter(({ type }) => type === "error").length > seen);
        return { error: events.filter(({ type }) => type === "error").at(-1), before, after: await total(), loaded: viewer.loaded };
      }, name);
      check(found.error.message.includes(words), `${name}: ${JSON.stringify(found.error)}`);
      check(/^[A-Z][^]*\.$/.test(found.error.message), found.error.message);
      same([found.after, found.loaded], [found.before, true], name);
    }
  });
  equal(faults.filter((fault) => !fault.startsWith("Failed to load")).join("\n"), "", "faults");
  await page.close();

  await harness.long("environment::surfaces_that_shine_are_dimmed_and_switched_off", async () => {
    const [gltf, baked] = ["panel.gltf", "panel.rbn"].map((name) => path.join(context.work, name));
    await writeFile(gltf, panel());
    await exec(context.rebounce, ["bake", gltf, "--preset", "draft", "-o", baked]);
    const bytes = await readFile(baked);
    const shining = '<rebounce-viewer src="panel.rbn" controls></rebounce-viewer>';
    const { page, faults } = await open(context, { html: shining, routes: { "**/panel.rbn": fulfill(bytes) }, prepare: helpers });
    equal((await outcome(page)).type, "load", "the event");
    const found = await page.evaluate(async () => {
      viewer.autoExposure = false;
      viewer.backdrop = "none";
      const lights = viewer.lights.filter(({ type }) => type === "emissive");
      const shine = async (intensity) => {
        viewer.lights = lights.map((light) => ({ ...light, intensity }));
        return await total();
      };
      const pictures = [await shine(1), await shine(0.2), await shine(0)];
      await shine(1);
      await until(() => viewer.shadowRoot.querySelector(".panel summary"));
      viewer.shadowRoot.querySelector(".panel summary").click();
      await until(() => viewer.shadowRoot.querySelector(".lights input"));
      const listed = viewer.shadowRoot.querySelector(".lights .entry").textContent;
      viewer.shadowRoot.querySelector(".lights input").click();
      return { lights, pictures, listed, off: viewer.mix, dark: await total() };
    });
    console.log(`    ${JSON.stringify(found)}`);
    equal(found.lights.length, 1, "groups");
    const [full, dim, off] = found.pictures;
    check(full > 1.2 * dim && dim > off + 1000, "dimmed, the picture is darker");
    check(found.listed.includes("surfaces"), found.listed);
    same([found.off, found.dark], [[{ mute: true }], off], "switched off");
    equal(faults.join("\n"), "", "faults");
    await page.close();
  });
}
