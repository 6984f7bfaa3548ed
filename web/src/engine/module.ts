/** The renderer's wasm modules, each loaded once for all elements of a page. */

import init, { Viewer as Linked } from "../rebounce_viewer.js";
import type { Moving } from "../nodes/moving.js";
import { Failure, wanted } from "../wire/failure.js";

/** The build writes the hash of the wasm file here, so that no other one is run. */
const WASM = "sha256-of-the-wasm";

let loading: Promise<unknown> | undefined;

/**
 * Whether a file is for the renderer of all files, by its table of sections (docs/format/rbn.md): its bounced light comes not
 * from links alone, its materials have an index of refraction, a specular colour or a clear layer, or it has glossy transfer.
 */
export const wantsRadiosity = (file: Uint8Array): boolean => /[LMR]GRP|REFL|MATG|GLSY|DTLY|RIGL/.test(String.fromCharCode(...file.subarray(32, 2080)));

/** A viewer; that of all files has nodes that move, and reflections, too. */
export type Viewer = Linked & { moving?: Moving; gloss?: boolean };

/** Makes a viewer on a canvas, of all files or of those with links alone. Rejects with an error whose `code` says what is missing. */
export async function createViewer(canvas: HTMLCanvasElement, radiosity: boolean): Promise<Viewer> {
  if (!("gpu" in navigator) || !navigator.gpu) {
    throw new Failure(
      "no-webgpu",
      window.isSecureContext
        ? "This browser has no WebGPU: there is no navigator.gpu."
        : "WebGPU needs a secure page: open this page over https.",
    );
  }
  if (radiosity) return (await wanted(import("../radiosity.js"), "renderer of radiosity")).createViewer(canvas) as unknown as Promise<Viewer>;
  loading ??= init({ module_or_path: fetch(new URL("rebounce_viewer_bg.wasm", import.meta.url), { integrity: WASM }) });
  try {
    await loading;
  } catch (error) {
    loading = undefined;
    throw new Failure("network", "The viewer's program could not be loaded; check the connection and reload.", {
      cause: error,
    });
  }
  return Linked.create(canvas);
}

