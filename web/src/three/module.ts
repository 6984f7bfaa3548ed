/** The wasm module, loaded once a page. */

import init from "../rebounce_three.js";
import { Failure } from "../wire/failure.js";

/** The build writes the hash of the wasm file here, so that no other one is run. */
const WASM = "sha256-of-the-wasm";

let loading: Promise<unknown> | undefined;

/** Loads it. Rejects with a `Failure`. */
export async function loaded(): Promise<void> {
  loading ??= init({ module_or_path: fetch(new URL("rebounce_three_bg.wasm", import.meta.url), { integrity: WASM }) });
  try {
    await loading;
  } catch (error) {
    loading = undefined;
    throw new Failure("network", "The program for three.js could not be loaded; check the connection and reload.", { cause: error });
  }
}
