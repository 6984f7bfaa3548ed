/** WebAssembly of a baker, fetched and compiled once, when first wanted. */

import { IS_NODE, nodeModule } from "./node.js";

const loading = new Map<string, Promise<WebAssembly.Module>>();

/** Returns a compiled baker, by the name of its file and its hash. Rejects with a sentence. */
export async function downloaded(url: URL, integrity: string): Promise<WebAssembly.Module> {
  const module = loading.get(url.href) ?? load(url, integrity);
  loading.set(url.href, module);
  try {
    return await module;
  } catch (error) {
    loading.delete(url.href);
    throw new Error("The baker's program could not be loaded; check the connection and try again.", { cause: error });
  }
}

async function load(url: URL, integrity: string): Promise<WebAssembly.Module> {
  if (IS_NODE && url.protocol === "file:") {
    const { readFile } = await nodeModule<{ readFile: (url: URL) => Promise<Uint8Array<ArrayBuffer>> }>("node:fs/promises");
    return WebAssembly.compile(await readFile(url));
  }
  const response = await fetch(url, { integrity });
  if (!response.ok) throw new Error(`${response.status} ${response.url}`);
  // A server that gives it another type keeps it from being compiled while it comes.
  return response.headers.get("Content-Type") === "application/wasm"
    ? WebAssembly.compileStreaming(response)
    : WebAssembly.compile(await response.arrayBuffer());
}
