// A server whose page allows as little as the element can live with, and whose files may be faults.

import { readFile } from "node:fs/promises";
import { createServer } from "node:http";
import path from "node:path";
import { fileURLToPath } from "node:url";

const DIST = fileURLToPath(new URL("../dist", import.meta.url));
const TYPES = { ".js": "text/javascript", ".css": "text/css", ".wasm": "application/wasm", ".rbn": "application/octet-stream" };

/** The strictest policy under which the element works; web/README.md has it, too. */
export const STRICTEST =
  "default-src 'none'; script-src 'self' 'wasm-unsafe-eval'; connect-src 'self'; base-uri 'none'; form-action 'none'; " +
  "frame-ancestors 'none'; require-trusted-types-for 'script'; trusted-types 'none'";

/** A page with this in its head and body. */
export const document = (body, head = '<script type="module" src="rebounce-viewer.js"></script>') =>
  `<!doctype html><html lang="en"><head><meta charset="utf-8"><title>Rebounce</title>${head}</head><body>${body}</body></html>`;

/**
 * Serves web/dist and these folders on a free port of 127.0.0.1. `pages`: the text of each page, by its path.
 * `faults`: what answers a path instead of a file, `(request, response) => …`. Gives the address, what was asked for, and
 * a way to end.
 */
export async function serveStrictly({ folders = [], pages = {}, faults = {} }) {
  const asked = [];
  const server = createServer(async (request, response) => {
    const name = decodeURIComponent(new URL(request.url, "http://127.0.0.1").pathname.slice(1));
    asked.push(name);
    const fault = faults[name];
    if (fault) return fault(request, response);
    response.setHeader("x-content-type-options", "nosniff").setHeader("cache-control", "no-cache");
    if (name in pages) {
      const headers = { "content-type": "text/html; charset=utf-8", "content-security-policy": STRICTEST };
      return response.writeHead(200, headers).end(pages[name]);
    }
    for (const folder of [DIST, ...folders]) {
      const bytes = await readFile(path.join(folder, path.basename(name))).catch(() => undefined);
      if (!bytes) continue;
      response.setHeader("content-type", TYPES[path.extname(name)] ?? "application/octet-stream");
      return response.setHeader("content-length", bytes.length).end(bytes);
    }
    response.writeHead(404, { "content-type": "text/plain" }).end("there is no such file");
  });
  await new Promise((ready) => server.listen(0, "127.0.0.1", ready));
  const end = () => {
    server.closeAllConnections();
    server.close();
  };
  return { address: `http://127.0.0.1:${server.address().port}/`, asked, end };
}
