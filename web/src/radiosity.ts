/** The renderer of all files, those whose bounced light comes not from links alone among them: loaded for the first of these. */

import init, { Viewer } from "./rebounce_radiosity.js";
import { Failure } from "./wire/failure.js";
import { nodesOf, type Nodes } from "./wire/nodes.js";
import type { Viewer as Linked } from "./rebounce_viewer.js";

/** The build writes the hash of the wasm file here, so that no other one is run. */
const WASM = "sha256-of-the-wasm";

let loading: Promise<unknown> | undefined;

/** Makes a viewer on a canvas. Rejects with an error whose `code` says what is missing. */
export async function createViewer(canvas: HTMLCanvasElement): Promise<Linked & { nodes: Nodes }> {
  loading ??= init({ module_or_path: fetch(new URL("rebounce_radiosity_bg.wasm", import.meta.url), { integrity: WASM }) });
  try {
    await loading;
  } catch (error) {
    loading = undefined;
    throw new Failure("network", "The renderer of radiosity could not be loaded; check the connection and reload.", { cause: error });
  }
  const viewer: Viewer = await Viewer.create(canvas);
  Object.defineProperty(viewer, "nodes", { get: () => nodesOf(viewer) });
  return viewer as unknown as Linked & { nodes: Nodes };
}
