/** The WebAssembly of the baker that reads STEP files, too. */

import { downloaded } from "./download.js";

/** The build writes the hash of the wasm file here, so that no other one is run. */
const WASM = "sha256-of-the-wasm";

/** Returns the compiled baker. Rejects with a sentence. */
export function compiledForStep(): Promise<WebAssembly.Module> {
  return downloaded(new URL("rebounce_baker_step_bg.wasm", import.meta.url), WASM);
}
