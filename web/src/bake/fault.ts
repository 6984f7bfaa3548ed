/** What a worker says when its WebAssembly ends without a word. */

/** Bytes of memory from which a program that ends without a word has most likely asked for too much. */
const FULL = 3 * 2 ** 30;

/** Returns a sentence about a fault of the program. */
export function fault(why: string): string {
  return `the baker failed: ${why}; this is a fault of the baker: report it with the scene, if you can`;
}

/** Returns a sentence about the end of the program. `worker`: what has a limit of memory; `instead`: what has none. */
export function faultSentence(error: unknown, memory: WebAssembly.Memory | undefined, worker: string, instead: string): string {
  return (memory?.buffer.byteLength ?? 0) > FULL
    ? `the scene needs more memory than ${worker} has, 4 GB: bake it with ${instead}`
    : fault(String(error));
}

/** Whether an error is the end of the program, and not what it says. */
export function isFault(error: unknown): boolean {
  return error instanceof WebAssembly.RuntimeError || error instanceof RangeError;
}
