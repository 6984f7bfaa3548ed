/** What a worker of a bake does, in browsers and in Node.js. */

import type initBaker from "../rebounce_baker.js";
import type { SceneFiles, bake } from "../rebounce_baker.js";
import { faultSentence, isFault } from "./fault.js";
import { Host } from "./host.js";
import type { Start, Told } from "./messages.js";
import { IS_NODE, nodeModule } from "./node.js";

/** What this uses of `parentPort` of node:worker_threads. */
interface ParentPort {
  postMessage(message: Told, transfer?: readonly ArrayBuffer[]): void;
  once(event: "message", then: (message: Start) => void): void;
}

/** The module of a baker, with STEP files or without. */
export interface Baker {
  default: typeof initBaker;
  SceneFiles: typeof SceneFiles;
  bake: typeof bake;
}

async function run(baker: Baker, start: Start, tell: (message: Told, transfer?: ArrayBuffer[]) => void): Promise<void> {
  const failed = (message: string): void => tell({ type: "failed", message });
  const host = new Host(start.rank, start.ports, tell, failed);
  let memory: WebAssembly.Memory | undefined;
  // What the wasm does after a pause fails outside of the call that began it.
  const ended = (error: unknown): void => failed(faultSentence(error, memory, "a worker of a page", "the command rebounce"));
  globalThis.addEventListener?.("unhandledrejection", ({ reason }) => ended(reason));
  try {
    ({ memory } = await baker.default(start.module));
    const files = new baker.SceneFiles();
    for (const [path, bytes] of start.files) files.insert(path, bytes);
    const baked = await baker.bake(host, files, start.path, start.options, start.rank, start.size);
    if (!baked) return;
    const file = baked.bytes;
    tell({ type: "done", file, report: baked.report }, [file.buffer as ArrayBuffer]);
  } catch (error) {
    if (isFault(error)) ended(error);
    else failed(error instanceof Error ? error.message : String(error));
  }
}

/** Waits for the start of a bake, and takes part in it. */
export function work(baker: Baker): void {
  if (IS_NODE) {
    // No await: bundlers make a classic script of a worker. A server that only imports this is no worker.
    void nodeModule<{ parentPort: ParentPort | null }>("node:worker_threads").then(({ parentPort }) =>
      parentPort?.once("message", (start) => void run(baker, start, (message, transfer) => parentPort.postMessage(message, transfer))),
    );
  } else {
    const page = globalThis as unknown as Pick<Worker, "postMessage" | "onmessage">;
    page.onmessage = ({ data }: MessageEvent<Start>) => void run(baker, data, (message, transfer) => page.postMessage(message, transfer ?? []));
  }
}
