/** A worker of a bake. */

import { parentPort } from "node:worker_threads";
import init, { bakeCommand } from "../rebounce_baker.js";
import { faultSentence, isFault } from "../../../../web/src/bake/fault.js";
import { CommandHost } from "./host.js";
import type { CommandStart, CommandTold } from "./messages.js";

async function run(start: CommandStart, tell: (message: CommandTold, transfer?: ArrayBuffer[]) => void): Promise<void> {
  const failed = (message: string): void => tell({ type: "failed", message });
  const host = new CommandHost(start.rank, start.ports, start.files, tell, failed);
  let memory: WebAssembly.Memory | undefined;
  // What the wasm does after a pause fails outside of the call that began it.
  const ended = (error: unknown): void => failed(faultSentence(error, memory, "a worker", "the native program"));
  process.on("unhandledRejection", ended);
  try {
    ({ memory } = await init(start.module));
    const baked = await bakeCommand(host, start.words, start.rank, start.size);
    if (!baked) return;
    const { bytes: file, summary, report, lastLine } = baked;
    tell({ type: "done", file, summary, report, lastLine }, [file.buffer as ArrayBuffer]);
  } catch (error) {
    if (isFault(error)) ended(error);
    else failed(error instanceof Error ? error.message : String(error));
  }
}

parentPort?.once("message", (start: CommandStart) => void run(start, (message, transfer) => parentPort?.postMessage(message, transfer ?? [])));
