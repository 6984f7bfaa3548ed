/** The scene of an element, baked in the page and shown meanwhile. */

import { bake } from "../bake.js";
import type { RebounceEventMap } from "../element/events.js";
import type { RebounceViewer } from "../rebounce-viewer.js";
import { Failure } from "../wire/failure.js";
import { fetchedScene, sceneAmong, type Scene, type SceneFiles } from "./scene.js";

/** What a bake does with its element. */
export interface BakeHost {
  readonly element: RebounceViewer;
  /** Files that were dropped or opened; none for the file of `src`. */
  readonly files: SceneFiles | undefined;
  /** Ends the bake. */
  readonly signal: AbortSignal;
  /** Shows how far it is, 0 to 1; nothing hides it. */
  setProgress(ratio?: number): void;
  /** Shows a .rbn file; of those after the first the view stays. */
  show(file: Uint8Array): Promise<void>;
  /** Takes the finished file. */
  keep(file: Uint8Array): void;
}

/** Finds the scene, bakes it, and shows previews until the file is there. Rejects with a `Failure`, or the signal's reason. */
export async function bakeInto({ element, files, signal, setProgress, show, keep }: BakeHost): Promise<void> {
  const scene = await (files ? sceneAmong(files) : fetchedScene(element.src, signal));
  if (scene.isBaked) {
    const file = new Uint8Array(await scene.file.arrayBuffer());
    await show(file);
    keep(file);
    return;
  }
  const tell = (detail: RebounceEventMap["bake-progress"]["detail"]) => {
    setProgress(detail.ratio);
    element.dispatchEvent(new CustomEvent("bake-progress", { detail }));
  };
  // One file is shown after the other; of those that come meanwhile the last.
  let next: Uint8Array | undefined;
  let showing = Promise.resolve();
  let ratio = 0;
  // A picture that cannot be shown ends the bake.
  const failed = new AbortController();
  const preview = (file: Uint8Array) => {
    const isWaiting = next !== undefined;
    next = file;
    if (isWaiting) return;
    showing = showing.then(async () => {
      const newest = next;
      next = undefined;
      if (!newest || signal.aborted) return;
      await show(newest);
      setProgress(ratio);
    });
    showing.catch((error: unknown) => failed.abort(error));
  };
  const file = await baked(scene, element, AbortSignal.any([signal, failed.signal]), preview, (progress) => {
    ({ ratio } = progress);
    tell(progress);
  });
  next = undefined;
  await showing;
  signal.throwIfAborted();
  await show(file);
  keep(file);
  tell({ stage: "done", ratio: 1, secondsLeft: 0 });
  setProgress();
}

async function baked(
  { name, file, files }: Scene,
  { preset, solver }: RebounceViewer,
  signal: AbortSignal,
  onPreview: (file: Uint8Array) => void,
  onProgress: (progress: RebounceEventMap["bake-progress"]["detail"]) => void,
): Promise<Uint8Array> {
  try {
    const onWarning = (sentence: string) => console.warn(`<rebounce-viewer>: ${name}: ${sentence}`);
    return await bake(file, { preset, solver: solver === "radiosity" ? solver : "operator", name, files, signal, onPreview, onProgress, onWarning });
  } catch (error) {
    signal.throwIfAborted();
    throw new Failure("bake", error instanceof Error ? error.message : String(error), { cause: error });
  }
}
