// Pages to measure, from a server of their own.

import { createReadStream } from "node:fs";
import { createServer } from "node:http";
import path from "node:path";
import { within } from "../test/browser.mjs";

const web = path.join(import.meta.dirname, "..");
const TYPES = { ".html": "text/html", ".mjs": "text/javascript", ".js": "text/javascript", ".wasm": "application/wasm" };
const FOLDERS = { "/three/": "bench/node_modules/three", "/dist/": "dist", "/bench/": "bench", "/test/": "test" };

/** Serves the pages, and `files` by their address; `close()` ends it. */
export async function serve(files) {
  const fileOf = (url) => {
    if (files[url]) return files[url];
    const prefix = Object.keys(FOLDERS).find((folder) => url.startsWith(folder));
    return prefix && !url.includes("..") ? path.join(web, FOLDERS[prefix], url.slice(prefix.length)) : undefined;
  };
  const server = createServer((request, response) => {
    const file = fileOf(new URL(request.url, "http://localhost").pathname);
    if (!file) return response.writeHead(404).end();
    const stream = createReadStream(file);
    stream.on("error", () => response.writeHead(404).end());
    stream.on("open", () => {
      response.writeHead(200, { "content-type": TYPES[path.extname(file)] ?? "application/octet-stream" });
      stream.pipe(response);
    });
  });
  await new Promise((listening) => server.listen(0, "127.0.0.1", listening));
  return { address: `http://127.0.0.1:${server.address().port}/bench/`, close: () => server.close() };
}

/** Opens a page and waits until it can be measured. */
export async function openPage(browser, address, viewport) {
  const page = await browser.newPage({ viewport });
  page.setDefaultTimeout(600_000);
  page.on("pageerror", (error) => console.error(`${address}: ${error}`));
  await page.goto(address);
  await within(address, page.waitForFunction(() => globalThis.bench));
  return page;
}

/** A Radiance picture of an uneven sky over a dark ground, without a sun: RGBE in rows that are not packed. */
export function skyPicture(width = 512, height = 256) {
  const texel = (i) => {
    const turn = 0.5 + 0.4 * Math.cos((2 * Math.PI * (i % width)) / width);
    return i < (width * height) / 2 ? [90 * turn, 120 * turn, 200 * turn, 129] : [40, 35, 30, 127];
  };
  const texels = Array.from({ length: width * height }, (_, i) => texel(i));
  return Buffer.concat([Buffer.from(`#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y ${height} +X ${width}\n`), Buffer.from(texels.flat())]);
}

/** The one in the middle. */
export const median = (numbers) => [...numbers].sort((a, b) => a - b)[Math.floor(numbers.length / 2)];
