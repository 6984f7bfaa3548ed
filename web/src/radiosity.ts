/** The renderer of all files, those whose bounced light comes not from links alone among them: loaded for the first of these. */

import init, { Viewer } from "./rebounce_radiosity.js";
import { Moving } from "./nodes/moving.js";
import { Failure } from "./wire/failure.js";

/** The build writes the hash of the wasm file here, so that no other one is run. */
const WASM = "sha256-of-the-wasm";

let loading: Promise<unknown> | undefined;

/** Makes a viewer on a canvas, with its nodes. Rejects with an error whose `code` says what is missing. */
export async function createViewer(canvas: HTMLCanvasElement): Promise<Viewer & { moving: Moving }> {
  loading ??= init({ module_or_path: fetch(new URL("rebounce_radiosity_bg.wasm", import.meta.url), { integrity: WASM }) });
  try {
    await loading;
  } catch (error) {
    loading = undefined;
    throw new Failure("network", "The renderer of radiosity could not be loaded; check the connection and reload.", { cause: error });
  }
  const viewer: Viewer = await Viewer.create(canvas);
  return Object.assign(viewer, { moving: new Moving(viewer) });
}
