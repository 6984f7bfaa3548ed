// The browser's indirect light against the CPU's: the same file, the same shot, floats against floats.

import { execFile, spawn } from "node:child_process";
import { readFile, writeFile } from "node:fs/promises";
import path from "node:path";
import { promisify } from "node:util";
import { within } from "./browser.mjs";

/** Runs a program to its end; what it printed. */
export const exec = (program, args) => promisify(execFile)(program, args, { maxBuffer: 1 << 26 });

/** Starts `rebounce view` on a free port, with `more` arguments, and waits for the address that it prints. */
export async function serve(rebounce, file, more = []) {
  const process = spawn(rebounce, ["view", file, "--port", "0", "--no-open", ...more], { stdio: ["ignore", "pipe", "inherit"] });
  const address = new Promise((resolve, reject) => {
    let text = "";
    process.stdout.on("data", (data) => {
      text += data;
      const found = /http:\/\/127\.0\.0\.1:\d+\//.exec(text);
      if (found) resolve(found[0]);
    });
    process.on("exit", (code) => reject(new Error(`rebounce view ended (${code})`)));
    process.on("error", reject);
  });
  return { process, address: await within("rebounce view", address) };
}

/**
 * Sets a shot in a page whose scene is loaded, reads the indirect light back, has the CPU render the
 * same, and compares. `tools`: the programs rebounce and compare, the baked file, a folder to work in.
 * `finer`: how many times as many pixels a side the browser draws for each pixel compared, since the
 * CPU takes so many `samples` a pixel. `detail`: whether both have it. Gives the difference and the file of the browser's picture.
 */
export async function agreement(page, tools, name, shot, size, finer, samples = 256, detail = true) {
  const stem = path.join(tools.work, name.replaceAll(/\W+/g, "-"));
  await writeFile(`${stem}.json`, JSON.stringify({ ...shot, size }));
  const cpu = ["render", tools.baked, "--shot", `${stem}.json`, "-o", `${stem}.exr`, ...(detail ? [] : ["--no-detail"])];
  await exec(tools.rebounce, [...cpu, "--only", "indirect", "--spp", String(samples)]);
  const base64 = await within("readIndirect", page.evaluate(readIndirect, { shot, size, finer, detail }));
  const file = `${stem}-${size.join("x")}.f32`;
  await writeFile(file, Buffer.from(base64, "base64"));
  return { file, difference: await difference(tools, file, `${stem}.exr`) };
}

/** How far one picture is from another: relative RMS and bias. */
export async function difference(tools, picture, reference) {
  return JSON.parse((await exec(tools.compare, [picture, reference])).stdout);
}

/** A shot from a file, without what the element has no use for. */
export async function readShot(file) {
  const { camera, lights } = JSON.parse(await readFile(file, "utf8"));
  return { camera, lights };
}

/** In the page: the indirect light of a shot, each pixel the mean of finer x finer ones; floats as base64. */
async function readIndirect({ shot, size: [width, height], finer, detail }) {
  const viewer = document.querySelector("rebounce-viewer");
  viewer.shot = shot;
  viewer.detail = detail;
  // The events tell of it with the next frame.
  await new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)));
  const fine = await viewer.readIndirect(width * finer, height * finer);
  if (fine.length !== width * height * finer * finer * 4) throw new Error(`${fine.length} floats`);
  const mean = new Float32Array(width * height * 4);
  for (let i = 0; i < fine.length; i += 4) {
    const x = Math.floor(((i / 4) % (width * finer)) / finer);
    const y = Math.floor(i / 4 / (width * finer) / finer);
    for (let c = 0; c < 4; c += 1) mean[(y * width + x) * 4 + c] += fine[i + c] / (finer * finer);
  }
  return new Promise((resolve) => {
    const reader = new FileReader();
    reader.onload = () => resolve(reader.result.split(",")[1]);
    reader.readAsDataURL(new Blob([mean]));
  });
}
