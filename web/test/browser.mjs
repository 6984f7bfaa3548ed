// Chromium with WebGPU in software, on a machine with or without a GPU.

import { chromium } from "playwright-core";

const FLAGS = [
  "--no-sandbox",
  // Leave out any of these four, and WebGPU loses its device or is not there.
  "--enable-unsafe-webgpu",
  "--enable-features=Vulkan",
  "--use-vulkan=swiftshader",
  "--use-angle=swiftshader",
  "--disable-quic",
  "--no-first-run",
  "--disable-background-networking",
  "--disable-component-update",
  "--disable-sync",
];

/** Starts the browser that the variable CHROMIUM names. */
export function launch() {
  const executablePath = process.env.CHROMIUM ?? "/usr/bin/chromium";
  return chromium.launch({ executablePath, headless: true, args: FLAGS });
}

/** Device pixels for a CSS pixel in tests: pages lay out as ever, and draw a sixteenth of the pixels, which is what software WebGPU costs by. */
export const DEVICE_PIXELS = 0.25;

/** Something took too long. */
export class Late extends Error {}

/** What takes so many seconds hangs. It is no measure: on a busy machine everything takes as long as it takes. */
export const HANGS = 600;

/** Rejects with `Late` if a promise takes longer: software WebGPU is slow, but it comes to an end. */
export async function within(what, promise, seconds = HANGS) {
  let timer;
  const late = new Promise((_, reject) => {
    timer = setTimeout(() => reject(new Late(`${what}: nothing after ${seconds} s`)), seconds * 1000);
  });
  try {
    return await Promise.race([promise, late]);
  } finally {
    clearTimeout(timer);
  }
}

/** Mean and standard deviation of the brightness of RGBA bytes, 0 to 255. */
export function spread(pixels) {
  const count = pixels.length / 4;
  let sum = 0;
  let squares = 0;
  for (let i = 0; i < pixels.length; i += 4) {
    const value = (pixels[i] + pixels[i + 1] + pixels[i + 2]) / 3;
    sum += value;
    squares += value * value;
  }
  const mean = sum / count;
  return { mean, deviation: Math.sqrt(Math.max(squares / count - mean * mean, 0)) };
}

/** The pixels of a PNG file, decoded by the browser: RGBA bytes. */
export async function decode(browser, png) {
  const page = await browser.newPage();
  try {
    const bytes = await page.evaluate(async (base64) => {
      const blob = await (await fetch(`data:image/png;base64,${base64}`)).blob();
      const bitmap = await createImageBitmap(blob);
      const context = new OffscreenCanvas(bitmap.width, bitmap.height).getContext("2d");
      context.drawImage(bitmap, 0, 0);
      return Array.from(context.getImageData(0, 0, bitmap.width, bitmap.height).data);
    }, png.toString("base64"));
    return Uint8ClampedArray.from(bytes);
  } finally {
    await page.close();
  }
}
