/** Bakes a scene of three.js in the page. */

import type { Object3D } from "three/webgpu";
import type { BakeOptions as Options } from "../bake.js";

/** How a scene is baked: as in `rebounce-viewer/bake`. */
export type BakeOptions = Pick<Options, "preset" | "seed" | "functions" | "workers" | "onProgress" | "onPreview" | "onWarning">;

/** Bakes what a scene shows, as a .glb that three's own exporter writes. Rejects with an error whose message is a sentence. */
export async function bakeScene(scene: Object3D, options: BakeOptions & { signal?: AbortSignal }): Promise<Uint8Array> {
  const [{ GLTFExporter }, { bake }] = await Promise.all([import("three/addons/exporters/GLTFExporter.js"), import("../bake.js")]);
  const file = await new GLTFExporter().parseAsync(scene, { binary: true, onlyVisible: true });
  const { preset, seed, functions, workers, onProgress, onPreview, onWarning, signal } = options;
  const given = Object.entries({ preset, seed, functions, workers, onProgress, onPreview, onWarning, signal }).filter(([, value]) => value !== undefined);
  return bake(file as ArrayBuffer, Object.fromEntries(given));
}
