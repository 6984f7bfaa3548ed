/** Bakes scenes in the page, and in Node.js: the baker as WebAssembly, in workers that share the work. */

import { channels } from "./bake/channels.js";
import { checked, type BakeOptions } from "./bake/options.js";
import { compiled } from "./bake/module.js";
import { STEP } from "./bake/kinds.js";
import { compiledForStep } from "./bake/step-module.js";
import type { Start, Told } from "./bake/messages.js";
import { cores, startThread, type Thread } from "./bake/threads.js";

export type { BakeOptions, BakeProgress } from "./bake/options.js";

/** A .glb, .gltf or .step file: its bytes, or a file that was chosen or dropped. */
export type SceneFile = Uint8Array | ArrayBuffer | Blob;

/** Most workers when their number is not given: each has the scene in its own memory. */
const MOST = 8;

/**
 * Bakes a scene; resolves with the .rbn file. It has the bytes of `rebounce bake` with the same preset and seed. Rejects with an error whose message is a sentence, and with the signal's reason when that aborts.
 */
export async function bake(scene: SceneFile, options: BakeOptions = {}): Promise<Uint8Array> {
  const { preset, seed, functions, solver, groups, workers, name, files = {}, onProgress, onPreview, onWarning, onReport, signal } = checked(options);
  signal?.throwIfAborted();
  const named = "name" in scene && typeof scene.name === "string" ? scene.name : "scene.glb";
  const path = name ?? named;
  const module = STEP.test(path) ? compiledForStep() : compiled();
  const beside = Object.entries(files).map(async ([file, bytes]): Promise<[string, Uint8Array]> => [file, await bytesOf(bytes)]);
  const size = workers ?? Math.min(await cores(), MOST);
  const start: Omit<Start, "rank" | "ports"> = {
    size,
    path,
    files: [[path, await bytesOf(scene)], ...(await Promise.all(beside))],
    options: JSON.stringify({ preset, seed, functions: functions ?? null, radiosity: solver === "radiosity", groups: Object.entries(groups ?? {}), previews: onPreview !== undefined }),
    module: await module,
  };
  const threads: Thread<Start>[] = [];
  let ratio = 0;
  try {
    return await new Promise<Uint8Array>((resolve, reject) => {
      const aborted = (): void => reject(signal?.reason);
      signal?.addEventListener("abort", aborted, { once: true });
      const told = (message: Told): void => {
        if (signal?.aborted) return;
        if (message.type === "failed") reject(new Error(message.message));
        else if (message.type === "done") {
          onReport?.(message.report);
          resolve(message.file);
        } else if (message.type === "warning") onWarning?.(message.sentence);
        else if (message.type === "preview") onPreview?.(message.file);
        else {
          // The estimate of the time left may grow; what is done does not become less.
          ratio = Math.max(ratio, message.ratio);
          onProgress?.({ stage: message.stage, ratio, secondsLeft: message.secondsLeft });
        }
      };
      const died = (why: string): void =>
        reject(new Error(`a worker of the bake ended before its work: ${why}; bake with fewer workers, or with the command rebounce`));
      begin(start, told, died, threads).catch(reject);
    });
  } finally {
    for (const thread of threads) thread.stop();
  }
}

async function bytesOf(file: SceneFile): Promise<Uint8Array> {
  if (file instanceof Uint8Array) return file;
  return new Uint8Array(file instanceof Blob ? await file.arrayBuffer() : file);
}

/** Starts the workers, each with a channel to every other. */
async function begin(
  start: Omit<Start, "rank" | "ports">,
  told: (message: Told) => void,
  died: (why: string) => void,
  threads: Thread<Start>[],
): Promise<void> {
  await Promise.all(
    channels(start.size).map(async (own, rank) => {
      const thread = await startThread<Start, Told>(STEP.test(start.path), told, died);
      threads.push(thread);
      thread.post({ ...start, rank, ports: own }, own.filter((port) => port !== null));
    }),
  );
}
