/** The WebAssembly of the baker that reads STEP files, too. */

import { downloaded } from "./download.js";

/** The build writes the hash of the wasm file here, so that no other one is run. */
const WASM = "sha256-of-the-wasm";

/** Whether a path is that of a STEP file. */
export const isStep = (path: string): boolean => /\.(step|stp|p21)$/i.test(path);

/** Returns the compiled baker. Rejects with a sentence. */
export function compiledForStep(): Promise<WebAssembly.Module> {
  return downloaded(new URL("rebounce_baker_step_bg.wasm", import.meta.url), WASM);
}
