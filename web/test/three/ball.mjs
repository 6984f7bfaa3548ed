// What a ball that no bake knows is to look like, and how far from it a picture is: for tests and the benchmark.

import parseExr from "parse-exr";
import { readFile, writeFile } from "node:fs/promises";
import path from "node:path";
import { exec } from "../agreement.mjs";
import { IS_BALL, SIZE } from "./picture.mjs";
import { room } from "./rooms.mjs";

/** Bakes a scene of rooms.mjs; its files as base64. */
export async function baked({ work, rebounce }, name, scene) {
  const glb = path.join(work, `three-${name}.glb`);
  await writeFile(glb, await scene(false).glb());
  const rbn = path.join(work, `three-${name}.rbn`);
  await exec(rebounce, ["bake", glb, "--preset", "draft", "-o", rbn]);
  const [glbText, rbnText] = await Promise.all([glb, rbn].map(async (file) => (await readFile(file)).toString("base64")));
  return { glb: glbText, rbn: rbnText };
}

/** Bounced light as a path tracer sees it with the ball in the room: RGB of a pixel, rows from the bottom. */
export async function traced({ work, rebounce }) {
  const [glb, out] = ["three-ball.glb", "three-ball.exr"].map((name) => path.join(work, name));
  await writeFile(glb, await room(true).glb());
  await exec(rebounce, ["reference", glb, "--only", "indirect", "--size", SIZE.join("x"), "--spp", "256", "-o", out]);
  const bytes = await readFile(out);
  // FloatType of three.js, for what parse-exr is to give.
  const { data, width, height } = parseExr(bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.byteLength), 1015);
  const channels = data.length / (width * height);
  return (x, y) => [0, 1, 2].map((c) => data[channels * ((height - 1 - y) * width + x) + c]);
}

/** Relative error of a picture of the ball, over so many pixels. */
export function errorOf(pixels, truth) {
  const [width, height] = SIZE;
  const isBall = (x, y) => pixels[4 * (y * width + x) + 3] === IS_BALL;
  let [error, power, sum, wantedSum, count] = [0, 0, 0, 0, 0];
  for (let y = 1; y < height - 1; y += 1) {
    for (let x = 1; x < width - 1; x += 1) {
      // Pixels at the rim show what is behind, too.
      if (![[0, 0], [1, 0], [-1, 0], [0, 1], [0, -1]].every(([dx, dy]) => isBall(x + dx, y + dy))) continue;
      truth(x, y).forEach((wanted, c) => {
        const found = pixels[4 * (y * width + x) + c];
        error += (found - wanted) ** 2;
        power += wanted ** 2;
        sum += found;
        wantedSum += wanted;
      });
      count += 1;
    }
  }
  return { error: Math.sqrt(error / power), bias: sum / wantedSum - 1, count };
}

/** Mean radiance of the ball in a picture of it. */
export function meanOf(pixels) {
  const seen = pixels.filter((_, i) => i % 4 < 3 && pixels[4 * Math.floor(i / 4) + 3] === IS_BALL);
  return seen.reduce((sum, x) => sum + x, 0) / seen.length;
}
