/** The baker's WebAssembly, fetched and compiled once, when first wanted. */

import { IS_NODE, nodeModule } from "./node.js";

/** The build writes the hash of the wasm file here, so that no other one is run. */
const WASM = "sha256-of-the-wasm";

let loading: Promise<WebAssembly.Module> | undefined;

/** Returns the compiled baker. Rejects with a sentence. */
export async function compiled(): Promise<WebAssembly.Module> {
  loading ??= load();
  try {
    return await loading;
  } catch (error) {
    loading = undefined;
    throw new Error("The baker's program could not be loaded; check the connection and try again.", { cause: error });
  }
}

async function load(): Promise<WebAssembly.Module> {
  const url = new URL("rebounce_baker_bg.wasm", import.meta.url);
  if (IS_NODE && url.protocol === "file:") {
    const { readFile } = await nodeModule<{ readFile: (url: URL) => Promise<Uint8Array<ArrayBuffer>> }>("node:fs/promises");
    return WebAssembly.compile(await readFile(url));
  }
  const response = await fetch(url, { integrity: WASM });
  if (!response.ok) throw new Error(`${response.status} ${response.url}`);
  // A server that gives it another type keeps it from being compiled while it comes.
  return response.headers.get("Content-Type") === "application/wasm"
    ? WebAssembly.compileStreaming(response)
    : WebAssembly.compile(await response.arrayBuffer());
}
