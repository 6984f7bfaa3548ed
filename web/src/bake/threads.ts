/** Workers: of a browser, or of Node.js. */

import { IS_NODE, nodeModule } from "./node.js";

/** A running worker, which is sent an `S` to start. */
export interface Thread<S> {
  /** Sends the start; hands over the ports. */
  post(message: S, ports: MessagePort[]): void;
  /** Ends the worker at once. */
  stop(): void;
}

/** What this uses of `Worker` of node:worker_threads. */
interface NodeWorker {
  postMessage(message: unknown, transfer: readonly MessagePort[]): void;
  terminate(): Promise<number>;
  on(event: "message" | "error" | "exit", then: (value: never) => void): void;
}

/** Returns the number of processor cores. */
export async function cores(): Promise<number> {
  if (!IS_NODE) return navigator.hardwareConcurrency;
  const { cpus } = await nodeModule<{ cpus: () => unknown[] }>("node:os");
  return Math.max(cpus().length, 1);
}

/** Starts a worker, for STEP files or for others. `told` receives its messages, `died` the reason of its early end. */
export async function startThread<S, T>(isStep: boolean, told: (message: T) => void, died: (why: string) => void): Promise<Thread<S>> {
  const url = isStep ? new URL("bake-step-worker.js", import.meta.url) : new URL("bake-worker.js", import.meta.url);
  if (IS_NODE) {
    const { Worker } = await nodeModule<{ Worker: new (url: URL) => NodeWorker }>("node:worker_threads");
    const worker = new Worker(url);
    worker.on("message", told);
    worker.on("error", (error: Error) => died(error.message));
    worker.on("exit", (code: number) => died(`exit code ${code}`));
    return { post: (message, ports) => worker.postMessage(message, ports), stop: () => void worker.terminate() };
  }
  // Bundlers find workers by these words alone.
  const own = () =>
    isStep
      ? new Worker(new URL("bake-step-worker.js", import.meta.url), { type: "module" })
      : new Worker(new URL("bake-worker.js", import.meta.url), { type: "module" });
  const worker = url.origin === location.origin ? own() : foreign(url);
  worker.onmessage = ({ data }: MessageEvent<T>) => told(data);
  worker.onerror = (event) => died(event.message || "its program could not be loaded");
  worker.onmessageerror = () => died("a message could not be read");
  return { post: (message, ports) => worker.postMessage(message, ports), stop: () => worker.terminate() };
}

/** Starts a worker from another site: a browser starts only the page's own scripts, which may import others. */
function foreign(url: URL): Worker {
  const script = URL.createObjectURL(new Blob([`import ${JSON.stringify(url.href)};`], { type: "text/javascript" }));
  const worker = new Worker(script, { type: "module" });
  worker.addEventListener("message", () => URL.revokeObjectURL(script), { once: true });
  return worker;
}
