// Exported light, shown by three.js, is the light of the picture that the command takes.

import { readFile, writeFile } from "node:fs/promises";
import path from "node:path";
import { serve } from "../../bench/pages.mjs";
import { difference, exec } from "../agreement.mjs";
import { HANGS, decode, within } from "../browser.mjs";
import { check } from "../harness.mjs";

const SIZE = [192, 144];
/** Pixels of three.js a side for each pixel compared. */
const FINER = 4;
/** Texels on a metre of the Cornell box, which is 5.5 m wide: a texel is three pixels. */
const TEXELS = "40";
/** The most that a picture may differ, relative RMS. */
const TOLERANCE = 0.05;

const SHOT = {
  size: SIZE,
  camera: { position: [0, 2.73, 8], target: [0, 2.73, -2.8], up: [0, 1, 0], yfov_deg: 39.3 },
  lights: [
    {
      type: "spot",
      position: [0, 5.4, -2.8],
      direction: [0, -1, 0],
      outer_cone_deg: 60,
      inner_cone_deg: 50,
      intensity: 120,
      color: [1, 0.85, 0.65],
    },
  ],
};

export async function exported(harness, context) {
  const { work, rebounce, baked } = context;
  const at = (name) => path.join(work, name);
  await writeFile(at("exported.json"), JSON.stringify(SHOT));
  const shot = ["--shot", at("exported.json")];
  const make = (name, more) => exec(rebounce, ["export", baked, ...shot, "--texels-per-metre", TEXELS, "-o", at(name), ...more]);
  const files = { "/map.glb": at("map.glb"), "/map.exr": at("map.exr"), "/unlit.glb": at("unlit.glb") };
  const server = await serve(files);
  const page = await context.browser.newPage({ viewport: { width: 320, height: 240 } });
  page.setDefaultTimeout(1000 * HANGS);
  const faults = [];
  page.on("pageerror", (error) => faults.push(String(error)));
  page.on("console", (message) => message.type() === "error" && faults.push(message.text()));
  const sound = () => check(faults.length === 0, faults.join("\n"));
  const open = async () => {
    await page.goto(new URL("/test/exported.html", server.address).href);
    await within("three.js", page.waitForFunction(() => globalThis.shown));
  };
  try {
    for (const only of ["all", "indirect"]) {
      await harness.test(`page::a_lightmap_in_three_js_is_the_light_of_the_picture: ${only}`, async () => {
        await make("map.glb", ["--lightmap-texture", "--only", only]);
        await exec(rebounce, ["render", baked, ...shot, "--only", only, "--spp", "256", "-o", at("exported.exr")]);
        await open();
        const draw = page.evaluate(([size, finer]) => shown.lightmap("/map.glb", "/map.exr", size, finer), [SIZE, FINER]);
        const pixels = await within("a picture", draw);
        sound();
        const file = at(`exported-${only}-${SIZE.join("x")}.f32`);
        await writeFile(file, Buffer.from(new Float32Array(pixels).buffer));
        const found = await difference(context, file, at("exported.exr"));
        console.log(`  ${only}: ${JSON.stringify(found)}`);
        check(found.error < TOLERANCE, `${only}: ${JSON.stringify(found)}`);
      });
    }
    await harness.test("page::an_unlit_file_in_three_js_looks_like_the_picture", async () => {
      await make("unlit.glb", []);
      await exec(rebounce, ["render", baked, ...shot, "-o", at("exported.png")]);
      await open();
      const draw = page.evaluate(([size, finer]) => shown.unlit("/unlit.glb", size, finer), [SIZE, FINER]);
      const pixels = await within("a picture", draw);
      sound();
      const expected = await decode(context.browser, await readFile(at("exported.png")));
      const { error, mean } = relative(pixels, expected);
      console.log(`  unlit: ${error.toFixed(4)} of the RMS, mean ${mean.toFixed(3)}`);
      check(mean > 0.05, `the picture is dark: ${mean}`);
      check(error < TOLERANCE, `${error} of the RMS`);
    });
  } finally {
    await page.close();
    server.close();
  }
}

/** Linear value of an 8-bit sRGB value (IEC 61966-2-1). */
const linear = (byte) => (byte <= 10.31 ? byte / 255 / 12.92 : ((byte / 255 + 0.055) / 1.055) ** 2.4);

/** How far linear display values are from a picture's bytes, relative RMS; and the picture's mean. */
function relative(pixels, bytes) {
  let [apart, power, sum, count] = [0, 0, 0, 0];
  for (let i = 0; i < bytes.length; i += 1) {
    if (i % 4 === 3) continue;
    const expected = linear(bytes[i]);
    apart += (pixels[i] - expected) ** 2;
    power += expected ** 2;
    sum += expected;
    count += 1;
  }
  return { error: Math.sqrt(apart / power), mean: sum / count };
}
