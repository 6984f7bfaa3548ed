/** A worker of a bake. */

import { parentPort } from "node:worker_threads";
import init, { bakeCommand } from "../rebounce_baker.js";
import { CommandHost } from "./host.js";
import type { CommandStart, CommandTold } from "./messages.js";

/** Bytes of memory from which a program that ends without a word has most likely asked for too much. */
const FULL = 3 * 2 ** 30;

async function run(start: CommandStart, tell: (message: CommandTold, transfer?: ArrayBuffer[]) => void): Promise<void> {
  const failed = (message: string): void => tell({ type: "failed", message });
  const host = new CommandHost(start.rank, start.ports, start.files, tell, failed);
  let memory: WebAssembly.Memory | undefined;
  // What the wasm does after a pause fails outside of the call that began it.
  const ended = (error: unknown): void =>
    failed(
      (memory?.buffer.byteLength ?? 0) > FULL
        ? "the scene needs more memory than a worker has, 4 GB: bake it with the native program"
        : `the baker failed: ${String(error)}; this is a fault of the baker: report it with the scene, if you can`,
    );
  process.on("unhandledRejection", ended);
  try {
    ({ memory } = await init(start.module));
    const baked = await bakeCommand(host, start.words, start.rank, start.size);
    if (!baked) return;
    const { bytes: file, summary, report, lastLine } = baked;
    tell({ type: "done", file, summary, report, lastLine }, [file.buffer as ArrayBuffer]);
  } catch (error) {
    if (error instanceof WebAssembly.RuntimeError || error instanceof RangeError) ended(error);
    else failed(error instanceof Error ? error.message : String(error));
  }
}

parentPort?.once("message", (start: CommandStart) => void run(start, (message, transfer) => parentPort?.postMessage(message, transfer ?? [])));
