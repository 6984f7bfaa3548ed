// node test/serve.mjs FOLDER [PORT]: serves a folder's files on 127.0.0.1, and says where.

import { createServer } from "node:http";
import { readFile } from "node:fs/promises";
import path from "node:path";
import { pathToFileURL } from "node:url";

const TYPES = {
  ".html": "text/html; charset=utf-8",
  ".js": "text/javascript; charset=utf-8",
  ".mjs": "text/javascript; charset=utf-8",
  ".css": "text/css; charset=utf-8",
  ".json": "application/json",
  ".wasm": "application/wasm",
  ".png": "image/png",
  ".svg": "image/svg+xml",
};

/** As strict as the element allows. */
const POLICY =
  "default-src 'none'; script-src 'self' 'wasm-unsafe-eval'; style-src 'self'; img-src 'self' data: blob:; " +
  "connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

/** Starts to serve a folder, under the strict policy unless `policy` is false; port 0: any that is free. Gives the address, and a way to end. */
export async function serveFolder(folder, port = 0, { policy = true } = {}) {
  const root = path.resolve(folder);
  const server = createServer(async (request, response) => {
    const host = `127.0.0.1:${server.address().port}`;
    if (policy) response.setHeader("content-security-policy", POLICY);
    response.setHeader("x-content-type-options", "nosniff");
    // Another name for this machine would let a foreign page read the files.
    if (request.headers.host !== host) return response.writeHead(403).end();
    const file = inside(root, request.url);
    const bytes = file && (await readFile(file).catch(() => undefined));
    if (!bytes) return response.writeHead(404, { "content-type": "text/plain" }).end("there is no such file");
    response.setHeader("content-type", TYPES[path.extname(file)] ?? "application/octet-stream");
    response.setHeader("content-length", bytes.length).setHeader("cache-control", "no-cache");
    response.end(request.method === "HEAD" ? undefined : bytes);
  });
  await new Promise((ready, failed) => {
    server.once("error", failed);
    server.listen(port, "127.0.0.1", ready);
  });
  const end = () => {
    server.closeAllConnections?.();
    server.close();
  };
  return { address: `http://127.0.0.1:${server.address().port}/`, end };
}

/** The file that a request means; nothing where it lies outside the root. */
function inside(root, target) {
  let name;
  try {
    name = decodeURIComponent(new URL(target, "http://127.0.0.1").pathname);
  } catch {
    return undefined;
  }
  const file = path.join(root, name.endsWith("/") ? `${name}index.html` : name);
  return file.startsWith(root + path.sep) && !file.includes("\0") ? file : undefined;
}

if (process.argv[1] && import.meta.url === pathToFileURL(process.argv[1]).href) {
  const [folder, port] = process.argv.slice(2);
  if (!folder) throw new Error("usage: node serve.mjs FOLDER [PORT]");
  const { address } = await serveFolder(folder, Number(port ?? 0));
  console.log(`${folder} at ${address} (Ctrl-C ends)`);
}
