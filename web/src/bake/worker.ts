/** A worker of a bake: runs in browsers and in Node.js. */

import init, { SceneFiles, bake } from "../rebounce_baker.js";
import { Host } from "./host.js";
import type { Start, Told } from "./messages.js";
import { IS_NODE, nodeModule } from "./node.js";

/** What this uses of `parentPort` of node:worker_threads. */
interface ParentPort {
  postMessage(message: Told, transfer?: readonly ArrayBuffer[]): void;
  once(event: "message", then: (message: Start) => void): void;
}

/** Bytes of memory from which a program that ends without a word has most likely asked for too much. */
const FULL = 3 * 2 ** 30;

async function run(start: Start, tell: (message: Told, transfer?: ArrayBuffer[]) => void): Promise<void> {
  const failed = (message: string): void => tell({ type: "failed", message });
  const host = new Host(start.rank, start.ports, tell, failed);
  let memory: WebAssembly.Memory | undefined;
  // What the wasm does after a pause fails outside of the call that began it.
  const ended = (error: unknown): void =>
    failed(
      (memory?.buffer.byteLength ?? 0) > FULL
        ? "the scene needs more memory than a worker of a page has, 4 GB: bake it with the command rebounce"
        : `the baker failed: ${String(error)}; this is a fault of the baker: report it with the scene, if you can`,
    );
  globalThis.addEventListener?.("unhandledrejection", ({ reason }) => ended(reason));
  try {
    ({ memory } = await init(start.module));
    const files = new SceneFiles();
    for (const [path, bytes] of start.files) files.insert(path, bytes);
    const baked = await bake(host, files, start.path, start.options, start.rank, start.size);
    if (!baked) return;
    const file = baked.bytes;
    tell({ type: "done", file, report: baked.report }, [file.buffer as ArrayBuffer]);
  } catch (error) {
    if (error instanceof WebAssembly.RuntimeError || error instanceof RangeError) ended(error);
    else failed(error instanceof Error ? error.message : String(error));
  }
}

if (IS_NODE) {
  // No await: bundlers make a classic script of a worker. A server that only imports this is no worker.
  void nodeModule<{ parentPort: ParentPort | null }>("node:worker_threads").then(({ parentPort }) =>
    parentPort?.once("message", (start) => void run(start, (message, transfer) => parentPort.postMessage(message, transfer))),
  );
} else {
  const page = globalThis as unknown as Pick<Worker, "postMessage" | "onmessage">;
  page.onmessage = ({ data }: MessageEvent<Start>) => void run(data, (message, transfer) => page.postMessage(message, transfer ?? []));
}
