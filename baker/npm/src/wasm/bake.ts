/** Bakes with the baker as WebAssembly, in worker threads that share the work. */

import { channels } from "../../../../web/src/bake/channels.js";
import { compiled } from "../../../../web/src/bake/module.js";
import { cores, startThread, type Thread } from "../../../../web/src/bake/threads.js";
import init, { parse } from "../rebounce_baker.js";
import { CommandHost } from "./host.js";
import type { CommandStart, CommandTold } from "./messages.js";

/** Most workers when their number is not given: each has the scene in its own memory. */
const MOST = 8;

/** What the words of a command line ask for: `Next` of baker/wasm. */
export type Next =
  | { do: "print"; text: string; isError: boolean; code: number }
  | { do: "bake"; output: string; report: string | null; preview: string | null; isJson: boolean; workers: number | null };

/** The result of a bake. */
export type Done = Extract<CommandTold, { type: "done" }>;

/** What is told during a bake. */
export type Tidings = Exclude<CommandTold, { type: "done" } | { type: "failed" }>;

/** Parses the words of a command line and checks the paths in them. `isColoured`: texts have the colours of a terminal. */
export async function parsed(words: readonly string[], files: CommandStart["files"], isColoured: boolean): Promise<Next> {
  await init(await compiled());
  const fails = (message: string): never => {
    throw new Error(message);
  };
  const host = new CommandHost(0, [], files, () => undefined, fails);
  return JSON.parse(parse(host, [...words], isColoured)) as Next;
}

/** The number of workers of a bake. */
export async function workersFor(wanted: number | null): Promise<number> {
  return wanted ?? Math.min(await cores(), MOST);
}

/** Bakes. Rejects with an error whose message is a sentence, and with the signal's reason. */
export async function bakeInWorkers(
  words: readonly string[],
  files: CommandStart["files"],
  size: number,
  told: (tidings: Tidings) => void,
  signal?: AbortSignal,
): Promise<Done> {
  const module = await compiled();
  signal?.throwIfAborted();
  const threads: Thread<CommandStart>[] = [];
  try {
    return await new Promise<Done>((resolve, reject) => {
      signal?.addEventListener("abort", () => reject(signal.reason), { once: true });
      const message = (one: CommandTold): void => {
        if (signal?.aborted) return;
        if (one.type === "failed") reject(new Error(one.message));
        else if (one.type === "done") resolve(one);
        else told(one);
      };
      const died = (why: string): void =>
        reject(new Error(`a worker of the bake ended before its work: ${why}; bake with fewer --threads, or with the native program`));
      // The package has one worker, which reads STEP files, too.
      const begin = async (own: (MessagePort | null)[], rank: number): Promise<void> => {
        const thread = await startThread<CommandStart, CommandTold>(false, message, died);
        threads.push(thread);
        thread.post({ rank, size, ports: own, words: [...words], files, module }, own.filter((port) => port !== null));
      };
      Promise.all(channels(size).map(begin)).catch(reject);
    });
  } finally {
    for (const thread of threads) thread.stop();
  }
}
